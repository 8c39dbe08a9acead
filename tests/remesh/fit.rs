//! Promise: fitting brings the triangles of a remesh closer to the mesh, and moves nothing that must stay.
#![cfg(feature = "quality")]

use std::collections::BTreeSet;
use std::ops::ControlFlow;

use crate::support::{awkward, models, remesh, sides};
use glam::DVec3;
use multires::mesh::{Mesh, shapes};
use multires::quality::{Distance, DistanceOptions, Surface};
use multires::remesh::{Depth, Fitting, Parameterisation, Remesher};
use multires::wavelet::{Normals, WaveletOptions};

fn maps(mesh: &Mesh, faces: usize) -> [Parameterisation; 2] {
    [Fitting::Off, Fitting::LeastSquares]
        .map(|fitting| Remesher::new().base_faces(faces).fitting(fitting).run(mesh).unwrap())
}

fn apart(mesh: &Mesh, other: &Mesh) -> Distance {
    let options = DistanceOptions::default().with_samples(20_000);
    Surface::new(mesh).unwrap().distance(&Surface::new(other).unwrap(), &options).unwrap()
}

#[test]
fn the_mean_distance_falls() {
    // With the share that is left: least where the level shows what there is of relief.
    let curved = [
        ("rock", shapes::rock(6_000, 1), 60, 4, 0.8),
        ("torus", shapes::torus(1.0, 0.4, 120, 60), 60, 3, 0.6),
        ("terrain", shapes::terrain(65, 2), 40, 4, 0.8),
        ("sphere", shapes::icosphere(5), 20, 3, 0.6),
    ];
    for (name, mesh, faces, levels, most) in curved {
        let [on, fitted] = maps(&mesh, faces).map(|map| {
            let distance = apart(&mesh, &remesh(&map, &mesh, levels).finest(Normals::Kept));
            distance.forward.mean.max(distance.backward.mean)
        });
        println!("{name}: {on:.6} on the mesh, {fitted:.6} fitted, {:.2}", fitted / on);
        assert!(fitted < most * on, "{name}: {on} on the mesh, {fitted} fitted");
    }
}

/// Meshes with creases, which bend by more than 60 degrees.
const CREASED: [&str; 4] = ["gear", "washer", "pocketed block", "cube"];

/// Returns which vertices lie on borders, and on edges where the cosine between normals is below `least`.
fn on_curves(mesh: &Mesh, least: f64) -> Vec<bool> {
    let points: Vec<DVec3> = mesh.positions().iter().map(|p| DVec3::from_array(p.map(f64::from))).collect();
    let normal = |t: u32| {
        let [a, b, c] = mesh.triangles()[t as usize].map(|v| points[v as usize]);
        (b - a).cross(c - a).normalize_or_zero()
    };
    let mut is_on = vec![false; points.len()];
    for sides in sides(mesh).values() {
        if sides.len() != 2 || normal(sides[0].0).dot(normal(sides[1].0)) < least {
            for &(t, side, _) in sides {
                let corners = mesh.triangles()[t as usize];
                is_on[corners[side] as usize] = true;
                is_on[corners[(side + 1) % 3] as usize] = true;
            }
        }
    }
    is_on
}

#[test]
fn vertices_on_curves_and_of_the_base_stay() {
    for (name, mesh, faces) in models() {
        let maps = maps(&mesh, faces);
        let base: BTreeSet<[u32; 3]> =
            maps[0].base().positions().iter().map(|p| p.map(f32::to_bits)).collect();
        let [on, fitted] = maps.map(|map| remesh(&map, &mesh, 2).finest(Normals::Kept));
        assert_eq!(on.triangles(), fitted.triangles(), "{name}");
        let stays = on_curves(&on, if CREASED.contains(&name) { 0.5 } else { -2.0 });
        let pairs = on.positions().iter().zip(fitted.positions()).zip(stays).enumerate();
        let mut moved = 0;
        for (vertex, ((on, fitted), stays)) in pairs {
            moved += usize::from(on != fitted);
            assert!(
                on == fitted || !(stays || base.contains(&on.map(f32::to_bits))),
                "{name}: {vertex} went from {on:?} to {fitted:?}"
            );
        }
        println!("{name}: {moved} of {} moved", on.positions().len());
    }
}

#[test]
fn no_more_triangles_face_away() {
    for (name, mesh, faces) in models().into_iter().chain(awkward().into_iter().map(|(n, m)| (n, m, 4))) {
        let [on, fitted] = maps(&mesh, faces).map(|map| {
            let go_on = |_| ControlFlow::Continue(());
            map.bake_with(&mesh, Depth::Levels(3), &WaveletOptions::default(), go_on).unwrap().folded
        });
        assert!(fitted <= on, "{name}: {on} on the mesh, {fitted} fitted");
    }
}

#[test]
fn a_remesh_to_an_error_stays_on_the_mesh() {
    let mesh = shapes::rock(3_000, 1);
    let [on, fitted] = maps(&mesh, 60).map(|map| {
        let baked = map.bake(&mesh, Depth::Error(0.01), &WaveletOptions::default()).unwrap();
        baked.structure().finest(Normals::Kept)
    });
    assert_eq!(on.positions(), fitted.positions());
}
