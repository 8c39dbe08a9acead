//! Promise: normal deviation is the angle between facets, in degrees, weighted by area, both ways, with and without
//! heed to which side is outside.
#![cfg(feature = "quality")]

use multires::{
    mesh::{Mesh, shapes},
    quality::{DistanceOptions, NormalDeviation, QualityError, Surface, normal_deviation},
};
use proptest::prelude::*;

fn measure(a: &Mesh, b: &Mesh) -> NormalDeviation {
    normal_deviation(a, b, &DistanceOptions::default().with_samples(20_000)).unwrap()
}

fn near(found: f64, expected: f64) {
    assert!((found - expected).abs() < 1e-5 * (1.0 + expected), "{found} is not {expected}");
}

/// A strip of `teeth` roofs of the given slope over 0..1 squared, `low` below z = 0.
fn roofs(teeth: u32, slope: f32, low: f32) -> Mesh {
    let steps = 2 * teeth;
    let positions: Vec<[f32; 3]> = (0..=steps)
        .flat_map(|i| {
            let x = i as f32 / steps as f32;
            let z = if i % 2 == 1 { slope / steps as f32 } else { 0.0 };
            [[x, 0.0, z - low], [x, 1.0, z - low]]
        })
        .collect();
    let triangles: Vec<[u32; 3]> =
        (0..steps).flat_map(|i| [[2 * i, 2 * i + 2, 2 * i + 3], [2 * i, 2 * i + 3, 2 * i + 1]]).collect();
    Mesh::new(positions, triangles).unwrap()
}

fn flipped(mesh: &Mesh) -> Mesh {
    let triangles: Vec<[u32; 3]> = mesh.triangles().iter().map(|&[a, b, c]| [a, c, b]).collect();
    Mesh::new(mesh.positions(), triangles).unwrap()
}

#[test]
fn a_mesh_does_not_turn_from_itself() {
    for mesh in [shapes::rock(2_000, 3), shapes::cube(), shapes::moebius(40), shapes::book(5)] {
        let d = measure(&mesh, &mesh);
        assert_eq!((d.forward, d.backward), (d.backward, d.forward));
        assert!(d.forward.unoriented.max < 1e-5 && d.forward.oriented.max < 1e-5, "{d:?}");
    }
}

#[test]
fn a_fan_lies_close_and_turns_far() {
    let d = measure(&roofs(50, 1.0, 1e-3), &roofs(1, 0.0, 0.0));
    for one in [d.forward, d.backward] {
        for angles in [one.oriented, one.unoriented] {
            near(angles.mean, 45.0);
            near(angles.rms, 45.0);
            near(angles.max, 45.0);
        }
    }
}

#[test]
fn what_faces_away_turns_by_the_supplement() {
    let (fan, flat) = (roofs(10, 0.5, 1e-3), roofs(1, 0.0, 0.0));
    let tilt = 0.5f64.atan().to_degrees();
    let d = measure(&flipped(&fan), &flat).forward;
    near(d.oriented.mean, 180.0 - tilt);
    near(d.unoriented.mean, tilt);
    near(d.unoriented.max, tilt);
}

#[test]
fn means_are_over_area() {
    // A quarter of the length is tilted to 45 degrees: the tilted part's area is larger by the root of two.
    let tilted = |x0: f32, x1: f32, z0: f32, z1: f32, first: u32| {
        let positions = [[x0, 0.0, z0], [x1, 0.0, z1], [x1, 1.0, z1], [x0, 1.0, z0]];
        (positions, [[first, first + 1, first + 2], [first, first + 2, first + 3]])
    };
    let (p, t) = tilted(0.0, 0.75, 0.0, 0.0, 0);
    let (q, u) = tilted(0.75, 1.0, 0.0, 0.25, 4);
    let bent = Mesh::new([p, q].concat(), [t, u].concat()).unwrap();
    let d = measure(&bent, &roofs(1, 0.0, 0.0)).forward;
    let steep = 0.25 * 2f64.sqrt();
    let share = steep / (0.75 + steep);
    assert!((d.oriented.mean - 45.0 * share).abs() < 0.01, "{d:?}");
    assert!((d.oriented.rms - 45.0 * share.sqrt()).abs() < 0.01, "{d:?}");
    assert!(d.oriented.max_at[0] >= 0.75, "{d:?}");
}

#[test]
fn finer_spheres_turn_less() {
    let sphere = shapes::icosphere(5);
    let mut last = f64::INFINITY;
    for levels in 1..5 {
        let d = measure(&shapes::icosphere(levels), &sphere);
        assert!(d.forward.oriented.mean < 0.6 * last, "{d:?}");
        assert_eq!(d.forward.oriented.mean, d.forward.unoriented.mean);
        last = d.forward.oriented.mean;
    }
}

#[test]
fn what_cannot_be_measured_is_refused() {
    let (mesh, options) = (shapes::cube(), DistanceOptions::default());
    let error = normal_deviation(&mesh, &Mesh::default(), &options).unwrap_err();
    assert_eq!(error, QualityError::NoSurface { which: "second", triangles: 0 });
    let surface = Surface::new(&mesh).unwrap();
    let error = surface.normal_deviation_to(&surface, &options.with_samples(0)).unwrap_err();
    assert!(matches!(error, QualityError::Samples { samples: 0, .. }));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn angles_are_in_range_and_ordered(seed in 0u32..1000, count in 1u32..60, scale in -38i32..38) {
        let scale = 10f32.powi(scale);
        let grown = |mesh: Mesh| {
            let positions: Vec<[f32; 3]> = mesh.positions().iter().map(|p| p.map(|x| x * scale)).collect();
            Mesh::new(positions, mesh.triangles()).unwrap()
        };
        let (a, b) = (grown(shapes::soup(count, seed)), grown(shapes::soup(20, seed + 1)));
        let Ok(d) = normal_deviation(&a, &b, &DistanceOptions::default().with_samples(500)) else {
            return Ok(());
        };
        for (angles, most) in [
            (d.forward.oriented, 180.0),
            (d.backward.oriented, 180.0),
            (d.forward.unoriented, 90.0),
            (d.backward.unoriented, 90.0),
        ] {
            prop_assert!(0.0 <= angles.mean && angles.mean <= angles.rms * (1.0 + 1e-9), "{angles:?}");
            prop_assert!(angles.rms <= angles.max * (1.0 + 1e-9) && angles.max <= most, "{angles:?}");
        }
        prop_assert!(d.forward.unoriented.mean <= d.forward.oriented.mean);
    }
}
