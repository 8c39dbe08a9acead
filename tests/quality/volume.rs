//! What `volume` and `ShapeReport` promise: analytic values where a mesh is closed and consistent, none elsewhere, and
//! numbers for every triangle.
#![cfg(feature = "quality")]

use std::f64::consts::PI;

use multires::{
    mesh::Mesh,
    quality::{ShapeReport, area, volume, volume_ratio},
};
use proptest::prelude::*;

/// A box from `low` to `high`, facing outward.
fn cuboid(low: [f32; 3], high: [f32; 3]) -> Mesh {
    let positions: Vec<[f32; 3]> = (0..8)
        .map(|i| std::array::from_fn(|axis| if i >> axis & 1 == 1 { high[axis] } else { low[axis] }))
        .collect();
    let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles: Vec<[u32; 3]> =
        quads.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Mesh::new(positions, triangles).unwrap()
}

fn flipped(mesh: &Mesh) -> Vec<[u32; 3]> {
    mesh.triangles().iter().map(|&[a, b, c]| [a, c, b]).collect()
}

/// Both meshes in one.
fn together(a: &Mesh, b: &Mesh) -> Mesh {
    let shift = a.positions().len() as u32;
    let positions = [a.positions(), b.positions()].concat();
    let moved: Vec<[u32; 3]> = b.triangles().iter().map(|t| t.map(|v| v + shift)).collect();
    Mesh::new(positions, [a.triangles(), &moved[..]].concat()).unwrap()
}

/// Every corner a vertex of its own, as a file without indices holds them.
fn exploded(mesh: &Mesh) -> Mesh {
    let positions: Vec<[f32; 3]> = mesh.indices().iter().map(|&v| mesh.positions()[v as usize]).collect();
    let triangles: Vec<[u32; 3]> =
        (0..mesh.triangles().len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    Mesh::new(positions, triangles).unwrap()
}

#[test]
fn a_box_holds_its_edges_product() {
    let mesh = cuboid([-1.0, 2.0, 0.5], [3.0, 4.0, 1.0]);
    assert_eq!(volume(&mesh), Some(4.0));
    assert_eq!(area(&mesh), 2.0 * (8.0 + 1.0 + 2.0));
    assert_eq!(volume(&exploded(&mesh)), Some(4.0));
    assert_eq!(volume(&Mesh::new(mesh.positions(), flipped(&mesh)).unwrap()), Some(-4.0));
}

#[test]
fn far_from_the_origin_nothing_cancels() {
    assert_eq!(volume(&cuboid([1e6, -1e6, 1e6], [1e6 + 1.0, -1e6 + 2.0, 1e6 + 3.0])), Some(6.0));
}

#[test]
fn bodies_add_up_and_cavities_are_taken_off() {
    let (outer, inner) = (cuboid([0.0; 3], [4.0; 3]), cuboid([1.0; 3], [2.0; 3]));
    let cavity = Mesh::new(inner.positions(), flipped(&inner)).unwrap();
    assert_eq!(volume(&together(&outer, &cavity)), Some(63.0));
    // Two boxes that meet in one edge: four triangles around it, in pairs.
    assert_eq!(
        volume(&together(&cuboid([0.0; 3], [1.0; 3]), &cuboid([1.0, 1.0, 0.0], [2.0, 2.0, 1.0]))),
        Some(2.0)
    );
}

#[test]
fn a_level_is_measured_in_shares_of_the_original() {
    let (whole, half) = (cuboid([0.0; 3], [4.0, 2.0, 1.0]), cuboid([7.0; 3], [9.0, 9.0, 8.0]));
    assert_eq!(volume_ratio(&whole, &half), Some(0.5));
    assert_eq!(volume_ratio(&half, &whole), Some(2.0));
    assert_eq!(volume_ratio(&whole, &Mesh::new(half.positions(), flipped(&half)).unwrap()), Some(-0.5));
    let open = Mesh::new(whole.positions(), &whole.triangles()[1..]).unwrap();
    let sheet = together(&whole, &Mesh::new(whole.positions(), flipped(&whole)).unwrap());
    for nothing in [&open, &Mesh::default()] {
        assert_eq!((volume_ratio(&whole, nothing), volume_ratio(nothing, &whole)), (None, None));
    }
    // What holds nothing is no share of anything.
    assert_eq!((volume_ratio(&whole, &sheet), volume_ratio(&sheet, &whole)), (Some(0.0), None));
}

#[test]
fn open_or_inconsistent_surfaces_hold_nothing() {
    let mesh = cuboid([0.0; 3], [1.0; 3]);
    assert_eq!(volume(&Mesh::default()), None);
    assert_eq!(volume(&Mesh::new(mesh.positions(), &mesh.triangles()[1..]).unwrap()), None);
    let mut one_flipped = mesh.triangles().to_vec();
    one_flipped[3].swap(0, 1);
    assert_eq!(volume(&Mesh::new(mesh.positions(), one_flipped).unwrap()), None);
    let mut one_twice = mesh.triangles().to_vec();
    one_twice.push(one_twice[0]);
    assert_eq!(volume(&Mesh::new(mesh.positions(), one_twice).unwrap()), None);
    // A triangle without an area closes what it closed and opens nothing.
    let mut with_degenerate = mesh.triangles().to_vec();
    with_degenerate.extend([[0, 0, 1], [2, 2, 2]]);
    assert_eq!(volume(&Mesh::new(mesh.positions(), with_degenerate).unwrap()), Some(1.0));
}

#[test]
fn shapes_are_those_of_known_triangles() {
    let triangle =
        |apex: [f32; 3]| Mesh::new([[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], apex], [[0, 1, 2]]).unwrap();
    let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-6, "{a} {b}");
    let equilateral = ShapeReport::new(&triangle([0.0, 3f32.sqrt(), 0.0]));
    near(equilateral.sliver_mean, 1.0);
    near(equilateral.compactness_min, 1.0);
    near(equilateral.aspect_min, 1.0);
    near(equilateral.aspect_mean, 1.0);
    near(equilateral.angle_min, PI / 3.0);
    let right = ShapeReport::new(&triangle([1.0, 2.0, 0.0]));
    near(right.sliver_max, (4.0 + 8f64.sqrt()) / 6.0);
    // Area 2, half the perimeter 2 + sqrt 2, longest edge sqrt 8.
    near(right.aspect_min, 6.0 / 3f64.sqrt() * 2.0 / ((2.0 + 2f64.sqrt()) * 8f64.sqrt()));
    near(right.angle_max, PI / 2.0);
    near(right.angle_min, PI / 4.0);
    let cap = ShapeReport::new(&triangle([0.0, 1e-3, 0.0]));
    assert!(cap.compactness_min < 1e-2 && cap.sliver_max < 1.5 && cap.angle_max > 3.13, "{cap:?}");
    let needle = ShapeReport::new(&triangle([-1.0, 1e-3, 0.0]));
    assert!(needle.sliver_max > 600.0 && needle.angle_min < 1e-3, "{needle:?}");
}

#[test]
fn a_mean_of_equal_triangles_is_within_their_range() {
    for count in 1..200 {
        let corners = [[0.1, 0.2, 0.3], [1.7, 0.4, 0.9], [0.6, 2.3, 0.2]];
        let report = ShapeReport::new(&Mesh::new(corners, vec![[0, 1, 2]; count]).unwrap());
        assert!(report.sliver_mean <= report.sliver_max, "{count}: {report:?}");
        assert!(report.aspect_mean >= report.aspect_min, "{count}: {report:?}");
        assert!(report.compactness_mean >= report.compactness_min, "{count}: {report:?}");
    }
}

#[test]
fn degenerate_triangles_are_counted_apart() {
    let mesh = Mesh::new([[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]], [[0, 1, 2], [0, 0, 1]]).unwrap();
    let report = ShapeReport::new(&mesh);
    assert_eq!((report.triangles, report.degenerate), (0, 2));
    assert_eq!((report.sliver_mean, report.aspect_min, report.compactness_min), (0.0, 0.0, 0.0));
    assert_eq!((report.angle_min, report.aspect_mean), (0.0, 0.0));
}

proptest! {
    #[test]
    fn every_triangle_has_finite_numbers_in_range(
        positions in prop::collection::vec([-1e3f32..1e3, -1e3f32..1e3, -1.0f32..1.0], 3..30),
        corners in prop::collection::vec([0u32..3, 0u32..30, 0u32..30], 1..30),
    ) {
        let count = positions.len() as u32;
        let triangles: Vec<[u32; 3]> = corners.into_iter().map(|t| t.map(|v| v % count)).collect();
        let report = ShapeReport::new(&Mesh::new(positions, triangles).unwrap());
        if report.triangles > 0 {
            prop_assert!(report.sliver_mean >= 1.0 - 1e-9 && report.sliver_mean <= report.sliver_max);
            prop_assert!(report.sliver_max.is_finite());
            prop_assert!(report.aspect_min > 0.0 && report.aspect_min <= report.aspect_mean);
            prop_assert!(report.aspect_mean <= 1.0 + 1e-9);
            prop_assert!(report.compactness_min > 0.0 && report.compactness_mean <= 1.0 + 1e-9);
            prop_assert!(report.angle_min <= PI / 3.0 + 1e-9 && report.angle_max >= PI / 3.0 - 1e-9);
            prop_assert!(report.angle_max <= PI);
        }
    }
}
