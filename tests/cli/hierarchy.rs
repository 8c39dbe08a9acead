//! Promise: the command line bakes hierarchies, takes out what views ask for, and flies over them; it answers with one object,
//! exits 0, 1 or 2, and leaves no half-written file behind.
#![cfg(feature = "cli")]

use std::path::{Path, PathBuf};

use crate::command::{self, Folder, json, run};
use multires::io;
use multires::mesh::{Mesh, Report, names, shapes};
use serde_json::Value;

fn number(value: &Value) -> usize {
    value.as_u64().unwrap_or_else(|| panic!("{value} is no count")) as usize
}

/// A model and its baked hierarchy.
fn baked(folder: &Folder, mesh: &Mesh, how: &str) -> (PathBuf, Value) {
    let [input, baked] = ["in.ply", "all.mres"].map(|n| folder.file(n));
    io::write(&input, mesh).unwrap();
    let answer = json("build", &[&input, &baked], &format!("--structure hierarchy {how}")).answer();
    std::fs::remove_file(input).unwrap();
    (baked, answer)
}

fn adapt(baked: &Path, out: &Path, how: &str) -> (Value, Mesh) {
    let answer = json("adapt", &[baked, out], how).answer();
    let mesh = io::read(out).unwrap();
    assert_eq!(number(&answer["output"]["triangles"]), mesh.triangles().len());
    assert_eq!(number(&answer["output"]["vertices"]), mesh.positions().len());
    (answer, mesh)
}

fn materials(mesh: &Mesh) -> Vec<u32> {
    let mut ids = mesh.materials().to_vec();
    ids.sort_unstable();
    ids.dedup();
    ids
}

#[test]
fn a_hierarchy_is_baked_and_described() {
    let folder = Folder::new("hierarchy-baked");
    let mesh = shapes::demo();
    for policy in ["none", "adjacent", "neighbours"] {
        let (file, built) = baked(&folder, &mesh, &format!("--dependencies {policy}"));
        let info = json("info", &[&file], "").answer();
        for key in [
            "splits",
            "vertices",
            "triangles",
            "base_triangles",
            "memory",
            "origins_memory",
            "structure_bytes_per_vertex",
        ] {
            assert_eq!(built[key], info[key], "{key}");
            assert!(!info[key].is_null(), "{key}");
        }
        assert_eq!((&info["kind"], &built["structure"]), (&"hierarchy".into(), &"hierarchy".into()));
        assert_eq!((&info["dependencies"], &built["dependencies"]), (&policy.into(), &policy.into()));
        assert_eq!(number(&info["triangles"]), mesh.triangles().len());
        assert!(number(&info["base_triangles"]) * 10 < mesh.triangles().len());
        assert_eq!(info["attributes"].as_array().unwrap().len(), mesh.attributes().len());
        assert_eq!(info["materials"].as_array().unwrap().len(), 5);
        assert_eq!(number(&info["bytes"]), number(&built["output"]["bytes"]));
        assert!(number(&info["memory"]) > 0 && info["memory_percent"].as_f64().unwrap() > 100.0);
    }
    let (file, built) = baked(&folder, &shapes::icosphere(3), "--metric lindstrom-turk --order batched");
    assert_eq!((&built["placement"], &built["order"]), (&"optimal".into(), &"batched".into()));
    let vertices = &json("info", &[&file], "").answer()["vertices"];
    assert!(number(&vertices["all"]) > number(&vertices["finest"]));
    assert_eq!(folder.names(), ["all.mres"]);
}

#[test]
fn nearer_is_finer_and_a_tolerance_is_kept() {
    let folder = Folder::new("hierarchy-adapt");
    let out = folder.file("out.glb");
    let mesh = shapes::demo();
    let (file, built) = baked(&folder, &mesh, "");
    let mut last = usize::MAX;
    for distance in ["0.7", "2", "8", "60"] {
        let (answer, level) = adapt(&file, &out, &format!("--eye 0.3,0.2,{distance} --target 0,0,0"));
        assert!(level.triangles().len() < last, "{distance}");
        last = level.triangles().len();
        assert!(number(&answer["refinements"]) > 0);
        assert_eq!(materials(&level), materials(&mesh));
        assert!(level.attribute(names::UV).is_some() && level.attribute(names::NORMAL).is_some());
        let ratio = last as f64 / mesh.triangles().len() as f64;
        assert!((answer["ratio"].as_f64().unwrap() - ratio).abs() < 1e-9);
    }
    let count =
        |how: &str| adapt(&file, &out, &format!("--eye 0.3,0.2,2 --target 0,0,0 {how}")).1.triangles().len();
    let plain = count("");
    assert!(count("--tolerance 4") < plain && count("--tolerance 0.25") > plain);
    assert!(count("--silhouette 0.2") > plain);
    assert!(count("--error parametric") > plain);
    assert!(count("--no-frustum --fov 5") > count("--fov 5"));
    assert!(count("--both-sides") > plain);
    assert!(count("--viewport 640x360") < plain && count("--fov 20") > plain);
    // All but what is exactly flat.
    let all = count("--tolerance 0 --both-sides --no-frustum");
    assert!(100 * all > 99 * mesh.triangles().len(), "{all}");
    // Turned away, nothing but the base mesh is left.
    let (_, away) = adapt(&file, &out, "--eye 0,0,2 --target 0,0,4");
    assert_eq!(away.triangles().len(), number(&built["base_triangles"]));
    // Looking along what should be up is no failure, and what is up does not count in a square picture.
    let square = "--viewport 500x500 --no-frustum";
    let [a, b] = ["0,0,1", "0,1,0"].map(|up| count(&format!("{square} --up {up}")));
    assert_eq!(a, b);
    adapt(&file, &out, "--eye 0,2,0 --target 0,0,0 --up 0,-7,0");
    adapt(&file, &out, "--eye 0,2,0 --target 0,2,0");
    assert_eq!(folder.names(), ["all.mres", "out.glb"]);
}

#[test]
fn whole_levels_come_out_too() {
    let folder = Folder::new("hierarchy-extract");
    let out = folder.file("out.glb");
    let mesh = shapes::demo();
    let (file, built) = baked(&folder, &mesh, "");
    let extract = |how: &str| {
        let answer = json("extract", &[&file, &out], how).answer();
        let level = io::read(&out).unwrap();
        assert_eq!(number(&answer["output"]["triangles"]), level.triangles().len());
        // Parts may vanish, and materials with them.
        assert!(materials(&level).iter().all(|id| materials(&mesh).contains(id)));
        assert_eq!(level.attributes().len(), mesh.attributes().len());
        (answer, level.triangles().len())
    };
    let all = mesh.triangles().len();
    let mut last = (0.0, all);
    for percent in [70, 30, 5] {
        let most = all * percent / 100;
        let (answer, got) = extract(&format!("--triangles {most}"));
        assert!(got <= most && 100 * got >= 95 * most, "{got} of {most}");
        let error = answer["error"].as_f64().unwrap();
        assert!(error > last.0 && got < last.1, "{error} {got}");
        assert_eq!(extract(&format!("--ratio {}", percent as f64 / 100.0)).1, got);
        // So much error needs no more triangles; a little more, for what is lost between binary and decimal.
        assert!(extract(&format!("--error {}", 1.000_001 * error)).1 <= got);
        last = (error, got);
    }
    let (answer, got) = extract("--ratio 1");
    assert_eq!((answer["error"].as_f64(), got), (Some(0.0), all));
    for least in ["--triangles 0", "--vertices 0", "--ratio 0", "--level 0", "--error 1e30"] {
        assert_eq!(extract(least).1, number(&built["base_triangles"]), "{least}");
    }
    assert_eq!(folder.names(), ["all.mres", "out.glb"]);
}

#[test]
fn units_are_the_diagonal_or_the_objects() {
    let folder = Folder::new("hierarchy-units");
    let out = folder.file("out.ply");
    let rock = shapes::rock(3_000, 1);
    let far: Vec<[f32; 3]> =
        rock.positions().iter().map(|&[x, y, z]| [8.0 * x + 100.0, 8.0 * y, 8.0 * z]).collect();
    let mesh = Mesh::new(far, rock.triangles()).unwrap();
    let (file, _) = baked(&folder, &mesh, "");
    let [low, high] = mesh.bounds().unwrap();
    let eye: Vec<String> = (0..3)
        .map(|i| (low[i] + high[i]) as f64 * 0.5 + [0.2, 0.4, 1.5][i] * mesh.diagonal())
        .map(|x| x.to_string())
        .collect();
    let target: Vec<String> = (0..3).map(|i| ((low[i] + high[i]) as f64 * 0.5).to_string()).collect();
    let (_, own) =
        adapt(&file, &out, &format!("--units object --eye {} --target {}", eye.join(","), target.join(",")));
    let (_, diagonal) = adapt(&file, &out, "--eye 0.2,0.4,1.5 --target 0,0,0");
    let [own, diagonal] = [own, diagonal].map(|mesh| mesh.triangles().len() as f64);
    assert!((own - diagonal).abs() <= 0.02 * diagonal, "{own} {diagonal}");
    let (_, other) = adapt(&file, &out, "--units object --eye 0.2,0.4,1.5 --target 0,0,0");
    assert!((other.triangles().len() as f64) < 0.9 * diagonal);
}

#[test]
fn a_budget_is_kept() {
    let folder = Folder::new("hierarchy-budget");
    let out = folder.file("out.ply");
    let (file, built) = baked(&folder, &shapes::rock(20_000, 5), "");
    let how = "--eye 0,0,0.8 --target 0,0,0 --tolerance 0.3";
    let (free, all) = adapt(&file, &out, how);
    assert_eq!(free["coarsened"], 1.0);
    for budget in [all.triangles().len() / 2, all.triangles().len() / 10] {
        let (answer, mesh) = adapt(&file, &out, &format!("{how} --budget {budget}"));
        let got = mesh.triangles().len();
        assert!(got <= budget && 100 * got >= 98 * budget, "{got} of {budget}");
        assert!(answer["coarsened"].as_f64().unwrap() > 1.0);
    }
    let enough = all.triangles().len();
    assert_eq!(adapt(&file, &out, &format!("{how} --budget {enough}")).1, all);
    let said = json("adapt", &[&file, &out], &format!("{how} --budget 0"));
    assert_eq!(said.answer()["output"]["triangles"], built["base_triangles"]);
    assert!(said.err.starts_with("warning: "), "{said:?}");
}

/// Berkey and Song's system, by its parts.
#[test]
fn a_radius_is_fine_and_the_rest_coarse() {
    let folder = Folder::new("hierarchy-radius");
    let out = folder.file("out.ply");
    let mesh = shapes::terrain(64, 2);
    let how = "--metric edge-length --placement midpoint --order batched --dependencies neighbours";
    let (file, built) = baked(&folder, &mesh, how);
    let mut last = number(&built["base_triangles"]);
    for radius in ["0.2", "0.5", "0.9"] {
        let (_, level) = adapt(&file, &out, &format!("--eye 0,0.1,0.3 --target 0,0,0 --radius {radius}"));
        assert!(level.triangles().len() > last, "{radius}");
        last = level.triangles().len();
        let [before, after] = [&mesh, &level].map(Report::welded);
        assert_eq!(after.euler_characteristic, before.euler_characteristic);
        assert!(after.border_edges <= before.border_edges && after.is_manifold());
    }
}

fn path(folder: &Folder, frames: usize) -> PathBuf {
    let file = folder.file("path.csv");
    let mut text = "\u{feff}# a circle\r\n\r\nframe, ex, ey, ez, tx, ty, tz\r\n".to_owned();
    for frame in 0..frames {
        let angle = frame as f64 * 0.02;
        text += &format!(
            "{}, {}, 0.2,{}, 0, 0,-1e-3\r\n# more\r\n",
            frame + 7,
            0.9 * angle.sin(),
            0.9 * angle.cos()
        );
    }
    std::fs::write(&file, text).unwrap();
    file
}

#[test]
fn a_flight_keeps_to_its_limits() {
    let folder = Folder::new("hierarchy-fly-limits");
    let frames = folder.file("frames.csv");
    let (file, built) = baked(&folder, &shapes::demo(), "");
    let camera = path(&folder, 20);
    let budget = number(&built["base_triangles"]) + 4_000;
    let options = format!("--path {} --csv {}", camera.display(), frames.display());
    let columns = |more: &str| {
        json("fly", &[&file], &format!("{options} {more}")).answer();
        let text = std::fs::read_to_string(&frames).unwrap();
        let row = |line: &str| line.split(',').map(|field| field.parse().unwrap()).collect::<Vec<f64>>();
        text.lines().skip(1).map(row).collect::<Vec<_>>()
    };
    assert!(columns("").iter().any(|row| row[1] > budget as f64));
    let rows = columns(&format!("--budget {budget}"));
    assert!(rows.iter().all(|row| row[1] <= budget as f64 && row[1] > 0.9 * budget as f64));
    let rows = columns("--operations 50");
    assert!(rows.iter().all(|row| row[4] + row[5] <= 50.0) && rows[3][4] > 0.0);
}

#[test]
fn a_flight_is_a_row_a_frame() {
    let folder = Folder::new("hierarchy-fly");
    let [frames, out] = ["frames.csv", "out.ply"].map(|n| folder.file(n));
    let mesh = shapes::demo();
    let (file, _) = baked(&folder, &mesh, "--dependencies adjacent");
    let camera = path(&folder, 30);
    let options = format!("--path {} --csv {}", camera.display(), frames.display());
    for packed in [false, true] {
        let more = if packed { "--packed" } else { "" };
        let answer = json("fly", &[&file], &format!("{options} {more}")).answer();
        assert_eq!((number(&answer["frames"]), &answer["packed"]), (30, &packed.into()));
        let text = std::fs::read_to_string(&frames).unwrap();
        let mut lines = text.lines();
        let header: Vec<&str> = lines.next().unwrap().split(',').collect();
        assert_eq!(
            header,
            [
                "frame",
                "triangles",
                "vertices",
                "tests",
                "splits",
                "collapses",
                "microseconds",
                "bytes_changed"
            ]
        );
        let rows: Vec<Vec<f64>> =
            lines.map(|line| line.split(',').map(|field| field.parse().unwrap()).collect()).collect();
        assert_eq!(rows.len(), 30);
        assert!(rows.iter().enumerate().all(|(i, row)| row.len() == 8 && row[0] == (i + 7) as f64));
        for (column, name) in header.iter().enumerate().skip(1) {
            let mut values: Vec<f64> = rows.iter().map(|row| row[column]).collect();
            let mean = values.iter().sum::<f64>() / 30.0;
            values.sort_by(f64::total_cmp);
            let said = |key: &str| answer["columns"][name][key].as_f64().unwrap();
            for (key, value) in [("mean", mean), ("median", values[14]), ("p99", values[29])] {
                assert!((said(key) - value).abs() <= 1e-9 * value + 0.001, "{name} {key}");
            }
        }
        // The first frame comes from the base mesh, all of it new; later ones change little.
        let [first, second] = [&rows[0], &rows[1]];
        assert!(first[4] > 0.0 && first[5] == 0.0 && first[7] >= 12.0 * first[1]);
        assert!(second[4] + second[5] < 0.3 * first[4] && second[7] < 0.5 * first[7]);
        if packed {
            let per_vertex: usize = 12 + mesh.attributes().iter().map(|a| 4 * a.width()).sum::<usize>();
            assert!(first[7] >= 12.0 * first[1] + per_vertex as f64 * first[2]);
        }
        // A frame is what `adapt` gives for its view.
        let pose = format!("--eye {},0.2,{} --target 0,0,-1e-3", 0.9 * (0.4f64).sin(), 0.9 * (0.4f64).cos());
        let (_, at) = adapt(&file, &out, &pose);
        assert_eq!(rows[20][1] as usize, at.triangles().len());
        assert_eq!(rows[20][2] as usize, at.positions().len());
    }
    let said = run([
        std::ffi::OsStr::new("fly"),
        file.as_os_str(),
        "--path".as_ref(),
        camera.as_os_str(),
        "--csv".as_ref(),
        frames.as_os_str(),
    ]);
    assert!(said.code == Some(0) && said.err.is_empty() && said.out.contains("microseconds"), "{said:?}");
    assert_eq!(folder.names(), ["all.mres", "frames.csv", "out.ply", "path.csv"]);
}

#[test]
fn bad_usage_is_said_before_anything_is_read() {
    let folder = Folder::new("hierarchy-usage");
    let [input, out, baked] =
        ["none.obj", "old.ply", "old.mres"].map(|n| folder.file(n).to_str().unwrap().to_owned());
    let [i, o, b] = [input.as_str(), out.as_str(), baked.as_str()];
    let view = ["--eye", "1,2,3", "--target", "0,0,0"];
    let with = |more: &[&'static str]| -> Vec<String> {
        ["adapt", b, o].iter().chain(&view).chain(more).map(|s| s.to_string()).collect()
    };
    let plain = |all: &[&str]| -> Vec<String> { all.iter().map(|s| s.to_string()).collect() };
    for (arguments, reason) in [
        (plain(&["build", i, b, "--structure", "tom", "--dependencies", "none"]), "--structure hierarchy"),
        (plain(&["build", i, b, "--structure", "hierarchy", "--dependencies", "all"]), "adjacent"),
        (plain(&["adapt", b, o]), "--eye"),
        (plain(&["adapt", b, o, "--eye", "1,2", "--target", "0,0,0"]), "X,Y,Z"),
        (plain(&["adapt", b, o, "--eye", "1,2,3,4", "--target", "0,0,0"]), "X,Y,Z"),
        (plain(&["adapt", b, o, "--eye", "1,2,nan", "--target", "0,0,0"]), "X,Y,Z"),
        (plain(&["adapt", b, "out.fbx", "--eye", "1,2,3", "--target", "0,0,0"]), "extension"),
        (with(&["--units", "miles"]), "diagonal"),
        (with(&["--fov", "180"]), "degrees"),
        (with(&["--fov", "0"]), "degrees"),
        (with(&["--viewport", "1920"]), "WIDTHxHEIGHT"),
        (with(&["--viewport", "0x5"]), "WIDTHxHEIGHT"),
        (with(&["--tolerance", "-1"]), "-1"),
        (with(&["--silhouette", "inf"]), "0 or more"),
        (with(&["--error", "best"]), "geometric"),
        (with(&["--radius", "1", "--tolerance", "2"]), "--radius"),
        (with(&["--budget", "-4"]), "-4"),
        (plain(&["fly", b]), "--path"),
        (plain(&["fly", b, "--path", "p.csv"]), "--csv"),
    ] {
        for json in [false, true] {
            let said = run(arguments.iter().map(String::as_str).chain(json.then_some("--json")));
            assert_eq!(said.code, Some(2), "{arguments:?}: {said:?}");
            assert!(said.err.contains(reason), "{arguments:?}: {said:?}");
            assert!(!json || said.json()["error"].is_string());
        }
    }
    assert!(folder.names().is_empty());
}

#[test]
fn bad_input_leaves_the_output_alone() {
    let folder = Folder::new("hierarchy-bad");
    let [old, bad, other] = ["old.ply", "bad.mres", "other.mres"].map(|n| folder.file(n));
    let (file, _) = baked(&folder, &shapes::icosphere(3), "");
    io::write_baked(&other, "mesh", &shapes::icosphere(2)).unwrap();
    std::fs::write(&old, b"old").unwrap();
    let view = "--eye 0,0,2 --target 0,0,0";
    let refused = |file: &Path, view: &str| {
        let reason = json("adapt", &[file, &old], view).refusal();
        assert_eq!(std::fs::read(&old).unwrap(), b"old");
        reason
    };
    assert!(refused(&folder.file("none.mres"), view).contains("none.mres"));
    assert!(refused(&other, view).contains("\"mesh\""));
    assert!(json("extract", &[&other, &old], "--ratio 1").refusal().contains("\"mesh\""));
    assert!(refused(&file, "--eye 1e300,0,0 --target 0,0,0").contains("finite"));

    let bytes = std::fs::read(&file).unwrap();
    for at in (0..bytes.len()).step_by(bytes.len() / 12) {
        let mut flipped = bytes.clone();
        flipped[at] ^= 0x40;
        for content in [&flipped[..], &bytes[..at]] {
            std::fs::write(&bad, content).unwrap();
            let reason = refused(&bad, view);
            assert!(reason.contains("bad.mres"));
            assert_eq!(json("info", &[&bad], "").refusal(), reason);
        }
    }
    // A right checksum over what is no such structure.
    std::fs::write(&bad, io::bake("hierarchy", &shapes::tetrahedron()).unwrap()).unwrap();
    assert!(refused(&bad, view).contains("damaged"));

    let camera = folder.file("bad.csv");
    let fly = format!("--path {} --csv {}", camera.display(), old.display());
    for (text, reason) in [
        ("", "no frames"),
        ("frame,ex,ey,ez,tx,ty,tz\n# nothing\n", "no frames"),
        ("frame,ex\n1,2,3,4,5,6\n", "line 2: there is no target z"),
        ("frame,ex\n1,2,3,4,5,6,7,8\n", "line 2: there are more than 7"),
        ("1,2,3,4,5,6,7\n2,2,3,x,5,6,7\n", "line 2: \"x\" is no number for eye z"),
        ("1,2,3,4,5,6,7\nframe,a,b,c,d,e,f\n", "line 2: \"frame\" is no number of a frame"),
        ("1,2,3,4,5,6,inf\n", "line 1: \"inf\" is no number for target z"),
        ("-1,2,3,4,5,6,7\n", "line 1: \"-1\" is no number of a frame"),
        ("4,1e300,3,4,5,6,7\n", "frame 4: "),
    ] {
        std::fs::write(&camera, text).unwrap();
        let said = json("fly", &[&file], &fly).refusal();
        assert!(said.contains(reason), "{text:?}: {said}");
        assert_eq!(std::fs::read(&old).unwrap(), b"old");
    }
    std::fs::write(&camera, [0xff, 0xfe, 0x00]).unwrap();
    assert!(json("fly", &[&file], &fly).refusal().contains("no text"));
    std::fs::write(&camera, "1,2,3,4,5,6,7").unwrap();
    let nowhere = format!("--path {} --csv {}", camera.display(), folder.file("no/where.csv").display());
    assert!(json("fly", &[&file], &nowhere).refusal().contains("no such folder"));
    assert!(folder.names().iter().all(|name| !name.ends_with(".tmp")));
}

#[test]
fn nothing_is_adapted_to_nothing() {
    let folder = Folder::new("hierarchy-none");
    let [file, out, frames] = ["all.mres", "out.ply", "frames.csv"].map(|n| folder.file(n));
    let bundle = multires::hierarchy::HierarchyBuilder::new().bake(&Mesh::default()).unwrap();
    io::write_baked(&file, "hierarchy", &bundle).unwrap();
    assert_eq!(number(&json("info", &[&file], "").answer()["splits"]), 0);
    assert!(adapt(&file, &out, "--eye 0,0,1 --target 0,0,0").1.triangles().is_empty());
    let camera = path(&folder, 3);
    let how = format!("--path {} --csv {}", camera.display(), frames.display());
    assert_eq!(number(&json("fly", &[&file], &how).answer()["frames"]), 3);
}

#[test]
fn bytes_do_not_depend_on_threads() {
    let folder = Folder::new("hierarchy-threads");
    let input = folder.file("in.ply");
    io::write(&input, &shapes::rock(20_000, 3)).unwrap();
    let bytes = ["1", "4"].map(|threads| {
        let output = folder.file(&format!("{threads}.mres"));
        let mut command =
            command::command(["build", "--structure", "hierarchy", "--dependencies", "neighbours"]);
        let status =
            command.args([&input, &output]).env("RAYON_NUM_THREADS", threads).output().unwrap().status;
        assert!(status.success());
        std::fs::read(output).unwrap()
    });
    assert!(bytes[0] == bytes[1]);
}
