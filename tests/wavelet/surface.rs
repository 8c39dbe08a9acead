//! Promise: any set of wavelets is a mesh without cracks or T-vertices, and the same set is the same mesh, however it came about.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::wavelet::{
    bases, buffer, drawn_positions, edge_counts, hash, instance, patchy, positions, uniform, view,
};
use multires::lod::{Lod, Triangulation};
use multires::mesh::Mesh;
use multires::wavelet::{Normals, WaveletMesh, WaveletOptions};
use proptest::prelude::*;

const BOTH: [Triangulation; 2] = [Triangulation::Exact, Triangulation::Minimal];

fn meshes(seed: u64) -> Vec<(String, WaveletMesh, Mesh)> {
    let options = WaveletOptions::default();
    let mut all = Vec::new();
    for (name, base) in bases() {
        all.push((format!("{name}, uniform"), uniform(&base, 3, seed, &options), base.clone()));
        all.push((format!("{name}, patchy"), patchy(&base, 4, seed, &options), base));
    }
    all
}

/// As many triangles at every edge of the base as there, along all its parts; two at every other edge. So nothing is torn, and no
/// vertex lies on the side of a triangle.
fn check_watertight(name: &str, mesh: &Mesh, base: &Mesh) {
    let odd = |mesh: &Mesh| edge_counts(mesh).values().filter(|&&count| count != 2).count();
    if odd(base) == 0 {
        assert_eq!(odd(mesh), 0, "{name}");
    }
    // Borders and edges of many triangles are bent, but fork and end where those of the base do.
    let forks = |mesh: &Mesh| {
        let mut degree = BTreeMap::new();
        for (ends, count) in edge_counts(mesh).into_iter().filter(|(_, count)| *count != 2) {
            ends.iter().for_each(|end| *degree.entry((count, *end)).or_insert(0_usize) += 1);
        }
        let mut forks: Vec<(usize, usize)> =
            degree.iter().map(|(&(count, _), &degree)| (count, degree)).collect();
        forks.retain(|fork| fork.1 != 2);
        forks.sort_unstable();
        forks
    };
    assert_eq!(forks(mesh), forks(base), "{name}");
}

#[test]
fn any_set_is_watertight_and_has_the_triangles_that_its_vertices_add() {
    for seed in 0..4 {
        for (name, mesh, base) in meshes(seed) {
            for share in [0.0, 0.02, 0.2, 0.7, 1.0] {
                for triangulation in BOTH {
                    let asked = |wavelet: u32| hash(u64::from(wavelet), seed + 100) < share;
                    let drawn = mesh.extract(asked, triangulation, Normals::Kept);
                    let name = format!("{name}, {share}, {triangulation:?}, seed {seed}");
                    // Two faces on the same three points have edges of their own between the same vertices.
                    if !name.starts_with("pillow") {
                        check_watertight(&name, &drawn, &base);
                    }
                }
            }
        }
    }
}

#[test]
fn the_full_set_is_the_full_resolution() {
    for (name, mesh, _) in meshes(9) {
        let full = mesh.finest(Normals::Kept);
        if mesh.subdivision().is_uniform() {
            assert_eq!(full.triangles().len(), mesh.subdivision().leaf_count(), "{name}");
            let minimal = mesh.extract(|_| true, Triangulation::Minimal, Normals::Kept);
            assert_eq!(positions(&full), positions(&minimal), "{name}");
        }
        assert!(positions(&full).iter().flatten().all(|p| mesh.vertices().positions().contains(p)), "{name}");
    }
}

/// The first triangles that two lists do not share.
fn differs(a: &[[[f32; 3]; 3]], b: &[[[f32; 3]; 3]]) -> Option<String> {
    let only = |a: &[[[f32; 3]; 3]], b: &[[[f32; 3]; 3]]| a.iter().find(|t| !b.contains(t)).copied();
    (a != b).then(|| format!("{} and {} triangles; {:?} or {:?}", a.len(), b.len(), only(a, b), only(b, a)))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn a_cut_is_the_same_mesh_however_it_was_reached(seed in 0u64..1000, px in 0.5_f32..60.0) {
        let all = meshes(seed % 5);
        let (name, mesh, _) = all.into_iter().nth(seed as usize % 20).unwrap();
        let mesh = Arc::new(mesh);
        for triangulation in BOTH {
            for packed in [false, true] {
                let drawing = buffer(packed).with_triangulation(triangulation);
                let mut lod = instance(&mesh, &drawing);
                for step in 0..6 {
                    let view = view(&mesh, seed + step, px).of_world();
                    let change = lod.adapt(std::slice::from_ref(&view), 1.0 / 60.0);
                    prop_assert_eq!(change.triangles, (0..lod.groups()).map(|g| lod.triangles(g).len()).sum::<usize>());
                    let fresh = lod.to_mesh_with(Normals::Kept);
                    let difference = differs(&drawn_positions(&lod), &positions(&fresh));
                    prop_assert!(difference.is_none(), "{} {:?} step {} {:?}", &name, triangulation, step, difference);
                    let mut other = instance(&mesh, &drawing);
                    other.adapt(&[view], 1.0 / 60.0);
                    prop_assert_eq!(drawn_positions(&lod), drawn_positions(&other));
                }
            }
        }
    }
}
