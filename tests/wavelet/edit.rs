//! Promise: an edit at a level takes all that is finer along and nothing else; bounds and instances are then as if all had been made
//! anew, and it can be taken back.

use std::sync::Arc;

use crate::wavelet::{
    bases, buffer, drawn_positions, edge_counts, hash, instance, positions, rough, uniform, view,
};
use multires::adapt::Geomorph;
use multires::lod::{Lod, Triangulation};
use multires::mesh::{Mesh, shapes};
use multires::view::ErrorShape;
use multires::wavelet::{
    DetailFrame, Edited, ErrorBound, Midpoint, Normals, WaveletBuilder, WaveletError, WaveletLod,
    WaveletMesh, WaveletOptions,
};
use proptest::prelude::*;

/// How a mesh is split: the same whatever its positions are.
#[derive(Clone, Copy)]
struct Split {
    levels: usize,
    patchy: bool,
}

/// A mesh of a base; `place` is handed the number of each new vertex too.
fn build(
    base: &Mesh,
    split: Split,
    options: &WaveletOptions,
    mut place: impl FnMut(u32, &Midpoint) -> [f32; 3],
) -> WaveletMesh {
    let mut builder = WaveletBuilder::new(base).unwrap();
    let mut vertex = base.positions().len() as u32;
    for level in 0..split.levels {
        let mut face = 0;
        let is_split = |_: &multires::wavelet::Face| {
            face += 1;
            !split.patchy || hash(face, level as u64) < 0.5
        };
        builder
            .subdivide_where(is_split, |midpoint| {
                vertex += 1;
                place(vertex - 1, midpoint)
            })
            .unwrap();
    }
    builder.build(options).unwrap()
}

/// The same mesh made anew, of its positions.
fn anew(mesh: &WaveletMesh, base: &Mesh, split: Split) -> WaveletMesh {
    let positions = mesh.vertices().positions();
    let mut edited = Mesh::new(&positions[..base.positions().len()], base.triangles()).unwrap();
    for attribute in base.attributes() {
        edited = edited.with_attribute(attribute.clone()).unwrap();
    }
    build(&edited, split, mesh.options(), |vertex, _| positions[vertex as usize])
}

/// Meshes of all kinds, with what they were made of.
fn meshes(seed: u64, options: &WaveletOptions) -> Vec<(String, WaveletMesh, Mesh, Split)> {
    let mut all = Vec::new();
    for (name, base) in bases() {
        for (kind, split) in
            [("uniform", Split { levels: 3, patchy: false }), ("patchy", Split { levels: 5, patchy: true })]
        {
            let rough = rough(seed, 0.25);
            let mesh = build(&base, split, options, |_, midpoint| rough(midpoint));
            all.push((format!("{name}, {kind}"), mesh, base.clone(), split));
        }
    }
    // Deeper than errors are looked at one by one.
    let (base, split) = (shapes::tetrahedron(), Split { levels: 9, patchy: true });
    let rough = rough(seed, 0.25);
    all.push(("deep".to_owned(), build(&base, split, options, |_, midpoint| rough(midpoint)), base, split));
    all
}

/// Some vertices of levels up to one, moved by a share of the mesh.
fn some_moves(mesh: &WaveletMesh, level: usize, seed: u64, count: u64) -> Vec<(u32, [f32; 3])> {
    let of = mesh.subdivision();
    let coarse: Vec<u32> = (0..of.vertex_count() as u32)
        .filter(|&vertex| of.wavelet_of(vertex).is_none_or(|wavelet| of.level_of(wavelet) <= level))
        .collect();
    let size = 0.2 * mesh.diagonal() as f32;
    let one = |k: u64| {
        let vertex = coarse[(hash(seed, k) * coarse.len() as f64) as usize];
        let from = mesh.vertices().positions()[vertex as usize];
        let to = std::array::from_fn(|i| from[i] + size * (hash(seed + k, 5 + i as u64) as f32 - 0.5));
        (vertex, to)
    };
    (0..count).map(one).collect()
}

fn bits(mesh: &WaveletMesh) -> Vec<[u32; 3]> {
    mesh.vertices().positions().iter().map(|p| p.map(f32::to_bits)).collect()
}

/// Vertices of one place are in one place.
fn check_whole(name: &str, mesh: &WaveletMesh) {
    let of = mesh.subdivision();
    let at = |vertex: u32| mesh.vertices().positions()[vertex as usize];
    for wavelet in 0..of.wavelet_count() as u32 {
        for double in of.seam_vertices_of(wavelet) {
            assert_eq!(at(of.vertex_of(wavelet)), at(double), "{name}: wavelet {wavelet} is torn");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn bounds_are_as_if_made_anew(seed in 0u64..1000, local in any::<bool>(), siblings in any::<bool>(), cones in any::<bool>()) {
        let bound = if siblings { ErrorBound::Conservative } else { ErrorBound::WithoutSiblings };
        let shape = if cones { ErrorShape::SphereAndCones } else { ErrorShape::Spheroid };
        let options = WaveletOptions::default().with_bound(bound).with_shape(shape);
        let frame = if local { DetailFrame::Local } else { DetailFrame::Global };
        for (name, mut mesh, base, split) in meshes(seed, &options) {
            prop_assert!(anew(&mesh, &base, split) == mesh, "{} before", &name);
            for step in 0..4 {
                let level = ((seed + step) % 4) as usize;
                let before = mesh.clone();
                let edited = mesh.edit(level, &some_moves(&mesh, level, seed + step, 1 + step), frame).unwrap();
                let made = anew(&mesh, &base, split);
                prop_assert_eq!(mesh.extent(), made.extent());
                prop_assert!(made == mesh, "{} level {}: {:?}", &name, level, frame);
                check_whole(&name, &mesh);
                if step % 2 == 1 {
                    let redone = mesh.undo(&edited).unwrap();
                    prop_assert!(mesh == before && bits(&mesh) == bits(&before), "{} undone", &name);
                    mesh.undo(&redone).unwrap();
                    prop_assert!(mesh == made, "{} done again", &name);
                }
            }
        }
    }
}

#[test]
fn finer_levels_keep_their_coefficients_and_all_else_its_place() {
    for (at, (name, mesh, _, _)) in meshes(3, &WaveletOptions::default()).into_iter().enumerate() {
        let of = mesh.subdivision();
        for level in 0..3 {
            let moves = some_moves(&mesh, level, at as u64, 2);
            let mut after = mesh.clone();
            let edited = after.edit(level, &moves, DetailFrame::Global).unwrap();
            assert!(edited.vertices.is_sorted() && !edited.vertices.is_empty());
            let place = |mesh: &WaveletMesh, vertex: u32| mesh.vertices().positions()[vertex as usize];
            for vertex in 0..of.vertex_count() as u32 {
                let moved = place(&mesh, vertex) != place(&after, vertex);
                let listed = edited.vertices.binary_search(&vertex);
                assert_eq!(listed.is_ok(), moved, "{name}: {vertex}");
                if let Ok(at) = listed {
                    assert_eq!(edited.before[at], place(&mesh, vertex));
                }
                let own = of.wavelet_of(vertex).map_or(0, |wavelet| of.level_of(wavelet));
                if own > level {
                    let [a, b] = [&mesh, &after].map(|mesh| mesh.coefficient(vertex).unwrap());
                    assert!((0..3).all(|i| (a[i] - b[i]).abs() < 1e-6 * mesh.diagonal()), "{name}: {vertex}");
                } else if moved {
                    let point = place(&mesh, vertex);
                    let named = moves.iter().rev().find(|(named, _)| place(&mesh, *named) == point);
                    assert_eq!(named.map(|named| named.1), Some(place(&after, vertex)), "{name}: {vertex}");
                }
            }
            for &(vertex, to) in &moves {
                let last = moves.iter().rev().find(|(v, _)| place(&mesh, *v) == place(&mesh, vertex));
                assert!(place(&after, vertex) == to || last.is_some_and(|l| l.1 != to), "{name}");
            }
        }
    }
}

fn sphere(levels: usize) -> WaveletMesh {
    let mut builder = WaveletBuilder::new(&shapes::icosphere(0)).unwrap();
    for _ in 0..levels {
        builder
            .subdivide(|midpoint| {
                let length = midpoint.middle.iter().map(|x| x * x).sum::<f32>().sqrt();
                midpoint.middle.map(|x| x / length)
            })
            .unwrap();
    }
    builder.build(&WaveletOptions::default()).unwrap()
}

/// A region moves by the hat over it: by what the edited vertex weighs at each place of the base.
#[test]
fn a_region_moves_smoothly() {
    let before = sphere(4);
    let mut mesh = before.clone();
    let of = before.subdivision();
    let by = [0.3_f32, -0.2, 0.5];
    let at = before.vertices().positions()[5];
    let to: [f32; 3] = std::array::from_fn(|i| at[i] + by[i]);
    let edited = mesh.edit(0, &[(5, to)], DetailFrame::Global).unwrap();
    let mut moved = 0;
    for vertex in 0..of.vertex_count() as u32 {
        let point = of.domain_of(vertex).next().unwrap();
        let corner = of.base_face(point.base_face).unwrap().iter().position(|&corner| corner == 5);
        let weight = corner.map_or(0.0, |corner| point.barycentric[corner]);
        moved += usize::from(weight > 0.0);
        let [from, to] = [&before, &mesh].map(|mesh| mesh.vertices().positions()[vertex as usize]);
        for i in 0..3 {
            let expected = f64::from(from[i]) + weight * f64::from(by[i]);
            assert!((f64::from(to[i]) - expected).abs() < 1e-6, "{vertex}");
        }
    }
    assert_eq!(edited.vertices.len(), moved);
    let full = mesh.finest(Normals::Kept);
    assert!(edge_counts(&full).values().all(|&count| count == 2));
}

/// A quarter turn and a bit about an axis.
fn turned(p: [f32; 3]) -> [f32; 3] {
    let (sin, cos) = 1.9_f64.sin_cos();
    let [x, y, z] = p.map(f64::from);
    [(cos * x - sin * z) as f32, y as f32, (sin * x + cos * z) as f32]
}

#[test]
fn details_turn_with_the_surface_in_local_frames() {
    for (name, before, base, _) in meshes(8, &WaveletOptions::default()) {
        let moves: Vec<_> = (0..base.positions().len() as u32)
            .map(|vertex| (vertex, turned(base.positions()[vertex as usize])))
            .collect();
        let off = |frame: DetailFrame| {
            let mut mesh = before.clone();
            mesh.edit(0, &moves, frame).unwrap();
            let pairs = before.vertices().positions().iter().zip(mesh.vertices().positions());
            pairs.fold(0.0_f32, |off, (from, to)| {
                let turned = turned(*from);
                (0..3).fold(off, |off, i| off.max((turned[i] - to[i]).abs()))
            })
        };
        let size = before.diagonal() as f32;
        assert!(off(DetailFrame::Local) < 1e-4 * size, "{name}: {}", off(DetailFrame::Local));
        assert!(off(DetailFrame::Global) > 1e-2 * size, "{name}: {}", off(DetailFrame::Global));
    }
}

/// Wavelets whose supports are elsewhere are left alone.
#[test]
fn only_what_changed_is_touched() {
    let mut mesh = uniform(&shapes::terrain(2, 1), 7, 3, &WaveletOptions::default());
    let of = mesh.subdivision().clone();
    let wavelet = of.wavelets_of(7).start + 9000;
    let vertex = of.vertex_of(wavelet);
    let at = mesh.vertices().positions()[vertex as usize];
    let edited = mesh.edit(7, &[(vertex, [at[0], at[1] + 0.01, at[2]])], DetailFrame::Global).unwrap();
    assert_eq!(edited.vertices, [vertex]);
    assert!(edited.wavelets.len() < 8 * 7, "{}", edited.wavelets.len());
    let mut ancestors = vec![wavelet];
    while let Some(wavelet) = ancestors.pop() {
        assert!(edited.wavelets.binary_search(&wavelet).is_ok());
        let [a, b] = of.ends(of.vertex_of(wavelet)).unwrap();
        ancestors.extend([a, b].into_iter().filter_map(|end| of.wavelet_of(end)));
    }
    // One of level 6 moves its hat: all of the last level whose ends include it.
    let wavelet = of.wavelets_of(6).start + 2000;
    let vertex = of.vertex_of(wavelet);
    let edited = mesh.edit(6, &[(vertex, [0.0; 3])], DetailFrame::Global).unwrap();
    assert!(edited.vertices.len() <= 7, "{:?}", edited.vertices);
}

/// What an instance draws, where everything has come to rest, is what its set of wavelets is.
fn check_drawn(name: &str, lod: &WaveletLod<[f32; 3]>) {
    assert_eq!(drawn_positions(lod), positions(&lod.to_mesh_with(Normals::Kept)), "{name}");
}

#[test]
fn instances_of_an_edited_mesh_are_as_new_ones() {
    for (at, (name, mesh, _, _)) in meshes(6, &WaveletOptions::default()).into_iter().enumerate() {
        let at = at as u64;
        for triangulation in [Triangulation::Exact, Triangulation::Minimal] {
            for geomorph in [None, Some(Geomorph::default())] {
                let drawing = buffer(at % 2 == 1).with_triangulation(triangulation).with_geomorph(geomorph);
                let mut mesh = Arc::new(mesh.clone());
                let mut lod = instance(&mesh, &drawing);
                let mut own = instance(&mesh, &drawing);
                if at.is_multiple_of(3) {
                    let limits = drawing.with_triangles(Some(60));
                    lod.set_options(&limits).unwrap();
                    own.set_options(&limits).unwrap();
                }
                for step in 0..6 {
                    let view = view(&mesh, 10 * at + step / 2, 12.0).of_world();
                    lod.adapt(std::slice::from_ref(&view), 0.05);
                    own.adapt(std::slice::from_ref(&view), 0.05);
                    lod.clean();
                    let level = (step % 4) as usize;
                    let moves = some_moves(&mesh, level, step + at, 2);
                    let before = drawn_positions(&lod);

                    let frame = DetailFrame::Global;
                    let edited = own.edit(level, &moves, frame, |mesh, vertex| {
                        mesh.vertices().positions()[vertex as usize]
                    });
                    let edited = edited.unwrap();
                    assert!(**own.own_values() == *own.mesh().vertices().positions());
                    let old = Arc::clone(&mesh);
                    let same: Edited = Arc::make_mut(&mut mesh).edit(level, &moves, frame).unwrap();
                    assert_eq!(same, edited);
                    assert!(**own.mesh() == *mesh && Arc::ptr_eq(lod.mesh(), &old));
                    let values: Arc<[[f32; 3]]> = mesh.vertices().positions().into();
                    lod.replace(Arc::clone(&mesh), values, &edited.vertices).unwrap();

                    // At once, on the way too, and nothing that changed is clean.
                    assert_eq!(drawn_positions(&lod), drawn_positions(&own), "{name}");
                    let dirty: usize = lod.dirty_vertices(0).map(|range| range.len()).sum();
                    assert!(dirty > 0 || before == drawn_positions(&lod), "{name}");
                    if geomorph.is_none() {
                        check_drawn(&name, &lod);
                    }
                }
                let view = view(&mesh, at, 12.0).of_world();
                let mut fresh = instance(&mesh, &drawing);
                fresh.set_options(lod.options()).unwrap();
                for lod in [&mut lod, &mut own, &mut fresh] {
                    lod.adapt(std::slice::from_ref(&view), 1.0 / 60.0);
                    lod.settle();
                    check_drawn(&name, lod);
                }
                if lod.options().triangles.is_none() {
                    assert_eq!(drawn_positions(&lod), drawn_positions(&fresh), "{name}");
                }
                assert_eq!(drawn_positions(&lod), drawn_positions(&own), "{name}");
            }
        }
    }
}

#[test]
fn edits_that_make_no_sense_change_nothing() {
    let (_, mesh, ..) = meshes(1, &WaveletOptions::default()).remove(0);
    let mut mesh = Arc::new(mesh);
    let before = mesh.clone();
    let of = mesh.subdivision().clone();
    let count = of.vertex_count() as u32;
    let fine = of.vertex_of(of.wavelets_of(2).start);
    let good = (0, [9.0; 3]);
    let mut refuse = |level: usize, moves: &[(u32, [f32; 3])]| {
        let error = Arc::make_mut(&mut mesh).edit(level, moves, DetailFrame::Local).unwrap_err();
        assert!(mesh == before, "{error}");
        error
    };
    let invalid = |at: u32| move |error: WaveletError| matches!(error, WaveletError::Invalid { at: a, .. } if a == at as usize);
    assert!(invalid(count)(refuse(0, &[good, (count, [0.0; 3])])));
    assert!(invalid(u32::MAX)(refuse(9, &[good, (u32::MAX, [0.0; 3])])));
    assert!(invalid(fine)(refuse(1, &[good, (fine, [0.0; 3])])));
    assert!(matches!(refuse(1, &[good, (1, [f32::NAN, 0.0, 0.0])]), WaveletError::Mesh(_)));
    assert_eq!(
        Arc::make_mut(&mut mesh).edit(usize::MAX, &[], DetailFrame::Local).unwrap(),
        Edited::default()
    );

    let values: Arc<[[f32; 3]]> = mesh.vertices().positions().into();
    let mut lod = instance(&mesh, &buffer(false));
    let other = Arc::new(uniform(&shapes::tetrahedron(), 2, 1, &WaveletOptions::default()));
    assert!(lod.replace(other, Arc::clone(&values), &[]).is_err());
    assert!(lod.replace(Arc::clone(&mesh), Arc::from(&values[1..]), &[]).is_err());
    assert!(lod.replace(Arc::clone(&mesh), Arc::clone(&values), &[count]).is_err());
    assert!(lod.edit(0, &[(count, [0.0; 3])], DetailFrame::Global, |_, _| [0.0; 3]).is_err());
    assert!(lod.replace(Arc::clone(&mesh), values, &[0, 0]).is_ok());
    check_drawn("", &lod);

    // Farther than numbers go.
    let far = f32::MAX;
    let mesh = Arc::make_mut(&mut mesh);
    mesh.edit(0, &[(0, [far; 3]), (1, [far; 3]), (2, [far; 3])], DetailFrame::Global).unwrap();
    mesh.edit(0, &[(3, [-far; 3])], DetailFrame::Local).unwrap();
    assert!(mesh.vertices().positions().as_flattened().iter().all(|x| x.is_finite()));
    let mut empty = WaveletBuilder::new(&Mesh::default()).unwrap().build(&WaveletOptions::default()).unwrap();
    assert_eq!(empty.edit(3, &[], DetailFrame::Global).unwrap(), Edited::default());
}
