//! Promise: every command does what it says, answers with one JSON object, exits 0, 1 or 2, and leaves no half-written
//! file behind.
#![cfg(feature = "cli")]

use std::io::Read;
use std::path::Path;
use std::process::Stdio;

use crate::command::{self, Folder, json, run};
use crate::content::{Content, content_of};
use multires::io;
use multires::mesh::{Mesh, Report, names, shapes};
use multires::simplify::metric::NAMES;
use serde_json::Value;

fn number(value: &Value) -> usize {
    value.as_u64().unwrap_or_else(|| panic!("{value} is no count")) as usize
}

/// Positions, texture coordinates and materials of a mesh.
fn content(mesh: &Mesh) -> Content {
    let uv = mesh.attribute(names::UV).and_then(|a| a.as_floats());
    content_of(mesh, |v| {
        let [x, y, z] = mesh.positions()[v as usize].map(|x| (x + 0.0).to_bits());
        let at = 2 * v as usize;
        let [s, t] = uv.map_or([0, 0], |uv| [uv[at].to_bits(), uv[at + 1].to_bits()]);
        vec![x, y, z, s, t]
    })
}

#[test]
fn every_command_answers_with_one_object() {
    let folder = Folder::new("answers");
    let [input, output, baked, level] =
        ["in.glb", "out.ply", "all.mres", "level.glb"].map(|n| folder.file(n));
    io::write(&input, &shapes::demo()).unwrap();
    let mesh = io::read(&input).unwrap();

    let info = json("info", &[&input], "").answer();
    assert_eq!(number(&info["stored"]["vertices"]), mesh.positions().len());
    assert_eq!(number(&info["stored"]["triangles"]), mesh.triangles().len());
    let welded = Report::welded(&mesh);
    assert_eq!(number(&info["welded"]["vertices"]), welded.vertices);
    assert_eq!(info["welded"]["closed"], welded.is_closed());
    assert_eq!(info["attributes"].as_array().unwrap().len(), mesh.attributes().len());
    for (said, attribute) in info["attributes"].as_array().unwrap().iter().zip(mesh.attributes()) {
        assert_eq!(said["name"], attribute.name());
        assert_eq!(number(&said["width"]), attribute.width());
    }
    let mut ids = mesh.materials().to_vec();
    ids.sort_unstable();
    ids.dedup();
    let said = info["materials"].as_array().unwrap();
    assert_eq!(said.iter().map(|m| number(&m["id"]) as u32).collect::<Vec<_>>(), ids);
    assert!(said.iter().all(|m| m["name"] == mesh.material_names()[number(&m["id"])]));
    assert_eq!(said.iter().map(|m| number(&m["triangles"])).sum::<usize>(), mesh.triangles().len());
    assert_eq!(number(&info["memory"]), mesh.memory());
    assert!(info["bounds"][1][2].is_number());

    let simplified = json("simplify", &[&input, &output], "--ratio 0.25").answer();
    let result = io::read(&output).unwrap();
    assert_eq!(number(&simplified["input"]["triangles"]), mesh.triangles().len());
    assert_eq!(number(&simplified["output"]["triangles"]), result.triangles().len());
    assert_eq!(number(&simplified["output"]["vertices"]), result.positions().len());
    assert_eq!(number(&simplified["output"]["bytes"]) as u64, std::fs::metadata(&output).unwrap().len());
    assert!(4 * result.triangles().len() <= mesh.triangles().len());
    let ratio = result.triangles().len() as f64 / mesh.triangles().len() as f64;
    assert!((simplified["ratio"].as_f64().unwrap() - ratio).abs() < 1e-9);
    let error = simplified["error"].as_f64().unwrap();
    assert!(error > 0.0);
    let percent = 100.0 * error / mesh.diagonal();
    assert!((simplified["error_percent"].as_f64().unwrap() - percent).abs() < 1e-9);
    for (key, value) in
        [("stop", "target"), ("metric", "quadric"), ("placement", "endpoint"), ("order", "linear")]
    {
        assert_eq!(simplified[key], value);
    }
    assert!(simplified["seconds"].as_f64().unwrap() >= 0.0);
    assert!(simplified["refusals"].as_array().unwrap().iter().all(|r| r["oracle"].is_string()));

    let built = json("build", &[&input, &baked], "--structure tom").answer();
    let info = json("info", &[&baked], "").answer();
    for key in ["finest", "coarsest", "memory", "memory_percent", "origins_memory"] {
        assert_eq!(built[key], info[key], "{key}");
        assert!(!info[key].is_null(), "{key}");
    }
    assert_eq!(info["kind"], "tom");
    assert_eq!(info["version"], io::BAKED_VERSION);
    assert_eq!(number(&info["finest"]["triangles"]), mesh.triangles().len());
    assert!(number(&info["coarsest"]["triangles"]) < mesh.triangles().len() / 10);
    let marks = info["error_marks"].as_array().unwrap();
    assert_eq!(marks[0]["error"], info["coarsest"]["error"]);

    let asked = mesh.triangles().len() / 2;
    let extracted = json("extract", &[&baked, &level], &format!("--triangles {asked}")).answer();
    let result = io::read(&level).unwrap();
    assert_eq!(number(&extracted["output"]["triangles"]), result.triangles().len());
    assert!((asked - 50..=asked).contains(&result.triangles().len()));
    assert!(extracted["error"].as_f64().unwrap() <= info["coarsest"]["error"].as_f64().unwrap());
    assert_eq!(folder.names(), ["all.mres", "in.glb", "level.glb", "out.ply"]);
}

#[test]
fn people_get_text() {
    let folder = Folder::new("text");
    let [input, output, baked] = ["in.obj", "out.stl", "all.mres"].map(|n| folder.file(n));
    io::write(&input, &shapes::icosphere(3)).unwrap();
    let [i, o, b] = [&input, &output, &baked].map(|p| p.to_str().unwrap());
    for arguments in [
        &["info", i][..],
        &["simplify", i, o, "--ratio", "0.5"],
        &["build", i, b, "--structure", "tom"],
        &["info", b],
        &["extract", b, o, "--level", "0.5"],
        &["--help"],
        &["help", "simplify"],
        &["--version"],
    ] {
        let said = run(arguments);
        assert_eq!((said.code, said.err.as_str()), (Some(0), ""), "{said:?}");
        assert!(!said.out.trim().is_empty() && serde_json::from_str::<Value>(&said.out).is_err(), "{said:?}");
    }
}

#[test]
fn targets_are_kept() {
    let folder = Folder::new("targets");
    let [input, output] = ["in.ply", "out.ply"].map(|n| folder.file(n));
    let mesh = shapes::torus(1.0, 0.3, 48, 24);
    io::write(&input, &mesh).unwrap();
    let per_vertex = 12 + mesh.attributes().iter().map(|a| 4 * a.width()).sum::<usize>();
    let simplify = |target: &str| {
        let answer = json("simplify", &[&input, &output], target).answer();
        let result = io::read(&output).unwrap();
        (answer, result.triangles().len(), result.positions().len())
    };
    let (answer, triangles, _) = simplify("--triangles 600");
    assert!((590..=600).contains(&triangles) && answer["stop"] == "target");
    assert!((370..=400).contains(&simplify("--vertices 400").2));
    assert!((565..=576).contains(&simplify("--ratio 0.25").1));
    let (answer, triangles, _) = simplify("--error 0.02");
    assert!(answer["error"].as_f64().unwrap() <= 0.02 && answer["stop"] == "error", "{answer}");
    assert!(triangles < mesh.triangles().len());
    let (answer, in_percent, _) = simplify("--error-percent 0.5");
    assert!(answer["error_percent"].as_f64().unwrap() <= 0.5 && answer["stop"] == "error", "{answer}");
    assert!(in_percent != triangles);
    let (_, triangles, vertices) = simplify("--bytes 20000");
    let bytes = 12 * triangles + per_vertex * vertices;
    assert!((19_000..=20_000).contains(&bytes), "{bytes}");
    // The first one reached stops.
    let (answer, triangles, _) = simplify("--triangles 0 --vertices 0 --ratio 0.5");
    assert!((1140..=1152).contains(&triangles) && answer["stop"] == "target");
}

#[test]
fn every_metric_placement_and_order_runs() {
    let folder = Folder::new("metrics");
    let [input, output, baked] = ["in.ply", "out.ply", "all.mres"].map(|n| folder.file(n));
    let mesh = shapes::icosphere(2);
    io::write(&input, &mesh).unwrap();
    for metric in NAMES {
        for order in ["linear", "batched"] {
            for placement in ["midpoint", "endpoint", "subset", "optimal"] {
                let how = format!("--triangles 80 --metric {metric} --placement {placement} --order {order}");
                let answer = json("simplify", &[&input, &output], &how).answer();
                let said =
                    ["metric", "placement", "order"].map(|key| answer[key].as_str().unwrap().to_owned());
                assert_eq!(said, [metric, placement, order]);
                let report = Report::welded(&io::read(&output).unwrap());
                assert!(report.triangles <= 80 && report.is_closed() && report.genus() == Some(0), "{how}");
            }
        }
        let answer =
            json("simplify", &[&input, &output], &format!("--triangles 80 --metric {metric}")).answer();
        let suits = if metric == "lindstrom-turk" { "optimal" } else { "endpoint" };
        assert_eq!(answer["placement"], suits);
        let built = json("build", &[&input, &baked], &format!("--structure tom --metric {metric}")).answer();
        assert_eq!(built["placement"], "endpoint");
        assert_eq!(number(&built["finest"]["triangles"]), mesh.triangles().len());
    }
}

#[test]
fn rules_can_be_changed() {
    let folder = Folder::new("rules");
    let [input, output] = ["in.ply", "out.ply"].map(|n| folder.file(n));
    let simplify = |mesh: &Mesh, more: &str| {
        io::write(&input, mesh).unwrap();
        json("simplify", &[&input, &output], &format!("--triangles 0 {more}")).answer();
        io::read(&output).unwrap()
    };
    let plane = shapes::plane(8);
    let borders = |mesh: &Mesh| Report::welded(mesh).border_edges;
    assert!(borders(&simplify(&plane, "")) < borders(&plane));
    assert_eq!(borders(&simplify(&plane, "--lock-borders")), borders(&plane));

    let rock = shapes::rock(2000, 1);
    let least = simplify(&rock, "").triangles().len();
    assert!(simplify(&rock, "--max-turn 5").triangles().len() > least);
    // Needles wait, they stop nothing.
    assert!(simplify(&rock, "--min-quality 0.8").triangles().len() <= least);

    let flat = shapes::box_with_face_normals(6);
    let dropped = simplify(&flat, "--drop normal");
    assert!(dropped.attribute(names::NORMAL).is_none());
    assert_eq!(dropped.attributes().len(), flat.attributes().len() - 1);
    let demo = shapes::demo();
    assert!(simplify(&demo, "--drop material").materials().is_empty());

    let steered = |how: &str| {
        io::write(&input, &demo).unwrap();
        json("simplify", &[&input, &output], &format!("--triangles 1000 {how}")).answer();
        std::fs::read(&output).unwrap()
    };
    let [off, on, same, chosen] =
        ["--attributes off", "--attributes on", "--attributes on", "--attributes normal=0.5,uv=0"]
            .map(steered);
    assert!(off != on && on == same && chosen != on && chosen != off);
    assert!(steered("") == on, "attributes count by default");
    assert!(steered("--attribute-values kept") != on);
    let answer = json("simplify", &[&input, &output], "--triangles 1000").answer();
    assert_eq!(answer["attribute_values"], "fitted");
    let said = answer["attribute_deviations"].as_array().unwrap();
    let units: Vec<_> =
        said.iter().map(|d| (d["name"].as_str().unwrap(), d["unit"].as_str().unwrap())).collect();
    assert!(
        units.contains(&(names::NORMAL, "degrees")) && units.contains(&(names::UV, "object units")),
        "{units:?}"
    );
    assert!(said.iter().all(|d| d["mean"].as_f64() <= d["max"].as_f64() && d["max"].as_f64() > Some(0.0)));
    // Whatever the metric.
    let [off, on] = ["off", "on"].map(|how| steered(&format!("--metric hybrid --attributes {how}")));
    assert!(off != on);

    let [parametric, verified] = ["parametric", "verified"].map(|m| {
        io::write(&input, &rock).unwrap();
        let how = format!("--triangles 500 --error-measure {m}");
        let answer = json("simplify", &[&input, &output], &how).answer();
        assert_eq!(answer["error_measure"], m);
        answer["error"].as_f64().unwrap()
    });
    assert!(parametric > 2.0 * verified, "{parametric} {verified}");

    let two = {
        let sphere = shapes::icosphere(2);
        let count = sphere.positions().len() as u32;
        let beside = sphere.positions().iter().map(|&[x, y, z]| [x + 2.05, y, z]);
        let positions: Vec<_> = sphere.positions().iter().copied().chain(beside).collect();
        let second = sphere.triangles().iter().map(|t| t.map(|v| v + count));
        let triangles: Vec<_> = sphere.triangles().iter().copied().chain(second).collect();
        Mesh::new(positions, triangles).unwrap()
    };
    assert_eq!(Report::welded(&simplify(&two, "--keep-parts")).components, 2);
    // The default: one vanishes.
    assert_eq!(Report::welded(&simplify(&two, "")).components, 1);
    assert_eq!(Report::welded(&simplify(&two, "--keep-parts --join-distance 0.5")).components, 1);
}

#[test]
fn a_target_that_cannot_be_reached_is_a_warning() {
    let folder = Folder::new("unreachable");
    let [input, output] = ["in.ply", "out.ply"].map(|n| folder.file(n));
    io::write(&input, &shapes::plane(8)).unwrap();
    let said = json("simplify", &[&input, &output], "--triangles 4 --lock-borders");
    let answer = said.answer();
    assert_eq!(answer["stop"], "nothing-legal");
    assert_eq!(said.err.lines().count(), 1, "{said:?}");
    assert!(said.err.starts_with("warning: stopped at "), "{said:?}");
    assert!(said.err.contains("border ") && said.err.contains("--lock-borders"), "{said:?}");
    assert_eq!(format!("warning: {}", answer["warnings"][0].as_str().unwrap()), said.err.trim_end());
}

#[test]
fn all_of_it_comes_back_and_levels_lie_in_between() {
    let folder = Folder::new("levels");
    let [input, baked, level] = ["in.ply", "all.mres", "level.ply"].map(|n| folder.file(n));
    let mesh = shapes::demo();
    io::write(&input, &mesh).unwrap();
    let built = json("build", &[&input, &baked], "--structure tom").answer();
    let extract = |how: &str| {
        let answer = json("extract", &[&baked, &level], how).answer();
        let result = io::read(&level).unwrap();
        assert_eq!(number(&answer["output"]["triangles"]), result.triangles().len());
        (answer, result)
    };
    for all in ["--ratio 1", "--level 1", "--triangles 99999999", "--vertices 99999999"] {
        let (answer, result) = extract(all);
        assert_eq!(answer["error"], 0.0);
        assert!(content(&result) == content(&mesh), "{all}");
        let names = |mesh: &Mesh| mesh.attributes().iter().map(|a| a.name().to_owned()).collect::<Vec<_>>();
        assert_eq!(names(&result), names(&mesh));
        assert_eq!(result.material_names(), mesh.material_names());
    }
    for least in ["--ratio 0", "--level 0", "--triangles 0", "--vertices 0", "--error 1e30"] {
        let (answer, result) = extract(least);
        assert_eq!(result.triangles().len(), number(&built["coarsest"]["triangles"]), "{least}");
        assert_eq!(answer["error"], built["coarsest"]["error"]);
    }
    let mut last = 0;
    for share in ["0.1", "0.3", "0.5", "0.7", "0.9"] {
        let (_, result) = extract(&format!("--level {share}"));
        assert!(result.triangles().len() > last);
        last = result.triangles().len();
    }
    let half = number(&built["finest"]["vertices"]) / 2;
    let vertices = extract(&format!("--vertices {half}")).1.positions().len();
    assert!((half - 50..=half).contains(&vertices), "{vertices} of {half}");
    let (answer, _) = extract("--error-percent 0.5");
    assert!(answer["error_percent"].as_f64().unwrap() <= 0.5);
    assert!(number(&answer["output"]["triangles"]) < mesh.triangles().len());
}

/// Nearer is finer, the whole of it at one level; a frame of a flight is what `adapt` gives for its view.
#[test]
fn views_are_followed() {
    let folder = Folder::new("tom-views");
    let [input, baked, out, camera, frames] =
        ["in.ply", "all.mres", "out.ply", "path.csv", "frames.csv"].map(|n| folder.file(n));
    let mesh = shapes::demo();
    io::write(&input, &mesh).unwrap();
    let built = json("build", &[&input, &baked], "--structure tom").answer();
    let base = number(&built["coarsest"]["triangles"]);
    let adapt = |how: &str| {
        let answer = json("adapt", &[&baked, &out], how).answer();
        let level = io::read(&out).unwrap();
        assert_eq!(number(&answer["output"]["triangles"]), level.triangles().len());
        (answer, level)
    };
    let (distances, mut path, mut last) = ([1.5, 6.0, 25.0, 100.0], String::new(), usize::MAX);
    for (frame, distance) in distances.into_iter().enumerate() {
        let (answer, level) = adapt(&format!("--eye 0.3,0.2,{distance} --target 0,0,0"));
        assert!((base..last).contains(&level.triangles().len()), "{distance}");
        last = level.triangles().len();
        assert!(number(&answer["refinements"]) > 0);
        path += &format!("{frame},0.3,0.2,{distance},0,0,0\n");
    }
    let how = "--eye 0.3,0.2,6 --target 0,0,0";
    let plain = adapt(how).1.triangles().len();
    assert!(adapt(&format!("{how} --tolerance 4")).1.triangles().len() < plain);
    let (answer, level) = adapt(&format!("{how} --budget {}", plain / 2));
    assert!(level.triangles().len() <= plain / 2 && answer["coarsened"].as_f64().unwrap() > 1.0);
    assert_eq!(adapt("--eye 0,0,2 --target 0,0,4").1.triangles().len(), base, "turned away");

    std::fs::write(&camera, path).unwrap();
    let fly = |more: &str| {
        let options = format!("--path {} --csv {}", camera.display(), frames.display());
        assert_eq!(number(&json("fly", &[&baked], &format!("{options} {more}")).answer()["frames"]), 4);
        let text = std::fs::read_to_string(&frames).unwrap();
        let row = |line: &str| line.split(',').map(|field| field.parse().unwrap()).collect::<Vec<f64>>();
        text.lines().skip(1).map(row).collect::<Vec<_>>()
    };
    let per_vertex = 12 + mesh.attributes().iter().map(|a| 4 * a.width()).sum::<usize>();
    let (rows, packed) = (fly(""), fly("--packed"));
    for ((distance, row), packed) in distances.into_iter().zip(&rows).zip(&packed) {
        let (_, at) = adapt(&format!("--eye 0.3,0.2,{distance} --target 0,0,0"));
        assert_eq!([row[1], row[2]], [at.triangles().len(), at.positions().len()].map(|n| n as f64));
        assert_eq!(row[1..6], packed[1..6]);
    }
    // The first frame comes from the base mesh, all of it new; vertices that are shared are uploaded by nobody.
    assert!(rows[0][7] >= 12.0 * rows[0][1] && rows[0][4] > 0.0 && rows[0][5] == 0.0);
    assert!(packed[0][7] >= 12.0 * packed[0][1] + per_vertex as f64 * packed[0][2]);
    let budget = fly(&format!("--budget {}", base + 2_000));
    assert!(budget.iter().all(|row| row[1] <= (base + 2_000) as f64));
    // What vanishes in one step comes and goes as one: here a part of 472 vertices.
    let operations = fly("--operations 500");
    assert!(operations.iter().all(|row| row[4] + row[5] <= 500.0) && operations[0][4] > 0.0);
}

#[test]
fn an_output_may_be_its_input() {
    let folder = Folder::new("same");
    let file = folder.file("mesh.off");
    io::write(&file, &shapes::icosphere(3)).unwrap();
    let answer = json("simplify", &[&file, &file], "--triangles 100").answer();
    assert_eq!(number(&answer["input"]["triangles"]), 1280);
    assert_eq!(number(&answer["output"]["triangles"]), io::read(&file).unwrap().triangles().len());
    assert_eq!(folder.names(), ["mesh.off"]);
}

#[test]
fn bytes_do_not_depend_on_threads() {
    let folder = Folder::new("threads");
    let input = folder.file("in.ply");
    io::write(&input, &shapes::rock(20_000, 3)).unwrap();
    let bytes = ["1", "4"].map(|threads| {
        let output = folder.file(&format!("{threads}.mres"));
        let mut command = command::command(["build", "--structure", "tom", "--order", "batched"]);
        let status =
            command.args([&input, &output]).env("RAYON_NUM_THREADS", threads).output().unwrap().status;
        assert!(status.success());
        std::fs::read(output).unwrap()
    });
    assert!(bytes[0] == bytes[1]);
}

#[test]
fn bad_usage_is_said_before_anything_is_read() {
    let folder = Folder::new("usage");
    let old = folder.file("old.ply");
    std::fs::write(&old, b"old").unwrap();
    let [input, out, baked] =
        ["none.obj", "old.ply", "old.mres"].map(|n| folder.file(n).to_str().unwrap().to_owned());
    let [i, o, b] = [input.as_str(), out.as_str(), baked.as_str()];
    for (arguments, reason) in [
        (&[][..], ""),
        (&["frobnicate"], "frobnicate"),
        (&["adapt", b, o], "--eye"),
        (&["info"], "<FILE>"),
        (&["simplify", i, o], "--triangles"),
        (&["simplify", i, o, "--triangles", "-1"], "-1"),
        (&["simplify", i, o, "--ratio", "1.5"], "from 0 to 1"),
        (&["simplify", i, o, "--ratio", "nan"], "from 0 to 1"),
        (&["simplify", i, o, "--error", "-2"], "-2"),
        (&["simplify", i, o, "--error", "inf"], "0 or more"),
        (&["simplify", i, o, "--ratio", "1", "--metric", "best"], "quadric"),
        (&["simplify", i, o, "--ratio", "1", "--placement", "best"], "midpoint"),
        (&["simplify", i, o, "--ratio", "1", "--attributes", "uv"], "NAME=WEIGHT"),
        (&["simplify", i, o, "--ratio", "1", "--attributes", "uv=-1"], "0 or more"),
        (&["simplify", i, "out.fbx", "--ratio", "1"], ".fbx"),
        (&["simplify", i, "out", "--ratio", "1"], "extension"),
        (&["build", i, b], "--structure"),
        (&["build", i, b, "--structure", "octree"], "tom"),
        (&["build", i, o, "--structure", "tom"], ".mres"),
        (&["build", i, b, "--structure", "tom", "--placement", "optimal"], "endpoint"),
        (&["extract", b, o], "--level"),
        (&["extract", b, o, "--level=-1"], "from 0 to 1"),
        (&["extract", b, o, "--ratio", "1", "--level", "1"], "--level"),
        (&["extract", b, "out.mres", "--ratio", "1"], "extension"),
    ] {
        for json in [false, true] {
            let more = if json { &["--json"][..] } else { &[] };
            let said = run(arguments.iter().chain(more));
            assert_eq!(said.code, Some(2), "{arguments:?}: {said:?}");
            assert!(said.err.contains(reason), "{arguments:?}: {said:?}");
            if json && !arguments.is_empty() {
                assert!(said.json()["error"].is_string());
            }
        }
    }
    assert_eq!(folder.names(), ["old.ply"]);
    assert_eq!(std::fs::read(old).unwrap(), b"old");
}

#[test]
fn bad_input_leaves_the_output_alone() {
    let folder = Folder::new("bad");
    let [good, old, baked] = ["good.ply", "old.ply", "good.mres"].map(|n| folder.file(n));
    io::write(&good, &shapes::demo()).unwrap();
    json("build", &[&good, &baked], "--structure tom").answer();
    std::fs::write(&old, b"old").unwrap();
    let names = folder.names();
    let refused = |command: &str, files: &[&Path], more: &str| {
        let reason = json(command, files, more).refusal();
        assert_eq!(std::fs::read(&old).unwrap(), b"old");
        reason
    };

    assert!(refused("info", &[&folder.file("none.obj")], "").contains("none.obj"));
    assert!(refused("simplify", &[&folder.file("none.obj"), &old], "--ratio 1").contains("none.obj"));
    assert!(refused("extract", &[&folder.file("none.mres"), &old], "--ratio 1").contains("none.mres"));
    assert!(refused("info", &[Path::new("a.fbx")], "").contains("extension"));
    let nowhere = folder.file("no/where.ply");
    assert!(refused("simplify", &[&good, &nowhere], "--ratio 1").contains("no such folder"));
    assert!(refused("extract", &[&baked, &nowhere], "--ratio 1").contains("no such folder"));
    assert!(refused("simplify", &[&good, &old], "--ratio 1 --drop tint").contains("\"tint\""));
    assert!(refused("simplify", &[&good, &old], "--ratio 1 --attributes tint=1").contains("\"tint\""));
    assert_eq!(folder.names(), names);

    let broken = folder.file("broken.obj");
    std::fs::write(&broken, "v 0 0 0\nv 1 0 0\nf 1 2 3\n").unwrap();
    for command in ["info", "simplify", "build"] {
        let out = if command == "build" { baked.clone() } else { old.clone() };
        let files = [&broken, &out].map(|p| p.as_path());
        let (files, more) = match command {
            "info" => (&files[..1], ""),
            "simplify" => (&files[..], "--ratio 1"),
            _ => (&files[..], "--structure tom"),
        };
        let before = std::fs::read(&out).unwrap();
        let reason = refused(command, files, more);
        assert!(reason.contains("broken.obj") && reason.contains("line 3"), "{reason}");
        assert!(std::fs::read(&out).unwrap() == before);
    }
}

#[test]
fn damaged_and_foreign_baked_files_are_refused() {
    let folder = Folder::new("damage");
    let [good, baked, bad, out] = ["good.ply", "good.mres", "bad.mres", "out.ply"].map(|n| folder.file(n));
    io::write(&good, &shapes::icosphere(3)).unwrap();
    json("build", &[&good, &baked], "--structure tom").answer();
    let bytes = std::fs::read(&baked).unwrap();
    let refused = |content: &[u8]| {
        std::fs::write(&bad, content).unwrap();
        let reason = json("extract", &[&bad, &out], "--ratio 0.5").refusal();
        assert_eq!(json("info", &[&bad], "").refusal(), reason);
        assert!(!out.exists());
        reason
    };
    for at in (0..bytes.len()).step_by(bytes.len() / 12) {
        let mut flipped = bytes.clone();
        flipped[at] ^= 0x40;
        assert!(refused(&flipped).contains("bad.mres"));
        assert!(refused(&bytes[..at]).contains("bad.mres"));
    }
    assert!(refused(b"").contains("no baked file"));
    assert!(refused(&std::fs::read(&good).unwrap()).contains("no baked file"));
    assert!(refused(&io::bake("mesh", &shapes::tetrahedron()).unwrap()).contains("\"mesh\""));
    // A right checksum over what is no such structure.
    assert!(refused(&io::bake("tom", &shapes::tetrahedron()).unwrap()).contains("damaged"));
    let more: Vec<u8> = bytes.iter().copied().chain([0]).collect();
    assert!(refused(&more).contains("follow"));
    std::fs::write(&bad, &bytes).unwrap();
    json("extract", &[&bad, &out], "--ratio 0.5").answer();
}

#[test]
fn a_reader_that_has_seen_enough_is_no_error() {
    let folder = Folder::new("pipe");
    let input = folder.file("in.ply");
    io::write(&input, &shapes::icosphere(4)).unwrap();
    for more in [&["--json"][..], &[]] {
        let mut command = command::command(["info", input.to_str().unwrap()]);
        let mut child = command.args(more).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        drop(child.stdout.take());
        let mut said = String::new();
        child.stderr.take().unwrap().read_to_string(&mut said).unwrap();
        assert_eq!((child.wait().unwrap().code(), said.as_str()), (Some(0), ""));
    }
}
