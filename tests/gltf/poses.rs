//! Skinned and morphing meshes keep their shape where they bend.

use multires::io::GltfDocument;
use multires::mesh::{Mesh, names};
use multires::quality::{DistanceOptions, distance};

use crate::gltf_samples;

fn posed(mesh: &Mesh, positions: Vec<[f32; 3]>) -> Mesh {
    Mesh::new(positions, mesh.triangles()).unwrap()
}

#[test]
fn a_skin_bends_as_its_joints_turn() {
    let document = GltfDocument::from_bytes(&gltf_samples::skinned().glb()).unwrap();
    // A unit is 100 in the scene; poses are in units of the mesh.
    assert!((document.mesh_scale(0) - 100.0).abs() < 1e-9);
    let mesh = document.mesh(0).unwrap().unwrap().mesh;
    let poses = document.poses(0, 3).unwrap();
    assert_eq!(poses.iter().map(|p| p.time().unwrap()).collect::<Vec<_>>(), [0.0, 1.0, 2.0]);
    assert!(poses.iter().all(|p| p.name() == "bend"));
    for (from, to) in mesh.positions().iter().zip(poses[0].positions(&mesh)) {
        assert!(from.iter().zip(to).all(|(a, b)| (a - b).abs() < 1e-5));
    }
    // The upper end turns by a quarter about the x axis, at a height of 5.
    for (from, to) in mesh.positions().iter().zip(poses[1].positions(&mesh)).filter(|(p, _)| p[1] > 7.5) {
        let expected = [from[0], 5.0 - from[2], from[1] - 5.0];
        assert!(to.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-4), "{from:?}: {to:?}");
    }
}

#[test]
fn targets_move_as_they_weigh() {
    for sparse in [false, true] {
        let document = GltfDocument::from_bytes(&gltf_samples::morphed(sparse).glb()).unwrap();
        let mesh = document.mesh(0).unwrap().unwrap().mesh;
        let targets = document.target_poses(0);
        assert_eq!(targets.iter().map(|p| p.name()).collect::<Vec<_>>(), ["bulge", "lean"]);
        let lean = mesh.attribute("displacement1").unwrap().as_floats().unwrap();
        assert_eq!(mesh.attribute(names::DISPLACEMENT).unwrap().width(), 3);
        let positions = targets[1].positions(&mesh);
        for (v, p) in mesh.positions().iter().enumerate() {
            assert!((positions[v][0] - p[0] - lean[3 * v]).abs() < 1e-6);
            assert!((lean[3 * v] - 0.05 * p[1] * p[1]).abs() < 1e-5);
        }
        // At the end of the animation: all of the first, half of the second.
        let last = document.poses(0, 2).unwrap().pop().unwrap().positions(&mesh);
        let first = targets[0].positions(&mesh);
        for (v, p) in mesh.positions().iter().enumerate() {
            assert!((last[v][0] - (first[v][0] + 0.5 * (positions[v][0] - p[0]))).abs() < 1e-5);
        }
    }
}

#[test]
fn levels_hold_in_every_target() {
    let document = GltfDocument::from_bytes(&gltf_samples::morphed(false).glb()).unwrap();
    let mesh = document.mesh(0).unwrap().unwrap().mesh;
    let mut simplifier = multires::Simplifier::new().target(multires::Target::Ratio(0.25));
    let sequence = simplifier.run(&mesh).unwrap();
    let level = sequence.extract(&mesh, sequence.len());
    let options = DistanceOptions::default().with_samples(20_000);
    let apart = |a: Vec<[f32; 3]>, b: Vec<[f32; 3]>| {
        distance(&posed(&mesh, a), &posed(&level, b), &options).unwrap().hausdorff()
    };
    let still = apart(mesh.positions().to_vec(), level.positions().to_vec());
    for pose in document.target_poses(0) {
        let bent = apart(pose.positions(&mesh), pose.positions(&level));
        assert!(bent <= 1.5 * still, "{}: {bent} after {still}", pose.name());
    }
}

/// Frames of each animation.
const FRAMES: usize = 8;

/// The largest sampled distances of a level from its mesh: as they are, and over poses.
fn bent(document: &GltfDocument, index: usize, share: f64, frames: usize) -> [f64; 2] {
    let mesh = document.mesh(index).unwrap().unwrap().mesh;
    let poses = document.poses(index, frames).unwrap();
    let with = GltfDocument::with_poses(&mesh, &GltfDocument::extreme_poses(&poses, &mesh, 4)).unwrap();
    let sequence = multires::Simplifier::new().target(multires::Target::Ratio(share)).run(&with).unwrap();
    let level = sequence.extract(&with, sequence.len());
    let options = DistanceOptions::default().with_samples(5_000);
    let apart = |a: Vec<[f32; 3]>, b: Vec<[f32; 3]>| {
        distance(&posed(&mesh, a), &posed(&level, b), &options).unwrap().hausdorff()
    };
    let still = apart(mesh.positions().to_vec(), level.positions().to_vec());
    let all = poses.iter().map(|pose| apart(pose.positions(&mesh), pose.positions(&level)));
    [still, all.fold(0.0, f64::max)]
}

#[test]
fn game_figures_do_not_tear() {
    let test = "game_figures_do_not_tear";
    for (name, meshes) in [("game/Fox.glb", 1), ("game/pigman/scene.gltf", 14)] {
        let Some(path) = crate::models::find(test, name) else { continue };
        let document = GltfDocument::read(path).unwrap();
        assert_eq!(document.mesh_count(), meshes);
        let all: Vec<[f64; 2]> = (0..meshes).map(|i| bent(&document, i, 0.25, FRAMES)).collect();
        // Over the whole figure, in the units of its meshes: all have the same scale but for rounding and the axe.
        let [still, posed] = [0, 1].map(|i| all.iter().map(|e| e[i]).fold(0.0, f64::max));
        eprintln!("{name}: {still:.4} still, {posed:.4} over the frames: {:.3}", posed / still);
        assert!(posed <= 1.5 * still, "{name}: {posed} over the frames, {still} still");
    }
}

#[test]
fn extremes_are_the_poses_that_bend_most() {
    let document = GltfDocument::from_bytes(&gltf_samples::skinned().glb()).unwrap();
    let mesh = document.mesh(0).unwrap().unwrap().mesh;
    let poses = document.poses(0, 9).unwrap();
    let extremes = GltfDocument::extreme_poses(&poses, &mesh, 2);
    let mut times: Vec<f64> = extremes.iter().map(|p| p.time().unwrap()).collect();
    times.sort_by(f64::total_cmp);
    // A quarter turn about one axis, then half a turn about another.
    assert_eq!(times.len(), 2);
    assert!(times[1] == 2.0 && (0.5..=1.5).contains(&times[0]), "{times:?}");
    // Rigid meshes have none.
    assert!(GltfDocument::from_bytes(&gltf_samples::all()[0].glb()).unwrap().poses(0, 9).unwrap().is_empty());
}
