//! Promise: signed distances are positive outside and negative inside, at faces, edges and corners, however vertices are
//! split and triangles cut; and a surface without an inside is refused, by the edge at fault.
#![cfg(feature = "quality")]

use multires::{
    mesh::{Mesh, shapes},
    quality::{
        DistanceOptions, QualityError, Surface, signed_distance, vertex_distances, vertex_signed_distances,
    },
};
use proptest::prelude::*;

fn options(samples: usize) -> DistanceOptions {
    DistanceOptions::default().with_samples(samples)
}

fn points(positions: &[[f32; 3]]) -> Mesh {
    Mesh::new(positions, Vec::new()).unwrap()
}

/// Every corner a vertex of its own.
fn exploded(mesh: &Mesh) -> Mesh {
    let positions: Vec<[f32; 3]> = mesh.indices().iter().map(|&v| mesh.positions()[v as usize]).collect();
    let triangles: Vec<[u32; 3]> =
        (0..mesh.triangles().len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    Mesh::new(positions, triangles).unwrap()
}

fn scaled(mesh: &Mesh, scale: f32) -> Mesh {
    let positions: Vec<[f32; 3]> = mesh.positions().iter().map(|p| p.map(|x| x * scale)).collect();
    Mesh::new(positions, mesh.triangles()).unwrap()
}

fn flipped(mesh: &Mesh) -> Mesh {
    let triangles: Vec<[u32; 3]> = mesh.triangles().iter().map(|&[a, b, c]| [a, c, b]).collect();
    Mesh::new(mesh.positions(), triangles).unwrap()
}

fn together(a: &Mesh, b: &Mesh) -> Mesh {
    let shift = a.positions().len() as u32;
    let moved: Vec<[u32; 3]> = b.triangles().iter().map(|t| t.map(|v| v + shift)).collect();
    Mesh::new([a.positions(), b.positions()].concat(), [a.triangles(), &moved[..]].concat()).unwrap()
}

/// A box from -1 to 1, stretched.
fn cuboid(half: [f32; 3]) -> Mesh {
    let positions: Vec<[f32; 3]> = (0..8)
        .map(|i| std::array::from_fn(|axis| if i >> axis & 1 == 1 { half[axis] } else { -half[axis] }))
        .collect();
    let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles: Vec<[u32; 3]> =
        quads.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Mesh::new(positions, triangles).unwrap()
}

/// Signed distance from a box about the origin.
fn from_cuboid(p: [f32; 3], half: [f32; 3]) -> f64 {
    let q: [f64; 3] = std::array::from_fn(|i| f64::from(p[i]).abs() - f64::from(half[i]));
    let outside = q.iter().map(|x| x.max(0.0).powi(2)).sum::<f64>().sqrt();
    outside + q.iter().fold(f64::NEG_INFINITY, |a, &b| a.max(b)).min(0.0)
}

/// Two needles' worth of a wedge: a prism whose ridge at z = 0 is far sharper than a right angle.
fn wedge(sharpness: f32) -> Mesh {
    let positions = [
        [-1.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [-1.0, -sharpness, -1.0],
        [1.0, -sharpness, -1.0],
        [-1.0, sharpness, -1.0],
        [1.0, sharpness, -1.0],
    ];
    let triangles = [[0, 2, 3], [0, 3, 1], [0, 1, 5], [0, 5, 4], [2, 4, 5], [2, 5, 3], [0, 4, 2], [1, 3, 5]];
    Mesh::new(positions, triangles).unwrap()
}

#[test]
fn concentric_spheres_lie_outside_and_inside() {
    let (inner, outer) = (shapes::icosphere(4), scaled(&shapes::icosphere(4), 1.25));
    let d = signed_distance(&inner, &outer, &options(20_000)).unwrap();
    // Facets sag by 0.1 % of the radius.
    assert!((d.forward.mean + 0.25).abs() < 2e-3 && (d.backward.mean - 0.25).abs() < 2e-3, "{d:?}");
    assert_eq!((d.forward.outside, d.backward.inside), (0.0, 0.0));
    assert!((d.forward.inside - 0.25).abs() < 2e-3 && (d.backward.outside - 0.25).abs() < 2e-3, "{d:?}");
    assert_eq!((d.forward.inside_share, d.backward.inside_share), (1.0, 0.0));
    // Inside out, all is the other way round.
    let turned = signed_distance(&inner, &flipped(&outer), &options(20_000)).unwrap();
    assert!((turned.forward.mean + d.forward.mean).abs() < 1e-12, "{turned:?}");
    assert_eq!(turned.forward.inside_share, 0.0);
}

#[test]
fn a_box_through_a_box_is_both() {
    // A bar through a cube: 2 of its 2.5 long sides' shares lie inside.
    let (bar, cube) = (cuboid([2.0, 0.5, 0.5]), cuboid([1.0, 1.0, 1.0]));
    let one = Surface::new(&bar)
        .unwrap()
        .signed_distance_to(&Surface::new(&cube).unwrap(), &options(50_000))
        .unwrap();
    assert!((one.outside - 1.0).abs() < 1e-12, "{one:?}");
    assert!((one.inside - 0.5).abs() < 1e-12, "{one:?}");
    assert!((one.inside_share - 8.0 / 18.0).abs() < 1e-3, "{one:?}");
    assert_eq!(one.outside_at[0].abs(), 2.0);
}

#[test]
fn no_single_normal_at_a_sharp_ridge_tells_the_side() {
    for sharpness in [0.3, 0.01, 1e-4] {
        let mesh = wedge(sharpness);
        // Above the ridge and to the side: behind one of the two flanks' planes, nearest to the ridge or its ends.
        let above = [[0.0, 0.4, 0.2], [0.3, -0.4, 0.2], [1.5, 0.3, 0.2], [-1.5, 0.0, 0.1], [1.0, -0.3, 0.2]];
        for split in [mesh.clone(), exploded(&mesh)] {
            let signed = vertex_signed_distances(&points(&above), &split).unwrap();
            let plain = vertex_distances(&points(&above), &split).unwrap();
            assert_eq!(signed, plain, "{sharpness}");
            let below = points(&[[0.0, 0.0, -0.9], [0.2, 0.0, -1e-3]]);
            assert!(vertex_signed_distances(&below, &split).unwrap().iter().all(|&d| d < 0.0));
        }
    }
}

#[test]
fn a_flank_of_many_triangles_weighs_no_more_than_one_of_few() {
    let sharp = 0.3;
    let mesh = wedge(sharp);
    let mut positions = mesh.positions().to_vec();
    let cuts = 40u32;
    positions.extend((1..cuts).map(|i| [-1.0 + 2.0 * i as f32 / cuts as f32, -sharp, -1.0]));
    let along = |i: u32| match i {
        0 => 2,
        i if i == cuts => 3,
        i => 5 + i,
    };
    let mut triangles = mesh.triangles().to_vec();
    triangles.retain(|t| ![[0, 2, 3], [2, 5, 3]].contains(t));
    triangles.extend((0..cuts).flat_map(|i| [[0, along(i), along(i + 1)], [5, along(i + 1), along(i)]]));
    let fan = Mesh::new(positions, triangles).unwrap();
    let beyond = points(&[[-1.1, 0.4, 0.13], [-1.1, -0.4, 0.13], [-1.2, 0.0, 0.3]]);
    assert!(vertex_signed_distances(&beyond, &fan).unwrap().iter().all(|&d| d > 0.0));
}

#[test]
fn triangles_without_area_that_close_a_cut_edge_do_not_confuse() {
    // The ridge is whole on one flank and cut in two on the other; a triangle without area closes the gap.
    let mesh = wedge(0.05);
    let mut positions = mesh.positions().to_vec();
    positions.push([0.25, 0.0, 0.0]);
    let mut triangles = mesh.triangles().to_vec();
    triangles.retain(|t| *t != [0, 1, 5]);
    triangles.extend([[0, 6, 5], [6, 1, 5], [0, 1, 6]]);
    let cut = Mesh::new(positions, triangles).unwrap();
    let around = [
        [0.1, 0.4, 0.2],
        [0.1, -0.4, 0.2],
        [0.25, 0.4, 0.2],
        [0.25, -0.4, 0.2],
        [0.6, 0.4, 0.1],
        [0.6, -0.4, 0.1],
    ];
    assert!(vertex_signed_distances(&points(&around), &cut).unwrap().iter().all(|&d| d > 0.0));
}

#[test]
fn cavities_are_outside_and_touching_bodies_are_whole() {
    let shell = together(&scaled(&cuboid([1.0; 3]), 2.0), &flipped(&cuboid([1.0; 3])));
    let at = points(&[[0.0; 3], [1.5, 0.0, 0.0], [3.0, 0.0, 0.0], [0.9, 0.9, 0.9]]);
    let signs: Vec<bool> =
        vertex_signed_distances(&at, &shell).unwrap().iter().map(|d| d.is_sign_positive()).collect();
    assert_eq!(signs, [true, false, true, true]);
    // Two boxes that share an edge, which four triangles lie along.
    let moved = cuboid([1.0; 3]);
    let moved: Vec<[f32; 3]> = moved.positions().iter().map(|p| [p[0] + 2.0, p[1] + 2.0, p[2]]).collect();
    let pair = together(&cuboid([1.0; 3]), &Mesh::new(moved, cuboid([1.0; 3]).triangles()).unwrap());
    let at = points(&[[0.9, 0.9, 0.0], [1.1, 1.1, 0.0], [1.1, 0.8, 0.0], [1.0, 1.0, 1.5]]);
    let signs: Vec<bool> =
        vertex_signed_distances(&at, &pair).unwrap().iter().map(|d| d.is_sign_positive()).collect();
    assert_eq!(signs, [false, false, true, true]);
}

#[test]
fn twice_the_same_body_is_that_body_and_a_sheet_has_no_inside() {
    let body = shapes::icosphere(2);
    let at = points(&[[0.0; 3], [0.5, 0.2, 0.1], [2.0, 0.0, 1.0]]);
    assert_eq!(
        vertex_signed_distances(&at, &together(&body, &body)).unwrap(),
        vertex_signed_distances(&at, &body).unwrap()
    );
    let sheet = together(&cuboid([1.0; 3]), &flipped(&cuboid([1.0; 3])));
    assert!(vertex_signed_distances(&at, &sheet).unwrap().iter().all(|&d| d >= 0.0));
    assert!(vertex_signed_distances(&at, &shapes::pillow()).unwrap().iter().all(|&d| d >= 0.0));
}

#[test]
fn surfaces_without_an_inside_are_refused_by_edge() {
    let good = shapes::icosphere(1);
    let open = Mesh::new(cuboid([1.0; 3]).positions(), &cuboid([1.0; 3]).triangles()[1..]).unwrap();
    let mut triangles = cuboid([1.0; 3]).triangles().to_vec();
    triangles[3].swap(0, 1);
    let turned = Mesh::new(cuboid([1.0; 3]).positions(), triangles).unwrap();

    let error = signed_distance(&open, &good, &options(10)).unwrap_err();
    assert_eq!(error, QualityError::Open { which: "first", edge: [0, 4], triangles: 1 });
    assert!(error.to_string().contains("first mesh is not closed"), "{error}");
    let error = vertex_signed_distances(&good, &turned).unwrap_err();
    assert!(matches!(error, QualityError::Orientation { which: "second", .. }), "{error}");
    let (open, good) = (Surface::new(&open).unwrap(), Surface::new(&good).unwrap());
    assert!(matches!(open.point_signed_distances(&[]), Err(QualityError::Open { which: "given", .. })));
    // Open against closed has a sign, one way.
    assert!(open.signed_distance_to(&good, &options(10)).is_ok());
    let error = good.signed_distance_to(&open, &options(10)).unwrap_err();
    assert!(matches!(error, QualityError::Open { which: "second", .. }), "{error}");
}

#[test]
fn points_that_are_no_numbers_are_infinitely_far() {
    let mesh = shapes::icosphere(1);
    let surface = Surface::new(&mesh).unwrap();
    let odd = [[f32::NAN, 0.0, 0.0], [0.0, f32::INFINITY, 0.0]];
    assert_eq!(surface.point_distances(&odd), [f64::INFINITY; 2]);
    assert_eq!(surface.point_signed_distances(&odd).unwrap(), [f64::INFINITY; 2]);
}

#[cfg(feature = "parallel")]
#[test]
fn any_number_of_threads_gives_the_same_bytes() {
    let (a, b) = (shapes::rock(5_000, 1), shapes::rock(3_000, 2));
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| signed_distance(&a, &b, &options(30_000)).unwrap())
    };
    let alone = with(1);
    for threads in [2, 3, 8] {
        assert_eq!(with(threads), alone);
    }
}

fn coordinate() -> impl Strategy<Value = f32> {
    // Many points on the planes and lines where regions of nearest faces, edges and corners meet.
    prop_oneof![(-8i8..9).prop_map(|x| f32::from(x) * 0.25), -2.0f32..2.0]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn a_box_is_exact(
        at in prop::collection::vec([coordinate(), coordinate(), coordinate()], 1..40),
        half in [0.125f32..1.5, 0.125f32..1.5, 0.125f32..1.5],
    ) {
        let mesh = cuboid(half);
        for split in [exploded(&mesh), mesh] {
            let found = vertex_signed_distances(&points(&at), &split).unwrap();
            for (found, p) in found.iter().zip(&at) {
                let expected = from_cuboid(*p, half);
                prop_assert!((found - expected).abs() < 1e-12, "{p:?}: {found} is not {expected}");
            }
        }
    }

    #[test]
    fn spheres_and_tori_have_the_analytic_sign(
        at in prop::collection::vec([coordinate(), coordinate(), coordinate()], 1..60),
    ) {
        let length = |p: &[f64]| p.iter().map(|x| x * x).sum::<f64>().sqrt();
        let sphere = |p: [f64; 3]| length(&p) - 1.0;
        let torus = |p: [f64; 3]| (length(&[p[0], p[2]]) - 1.25).hypot(p[1]) - 0.5;
        let distances = |p: [f64; 3]| [sphere(p), torus(p)];
        let meshes = [shapes::icosphere(3), shapes::torus(1.25, 0.5, 48, 24)];
        for (which, mesh) in meshes.iter().enumerate() {
            let found = vertex_signed_distances(&points(&at), mesh).unwrap();
            for (found, p) in found.iter().zip(&at) {
                // Facets lie within 1 % of the surface they stand for.
                let expected = distances(p.map(f64::from))[which];
                prop_assert!((found - expected).abs() < 0.02, "{p:?}: {found} is not {expected}");
            }
        }
    }
}
