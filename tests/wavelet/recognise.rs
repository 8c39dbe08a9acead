//! Promise: four-to-one subdivisions are found however triangles and vertices are numbered, down to the coarsest base;
//! what comes out is a forest of the whole mesh whose faces, corners and edges fit together; no mesh makes it panic.

use crate::subdivide::check::check;
use crate::subdivide::*;
use multires::mesh::{Attribute, Mesh, names, shapes};
use multires::wavelet::{Recognition, Stop, recognise};
use proptest::prelude::*;

const NONE: u32 = u32::MAX;

fn checked(mesh: &Mesh) -> Recognition {
    let found = recognise(mesh);
    check(mesh, &found);
    found
}

/// Levels and base faces of every component.
fn found(mesh: &Mesh) -> Vec<(u32, u32)> {
    checked(mesh).components.iter().map(|c| (c.levels, c.base_faces)).collect()
}

/// The levels of every triangle's component.
fn levels_of_triangles(found: &Recognition) -> Vec<u32> {
    let forest = &found.quadrisection;
    let mut of_face = vec![0; forest.len()];
    for component in &found.components {
        let first = component.first_base_face as usize;
        of_face[first..first + component.base_faces as usize].fill(component.levels);
    }
    for (face, first) in forest.splits() {
        let levels = of_face[face];
        of_face[first..first + 4].fill(levels);
    }
    let mut of_triangle = vec![NONE; forest.triangles()];
    for (levels, &leaf) in of_face.iter().zip(forest.leaves()).filter(|(_, leaf)| **leaf != NONE) {
        of_triangle[(leaf / 3) as usize] = *levels;
    }
    of_triangle
}

fn stop(mesh: &Mesh) -> Stop {
    let found = checked(mesh);
    assert_eq!((found.components[0].levels, found.quadrisection.levels()), (0, 0));
    found.components[0].stop
}

/// The smallest case, by hand.
///
/// ```text
///            2
///           / \          0: [4, 0, 3], turned so that its corner 0 (point 0) is number 1
///          5---4         ...
///         / \ / \
///        0---3---1
/// ```
#[test]
fn four_triangles_are_one() {
    let triangles = [[5, 0, 3], [3, 4, 5], [4, 3, 1], [2, 5, 4]];
    let mesh = Faces { points: 6, corners: triangles.to_vec() }.mesh();
    let found = checked(&mesh);
    let forest = &found.quadrisection;
    assert_eq!((forest.base_faces(), forest.levels(), forest.len(), forest.triangles()), (1, 1, 5, 4));
    assert_eq!(forest.split(), [true, false, false, false, false]);
    assert_eq!(forest.leaves(), [NONE, 1, 3 * 2 + 2, 3 * 3, 3]);
    assert_eq!(forest.corners(&triangles), [[0, 1, 2], [0, 3, 5], [1, 4, 3], [2, 5, 4], [3, 4, 5]]);
    assert_eq!(forest.splits().collect::<Vec<_>>(), [(0, 1)]);
    assert_eq!(forest.faces_at(0).collect::<Vec<_>>(), [0]);
    assert_eq!(forest.faces_at(1).collect::<Vec<_>>(), [1, 2, 3, 4]);
    assert_eq!(forest.faces_at(9).count(), 4);
    assert_eq!((forest.level(0), forest.level(1), forest.level(2)), (0..1, 1..5, 5..5));
    assert_eq!(forest.corners(&triangles[..3])[3], [NONE; 3]);
    let component = found.components[0];
    assert_eq!(component.stop, Stop::SingleFace);
    assert_eq!(component.to_string(), "4 triangles, 1 level above 1 base face: a single face is left");
}

#[test]
fn no_triangles_make_no_faces() {
    let found = checked(&Mesh::default());
    assert!(found.quadrisection.is_empty() && found.components.is_empty());
    assert_eq!((found.quadrisection.levels(), found.quadrisection.level(0)), (0, 0..0));
}

/// What is no subdivision at all has as many levels as it is subdivided.
#[test]
fn levels_are_counted_exactly() {
    let meshes = [
        (shapes::tetrahedron(), 4),
        (shapes::cube(), 12),
        (shapes::icosphere(0), 20),
        (shapes::hub(7), 7),
        (shapes::spindle(5), 10),
        (shapes::moebius(5), 10),
        (shapes::book(3), 6),
        (shapes::plane(3), 18),
        (shapes::torus(1.0, 0.4, 5, 6), 60),
        (shapes::open_cylinder(5, 4), 40),
    ];
    for (mesh, faces) in meshes {
        for levels in 0..4 {
            let fine = Faces::of(&mesh).times(levels).mesh();
            assert_eq!(found(&fine), [(levels, faces)]);
            assert_eq!(found(&shuffled(&fine, 5).0), [(levels, faces)]);
        }
    }
    assert_eq!(found(&shapes::icosphere(4)), [(4, 20)]);
    assert_eq!(found(&shapes::plane(24)), [(3, 18)]);
    assert_eq!(found(&shapes::bowtie()), [(0, 2), (0, 2)]);
    assert_eq!(found(&Faces::of(&shapes::bowtie()).times(2).mesh()), [(2, 2), (2, 2)]);
    assert_eq!(found(&shapes::two_spheres_touching(2)), [(2, 20), (2, 20)]);
    // Duplicate vertices along seams at the edges of the box are no obstacle.
    assert_eq!(found(&shapes::box_with_face_normals(8)), [(3, 12)]);
}

/// Bases that are no simplicial complexes: edges are told apart by what lies along them, not by their ends.
#[test]
fn a_base_may_have_several_edges_between_two_points() {
    assert_eq!(found(&torus(16, 16).mesh()), [(3, 8)]);
    // With two by two points in the base, whose next level would join a point to itself.
    assert_eq!(
        checked(&torus(16, 16).mesh()).components[0].stop.to_string().split(' ').next_back(),
        Some("point")
    );
}

/// All vertices regular, so that several assumptions hold: each goes as far as the first.
#[test]
fn regular_surfaces_are_coarsened_all_the_way() {
    for seed in 0..8 {
        let levels = |faces: Faces| found(&shuffled(&faces.mesh(), seed).0)[0].0;
        assert_eq!(levels(torus(24, 40)), 3);
        assert_eq!(levels(torus(12, 5)), 0);
        assert_eq!(levels(Faces::of(&shapes::open_cylinder(24, 8))), 3);
        for shift in 0..4 {
            // One way of two keeps the rows where orientations clash on coarse edges, time and again.
            for cut in (shift % 2..9).step_by(2) {
                assert_eq!(levels(klein_bottle(24, 48, shift, cut)), 3);
                assert_eq!(levels(klein_bottle(40, 80, shift, cut)), 3);
            }
            assert_eq!(levels(klein_bottle(24, 48, shift, shift + 1)), 0);
        }
    }
}

/// A seam that opens at two points of a torus only, of which one way of coarsening keeps both and cannot go on:
///
/// ```text
///     o--m--o      row 2    X: two wedges, above and below the row
///      \/ \/
///     /\ /\        if X is old, the coarse rows 0 and 1 both hold a seam, and one of them runs inside the next faces;
///     X--m--o      row 0    if both are midpoints, no coarse corner sees a seam
/// ```
#[test]
fn of_several_ways_one_that_goes_on_is_taken() {
    let faces = torus(16, 16);
    let seam = [0, 32];
    let mut corners = faces.corners.clone();
    for (cell, pair) in corners.chunks_mut(2).enumerate() {
        let row = cell as u32 / 16;
        for corner in pair.iter_mut().flatten() {
            if let Some(i) = seam.iter().position(|&p| p == *corner && p / 16 == row) {
                *corner = 256 + i as u32;
            }
        }
    }
    let mut positions = faces.mesh().positions().to_vec();
    positions.extend(seam.map(|p| positions[p as usize]));
    let uv: Vec<_> = (0..258).map(|v| [v as f32, 0.0]).collect();
    let mesh = Mesh::new(positions, corners).unwrap();
    let mesh = mesh.with_attribute(Attribute::floats(names::UV, &uv)).unwrap();
    for seed in 0..20 {
        assert_eq!(found(&shuffled(&mesh, seed).0), [(3, 8)]);
    }
}

/// One flipped edge anywhere, and nothing is left.
#[test]
fn a_flipped_edge_breaks_the_component_and_no_other() {
    let mut faces = Faces::of(&shapes::icosphere(2));
    faces.add(&Faces::of(&shapes::cube()).times(1));
    let mesh = faces.mesh();
    assert_eq!(found(&mesh), [(2, 20), (1, 12)]);
    for first in 0..320 {
        for side in 0..3 {
            let mut flipped = faces.corners.clone();
            let [a, b, c] = [0, 1, 2].map(|k| flipped[first][(side + k) % 3]);
            let second =
                flipped.iter().position(|t| (0..3).any(|k| t[k] == b && t[(k + 1) % 3] == a)).unwrap();
            let d = *flipped[second].iter().find(|&&p| p != a && p != b).unwrap();
            (flipped[first], flipped[second]) = ([c, a, d], [d, b, c]);
            let broken = Faces { points: faces.points, corners: flipped };
            assert_eq!(found(&broken.mesh()), [(0, 320), (1, 12)]);
        }
    }
}

/// Faces subdivided as they should be, but glued so that midpoints have other valences than six, or three at a border:
///
/// ```text
///         P0           face i has corners A_i, A_i+1 and P_i, and M in the middle of its first side
///        /  \
///       n----m         next to it lies face i + 1, glued along the half from M to A_i+1 alone: three faces around M
///      / \  / \        are nine triangles there, and two at a border are six
///     A0---M---A1
/// ```
#[test]
fn midpoints_of_wrong_valence_are_found() {
    let rosette = |faces: u32, closed: bool| {
        let corners = (0..faces).flat_map(|i| {
            // The shared midpoint is 0, then come all A_i.
            let next = if closed { (i + 1) % faces } else { i + 1 };
            let (a, b) = (1 + i, 1 + next);
            let [p, m, n] = [0, 1, 2].map(|k| 2 + faces + 3 * i + k);
            [[a, 0, n], [b, m, 0], [p, n, m], [0, m, n]]
        });
        Faces { points: 2 + 4 * faces, corners: corners.collect() }.mesh()
    };
    for seed in 0..12 {
        let levels = |faces: u32, closed: bool| found(&shuffled(&rosette(faces, closed), seed).0)[0].0;
        assert_eq!((levels(1, false), levels(2, true)), (1, 1));
        assert_eq!((levels(2, false), levels(3, false), levels(3, true), levels(4, true)), (0, 0, 0, 0));
        assert!(matches!(stop(&rosette(3, true)), Stop::Irregular { .. }));
    }
}

#[test]
fn every_reason_to_stop_is_told() {
    let sphere = Faces::of(&shapes::icosphere(2));
    let without = |t: usize| {
        let mut faces = sphere.clone();
        faces.corners.remove(t);
        faces
    };
    assert_eq!(stop(&shapes::soup(1, 0)), Stop::SingleFace);
    assert_eq!(stop(&without(7).mesh()), Stop::NotFourfold { faces: 319 });
    assert_eq!(stop(&Faces { points: 2, corners: vec![[0, 1, 1]] }.mesh()), Stop::Degenerate { triangle: 0 });
    assert!(matches!(stop(&shapes::cube()), Stop::Irregular { .. }));
    assert!(matches!(stop(&shapes::moebius(4)), Stop::Border { .. }));
    assert!(matches!(stop(&shapes::tetrahedron()), Stop::RepeatedCorner { .. }));

    // Where a contradiction is met depends on how far assumptions hold; that of the true one is the farthest here.
    let mut faces = sphere.clone();
    faces.corners[300].swap(0, 1);
    assert!(matches!(stop(&faces.mesh()), Stop::Orientation { .. }));
    let mut faces = sphere.clone();
    let centre = faces.corners[240];
    faces.corners.extend([0, 1, 2, 0].map(|k| [centre[0], centre[1], faces.points + k]));
    faces.points += 3;
    assert!(matches!(stop(&faces.mesh()), Stop::NonManifold { .. }));

    let charts: Vec<u32> = (0..320).map(|t| u32::from(t == 100)).collect();
    assert!(matches!(stop(&sphere.charted(&charts)), Stop::Seam { .. }));
    assert!(matches!(stop(&sphere.mesh().with_materials(charts).unwrap()), Stop::Material { .. }));
}

/// Only the level that the seam or the material cuts through is lost, with those above it.
#[test]
fn seams_and_materials_run_along_coarse_edges() {
    let fine = Faces::of(&shapes::tetrahedron()).times(3);
    for (block, levels) in [(64, 3), (16, 2), (4, 1), (1, 0)] {
        let chart: Vec<u32> = (0..256).map(|t| u32::from(t / block == 0)).collect();
        let faces = 4 << (2 * (3 - levels));
        assert_eq!(found(&shuffled(&fine.charted(&chart), 3).0), [(levels, faces)]);
        assert_eq!(found(&shuffled(&fine.mesh().with_materials(chart).unwrap(), 4).0), [(levels, faces)]);
    }
}

/// Duplicates leave their component without levels; a triangle that names a point twice is none of it.
#[test]
fn duplicate_and_degenerate_triangles() {
    let fine = Faces::of(&shapes::tetrahedron()).times(2);
    for t in 0..64 {
        let mut twice = fine.clone();
        twice.corners.extend([twice.corners[t]; 4]);
        assert_eq!(found(&twice.mesh()), [(0, 68)]);
        twice.corners.iter_mut().skip(65).for_each(|t| t.swap(0, 1));
        assert_eq!(found(&twice.mesh()), [(0, 68)]);
        let mut flat = fine.clone();
        let [a, b, _] = flat.corners[t];
        flat.corners.insert(0, [a, b, a]);
        assert_eq!(found(&flat.mesh()), [(0, 1), (2, 4)]);
    }
    let mut doubled = fine.clone();
    doubled.corners.extend_from_within(..);
    assert_eq!(found(&doubled.mesh()), [(0, 128)]);
}

/// Time does not grow with the square of anything: not of the triangles, nor of those along an edge.
#[test]
fn large_meshes_end() {
    let sphere = shapes::icosphere(8);
    assert_eq!(sphere.triangles().len(), 1_310_720);
    let found =
        |mesh: &Mesh| recognise(mesh).components.iter().map(|c| (c.levels, c.base_faces)).collect::<Vec<_>>();
    assert_eq!(found(&sphere), [(8, 20)]);
    assert_eq!(found(&Faces::of(&shapes::book(150_000)).times(1).mesh()), [(1, 300_000)]);
    assert_eq!(found(&torus(512, 512).mesh()), [(8, 8)]);
    assert_eq!(recognise(&shapes::soup(200_000, 1)).components.len(), 200_000);
    assert_eq!(recognise(&shapes::spindle(400_000)).quadrisection.levels(), 0);
}

fn base(which: usize, size: u32) -> Mesh {
    match which {
        0 => shapes::tetrahedron(),
        1 => shapes::moebius(3 + size),
        2 => shapes::book(1 + size),
        3 => shapes::bowtie(),
        4 => shapes::hub(3 + size),
        5 => shapes::terrain(2 + size, 7),
        6 => shapes::torus(1.0, 0.4, 3 + size, 3 + size / 2),
        7 => shapes::cube(),
        8 => shapes::open_cylinder(3 + size, 1 + size / 2),
        9 => shapes::soup(1 + size, size),
        10 => shapes::two_spheres_touching(0),
        11 => shapes::spindle(3 + size),
        12 => shapes::uv_sphere(3 + size, 2 + size / 2),
        _ => shapes::rock(20 * (1 + size), size),
    }
}

/// A few bases, each with its own number of levels.
fn bases() -> impl Strategy<Value = Vec<(usize, u32, u32)>> {
    prop::collection::vec((0_usize..14, 0_u32..6, 0_u32..4), 1..4)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    /// Subdividing adds as many levels to what the base has, for each component, and seams and materials between
    /// base faces do not change that.
    #[test]
    fn subdivisions_are_found(bases in bases(), seed in any::<u64>(), charts in 1_u32..4) {
        let mut faces = Faces::default();
        let (mut expected, mut chart) = (Vec::new(), Vec::new());
        let mut state = seed;
        for (which, size, levels) in bases {
            let coarse = Faces::of(&base(which, size));
            let own: Vec<u32> = coarse.corners.iter().map(|_| next(&mut state) as u32 % charts).collect();
            let found = recognise(&coarse.charted(&own).with_materials(own.clone()).unwrap());
            let height = levels_of_triangles(&found);
            faces.add(&coarse.times(levels));
            for (height, own) in height.iter().zip(own) {
                expected.extend(std::iter::repeat_n(height + levels, 1 << (2 * levels)));
                chart.extend(std::iter::repeat_n(own, 1 << (2 * levels)));
            }
        }
        let mesh = faces.charted(&chart).with_materials(chart).unwrap();
        let (mesh, triangle) = shuffled(&mesh, seed);
        let found = checked(&mesh);
        for (levels, from) in levels_of_triangles(&found).into_iter().zip(triangle) {
            prop_assert_eq!(levels, expected[from as usize]);
        }
    }

    /// Whatever is merged or torn, what comes out fits together.
    #[test]
    fn damaged_subdivisions_are_handled(
        bases in bases(),
        merges in prop::collection::vec([any::<u32>(), any::<u32>()], 0..6),
        turned in prop::collection::vec(any::<u32>(), 0..3),
        gone in prop::collection::vec(any::<u32>(), 0..3),
        seed in any::<u64>(),
    ) {
        let mut faces = Faces::default();
        bases.iter().for_each(|&(which, size, levels)| faces.add(&Faces::of(&base(which, size)).times(levels)));
        for [a, b] in merges {
            let (a, b) = (a % faces.points, b % faces.points);
            faces.corners.as_flattened_mut().iter_mut().filter(|p| **p == a).for_each(|p| *p = b);
        }
        for t in turned {
            let at = t as usize % faces.corners.len();
            faces.corners[at].swap(0, 1);
        }
        for t in gone {
            let count = faces.corners.len();
            if count > 1 {
                faces.corners.swap_remove(t as usize % count);
            }
        }
        checked(&shuffled(&faces.mesh(), seed).0);
    }

    /// The numbers of triangles and vertices, and how triangles are turned, do not matter.
    #[test]
    fn numbering_does_not_matter(bases in bases(), seeds in [any::<u64>(), any::<u64>()]) {
        let mut faces = Faces::default();
        bases.iter().for_each(|&(which, size, levels)| faces.add(&Faces::of(&base(which, size)).times(levels)));
        let all = seeds.map(|seed| {
            let mut all = found(&shuffled(&faces.mesh(), seed).0);
            all.sort_unstable();
            all
        });
        prop_assert_eq!(&all[0], &all[1]);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]

    #[test]
    fn any_triangles_will_do(
        triangles in prop::collection::vec([0_u32..9, 0_u32..9, 0_u32..9], 0..24),
        materials in prop::collection::vec(0_u32..2, 24),
        coarse in any::<bool>(),
    ) {
        let count = triangles.len();
        // Vertices 0 to 8 lie in as many points, or in five.
        let positions: Vec<_> = (0..9).map(|v| [(if coarse { v % 5 } else { v }) as f32, 0.0, -0.0]).collect();
        let uv: Vec<_> = (0..9).map(|v| [(v / 7) as f32, 0.5]).collect();
        let mesh = Mesh::new(positions, triangles).unwrap().with_materials(&materials[..count]).unwrap();
        checked(&mesh.with_attribute(Attribute::floats(names::UV, &uv)).unwrap());
    }
}

/// The models, with what their readme says of them.
#[cfg(feature = "io")]
mod models {
    use std::collections::BTreeSet;

    use super::*;

    fn read(file: &str) -> Option<Mesh> {
        crate::models::read("wavelet/recognise", file)
    }

    #[test]
    fn known_bases_are_found() {
        let known = [
            ("subdivision/bunny-rand-s3.ply", 3, 500),
            ("subdivision/bunny-rand-s2.obj", 2, 500),
            ("subdivision/bunny-rand-s0.obj", 0, 500),
            ("subdivision/bunny-ssp-s2.obj", 2, 499),
            ("subdivision/bumpy-s2.ply", 2, 2_496),
            ("subdivision/bumpy-s0.ply", 0, 2_496),
            ("subdivision/penguin-s3.ply", 1, 6_720),
            ("subdivision/3holes.ply", 2, 450),
            // 96 by 24 vertices: the next level would need an even number of the last three.
            ("subdivision/torus-s3.obj", 3, 72),
            ("subdivision/icosphere-s3.obj", 3, 20),
            ("subdivision/cube-uv-s1.obj", 1, 12),
            ("subdivision/bunny-open-original.ply", 0, 18_555),
            ("subdivision/spot-control.obj", 0, 372),
            ("subdivision/spot-quads-s2.obj", 0, 5_856),
            ("subdivision/fish-control.obj", 0, 220),
            ("real/homer.obj", 1, 3_000),
            ("real/armadillo.ply", 0, 86_482),
            ("real/spot.obj", 0, 5_856),
            ("real/rocker-arm.obj", 0, 20_088),
        ];
        for (file, levels, base_faces) in known {
            let Some(mesh) = read(file) else { continue };
            assert_eq!(found(&mesh), [(levels, base_faces)], "{file}");
            assert_eq!(found(&shuffled(&mesh, 9).0), [(levels, base_faces)], "{file}, shuffled");
        }
    }

    #[test]
    fn several_pieces_have_levels_of_their_own() {
        if let Some(mountains) = read("game/terrain/Mountains.gltf") {
            // One mesh at two places.
            assert_eq!(found(&mountains), [(4, 50), (4, 50)]);
        }
        if let Some(teapot) = read("real/teapot.obj") {
            // Handle and spout; body and lid have a pole.
            assert_eq!(found(&teapot), [(0, 3_160), (2, 50), (2, 50), (0, 1_560)]);
        }
    }

    /// The connectivity of the boat is that of two levels, but nine faces of the first have a texture seam inside.
    #[test]
    fn a_seam_inside_coarse_faces_is_respected() {
        let Some(boat) = read("subdivision/boat.obj") else { return };
        assert!(matches!(stop(&boat), Stop::Seam { .. }));
        let bare = Mesh::new(boat.positions(), boat.triangles()).unwrap();
        assert_eq!(found(&bare), [(2, 2_026)]);
        let across = multires::wavelet::recognise_across_seams(&boat);
        assert_eq!(
            across.components.iter().map(|c| (c.levels, c.base_faces)).collect::<Vec<_>>(),
            [(2, 2_026)]
        );
    }

    /// Where the coarser mesh is there too, its triangles are those of the level.
    #[test]
    fn coarse_faces_are_those_of_the_coarser_file() {
        for (fine, coarse, level) in [
            ("bunny-rand-s3.ply", "bunny-rand-s0.obj", 0),
            ("bunny-rand-s3.ply", "bunny-rand-s1.obj", 1),
            ("bunny-rand-s3.ply", "bunny-rand-s2.obj", 2),
            ("bunny-ssp-s2.obj", "bunny-ssp-s0.obj", 0),
            ("bumpy-s2.ply", "bumpy-s0.ply", 0),
            ("penguin-s3.ply", "penguin-s2.obj", 0),
        ] {
            let read = |file: &str| read(&format!("subdivision/{file}"));
            let (Some(fine_mesh), Some(coarse_mesh)) = (read(fine), read(coarse)) else { continue };
            let found = checked(&fine_mesh);
            let corners = found.quadrisection.corners(fine_mesh.triangles());
            let turned = |&[a, b, c]: &[u32; 3]| [[a, b, c], [b, c, a], [c, a, b]].into_iter().min().unwrap();
            let faces: BTreeSet<_> =
                found.quadrisection.faces_at(level).map(|face| turned(&corners[face])).collect();
            let given: BTreeSet<_> = coarse_mesh.triangles().iter().map(turned).collect();
            assert!(faces == given, "{fine}, level {level} against {coarse}");
        }
    }
}
