//! Promise: a recognised mesh comes out as it went in: every triangle, attribute and material, bit for bit; and what coarser levels
//! have of it is what it has.

use crate::wavelet::{bases, hash, uniform};
use multires::mesh::{Attribute, AttributeValues, Mesh, names, shapes};
use multires::wavelet::{ErrorBound, Normals, Triangulation, WaveletError, WaveletMesh, WaveletOptions};

/// All that a corner has, in words.
fn corner(mesh: &Mesh, vertex: u32) -> Vec<u32> {
    let mut words: Vec<u32> = mesh.positions()[vertex as usize].iter().map(|x| (x + 0.0).to_bits()).collect();
    for attribute in mesh.attributes() {
        let range = vertex as usize * attribute.width()..(vertex as usize + 1) * attribute.width();
        match attribute.values() {
            AttributeValues::Float(values) => words.extend(values[range].iter().map(|x| x.to_bits())),
            AttributeValues::Uint(values) => words.extend(&values[range]),
            AttributeValues::Int(values) => words.extend(values[range].iter().map(|&x| x as u32)),
            _ => unreachable!(),
        }
    }
    words
}

/// Every triangle by the values of its corners, from the lowest on, and its material; in order.
fn triangles(mesh: &Mesh) -> Vec<(Vec<Vec<u32>>, Option<u32>)> {
    let mut all: Vec<_> = mesh
        .triangles()
        .iter()
        .enumerate()
        .map(|(t, corners)| {
            let mut values: Vec<Vec<u32>> = corners.iter().map(|&v| corner(mesh, v)).collect();
            let low = (0..3).min_by_key(|&k| values[k].clone()).unwrap();
            values.rotate_left(low);
            (values, mesh.materials().get(t).copied())
        })
        .collect();
    all.sort_unstable();
    all
}

fn recognise(mesh: &Mesh) -> WaveletMesh {
    WaveletMesh::recognise(mesh, &WaveletOptions::default()).unwrap()
}

/// Shuffled, with corners turned.
fn scrambled(mesh: &Mesh, seed: u64) -> Mesh {
    let mut order: Vec<usize> = (0..mesh.triangles().len()).collect();
    order.sort_by_key(|&t| hash(t as u64, seed).to_bits());
    let turned = order.iter().map(|&t| {
        let mut corners = mesh.triangles()[t];
        corners.rotate_left((hash(t as u64, seed + 1) * 3.0) as usize % 3);
        corners
    });
    let mut out = Mesh::new(mesh.positions(), turned.collect::<Vec<_>>()).unwrap();
    for attribute in mesh.attributes() {
        out = out.with_attribute(attribute.clone()).unwrap();
    }
    let materials: Vec<u32> = if mesh.materials().is_empty() {
        Vec::new()
    } else {
        order.iter().map(|&t| mesh.materials()[t]).collect()
    };
    out.with_materials(materials).unwrap()
}

#[test]
fn generated_meshes_come_out_as_they_went_in() {
    // Of two faces on the same three points the parts have the same edges, which then look non-manifold.
    for (name, base) in bases().into_iter().filter(|(name, _)| *name != "pillow") {
        for seed in 0..3 {
            let fine = uniform(&base, 2, seed, &WaveletOptions::default()).finest(Normals::Kept);
            let fine = scrambled(&fine, seed);
            let found = recognise(&fine);
            assert!(found.subdivision().base_face_count() <= base.triangles().len(), "{name}");
            assert!(found.subdivision().depth() >= 2, "{name}");
            assert_eq!(triangles(&found.finest(Normals::Kept)), triangles(&fine), "{name}");
        }
    }
}

/// A grid whose charts meet along a line that is no edge of the base: it runs inside base faces.
fn seam_across() -> Mesh {
    let mesh = shapes::terrain(17, 3);
    let chart = |t: &[u32; 3]| u32::from(t.iter().map(|v| v % 17).sum::<u32>() > 15);
    let mut positions = mesh.positions().to_vec();
    let count = positions.len() as u32;
    positions.extend_from_within(..);
    let corners: Vec<[u32; 3]> = mesh.triangles().iter().map(|t| t.map(|v| v + count * chart(t))).collect();
    let uv: Vec<[f32; 2]> = (0..2 * count)
        .map(|v| {
            let at = positions[v as usize];
            [at[0] + 3.0 * (v / count) as f32, at[2]]
        })
        .collect();
    let materials: Vec<u32> = mesh.triangles().iter().map(|t| u32::from(t[0] / 17 >= 8) * 5 + 2).collect();
    Mesh::new(positions, corners)
        .unwrap()
        .with_attribute(Attribute::floats(names::UV, &uv))
        .unwrap()
        .with_materials(materials)
        .unwrap()
}

#[test]
fn seams_and_materials_are_kept_wherever_they_run() {
    let mesh = seam_across();
    let found = recognise(&mesh);
    // The border of materials runs along the middle row, the seam across the base faces.
    assert_eq!(found.subdivision().base_face_count(), 8);
    assert_eq!(found.materials(), [2, 7]);
    assert_eq!(triangles(&found.finest(Normals::Kept)), triangles(&mesh));

    // Where the seam is in view nothing is smeared across: every corner has coordinates of its chart, and no triangle both.
    let fine = found.at_tolerance(1e30, Triangulation::Exact, Normals::Kept);
    assert!(fine.triangles().len() < mesh.triangles().len());
    let uv = fine.attribute(names::UV).unwrap().as_floats().unwrap();
    for t in fine.triangles() {
        let charts = t.map(|v| uv[2 * v as usize] > 1.5);
        assert!(charts.iter().all(|&chart| chart == charts[0]), "{t:?}");
    }
}

#[test]
fn bounds_take_little_memory() {
    let options = WaveletOptions::default();
    for mesh in [recognise(&shapes::terrain(129, 1)), uniform(&shapes::icosphere(0), 5, 1, &options)] {
        let each = mesh.structure_memory() as f64 / mesh.subdivision().wavelet_count() as f64;
        assert!(each <= 40.0, "{each} bytes a wavelet");
    }
}

#[test]
fn the_coefficient_is_what_equation_1_says() {
    let mesh = uniform(&shapes::icosphere(1), 3, 4, &WaveletOptions::default());
    let at = |v: u32| mesh.vertices().positions()[v as usize].map(f64::from);
    for wavelet in 0..mesh.subdivision().wavelet_count() as u32 {
        let vertex = mesh.subdivision().vertex_of(wavelet);
        let [a, b] = mesh.subdivision().ends(vertex).unwrap().map(at);
        let s = mesh.coefficient(vertex).unwrap();
        for i in 0..3 {
            assert_eq!(s[i] + 0.5 * (a[i] + b[i]), at(vertex)[i]);
        }
    }
    assert_eq!(mesh.coefficient(0), None);
    assert_eq!(mesh.coefficient(u32::MAX), None);
}

#[test]
fn meshes_without_the_connectivity_are_refused_with_the_reason() {
    let refused = |mesh: &Mesh| match WaveletMesh::recognise(mesh, &WaveletOptions::default()) {
        Err(error @ WaveletError::NoConnectivity { .. }) => error.to_string(),
        other => panic!("{other:?}"),
    };
    assert!(refused(&shapes::tetrahedron()).contains("4 triangles"));
    assert!(refused(&Mesh::default()).contains("no triangles"));
    assert!(refused(&shapes::soup(5, 1)).contains("components"));
}

#[test]
fn the_same_bytes_for_any_number_of_threads() {
    let make = || {
        [ErrorBound::Conservative, ErrorBound::WithoutSiblings].map(|bound| {
            uniform(&shapes::torus(1.0, 0.3, 5, 4), 4, 2, &WaveletOptions::default().with_bound(bound))
        })
    };
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap().install(make);
    let four = rayon::ThreadPoolBuilder::new().num_threads(4).build().unwrap().install(make);
    assert_eq!(one, four);
}

#[cfg(feature = "io")]
mod models {
    use super::*;

    fn read(name: &str) -> Option<Mesh> {
        crate::models::read("wavelet/mesh", name)
    }

    #[test]
    fn models_come_out_as_they_went_in() {
        for (name, base, depth) in [
            ("subdivision/bunny-rand-s3.ply", 500, 3),
            ("subdivision/bunny-ssp-s2.obj", 499, 2),
            ("subdivision/bumpy-s2.ply", 2_496, 2),
            ("subdivision/penguin-s3.ply", 6_720, 1),
            ("subdivision/boat.obj", 2_026, 2),
            ("subdivision/3holes.ply", 450, 2),
            ("subdivision/torus-s3.obj", 72, 3),
            ("subdivision/icosphere-s3.obj", 20, 3),
            ("subdivision/cube-uv-s1.obj", 12, 1),
            ("real/homer.obj", 3_000, 1),
            ("game/terrain/Mountains.gltf", 100, 4),
        ] {
            let Some(mesh) = read(name) else { continue };
            let found = recognise(&mesh);
            assert_eq!(found.subdivision().base_face_count(), base, "{name}");
            assert_eq!(found.subdivision().depth(), depth, "{name}");
            assert_eq!(found.at_level(0, Normals::Kept).triangles().len(), base, "{name}");
            assert_eq!(triangles(&found.finest(Normals::Kept)), triangles(&mesh), "{name}");
        }
    }
}
