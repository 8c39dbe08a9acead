//! Promise: the command line remeshes any mesh with a triangle, to a mesh file of any format or a baked wavelet mesh, and describes
//! base, map and distortion; `build` does the same in one step; it answers with one object and exits 0, 1 or 2.
#![cfg(feature = "cli")]

use std::path::Path;

use crate::command::{self, Folder, Said, json};
use multires::io::{self, Format};
use multires::mesh::{Mesh, Report, names, shapes};
use multires::quality;
use serde_json::Value;

fn number(value: &Value) -> usize {
    value.as_u64().unwrap_or_else(|| panic!("{value} is no count")) as usize
}

fn length(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

fn base_faces(answer: &Value) -> usize {
    number(&answer["base"]["faces"])
}

/// Writes a mesh, remeshes it, and reads the remesh.
fn remeshed(folder: &Folder, mesh: &Mesh, how: &str) -> (Value, Mesh) {
    let [input, output] = ["in.glb", "out.glb"].map(|name| folder.file(name));
    io::write(&input, mesh).unwrap();
    let answer = json("remesh", &[&input, &output], how).answer();
    let remesh = io::read(&output).unwrap();
    assert_eq!(number(&answer["output"]["triangles"]), remesh.triangles().len());
    assert_eq!(number(&answer["output"]["vertices"]), remesh.positions().len());
    for file in [input, output] {
        std::fs::remove_file(file).unwrap();
    }
    (answer, remesh)
}

/// A cube of 16 x 16 squares a side without attributes.
fn cube() -> Mesh {
    let mesh = shapes::box_with_face_normals(16);
    Mesh::new(mesh.positions(), mesh.triangles()).unwrap()
}

/// Area of the triangles of a material.
fn area_of(mesh: &Mesh, material: u32) -> f64 {
    let of: Vec<[u32; 3]> = mesh
        .triangles()
        .iter()
        .zip(mesh.materials())
        .filter_map(|(triangle, &id)| (id == material).then_some(*triangle))
        .collect();
    quality::area(&Mesh::new(mesh.positions(), of).unwrap())
}

#[test]
fn a_remesh_is_described() {
    let folder = Folder::new("remesh-described");
    let mesh = shapes::rock(4_000, 1);
    let (answer, remesh) = remeshed(&folder, &mesh, "--levels 3 --base 120");
    assert_eq!((&answer["command"], &answer["metric"]), (&"remesh".into(), &"memoryless-quadric".into()));
    assert_eq!((number(&answer["base"]["asked"]), base_faces(&answer)), (120, 120));
    assert_eq!(number(&answer["base"]["vertices"]), 62);
    assert_eq!((number(&answer["levels"]), number(&answer["triangles"])), (3, 120 * 64));
    assert_eq!((remesh.triangles().len(), number(&answer["vertices"])), (120 * 64, 120 * 32 + 2));
    assert_eq!(number(&answer["input"]["triangles"]), mesh.triangles().len());
    let bytes = number(&answer["map"]["bytes"]) as f64;
    assert_eq!(length(&answer["map"]["bytes_per_triangle"]), bytes / mesh.triangles().len() as f64);
    let distortion = &answer["distortion"];
    assert_eq!((number(&distortion["level"]), number(&distortion["triangles"])), (3, 120 * 64));
    assert!(number(&answer["folded"]) == 0 && number(&answer["unfolded"]) < 120);
    for kind in ["angle", "area"] {
        let [mean, p99] = ["mean", "p99"].map(|name| length(&distortion[kind][name]));
        assert!(1.0 < mean && mean < 1.5 && mean < p99 && p99 < 4.0, "{kind}: {mean} {p99}");
    }
    assert!(answer["distance"].is_null() && length(&answer["seconds"]) > 0.0);
    assert!(Report::welded(&remesh).is_closed());
    assert_eq!(folder.names(), [""; 0]);
}

#[test]
fn a_remesh_is_as_far_off_as_measure_finds() {
    let folder = Folder::new("remesh-measured");
    let [input, output] = ["in.ply", "out.ply"].map(|name| folder.file(name));
    io::write(&input, &shapes::rock(4_000, 1)).unwrap();
    let answer = json("remesh", &[&input, &output], "--levels 3 --base 120 --measure").answer();
    let measured = json("measure", &[&input, &output], "").answer();
    assert_eq!(answer["distance"], measured["distance"]);
    assert!(length(&answer["distance"]["both"]["mean_percent"]) < 0.2);
}

#[test]
fn every_format_is_written() {
    let folder = Folder::new("remesh-formats");
    let input = folder.file("in.ply");
    io::write(&input, &shapes::rock(2_000, 1)).unwrap();
    for extension in ["obj", "ply", "stl", "off", "glb", "gltf"] {
        let output = folder.file(&format!("out.{extension}"));
        let answer = json("remesh", &[&input, &output], "--levels 1 --base 100").answer();
        let remesh = io::read(&output).unwrap();
        assert_eq!(remesh.triangles().len(), 4 * base_faces(&answer), "{extension}");
        assert!(Report::welded(&remesh).is_closed(), "{extension}");
    }
    // In place.
    let answer = json("remesh", &[&input, &input], "--levels 2 --base 100").answer();
    assert_eq!(io::read(&input).unwrap().triangles().len(), 16 * base_faces(&answer));
}

#[test]
fn a_baked_remesh_is_a_wavelet_mesh() {
    let folder = Folder::new("remesh-baked");
    let [input, mesh, baked, built, level] =
        ["in.ply", "out.ply", "remesh.mres", "build.mres", "level.ply"].map(|name| folder.file(name));
    io::write(&input, &shapes::rock(3_000, 2)).unwrap();
    let how = "--levels 3 --base 150";
    json("remesh", &[&input, &mesh], how).answer();
    let answer = json("remesh", &[&input, &baked], how).answer();
    let info = json("info", &[&baked], "").answer();
    for key in ["levels", "base_triangles", "wavelets", "vertices", "triangles", "by_level", "bound"] {
        assert_eq!(answer[key], info[key], "{key}");
        assert!(!info[key].is_null(), "{key}");
    }
    assert_eq!((&info["kind"], number(&info["base_triangles"])), (&"wavelet".into(), base_faces(&answer)));
    assert_eq!(number(&info["bytes"]), number(&answer["output"]["bytes"]));

    // Its finest level is the mesh; in one step it is the same file.
    json("extract", &[&baked, &level], "--level 3").answer();
    assert_eq!(io::read(&level).unwrap(), io::read(&mesh).unwrap());
    let of_build = json("build", &[&input, &built], &format!("--structure wavelet --remesh {how}")).answer();
    assert_eq!(std::fs::read(&baked).unwrap(), std::fs::read(&built).unwrap());
    for key in ["base", "map", "distortion", "metric", "unfolded", "folded"] {
        assert_eq!(of_build["remesh"][key], answer[key], "{key}");
    }

    let far = json("adapt", &[&baked, &level], "--eye 0,0,20 --target 0,0,0").answer();
    let near = json("adapt", &[&baked, &level], "--eye 0,0,2 --target 0,0,0").answer();
    assert!(number(&far["output"]["triangles"]) < number(&near["output"]["triangles"]));
    let hoppe = "--structure wavelet --remesh --bound without-siblings --shape hoppe";
    json("build", &[&input, &built], &format!("{hoppe} {how}")).answer();
    let info = json("info", &[&built], "").answer();
    assert_eq!((&info["bound"], &info["shape"]), (&"without-siblings".into(), &"hoppe".into()));
}

#[test]
fn a_smaller_error_takes_more_triangles() {
    let folder = Folder::new("remesh-error");
    let mesh = shapes::rock(3_000, 3);
    let mut last = 0;
    for percent in [2.0, 0.7, 0.25] {
        let (answer, remesh) = remeshed(&folder, &mesh, &format!("--error-percent {percent} --measure"));
        assert!(remesh.triangles().len() > last, "{percent} %: {}", remesh.triangles().len());
        last = remesh.triangles().len();
        assert!(length(&answer["distance"]["both"]["mean_percent"]) < percent, "{answer}");
        let error = percent / 100.0 * mesh.diagonal();
        let (absolute, same) = remeshed(&folder, &mesh, &format!("--error {error}"));
        assert_eq!((absolute["triangles"].clone(), same), (answer["triangles"].clone(), remesh));
        assert!(Report::welded(&io_of(&folder, &mesh, percent)).is_closed());
    }
}

/// The finest level of an adaptive remesh, by way of a baked file.
fn io_of(folder: &Folder, mesh: &Mesh, percent: f64) -> Mesh {
    let [input, baked, level] = ["in.ply", "all.mres", "level.ply"].map(|name| folder.file(name));
    io::write(&input, mesh).unwrap();
    let answer = json("remesh", &[&input, &baked], &format!("--error-percent {percent}")).answer();
    let levels = number(&answer["levels"]);
    let taken = json("extract", &[&baked, &level], &format!("--level {levels}")).answer();
    assert_eq!(taken["output"]["triangles"], answer["triangles"]);
    io::read(&level).unwrap()
}

#[test]
fn attributes_and_materials_come_along() {
    let folder = Folder::new("remesh-attributes");
    let mesh = shapes::box_with_face_normals(8);
    // A material a side of the box.
    let sides: Vec<u32> =
        (0..mesh.triangles().len()).map(|t| (6 * t / mesh.triangles().len()) as u32).collect();
    let mesh = mesh.with_materials(sides).unwrap();
    let (answer, remesh) = remeshed(&folder, &mesh, "--levels 3 --base 12 --measure");
    assert_eq!(base_faces(&answer), 12);
    assert!(length(&answer["distance"]["both"]["max_percent"]) < 1e-4, "{answer}");
    let [before, after] =
        [&mesh, &remesh].map(|mesh| mesh.attribute(names::NORMAL).unwrap().as_floats().unwrap());
    assert!(after.chunks(3).all(|normal| before.chunks(3).any(|of| of == normal)));
    for side in 0..6 {
        let [before, after] = [&mesh, &remesh].map(|mesh| area_of(mesh, side));
        assert!((before - after).abs() < 1e-5 * before, "side {side}: {before} {after}");
    }
    // Without materials, normals and creases fewer edges are held: those of seams of the texture.
    let (dropped, plain) =
        remeshed(&folder, &mesh, "--levels 3 --base 4 --drop normal,material,uv --features 180");
    assert_eq!(number(&dropped["base"]["feature_sides"]), 0);
    assert!(plain.materials().is_empty() && plain.attribute(names::NORMAL).is_none());
}

#[test]
fn features_hold_edges_of_the_base() {
    let folder = Folder::new("remesh-features");
    let feature_sides = |how: &str| {
        let (answer, _) = remeshed(&folder, &cube(), &format!("--base 12 --levels 2 --measure {how}"));
        assert!(length(&answer["distance"]["both"]["max_percent"]) < 1e-4, "{how}");
        number(&answer["base"]["feature_sides"])
    };
    // Twelve edges, each on two faces.
    assert_eq!(["", "--features 60", "--features 180"].map(feature_sides), [24, 24, 0]);
    // More features than faces asked for.
    let (answer, _) = remeshed(&folder, &cube(), "--base 4 --levels 1 --features 60");
    assert_eq!((base_faces(&answer), number(&answer["base"]["feature_sides"])), (12, 24));
    assert!(answer["warnings"][0].as_str().unwrap().contains("12 faces, not 4"), "{answer}");
}

#[test]
fn a_metric_makes_a_base_of_its_own() {
    let folder = Folder::new("remesh-metric");
    let mesh = shapes::rock(2_000, 5);
    let by = |how: &str| remeshed(&folder, &mesh, &format!("--base 80 --levels 1 {how}"));
    let (answer, edges) = by("--metric edge-length");
    assert_eq!(answer["metric"], "edge-length");
    assert!(by("").1.positions() != edges.positions());
    let [input, built] = ["in.ply", "all.mres"].map(|name| folder.file(name));
    io::write(&input, &mesh).unwrap();
    let how = "--structure wavelet --remesh --levels 1 --base 80 --metric edge-length";
    assert_eq!(json("build", &[&input, &built], how).answer()["remesh"]["metric"], "edge-length");
}

#[test]
fn smoothing_keeps_angles_better() {
    let folder = Folder::new("remesh-smoothing");
    let mesh = shapes::rock(4_000, 6);
    let [harmonic, off] = ["harmonic", "off"].map(|how| {
        let (answer, _) = remeshed(&folder, &mesh, &format!("--levels 4 --base 60 --smoothing {how}"));
        assert_eq!(answer["smoothing"], how);
        length(&answer["distortion"]["angle"]["mean"])
    });
    assert!(harmonic < off, "{harmonic} {off}");
    let (default, _) = remeshed(&folder, &mesh, "--levels 4 --base 60");
    assert_eq!(
        (&default["smoothing"], length(&default["distortion"]["angle"]["mean"])),
        (&"harmonic".into(), harmonic)
    );
}

#[test]
fn any_connectivity_is_taken() {
    let folder = Folder::new("remesh-any");
    for (name, mesh) in [
        ("tetrahedron", shapes::tetrahedron()),
        ("plane", shapes::plane(12)),
        ("moebius", shapes::moebius(60)),
        ("book", shapes::book(3)),
        ("bowtie", shapes::bowtie()),
        ("two spheres", shapes::two_spheres_touching(3)),
        ("torus", shapes::torus(1.0, 0.4, 48, 24)),
        ("soup", shapes::soup(60, 1)),
        ("gravel", shapes::gravel(12, 1)),
        ("gear", shapes::gear(12, 0.3)),
    ] {
        let (answer, remesh) = remeshed(&folder, &mesh, "--levels 2 --base 60");
        assert_eq!(remesh.triangles().len(), 16 * base_faces(&answer), "{name}");
        let [before, after] = [&mesh, &remesh].map(Report::welded);
        assert_eq!(before.is_closed(), after.is_closed(), "{name}");
        assert_eq!(before.components, after.components, "{name}");
        assert_eq!(before.euler_characteristic, after.euler_characteristic, "{name}");
    }
}

#[test]
fn bad_usage_is_said_before_anything_is_read() {
    let folder = Folder::new("remesh-usage");
    let [input, out, baked] = ["in.ply", "out.ply", "all.mres"].map(|name| folder.file(name));
    let usage = |command: &str, files: &[&Path], how: &str, reason: &str| {
        let said = json(command, files, how);
        assert_eq!(said.code, Some(2), "{how}: {said:?}");
        assert!(said.err.contains(reason) && said.json()["error"].is_string(), "{how}: {said:?}");
    };
    for (how, reason) in [
        ("", "--levels, --error or --error-percent"),
        ("--levels 2 --error 1", "cannot be used with"),
        ("--error 1 --error-percent 1", "cannot be used with"),
        ("--levels 11", "11 is not in 0..=10"),
        ("--levels -1", "-1"),
        ("--error=-1", "0 or more"),
        ("--error nan", "0 or more"),
        ("--levels 2 --features 181", "0 to 180"),
        ("--levels 2 --base x", "invalid digit"),
        ("--levels 2 --metric best", "lindstrom-turk"),
    ] {
        usage("remesh", &[&input, &out], how, reason);
    }
    usage("remesh", &[&input, &folder.file("out.xyz")], "--levels 2", ".glb");
    for (how, reason) in [
        ("--structure tom --remesh --levels 2", "--structure wavelet"),
        ("--structure wavelet --levels 2", "for --remesh"),
        ("--structure wavelet --base 100", "for --remesh"),
        ("--structure hierarchy --features 30", "for --remesh"),
        ("--structure wavelet --remesh", "--levels, --error or --error-percent"),
        ("--structure wavelet --remesh --levels 2 --placement endpoint", "--placement: --remesh"),
        ("--structure wavelet --remesh --levels 2 --coarsest 10", "--coarsest: --remesh"),
        ("--structure wavelet --metric quadric", "--metric: --structure wavelet"),
    ] {
        usage("build", &[&input, &baked], how, reason);
    }
    assert_eq!(folder.names(), [""; 0]);
}

#[test]
fn bad_input_leaves_the_output_alone() {
    let folder = Folder::new("remesh-bad");
    let [input, none, old] = ["in.ply", "none.ply", "old.ply"].map(|name| folder.file(name));
    std::fs::write(&old, b"old").unwrap();
    let refused = |input: &Path, how: &str| {
        let reason = json("remesh", &[input, &old], how).refusal();
        assert_eq!(std::fs::read(&old).unwrap(), b"old");
        reason
    };
    assert!(refused(&none, "--levels 2").contains("none.ply"));
    std::fs::write(&input, b"ply\nrubbish").unwrap();
    assert!(refused(&input, "--levels 2").contains("in.ply"));
    let needle = Mesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0; 3]], vec![[0, 1, 2]]).unwrap();
    for mesh in [Mesh::default(), needle] {
        io::write(&input, &mesh).unwrap();
        let said = refused(&input, "--levels 2");
        assert!(said.contains("in.ply: the mesh has no triangles"), "{said}");
    }
    io::write(&input, &shapes::tetrahedron()).unwrap();
    assert!(refused(&input, "--levels 2 --drop colour").contains("colour"));
    assert!(
        json("remesh", &[&input, &folder.file("no/out.ply")], "--levels 2")
            .refusal()
            .contains("no such folder")
    );
    assert_eq!(folder.names(), ["in.ply", "old.ply"]);
}

#[test]
fn bytes_do_not_depend_on_threads() {
    let folder = Folder::new("remesh-threads");
    let input = folder.file("in.ply");
    io::write(&input, &shapes::rock(6_000, 4)).unwrap();
    let bytes = ["1", "4"].map(|threads| {
        let output = folder.file(&format!("{threads}.mres"));
        let mut command = command::command(["remesh", "--levels", "3"]);
        let command = command.args([&input, &output]).env("RAYON_NUM_THREADS", threads);
        assert!(command.output().unwrap().status.success());
        std::fs::read(output).unwrap()
    });
    assert!(bytes[0] == bytes[1]);
}

#[test]
fn hostile_files() {
    let Some(hostile) = crate::models::find("cli/remesh", "hostile") else { return };
    let folder = Folder::new("remesh-hostile");
    let output = folder.file("out.ply");
    let mut files: Vec<_> = std::fs::read_dir(hostile).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.retain(|path| Format::from_path(path).is_some());
    files.sort();
    assert!(files.len() > 20);
    for file in files {
        let [info, said] = [json("info", &[&file], ""), json("remesh", &[&file, &output], "--levels 1")];
        match (info.code, said.code) {
            (Some(1), _) => assert_eq!(info.refusal(), said.refusal()),
            (_, Some(1)) => assert!(said.refusal().contains("the mesh has no triangles"), "{said:?}"),
            _ => {
                let answer = said.answer();
                let remesh = io::read(&output).unwrap();
                assert_eq!(remesh.triangles().len(), 4 * base_faces(&answer), "{}", file.display());
                std::fs::remove_file(&output).unwrap();
            }
        }
        assert_eq!(folder.names(), [""; 0], "{}", file.display());
    }
}

#[test]
fn real_models() {
    let folder = Folder::new("remesh-real");
    let output = folder.file("out.ply");
    // The topology is kept, and the remesh is near.
    for (name, base, mean_percent) in [
        ("real/fandisk.obj", 500, 0.03),
        ("real/fertility.ply", 500, 0.05),
        ("real/rocker-arm.obj", 500, 0.05),
        ("real/spot.obj", 500, 0.1),
    ] {
        let Some(file) = crate::models::find("cli/remesh", name) else { continue };
        let said: Said = json("remesh", &[&file, &output], &format!("--levels 4 --base {base} --measure"));
        let answer = said.answer();
        let [before, after] = [io::read(&file).unwrap(), io::read(&output).unwrap()];
        assert_eq!(after.triangles().len(), 256 * base_faces(&answer), "{name}");
        let [before, after] = [&before, &after].map(Report::welded);
        assert_eq!(before.euler_characteristic, after.euler_characteristic, "{name}");
        assert_eq!(before.is_closed(), after.is_closed(), "{name}");
        assert!(length(&answer["distance"]["both"]["mean_percent"]) < mean_percent, "{name}: {answer}");
    }
}

#[test]
fn pictures_are_baked_and_referred_to() {
    let folder = Folder::new("cli_remesh_bake");
    let [input, output, texture, pictures] =
        ["in.glb", "out.gltf", "texture.png", "pictures"].map(|name| folder.file(name));
    io::write(&input, &shapes::uv_sphere(32, 16)).unwrap();
    // A texture of one colour.
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 2, 2);
    encoder.set_color(png::ColorType::Rgb);
    encoder.write_header().unwrap().write_image_data(&[10, 200, 30].repeat(4)).unwrap();
    std::fs::write(&texture, bytes).unwrap();

    let [to, from] = [&pictures, &texture].map(|path| path.display().to_string());
    let how = format!("--levels 2 --base 40 --bake {to} --texture {from} --texels 256");
    let answer = json("remesh", &[&input, &output], &how).answer();
    assert_eq!(answer["baked"]["texels"], 256);
    assert_eq!(answer["baked"]["pictures"].as_array().unwrap().len(), 2);
    let document: Value = serde_json::from_slice(&std::fs::read(&output).unwrap()).unwrap();
    let uris: Vec<&str> =
        document["images"].as_array().unwrap().iter().map(|image| image["uri"].as_str().unwrap()).collect();
    assert_eq!(uris, ["pictures/base_color.png", "pictures/normal.png"]);
    let mesh = io::read(&output).unwrap();
    assert!([names::UV, names::TANGENT, names::NORMAL].iter().all(|name| mesh.attribute(name).is_some()));
    assert_eq!(mesh.triangles().len(), number(&answer["triangles"]));
    let decoder = png::Decoder::new(std::io::BufReader::new(
        std::fs::File::open(Path::new(&to).join("base_color.png")).unwrap(),
    ));
    let mut reader = decoder.read_info().unwrap();
    let mut texels = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut texels).unwrap();
    let filled = texels.chunks_exact(4).filter(|texel| texel == &[10, 200, 30, 255]).count();
    assert!(filled > 256 * 256 / 4 && texels.chunks_exact(4).all(|t| t == [10, 200, 30, 255] || t == [0; 4]));

    // Pictures need a level, and a file that refers to them.
    let uniform = format!("--levels 2 --bake {to}");
    let other = folder.file("out.ply");
    let said = json("remesh", &[&input, &other], &uniform);
    assert!(said.code == Some(2) && said.err.contains("--bake"), "{said:?}");
    let adaptive = format!("--error-percent 1 --bake {to}");
    let said = json("remesh", &[&input, &output], &adaptive);
    assert!(said.code == Some(2) && said.err.contains("--levels"), "{said:?}");
}
