//! Promise: parametric deviation bounds, over the whole surface and without samples, what distances are found by
//! sampling; texture deviation is what a texture slides by, seams or not.
#![cfg(feature = "quality")]

use crate::support;
use multires::{
    Simplifier,
    mesh::{Attribute, Mesh, names, shapes},
    quality::{
        DistanceOptions, ParametricDeviation, QualityError, Surface, distance, parametric_deviation,
        texture_deviation,
    },
    simplify::{CollapseSequence, ErrorMeasure, Origin, Placement},
};
use proptest::prelude::*;

fn options() -> DistanceOptions {
    DistanceOptions::default().with_samples(5_000)
}

fn near(found: f64, expected: f64, relative: f64) {
    assert!((found - expected).abs() <= relative * expected.abs(), "{found} is not {expected}");
}

/// A flat grid over 0..1 squared with its positions as texture coordinates.
fn chart(steps: u32, stretch: impl Fn([f32; 2]) -> [f32; 2]) -> Mesh {
    let grid = || (0..=steps).flat_map(|y| (0..=steps).map(move |x| (x, y)));
    let at = |i: u32| i as f32 / steps as f32;
    let positions: Vec<[f32; 3]> = grid().map(|(x, y)| [at(x), at(y), 0.0]).collect();
    let uv: Vec<[f32; 2]> = grid().map(|(x, y)| stretch([at(x), at(y)])).collect();
    let row = steps + 1;
    let cells = grid().filter(|&(x, y)| x < steps && y < steps).map(|(x, y)| y * row + x);
    let triangles: Vec<_> =
        cells.flat_map(|v| [[v, v + 1, v + row + 1], [v, v + row + 1, v + row]]).collect();
    Mesh::new(positions, triangles).unwrap().with_attribute(Attribute::floats(names::UV, &uv)).unwrap()
}

/// Mean and rms by a fine grid of equal triangles in every triangle, and the maximum over their corners.
fn by_hand(mesh: &Mesh, sequence: &CollapseSequence, steps: usize) -> [f64; 3] {
    let image = sequence.representatives(steps);
    let place = |v: u32| match sequence.origin(v) {
        Origin::Input(v) => mesh.positions()[v as usize].map(f64::from),
        Origin::Blend(new) => new.position.map(f64::from),
        _ => unreachable!(),
    };
    let sub = |a: [f64; 3], b: [f64; 3]| -> [f64; 3] { std::array::from_fn(|i| a[i] - b[i]) };
    let length = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
    let n = 40;
    let (mut total, mut mean, mut square, mut max) = (0.0, 0.0, 0.0, 0.0f64);
    for t in mesh.triangles() {
        let [a, b, c] = t.map(place);
        let (u, v) = (sub(b, a), sub(c, a));
        let cross = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        let travel = t.map(|v| sub(place(image[v as usize]), place(v)));
        let at = |i: f64, j: f64| {
            let (v, w) = (i / f64::from(n), j / f64::from(n));
            length(std::array::from_fn(|k| {
                travel[0][k] * (1.0 - v - w) + travel[1][k] * v + travel[2][k] * w
            }))
        };
        let piece = length(cross) / f64::from(n * n);
        for i in 0..n {
            for j in 0..n - i {
                let (i, j) = (f64::from(i), f64::from(j));
                let mut here = |shift: f64| {
                    let d = at(i + shift, j + shift);
                    (total, mean, square) = (total + piece, mean + piece * d, square + piece * d * d);
                };
                here(1.0 / 3.0);
                if i + j + 1.5 < f64::from(n) {
                    here(2.0 / 3.0);
                }
                max = max.max(at(i, j)).max(at(i + 1.0, j)).max(at(i, j + 1.0));
            }
        }
    }
    [max, mean / total, (square / total).sqrt()]
}

#[test]
fn one_collapse_in_the_plane_is_known() {
    // The middle of a square moves to a corner: the surface stays, its points travel.
    let positions = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 2.0, 0.0], [0.0, 2.0, 0.0], [1.0, 1.0, 0.0]];
    let mesh = Mesh::new(positions, [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]]).unwrap();
    let sequence = CollapseSequence::from_collapses(&mesh, &[], [(vec![[4, 0]], 0.0)]).unwrap();
    let d = parametric_deviation(&mesh, &sequence, 1).unwrap();
    assert_eq!((d.max, d.vertex), (2f64.sqrt(), 4));
    // A pyramid of height root 2 over every triangle: a third of it in the mean, a sixth of its square.
    near(d.mean, 2f64.sqrt() / 3.0, 1e-12);
    near(d.rms, (2.0f64 / 6.0).sqrt(), 1e-12);
    let level = sequence.extract(&mesh, 1);
    assert!(distance(&mesh, &level, &options()).unwrap().hausdorff() < 1e-12);
    let none = parametric_deviation(&mesh, &sequence, 0).unwrap();
    assert_eq!((none.max, none.mean, none.rms), (0.0, 0.0, 0.0));
}

#[test]
fn it_bounds_the_distance_and_travel_bounds_it() {
    for mesh in [shapes::demo(), shapes::terrain(40, 2), shapes::torus_knot(2, 3, 120, 12)] {
        for placement in [Placement::Endpoint, Placement::Optimal] {
            let sequence = Simplifier::new()
                .placement(placement)
                .error_measure(ErrorMeasure::Parametric)
                .run(&mesh)
                .unwrap();
            let original = Surface::new(&mesh).unwrap();
            for steps in [1, 2, 4, 8].map(|part| sequence.len() * part / 9) {
                let d = parametric_deviation(&mesh, &sequence, steps).unwrap();
                let level = sequence.extract(&mesh, steps);
                let apart = original.distance(&Surface::new(&level).unwrap(), &options()).unwrap();
                assert!(apart.hausdorff() <= d.max * (1.0 + 1e-9), "{apart:?} beyond {d:?}");
                assert!(apart.mean() <= d.mean && d.mean < d.rms && d.rms < d.max, "{apart:?} {d:?}");
                let bound = f64::from(sequence.error_after(steps));
                assert!(d.max <= bound * (1.0 + 1e-5), "{d:?} beyond {bound}");
            }
        }
    }
}

#[test]
fn sequences_of_other_meshes_and_empty_meshes_are_refused() {
    let mesh = shapes::icosphere(2);
    let sequence = Simplifier::new().run(&mesh).unwrap();
    let error = parametric_deviation(&shapes::cube(), &sequence, 1).unwrap_err();
    assert_eq!(error, QualityError::Sequence { vertices: 162, triangles: 320 });
    let empty = Mesh::default();
    let sequence = Simplifier::new().run(&empty).unwrap();
    let error = parametric_deviation(&empty, &sequence, 1).unwrap_err();
    assert_eq!(error, QualityError::NoSurface { which: "given", triangles: 0 });
}

#[test]
fn a_texture_that_lies_where_it_lay_has_not_slid() {
    // Coordinates are linear in the plane: whatever the triangles are, they say the same everywhere.
    let (fine, coarse) = (chart(13, |p| p), chart(3, |p| p));
    let d = texture_deviation(&fine, &coarse, &options()).unwrap();
    assert!(d.max < 1e-6, "{d:?}");
    let itself = texture_deviation(&shapes::demo(), &shapes::demo(), &options()).unwrap();
    assert!(itself.max < 1e-6, "{itself:?}");
}

#[test]
fn a_texture_that_was_moved_has_slid_by_that() {
    let moved = chart(3, |[u, v]| [u + 0.03, v - 0.04]);
    let d = texture_deviation(&chart(13, |p| p), &moved, &options()).unwrap();
    for found in [d.max, d.mean, d.rms] {
        near(found, 0.05, 1e-5);
    }
    // Stretched to the double, it has slid by u: 0 to 1, a half in the mean.
    let stretched = chart(3, |[u, v]| [2.0 * u, v]);
    let d = texture_deviation(&chart(13, |p| p), &stretched, &options()).unwrap();
    near(d.mean, 0.5, 1e-3);
    near(d.rms, 1.0 / 3f64.sqrt(), 1e-3);
    assert!(d.max > 0.98 && d.max_at[0] > 0.98, "{d:?}");
    near(d.uv_to[0], 2.0 * d.uv_at[0], 1e-5);
}

#[test]
fn seams_where_they_were_are_no_jump() {
    let fine = support::naive::torus(40, 20, true, false);
    let itself = texture_deviation(&fine, &fine, &options()).unwrap();
    assert!(itself.max < 1e-6, "{itself:?}");
    // Vertices on the seam, with the nearest points on its edges and corners, may take either side's coordinate.
    let turned: Vec<[u32; 3]> = fine.triangles().iter().rev().map(|&[a, b, c]| [b, c, a]).collect();
    let turned = Mesh::new(fine.positions(), turned).unwrap();
    let turned = turned.with_attribute(fine.attribute(names::UV).unwrap().clone()).unwrap();
    assert!(texture_deviation(&fine, &turned, &options()).unwrap().max < 1e-6);
}

#[test]
fn textures_that_are_missing_or_no_numbers_are_refused() {
    let (good, plain) = (chart(2, |p| p), shapes::icosphere(1));
    let error = |a: &Mesh, b: &Mesh| texture_deviation(a, b, &options()).unwrap_err();
    assert_eq!(error(&plain, &good), QualityError::NoTexture { which: "first" });
    assert_eq!(error(&good, &plain), QualityError::NoTexture { which: "second" });
    let bad = chart(2, |[u, v]| if [u, v] == [0.5, 0.5] { [u, f32::NAN] } else { [u, v] });
    assert_eq!(error(&good, &bad), QualityError::NonFiniteTexture { which: "second", vertex: 4 });
    let wide = plain.with_attribute(Attribute::floats(names::UV, &[[0.0f32; 3]; 42])).unwrap();
    assert_eq!(error(&wide, &good), QualityError::NoTexture { which: "first" });
}

fn within(found: f64, expected: f64, relative: f64) -> bool {
    (found - expected).abs() <= relative * expected.abs() + 1e-9
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn any_sequence_is_measured_right((mesh, sequence) in support::any_placement(), part in 0usize..=4) {
        // The shared strategy lies on a line: lift it off.
        let lifted: Vec<[f32; 3]> = mesh
            .positions()
            .iter()
            .map(|p| [p[0], (p[0] * 0.7).sin() * 20.0, (p[0] * 0.3).cos() * 20.0])
            .collect();
        let mesh = Mesh::new(lifted, mesh.triangles()).unwrap();
        let steps = sequence.len() * part / 4;
        match parametric_deviation(&mesh, &sequence, steps) {
            Ok(ParametricDeviation { max, mean, rms, vertex, .. }) => {
                let [by_max, by_mean, by_rms] = by_hand(&mesh, &sequence, steps);
                prop_assert!(by_max <= max * (1.0 + 1e-9), "{by_max} beyond {max}");
                // Both integrate by points; where one in a triangle stays in place the length has a kink.
                prop_assert!(within(mean, by_mean, 0.02), "mean {mean} is not {by_mean}");
                prop_assert!(within(rms, by_rms, 1e-3), "rms {rms} is not {by_rms}");
                prop_assert!((vertex as usize) < mesh.positions().len());
            }
            Err(error) => prop_assert!(matches!(error, QualityError::NoSurface { .. }), "{error}"),
        }
    }
}
