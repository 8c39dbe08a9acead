//! Promise: a patch of a few metres in map coordinates of thousands of kilometres loses nothing from file to file: it is read
//! relative to an origin of its own, which goes with it through levels and structures, and written where it lies.
#![cfg(feature = "cli")]

use std::fmt::Write;
use std::path::Path;

use crate::command::{Folder, json};
use multires::hierarchy::{HierarchyOptions, VertexHierarchy};
use multires::io::{self, Format, Imported, ReadOptions, SceneOrigin};
use multires::lod::{Baked, Structure};
use multires::mesh::{Mesh, shapes};
use multires::quality::{self, DistanceOptions};
use multires::simplify::{Simplifier, Target};
use multires::tom::{TomOptions, TotallyOrderedMesh};

const ALL: [Format; 6] = [Format::Obj, Format::Ply, Format::Stl, Format::Off, Format::Glb, Format::Gltf];
/// East, north and up, metres: single precision has steps of 0.5 there.
const PLACE: [f64; 3] = [512_345.25, 5_412_345.75, 412.3];

/// Points of a bumpy patch of 20 metres, to the millimetre.
fn points() -> Vec<[f64; 3]> {
    let mut points = Vec::new();
    for i in 0..=40u32 {
        for j in 0..=40u32 {
            let height = f64::from((i * 7 + j * j) % 13) * 0.031 + f64::from(i * j % 29) * 0.017;
            let [x, y] = [i, j].map(|n| f64::from(n) * 0.5 + f64::from(n % 3) * 0.013);
            points.push([PLACE[0] + x, PLACE[1] + y, PLACE[2] + height]);
        }
    }
    points
}

fn patch() -> String {
    let mut text = String::new();
    for [x, y, z] in points() {
        writeln!(text, "v {x:.3} {y:.3} {z:.3}").unwrap();
    }
    for i in 0..40 {
        for j in 1..=40 {
            let [a, b, c, d] = [41 * i + j, 41 * (i + 1) + j, 41 * (i + 1) + j + 1, 41 * i + j + 1];
            writeln!(text, "f {a} {b} {c}\nf {a} {c} {d}").unwrap();
        }
    }
    text
}

const DIAGONAL: f64 = 28.3;

/// How far any vertex lies from the nearest of the file's.
fn lost(mesh: &Mesh) -> f64 {
    let all = points();
    let far = mesh.positions().iter().map(|p| {
        let at: Vec<f64> = (0..3).map(|i| f64::from(p[i]) + mesh.origin()[i]).collect();
        let apart = |q: &[f64; 3]| (0..3).map(|i| (at[i] - q[i]).powi(2)).sum::<f64>().sqrt();
        all.iter().map(apart).fold(f64::INFINITY, f64::min)
    });
    far.fold(0.0, f64::max)
}

fn parse(format: Format, bytes: &[u8], origin: SceneOrigin) -> Imported {
    io::read_bytes_with(format, bytes, &ReadOptions::default().with_origin(origin)).unwrap()
}

#[test]
fn the_origin_is_moved_where_it_must_be_and_said() {
    let found = parse(Format::Obj, patch().as_bytes(), SceneOrigin::Automatic);
    assert_eq!(found.origin, found.mesh.origin());
    assert!((found.mesh.diagonal() - DIAGONAL).abs() < 1.0);
    assert!(lost(&found.mesh) < 1e-6 * DIAGONAL, "{}", lost(&found.mesh));
    assert_eq!(found.notes.len(), 1);
    assert!(found.notes[0].contains("relative to"), "{:?}", found.notes);

    let kept = parse(Format::Obj, patch().as_bytes(), SceneOrigin::Keep);
    assert_eq!(kept.mesh.origin(), [0.0; 3]);
    assert!(lost(&kept.mesh) > 0.1, "the patch is of the kind that suffers");

    // Nothing is lost of single precision itself, however far away, nor of what is large or near.
    for scale in [1.0, 1e-30, 1e30] {
        let near = shapes::rock(500, 1);
        let positions: Vec<[f32; 3]> =
            near.positions().iter().map(|p| p.map(|x| x * scale + 3.0 * scale)).collect();
        let near = Mesh::new(positions, near.triangles()).unwrap();
        let again = parse(Format::Obj, &io::write_bytes(Format::Obj, &near).unwrap(), SceneOrigin::Automatic);
        assert_eq!((again.origin, again.notes.len()), ([0.0; 3], 0));
        assert_eq!(again.mesh, near);
    }
    let far = Mesh::new(kept.mesh.positions(), kept.mesh.triangles()).unwrap();
    let again = parse(Format::Ply, &io::write_bytes(Format::Ply, &far).unwrap(), SceneOrigin::Automatic);
    assert_eq!(again.mesh, far);
}

#[test]
fn levels_are_written_where_they_lie_in_every_format() {
    let mesh = parse(Format::Obj, patch().as_bytes(), SceneOrigin::Automatic).mesh;
    let sequence = Simplifier::new().target(Target::Triangles(400)).run(&mesh).unwrap();
    let level = sequence.extract(&mesh, sequence.len());
    assert_eq!(level.origin(), mesh.origin());
    // The error is that of the shape, not of rounding: measured the same, and not zero.
    let error = f64::from(sequence.report().error);
    let measured = quality::distance(&mesh, &level, &DistanceOptions::default()).unwrap();
    let largest = measured.hausdorff();
    assert!(error > 0.01 && (0.5..2.0).contains(&(largest / error)), "{error} {largest}");

    for format in ALL {
        let bytes = io::write_bytes(format, &level).unwrap();
        let again = parse(format, &bytes, SceneOrigin::Automatic).mesh;
        assert_eq!(again.triangles().len(), level.triangles().len(), "{format}");
        assert_eq!(again.positions().len(), level.positions().len(), "{format}");
        assert!(lost(&again) < 1e-6 * DIAGONAL, "{format}: {}", lost(&again));
        // And again, with nothing changed.
        let twice = parse(format, &io::write_bytes(format, &again).unwrap(), SceneOrigin::Automatic).mesh;
        assert_eq!(twice, again, "{format}");
    }
}

#[test]
fn structures_keep_the_origin() {
    let mesh = parse(Format::Obj, patch().as_bytes(), SceneOrigin::Automatic).mesh;
    let sequence = Simplifier::new().run(&mesh).unwrap();
    let tom = Baked::<TotallyOrderedMesh>::of_sequence(&mesh, &sequence, &TomOptions::default()).unwrap();
    let hierarchy =
        Baked::<VertexHierarchy>::of_sequence(&mesh, &sequence, &HierarchyOptions::default()).unwrap();
    let baked = io::bake(TotallyOrderedMesh::KIND, &tom).unwrap();
    let tom: Baked<TotallyOrderedMesh> = io::unbake(TotallyOrderedMesh::KIND, &baked).unwrap();
    for level in [&tom.mesh_at(tom.structure().coarsest()), hierarchy.vertices()] {
        assert_eq!(level.origin(), mesh.origin());
        assert!(lost(level) < 1e-6 * DIAGONAL);
    }
}

#[test]
fn meshes_can_be_moved_to_another_origin() {
    let mesh = parse(Format::Obj, patch().as_bytes(), SceneOrigin::Automatic).mesh;
    let [x, y, z] = mesh.origin();
    let moved = mesh.moved_to([x + 8.0, y - 4.0, z]).unwrap();
    assert!(lost(&moved) < 1e-6 * DIAGONAL);
    assert!((moved.positions()[0][0] - (mesh.positions()[0][0] - 8.0)).abs() < 1e-5);
    assert!(mesh.moved_to([f64::NAN; 3]).is_err());
    assert!(mesh.moved_to([1e300; 3]).is_err());
    assert!(mesh.clone().with_origin([0.0, f64::INFINITY, 0.0]).is_err());
}

fn read_lost(path: &Path) -> f64 {
    lost(&io::read(path).unwrap())
}

#[test]
fn the_command_line_keeps_places() {
    let folder = Folder::new("large-coordinates");
    let input = folder.file("in.obj");
    std::fs::write(&input, patch()).unwrap();
    for format in ALL {
        let output = folder.file(&format!("level.{format}"));
        let said = json("simplify", &[&input, &output], "--ratio 0.2").answer();
        assert!(said["warnings"][0].as_str().unwrap().contains("relative to"), "{said}");
        assert!(said["error"].as_f64().unwrap() > 0.01, "{said}");
        assert!(read_lost(&output) < 1e-6 * DIAGONAL, "{format}");
        let measured = json("measure", &[&input, &output], "").answer();
        let same = json("measure", &[&output, &output], "").answer();
        assert!(measured["distance"]["both"]["max"].as_f64().unwrap() < 5.0, "{measured}");
        assert!(same["distance"]["both"]["max"].as_f64().unwrap() < 1e-9, "{same}");
    }
    let [baked, level] = ["all.mres", "level.obj"].map(|name| folder.file(name));
    json("build", &[&input, &baked], "--structure tom").answer();
    json("extract", &[&baked, &level], "--level 1").answer();
    assert!(read_lost(&level) < 1e-6 * DIAGONAL);
    json("build", &[&input, &baked], "--structure hierarchy").answer();
    // The eye is in the file's coordinates: straight above, where all is in view.
    let eye = format!("{},{},{}", PLACE[0] + 10.0, PLACE[1] + 10.0, PLACE[2] + 40.0);
    let target = format!("{},{},{}", PLACE[0] + 10.0, PLACE[1] + 10.0, PLACE[2]);
    let near =
        json("adapt", &[&baked, &level], &format!("--units object --up 0,1,0 --eye {eye} --target {target}"))
            .answer();
    assert!(read_lost(&level) < 1e-6 * DIAGONAL);
    let aside = format!("{},{},{}", PLACE[0] + 10_000.0, PLACE[1], PLACE[2] + 40.0);
    let away = json(
        "adapt",
        &[&baked, &level],
        &format!("--units object --up 0,1,0 --eye {aside} --target {target}"),
    )
    .answer();
    let triangles = |said: &serde_json::Value| said["output"]["triangles"].as_u64().unwrap();
    assert!(triangles(&near) > 4 * triangles(&away), "{near} {away}");
}
