//! Promise: `multires measure` says how far two meshes differ, the same as a table and as an object; nothing where it
//! is one mesh twice; why where there is no volume; one line and exit code 1 where a file is at fault.
#![cfg(feature = "cli")]

use std::path::Path;

use crate::command::{Folder, json, run};
use multires::io;
use multires::mesh::{Mesh, names, shapes};
use multires::quality::{self, DistanceOptions, ImageOptions, image_difference};
use serde_json::Value;

/// Numbers in an object are read back to within a last digit.
#[track_caller]
fn assert_same(said: &Value, expected: f64) {
    assert!((real(said) - expected).abs() <= 1e-15 * expected.abs(), "{said} is not {expected}");
}

fn real(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// A folder with a fine ball, a coarse one, and an open surface.
fn models(name: &str) -> (Folder, [std::path::PathBuf; 3]) {
    let folder = Folder::new(name);
    let files = ["fine.ply", "coarse.obj", "open.stl"].map(|n| folder.file(n));
    io::write(&files[0], &shapes::icosphere(4)).unwrap();
    io::write(&files[1], &shapes::icosphere(1)).unwrap();
    io::write(&files[2], &shapes::open_cylinder(24, 3)).unwrap();
    (folder, files)
}

fn measure(files: [&Path; 2], more: &str) -> Value {
    json("measure", &files, more).answer()
}

/// The numbers in the first line that starts with a label.
fn row(table: &str, label: &str) -> Vec<f64> {
    let start = format!("{label:<20} ");
    let line = table.lines().find_map(|line| line.strip_prefix(&start));
    let line = line.unwrap_or_else(|| panic!("no row {label:?} in\n{table}"));
    line.split_whitespace().filter_map(|word| word.parse().ok()).collect()
}

#[track_caller]
fn assert_near(said: f64, expected: f64) {
    assert!((said - expected).abs() <= 6e-5 * expected.abs(), "{said} is not {expected}");
}

#[test]
fn the_object_says_what_the_library_says() {
    let (folder, [fine, coarse, _]) = models("measure-object");
    let said = measure([&fine, &coarse], "--samples 5000 --images --views 3");
    let [a, b] = [&fine, &coarse].map(|path| io::read(path).unwrap());
    let distance = quality::distance(&a, &b, &DistanceOptions::default().with_samples(5000)).unwrap();
    assert_same(&said["diagonal"], distance.diagonal);
    for (key, side) in [("forward", distance.forward), ("backward", distance.backward)] {
        let said = &said["distance"][key];
        for (key, length) in [("max", side.max), ("mean", side.mean), ("rms", side.rms)] {
            assert_same(&said[key], length);
            assert_same(&said[format!("{key}_percent")], distance.percent(length));
        }
        assert_eq!(said["max_at"].as_array().unwrap().len(), 3);
    }
    let both = &said["distance"]["both"];
    assert_same(&both["max"], distance.hausdorff());
    assert_same(&both["mean_percent"], distance.mean_percent());
    assert_same(&both["rms"], distance.rms());

    let volumes = [&a, &b].map(|mesh| quality::volume(mesh).unwrap());
    assert_same(&said["volume"]["a"], volumes[0]);
    assert_same(&said["volume"]["b"], volumes[1]);
    assert_same(&said["volume"]["ratio"], volumes[1] / volumes[0]);
    assert!(said["volume"]["a_reason"].is_null() && said["volume"]["b_reason"].is_null());
    assert_same(&said["area"]["b"], quality::area(&b));
    let shape = quality::ShapeReport::new(&b);
    assert_same(&said["shape"]["b"]["sliver_mean"], shape.sliver_mean);
    assert_same(&said["shape"]["b"]["angle_min"], shape.angle_min);

    let images = image_difference(&a, &b, &ImageOptions::default().with_views(3)).unwrap();
    for (key, value) in [("l1", images.l1), ("l2", images.l2), ("silhouette", images.silhouette)] {
        assert!(value > 0.0);
        assert_same(&said["images"][key], value);
    }
    assert_eq!((&said["images"]["views"], &said["images"]["size"]), (&Value::from(3), &Value::from(512)));
    assert_eq!(said["a"]["triangles"], a.triangles().len());
    assert_eq!(said["b"]["vertices"], b.positions().len());
    assert_eq!((&said["command"], &said["samples"]), (&Value::from("measure"), &Value::from(5000)));
    assert!(said["colours"].is_null());
    assert!(measure([&fine, &coarse], "--samples 10")["images"].is_null());
    assert_eq!(folder.names(), ["coarse.obj", "fine.ply", "open.stl"]);
}

#[test]
fn the_table_says_what_the_object_says() {
    let (_folder, [fine, coarse, _]) = models("measure-table");
    let more = ["--samples", "3000", "--images", "--views", "2"];
    let said = measure([&fine, &coarse], &more.join(" "));
    let [a, b] = [&fine, &coarse].map(|path| path.to_str().unwrap());
    let table = run([&["measure", a, b][..], &more].concat());
    assert_eq!((table.code, table.err.as_str()), (Some(0), ""), "{table:?}");
    let table = table.out;
    for (label, key) in [("A to B", "forward"), ("B to A", "backward"), ("both", "both")] {
        let said = &said["distance"][key];
        let (plain, percents) = (row(&table, label), row(&table, &format!("{label}, %")));
        assert_eq!((plain.len(), percents.len()), (3, 3), "{table}");
        for (i, key) in ["max", "mean", "rms"].into_iter().enumerate() {
            assert_near(plain[i], real(&said[key]));
            assert_near(percents[i], real(&said[format!("{key}_percent")]));
        }
    }
    for label in ["volume", "area"] {
        let (row, said) = (row(&table, label), &said[label]);
        assert_near(row[0], real(&said["a"]));
        assert_near(row[1], real(&said["b"]));
        assert_near(row[2], real(&said["ratio"]));
    }
    for (label, key) in [("sliver ratio, mean", "sliver_mean"), ("sliver ratio, max", "sliver_max")] {
        for (shown, mesh) in row(&table, label).into_iter().zip(["a", "b"]) {
            assert_near(shown, real(&said["shape"][mesh][key]));
        }
    }
    for (label, key) in
        [("K_L1, grey levels", "l1"), ("K_L2, grey levels", "l2"), ("K_sil, pixels", "silhouette")]
    {
        let row = row(&table, label);
        assert_near(row[0], real(&said["images"][key]));
        assert_near(row[1], real(&said["images"][format!("{key}_max")]));
        assert_near(row[2], real(&said["images"][format!("{key}_max_view")]));
    }
    assert_near(row(&table, "diagonal of A")[0], real(&said["diagonal"]));
}

#[test]
fn a_mesh_does_not_differ_from_itself() {
    let (_folder, [fine, ..]) = models("measure-same");
    let said = measure([&fine, &fine], "--samples 4000 --images --views 2");
    for side in ["forward", "backward", "both"] {
        for key in ["max", "mean", "rms", "max_percent"] {
            assert!(real(&said["distance"][side][key]) < 1e-9, "{side} {key}: {said}");
        }
    }
    for key in ["l1", "l2", "silhouette", "silhouette_share", "l1_max", "silhouette_max"] {
        assert_eq!(real(&said["images"][key]), 0.0, "{key}");
    }
    assert_eq!((real(&said["volume"]["ratio"]), real(&said["area"]["ratio"])), (1.0, 1.0));
}

#[test]
fn without_a_volume_it_says_why() {
    let (folder, [fine, _, open]) = models("measure-open");
    let said = measure([&fine, &open], "--samples 100");
    let volume = &said["volume"];
    assert!(real(&volume["a"]) > 0.0 && volume["a_reason"].is_null());
    assert!(volume["b"].is_null() && volume["ratio"].is_null());
    let reason = volume["b_reason"].as_str().unwrap();
    assert!(reason.contains("open") && reason.contains("48"), "{reason}");
    let [a, b] = [&fine, &open].map(|path| path.to_str().unwrap());
    let table = run(["measure", a, b, "--samples", "100"]).out;
    assert!(table.lines().any(|l| l.starts_with("no volume of B") && l.ends_with(reason)), "{table}");

    let turned = folder.file("turned.ply");
    let ball = shapes::icosphere(1);
    let mut triangles = ball.triangles().to_vec();
    triangles[7].swap(0, 1);
    io::write(&turned, &Mesh::new(ball.positions(), triangles).unwrap()).unwrap();
    let said = measure([&turned, &fine], "--samples 100");
    let reason = said["volume"]["a_reason"].as_str().unwrap();
    assert!(reason.contains("3 edges") && said["volume"]["a"].is_null(), "{reason}");
}

#[test]
fn distances_are_shown_in_colours() {
    let (folder, [fine, coarse, _]) = models("measure-colours");
    let [coloured, picture] = ["painted.ply", "painted.png"].map(|n| folder.file(n));
    let options = format!("--samples 100 --colour {} --picture {}", coloured.display(), picture.display());
    assert!(!options.contains("  "), "the folder's name has a blank");
    let said = measure([&fine, &coarse], &options);
    let [a, b, painted] = [&fine, &coarse, &coloured].map(|path| io::read(path).unwrap());
    assert_eq!((painted.positions(), painted.triangles()), (a.positions(), a.triangles()));

    let distances = quality::vertex_distances(&a, &b).unwrap();
    let most = distances.iter().copied().fold(0.0, f64::max);
    assert_same(&said["colours"]["to"], most);
    assert_eq!(real(&said["colours"]["from"]), 0.0);
    let written = painted.attribute("distance").unwrap().as_floats().unwrap();
    assert!(written.iter().zip(&distances).all(|(w, d)| *w == *d as f32));
    let colours = painted.attribute(names::COLOR).unwrap().as_floats().unwrap();
    for (colour, distance) in colours.chunks(3).zip(&distances) {
        let expected =
            quality::palette::sequential((distance / most) as f32).map(|byte| f32::from(byte) / 255.0);
        assert_eq!(colour, expected);
    }
    assert!(most > 0.01 && distances.iter().any(|d| d / most < 0.01));

    let file = std::io::BufReader::new(std::fs::File::open(&picture).unwrap());
    let mut reader = png::Decoder::new(file).read_info().unwrap();
    let mut values = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut values).unwrap();
    assert_eq!((info.width, info.height, info.color_type), (1280, 724, png::ColorType::Rgb));
    let pixels: Vec<[u8; 3]> = values.chunks_exact(3).map(|p| [p[0], p[1], p[2]]).collect();
    let bar = |x: usize| pixels[655 * 1280 + 400 + x];
    let ends = [0.0, 1.0].map(quality::palette::sequential);
    assert_eq!([bar(0), bar(479)], ends);
    assert!(pixels.iter().filter(|p| **p != [247; 3]).count() > 100_000);

    // On a mesh twice there is nothing to show, and a scale nonetheless.
    let same = measure([&fine, &fine], &format!("--samples 100 --colour {}", coloured.display()));
    assert_eq!(real(&same["colours"]["to"]), 0.0);
    assert!(same["colours"]["picture"].is_null());
    assert_eq!(folder.names().len(), 5);
}

#[test]
fn bad_input_is_one_line() {
    let (folder, [fine, ..]) = models("measure-bad");
    let [missing, broken, empty, baked, model] =
        ["missing.ply", "broken.ply", "empty.obj", "baked.mres", "model.xyz"].map(|n| folder.file(n));
    std::fs::write(&broken, "ply\nformat ascii 1.0\n").unwrap();
    std::fs::write(&empty, "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n").unwrap();
    std::fs::write(&baked, "").unwrap();
    std::fs::write(&model, "").unwrap();
    for file in [&missing, &broken, &empty, &baked, &model] {
        for pair in [[file.as_path(), &fine], [&fine, file.as_path()]] {
            let reason = json("measure", &pair, "").refusal();
            assert!(reason.contains(file.file_name().unwrap().to_str().unwrap()), "{reason}");
        }
    }
    let advice = json("measure", &[&fine, &baked], "").refusal();
    assert!(advice.contains("multires extract"), "{advice}");
    let nothing = json("measure", &[&fine, &empty], "").refusal();
    assert!(nothing.contains("no surface: none of its 1 triangles"), "{nothing}");
    let nowhere = folder.file("nowhere").join("out.ply");
    let refused = json("measure", &[&fine, &fine], &format!("--colour {}", nowhere.display())).refusal();
    assert!(refused.contains("no such folder"), "{refused}");

    for wrong in [
        "--samples 0",
        "--samples x",
        "--images --views 0",
        "--images --views 5000",
        "--views 3",
        "--colour out.obj",
        "--picture out.jpg",
    ] {
        let said = json("measure", &[&fine, &fine], wrong);
        assert_eq!(said.code, Some(2), "{wrong}: {said:?}");
    }
    assert_eq!(run(["measure", fine.to_str().unwrap()]).code, Some(2));
    let names = ["baked.mres", "broken.ply", "coarse.obj", "empty.obj", "fine.ply", "model.xyz", "open.stl"];
    assert_eq!(folder.names(), names);
}
