//! Promise: the command line bakes meshes with subdivision connectivity as wavelets and says why where a mesh has none; takes out
//! levels and what views ask for, and flies over them; it answers with one object and exits 0, 1 or 2.
#![cfg(feature = "cli")]

use std::path::{Path, PathBuf};

use crate::command::{self, Folder, json, run};
use crate::wavelet_support::{positions, uniform};
use multires::Baked;
use multires::io;
use multires::mesh::{Mesh, Report, names, shapes};
use multires::wavelet::{Normals, WaveletBuilder, WaveletMesh, WaveletOptions};
use serde_json::Value;

fn number(value: &Value) -> usize {
    value.as_u64().unwrap_or_else(|| panic!("{value} is no count")) as usize
}

/// A rough sphere, 20 base faces.
fn sphere(levels: usize) -> Mesh {
    uniform(&shapes::icosphere(0), levels, 1, &WaveletOptions::default()).finest(Normals::Kept)
}

/// A rough box with seams, normals and two materials.
fn crate_box() -> Mesh {
    let base = shapes::box_with_face_normals(1);
    let materials: Vec<u32> = (0..base.triangles().len() as u32).map(|t| t % 2).collect();
    let base = base.with_materials(materials).unwrap();
    uniform(&base, 4, 2, &WaveletOptions::default()).finest(Normals::Kept)
}

/// Two meshes as one, some way apart.
fn beside(a: &Mesh, b: &Mesh) -> Mesh {
    let count = a.positions().len() as u32;
    let shifted = b.positions().iter().map(|&[x, y, z]| [x + 9.0, y, z]);
    let triangles = b.triangles().iter().map(|t| t.map(|v| v + count));
    let positions: Vec<[f32; 3]> = a.positions().iter().copied().chain(shifted).collect();
    Mesh::new(positions, a.triangles().iter().copied().chain(triangles).collect::<Vec<_>>()).unwrap()
}

/// A model and its baked wavelets.
fn baked(folder: &Folder, mesh: &Mesh, how: &str) -> (PathBuf, Value) {
    let [input, baked] = ["in.glb", "all.mres"].map(|n| folder.file(n));
    io::write(&input, mesh).unwrap();
    let answer = json("build", &[&input, &baked], &format!("--structure wavelet {how}")).answer();
    std::fs::remove_file(input).unwrap();
    (baked, answer)
}

fn take(command: &str, baked: &Path, out: &Path, how: &str) -> (Value, Mesh) {
    let answer = json(command, &[baked, out], how).answer();
    let mesh = io::read(out).unwrap();
    assert_eq!(number(&answer["output"]["triangles"]), mesh.triangles().len());
    assert_eq!(number(&answer["output"]["vertices"]), mesh.positions().len());
    (answer, mesh)
}

#[test]
fn wavelets_are_baked_and_described() {
    let folder = Folder::new("wavelet-baked");
    let mesh = sphere(4);
    for (bound, shape) in [("conservative", "spheroid"), ("without-siblings", "hoppe")] {
        let (file, built) = baked(&folder, &mesh, &format!("--bound {bound} --shape {shape}"));
        let info = json("info", &[&file], "").answer();
        for key in [
            "levels",
            "base_triangles",
            "wavelets",
            "vertices",
            "triangles",
            "by_level",
            "memory",
            "origins_memory",
        ] {
            assert_eq!(built[key], info[key], "{key}");
            assert!(!info[key].is_null(), "{key}");
        }
        assert_eq!((&info["kind"], &built["structure"]), (&"wavelet".into(), &"wavelet".into()));
        assert_eq!((&info["bound"], &info["shape"]), (&bound.into(), &shape.into()));
        assert_eq!((number(&info["levels"]), number(&info["base_triangles"])), (4, 20));
        assert_eq!((number(&info["triangles"]), number(&info["vertices"])), (20 * 256, 2562));
        assert_eq!(number(&info["wavelets"]), 2562 - 12);
        assert_eq!(number(&built["components"][0]["levels"]), 4);
        assert!(built["components"][0]["stop"].as_str().unwrap().contains("triangle"));
        let levels = info["by_level"].as_array().unwrap();
        assert!(levels.len() == 5 && levels[4]["error"] == 0.0 && levels[1]["faces"] == 80);
        assert!(levels.windows(2).all(|w| w[0]["error"].as_f64() > w[1]["error"].as_f64()));
        assert_eq!(number(&info["bytes"]), number(&built["output"]["bytes"]));
        assert!(info["memory_percent"].as_f64().unwrap() > 100.0);
    }
    // By default bounds are proven.
    let (file, built) = baked(&folder, &crate_box(), "");
    assert_eq!((&built["bound"], &built["shape"]), (&"conservative".into(), &"spheroid".into()));
    let info = json("info", &[&file], "").answer();
    assert_eq!(info["materials"].as_array().unwrap().len(), 2);
    assert_eq!(info["attributes"][0]["name"], names::NORMAL);
    assert_eq!((number(&info["base_triangles"]), number(&info["levels"])), (12, 4));
    assert_eq!(folder.names(), ["all.mres"]);
}

#[test]
fn meshes_without_the_connectivity_are_refused_with_the_reason() {
    let folder = Folder::new("wavelet-refused");
    let [input, output] = ["in.ply", "old.mres"].map(|n| folder.file(n));
    std::fs::write(&output, b"old").unwrap();
    for (mesh, reason) in [
        (shapes::moebius(9), "18 triangles, 0 levels: 18 faces do not divide by four"),
        (shapes::tetrahedron(), "4 triangles, 0 levels: "),
        (beside(&shapes::tetrahedron(), &shapes::moebius(9)), "the largest of 2 components has 18 triangles"),
        (Mesh::default(), "there are no triangles"),
    ] {
        io::write(&input, &mesh).unwrap();
        let said = json("build", &[&input, &output], "--structure wavelet").refusal();
        assert!(said.contains("in.ply") && said.contains(reason), "{said}");
        for way in ["--remesh --levels", "--structure hierarchy", "--structure tom", "subdivide"] {
            assert!(said.contains(way), "{said}");
        }
        assert_eq!(std::fs::read(&output).unwrap(), b"old");
    }
    // A component that has it is enough; the others are said.
    let fine = sphere(3);
    let both = beside(&fine, &shapes::moebius(9));
    io::write(&input, &both).unwrap();
    let said = json("build", &[&input, &output], "--structure wavelet");
    let answer = said.answer();
    assert!(said.err.starts_with("warning: 1 of 2 components") && answer["warnings"][0].is_string());
    assert_eq!(answer["components"].as_array().unwrap().len(), 2);
    assert_eq!(number(&answer["base_triangles"]), 20 + 18);
    let text = run([
        "build".as_ref(),
        input.as_os_str(),
        output.as_os_str(),
        "--structure".as_ref(),
        "wavelet".as_ref(),
    ]);
    assert!(text.code == Some(0) && text.out.contains("3 levels above 20 base faces"), "{text:?}");
    // A seam or a border of materials in the way can be left out.
    let striped = fine.with_materials((0..1280).map(|t| t % 2).collect::<Vec<u32>>()).unwrap();
    let input = folder.file("striped.glb");
    io::write(&input, &striped).unwrap();
    let said = json("build", &[&input, &output], "--structure wavelet").refusal();
    assert!(said.contains("materials change") && said.contains("--drop"), "{said}");
    let answer = json("build", &[&input, &output], "--structure wavelet --drop material").answer();
    assert_eq!(number(&answer["levels"]), 3);
}

#[test]
fn levels_come_out_as_they_are_in_the_library() {
    let folder = Folder::new("wavelet-extract");
    let out = folder.file("out.ply");
    let mesh = sphere(4);
    let (file, built) = baked(&folder, &mesh, "");
    let found = WaveletMesh::recognise(&mesh, &WaveletOptions::default()).unwrap();
    for level in 0..=4 {
        let (answer, result) = take("extract", &file, &out, &format!("--level {level}"));
        assert_eq!(positions(&result), positions(&found.at_level(level, Normals::Kept)));
        assert_eq!(result.triangles().len(), 20 << (2 * level));
        assert_eq!(answer["error"], built["by_level"][level]["error"]);
        assert_eq!(number(&answer["deepest_level"]), level);
    }
    let finest = take("extract", &file, &out, "--level 7").1;
    assert_eq!(positions(&finest), positions(&mesh));

    let coarsest = built["by_level"][0]["error"].as_f64().unwrap();
    let mut last = usize::MAX;
    for share in [0.01, 0.1, 0.3, 0.9] {
        let (answer, result) = take("extract", &file, &out, &format!("--error {}", share * coarsest));
        assert!(answer["error"].as_f64().unwrap() <= share * coarsest);
        assert!(result.triangles().len() < last && result.triangles().len() > 20);
        assert!(Report::welded(&result).is_closed());
        last = result.triangles().len();
        // So many triangles are enough for no more error.
        let (by_count, _) = take("extract", &file, &out, &format!("--triangles {last}"));
        assert!(by_count["error"].as_f64() <= answer["error"].as_f64());
    }
    let diagonal = json("info", &[&file], "").answer()["diagonal"].as_f64().unwrap();
    for vertices in [12, 40, 100] {
        let level = take("extract", &file, &out, &format!("--vertices {vertices}")).1;
        assert!(level.positions().len() <= vertices && level.triangles().len() >= 20);
    }
    let by = |how: &str| take("extract", &file, &out, how).1;
    let percent = 30.0 * coarsest / diagonal;
    assert_eq!(
        by(&format!("--error-percent {percent}")),
        by(&format!("--error {}", percent / 100.0 * diagonal))
    );
    for ratio in [0.02, 0.25, 0.8] {
        let (answer, result) = take("extract", &file, &out, &format!("--ratio {ratio}"));
        let most = (ratio * 5120.0) as usize;
        assert!(result.triangles().len() <= most && result.triangles().len() + 8 > most, "{ratio}");
        assert!((answer["ratio"].as_f64().unwrap() - result.triangles().len() as f64 / 5120.0).abs() < 1e-9);
        let minimal = by(&format!("--ratio {ratio} --triangulation minimal"));
        assert!(minimal.triangles().len() <= most && Report::welded(&minimal).is_closed());
    }
    assert_eq!(positions(&by("--ratio 1")), positions(&mesh));
    assert_eq!(by("--triangles 0").triangles().len(), 20);
    assert!(by("--ratio 0.3 --normals recomputed").attribute(names::NORMAL).is_some());
    assert!(by("--ratio 0.3 --normals kept").attribute(names::NORMAL).is_none());
    let (file, _) = baked(&folder, &crate_box(), "");
    let [kept, recomputed] = ["kept", "recomputed"].map(|how| {
        let mesh = take("extract", &file, &out, &format!("--level 1 --normals {how}")).1;
        mesh.attribute(names::NORMAL).unwrap().values().clone()
    });
    assert!(kept.len() == recomputed.len() && kept != recomputed);
}

#[test]
fn nearer_is_finer_and_a_budget_is_kept() {
    let folder = Folder::new("wavelet-adapt");
    let out = folder.file("out.glb");
    let mesh = crate_box();
    let (file, built) = baked(&folder, &mesh, "");
    let mut last = usize::MAX;
    for distance in ["0.7", "3", "12", "60"] {
        let (answer, level) = take("adapt", &file, &out, &format!("--eye 0.3,0.2,{distance} --target 0,0,0"));
        assert!(level.triangles().len() < last, "{distance}");
        last = level.triangles().len();
        assert!(number(&answer["refinements"]) > 0 && answer["splits"].is_null());
        assert!(level.attribute(names::NORMAL).is_some() && !level.materials().is_empty());
        assert!(Report::welded(&level).is_closed());
    }
    let view = "--eye 1,0.6,6 --target 0,0,0";
    let count = |how: &str| take("adapt", &file, &out, &format!("{view} {how}")).1.triangles().len();
    let plain = count("");
    assert!(count("--tolerance 4") < plain && count("--tolerance 0.25") > plain);
    assert!(count("--silhouette 0.05") > plain && count("--both-sides") > plain);
    assert!(count("--triangulation minimal --tolerance 4") <= count("--tolerance 4"));
    assert_eq!(count("--triangulation exact"), plain);
    assert!(count("--radius 6") > 12);
    let budget = plain / 2;
    let (answer, level) = take("adapt", &file, &out, &format!("{view} --budget {budget}"));
    assert!(level.triangles().len() <= budget && 10 * level.triangles().len() > 9 * budget);
    assert!(answer["coarsened"].as_f64().unwrap() > 1.0);
    let said = json("adapt", &[&file, &out], &format!("{view} --budget 0"));
    assert_eq!(said.answer()["output"]["triangles"], built["base_triangles"]);
    assert!(said.err.starts_with("warning: "), "{said:?}");
}

#[test]
fn a_flight_is_a_row_a_frame_within_its_limits() {
    let folder = Folder::new("wavelet-fly");
    let [frames, out, camera] = ["frames.csv", "out.ply", "path.csv"].map(|n| folder.file(n));
    let mut path = "frame,ex,ey,ez,tx,ty,tz\n".to_owned();
    for frame in 0..20 {
        let angle = f64::from(frame) * 0.02;
        path += &format!("{frame},{},0.2,{},0,0,0\n", 0.9 * angle.sin(), 0.9 * angle.cos());
    }
    std::fs::write(&camera, path).unwrap();
    // With attributes and without: what is written for a vertex is all that it has.
    for mesh in [crate_box(), sphere(5)] {
        let width: usize = mesh.attributes().iter().map(|attribute| attribute.width()).sum();
        let per_vertex = 12.0 + 4.0 * width as f64;
        let (file, _) = baked(&folder, &mesh, "");
        let options = format!("--path {} --csv {}", camera.display(), frames.display());
        let fly = |more: &str| {
            let answer = json("fly", &[&file], &format!("{options} {more}")).answer();
            assert_eq!(number(&answer["frames"]), 20);
            let text = std::fs::read_to_string(&frames).unwrap();
            let row = |line: &str| line.split(',').map(|field| field.parse().unwrap()).collect::<Vec<f64>>();
            text.lines().skip(1).map(row).collect::<Vec<_>>()
        };
        let rows = fly("--tolerance 2");
        let packed = fly("--tolerance 2 --packed");
        let all = mesh.positions().len() as f64;
        assert_eq!(rows[0][7], 12.0 * rows[0][1] + per_vertex * all);
        assert!(packed[0][7] < rows[0][7] && rows[1][7] < 0.5 * rows[0][7]);
        for (row, packed) in rows.iter().zip(&packed) {
            assert_eq!(row[..6], packed[..6]);
        }
        let (_, at) = take(
            "adapt",
            &file,
            &out,
            &format!(
                "--eye {},0.2,{} --target 0,0,0 --tolerance 2",
                0.9 * 0.2_f64.sin(),
                0.9 * 0.2_f64.cos()
            ),
        );
        assert_eq!((rows[10][1], rows[10][2]), (at.triangles().len() as f64, at.positions().len() as f64));
        let minimal = fly("--tolerance 2 --triangulation minimal");
        assert!(rows.iter().zip(&minimal).all(|(exact, minimal)| minimal[1] <= exact[1]));
        let most = rows[0][1] / 2.0;
        let budget = fly(&format!("--tolerance 2 --budget {most:.0}"));
        assert!(budget.iter().all(|row| row[1] <= most + 0.5 && row[1] > 0.8 * most));
        let operations = fly("--tolerance 2 --operations 30");
        assert!(operations.iter().all(|row| row[4] + row[5] <= 30.0) && operations[3][4] > 0.0);
    }
}

#[test]
fn bad_usage_is_said() {
    let folder = Folder::new("wavelet-usage");
    let [input, out] = ["in.ply", "out.ply"].map(|n| folder.file(n));
    let [tom, hierarchy, wavelet, new] =
        ["tom.mres", "hierarchy.mres", "wavelet.mres", "new.mres"].map(|n| folder.file(n));
    io::write(&input, &sphere(2)).unwrap();
    for (file, structure) in [(&tom, "tom"), (&hierarchy, "hierarchy"), (&wavelet, "wavelet")] {
        json("build", &[&input, file], &format!("--structure {structure}")).answer();
    }
    let usage = |command: &str, files: &[&Path], how: &str, reason: &str| {
        let said = json(command, files, how);
        assert_eq!(said.code, Some(2), "{how}: {said:?}");
        assert!(said.err.contains(reason) && said.json()["error"].is_string(), "{how}: {said:?}");
    };
    for given in [
        "--metric quadric",
        "--placement endpoint",
        "--order linear",
        "--error-measure parametric",
        "--attributes off",
        "--lock-borders",
        "--join-distance 0",
        "--max-turn 78",
        "--min-quality 0.01",
    ] {
        let option = given.split(' ').next().unwrap();
        usage("build", &[&input, &new], &format!("--structure wavelet {given}"), &format!("{option}: "));
    }
    for (how, reason) in [
        ("--structure wavelet --dependencies none", "--structure hierarchy"),
        ("--structure tom --bound conservative", "--structure wavelet"),
        ("--structure hierarchy --shape hoppe", "--structure wavelet"),
        ("--structure wavelet --bound best", "without-siblings"),
        ("--structure wavelet --shape ball", "hoppe"),
    ] {
        usage("build", &[&input, &new], how, reason);
    }
    for (file, how, reason) in [
        (&tom, "--level 2", "from 0 to 1"),
        (&tom, "--level 1 --normals kept", "--normals"),
        (&tom, "--level 1 --triangulation exact", "--triangulation"),
        (&wavelet, "--level 0.5", "whole number"),
        (&wavelet, "--level 1.5", "whole number"),
        (&wavelet, "--level -1", "-1"),
        (&wavelet, "--level 1 --normals none", "recomputed"),
        (&wavelet, "--level 1 --ratio 1", "--ratio"),
    ] {
        usage("extract", &[file, &out], how, reason);
    }
    let view = "--eye 0,0,2 --target 0,0,0";
    usage("adapt", &[&hierarchy, &out], &format!("{view} --triangulation exact"), "--triangulation");
    usage("adapt", &[&wavelet, &out], &format!("{view} --triangulation best"), "minimal");
    assert_eq!(folder.names(), ["hierarchy.mres", "in.ply", "tom.mres", "wavelet.mres"]);
}

#[test]
fn bad_input_leaves_the_output_alone() {
    let folder = Folder::new("wavelet-bad");
    let [old, bad] = ["old.ply", "bad.mres"].map(|n| folder.file(n));
    let (file, _) = baked(&folder, &sphere(3), "");
    std::fs::write(&old, b"old").unwrap();
    let refused = |file: &Path| {
        let reason = json("adapt", &[file, &old], "--eye 0,0,2 --target 0,0,0").refusal();
        assert_eq!(json("extract", &[file, &old], "--level 1").refusal(), reason);
        assert_eq!(json("info", &[file], "").refusal(), reason);
        assert_eq!(std::fs::read(&old).unwrap(), b"old");
        reason
    };
    assert!(refused(&folder.file("none.mres")).contains("none.mres"));
    let bytes = std::fs::read(&file).unwrap();
    for at in (0..bytes.len()).step_by(bytes.len() / 12) {
        let mut flipped = bytes.clone();
        flipped[at] ^= 0x40;
        for content in [&flipped[..], &bytes[..at]] {
            std::fs::write(&bad, content).unwrap();
            assert!(refused(&bad).contains("bad.mres"));
        }
    }
    // A right checksum over what is no such structure.
    std::fs::write(&bad, io::bake("wavelet", &shapes::tetrahedron()).unwrap()).unwrap();
    assert!(refused(&bad).contains("damaged"));
    assert!(json("adapt", &[&file, &old], "--eye 1e300,0,0 --target 0,0,0").refusal().contains("finite"));
    assert_eq!(std::fs::read(&old).unwrap(), b"old");
}

#[test]
fn nothing_is_adapted_to_nothing() {
    let folder = Folder::new("wavelet-none");
    let [file, out] = ["all.mres", "out.ply"].map(|n| folder.file(n));
    let none = WaveletBuilder::new(&Mesh::default()).unwrap().build(&WaveletOptions::default()).unwrap();
    Baked::from(none).write(&file).unwrap();
    assert_eq!(number(&json("info", &[&file], "").answer()["wavelets"]), 0);
    assert!(take("adapt", &file, &out, "--eye 0,0,1 --target 0,0,0").1.triangles().is_empty());
    for how in ["--level 0", "--level 3", "--ratio 1", "--error 0"] {
        assert!(take("extract", &file, &out, how).1.triangles().is_empty());
    }
}

#[test]
fn bytes_do_not_depend_on_threads() {
    let folder = Folder::new("wavelet-threads");
    let input = folder.file("in.ply");
    io::write(&input, &sphere(5)).unwrap();
    let bytes = ["1", "4"].map(|threads| {
        let output = folder.file(&format!("{threads}.mres"));
        let mut command = command::command(["build", "--structure", "wavelet"]);
        let status =
            command.args([&input, &output]).env("RAYON_NUM_THREADS", threads).output().unwrap().status;
        assert!(status.success());
        std::fs::read(output).unwrap()
    });
    assert!(bytes[0] == bytes[1]);
}
