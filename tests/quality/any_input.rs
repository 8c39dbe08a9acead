//! Promise: every measure gives finite numbers, or says by name why there are none; never NaN, on any mesh.
#![cfg(feature = "quality")]

use multires::{
    Simplifier,
    mesh::{Attribute, Mesh, names, shapes},
    quality::{
        DistanceOptions, QualityError, ShapeReport, Surface, area, distance, normal_deviation,
        parametric_deviation, signed_distance, texture_deviation, vertex_distances, vertex_signed_distances,
        volume, volume_ratio,
    },
};
use proptest::prelude::*;

fn options() -> DistanceOptions {
    DistanceOptions::default().with_samples(64)
}

fn with_uv(mesh: Mesh) -> Mesh {
    let uv: Vec<[f32; 2]> = mesh.positions().iter().map(|p| [p[0], p[1]]).collect();
    mesh.with_attribute(Attribute::floats(names::UV, &uv)).unwrap()
}

/// Meshes without a surface, by name.
fn surfaceless() -> [(&'static str, Mesh); 5] {
    let bare =
        |positions: &[[f32; 3]], triangles: &[[u32; 3]]| with_uv(Mesh::new(positions, triangles).unwrap());
    [
        ("empty", bare(&[], &[])),
        ("points", bare(&[[0.0; 3], [1.0; 3]], &[])),
        ("corners named twice", bare(&[[0.0; 3], [1.0; 3]], &[[0, 1, 1], [0, 0, 0]])),
        ("all in one place", bare(&[[3.0; 3]; 6], &[[0, 1, 2], [3, 4, 5]])),
        ("on a line", bare(&[[0.0; 3], [0.25; 3], [0.75; 3], [3e38; 3]], &[[0, 1, 2], [1, 2, 3]])),
    ]
}

#[test]
fn what_has_no_surface_is_refused_by_every_measure() {
    let good = with_uv(shapes::icosphere(1));
    for (name, bad) in surfaceless() {
        let refused = |which| QualityError::NoSurface { which, triangles: bad.triangles().len() };
        assert_eq!(Surface::new(&bad).unwrap_err(), refused("given"), "{name}");
        for (a, b, which) in [(&bad, &good, "first"), (&good, &bad, "second"), (&bad, &bad, "first")] {
            assert_eq!(distance(a, b, &options()), Err(refused(which)), "{name}");
            assert_eq!(signed_distance(a, b, &options()), Err(refused(which)), "{name}");
            assert_eq!(normal_deviation(a, b, &options()), Err(refused(which)), "{name}");
            assert_eq!(texture_deviation(a, b, &options()), Err(refused(which)), "{name}");
        }
        assert_eq!(vertex_distances(&good, &bad), Err(refused("second")), "{name}");
        assert_eq!(vertex_signed_distances(&good, &bad), Err(refused("second")), "{name}");
        // Vertices are asked for, not a surface.
        let from = vertex_distances(&bad, &good).unwrap();
        assert!(from.len() == bad.positions().len() && from.iter().all(|d| d.is_finite()), "{name}");

        let sequence = Simplifier::new().run(&bad).unwrap();
        assert_eq!(parametric_deviation(&bad, &sequence, 1), Err(refused("given")), "{name}");
        assert_eq!((volume_ratio(&bad, &good), area(&bad)), (None, 0.0), "{name}");
        assert!(volume(&bad).unwrap_or(0.0) == 0.0, "{name}");
        let shape = ShapeReport::new(&bad);
        assert_eq!((shape.triangles, shape.degenerate), (0, bad.triangles().len()), "{name}");
        assert!(finite(&shape), "{name}: {shape:?}");
    }
}

#[test]
fn numbers_of_samples_are_checked_by_every_measure() {
    let mesh = with_uv(shapes::icosphere(1));
    let surface = Surface::new(&mesh).unwrap();
    for samples in [0, (1 << 32) + 1] {
        let options = options().with_samples(samples);
        let errors = [
            distance(&mesh, &mesh, &options).unwrap_err(),
            signed_distance(&mesh, &mesh, &options).unwrap_err(),
            normal_deviation(&mesh, &mesh, &options).unwrap_err(),
            texture_deviation(&mesh, &mesh, &options).unwrap_err(),
            surface.distance(&surface, &options).unwrap_err(),
            surface.distance_to(&surface, &options).unwrap_err(),
            surface.signed_distance_to(&surface, &options).unwrap_err(),
            surface.normal_deviation_to(&surface, &options).unwrap_err(),
            surface.texture_deviation_to(&surface, &options).unwrap_err(),
        ];
        for error in errors {
            assert_eq!(error, QualityError::Samples { samples, limit: u32::MAX as usize });
        }
    }
}

fn finite(shape: &ShapeReport) -> bool {
    let ShapeReport {
        sliver_mean,
        sliver_max,
        aspect_mean,
        aspect_min,
        compactness_mean,
        compactness_min,
        angle_min,
        angle_max,
        ..
    } = *shape;
    [
        sliver_mean,
        sliver_max,
        aspect_mean,
        aspect_min,
        compactness_mean,
        compactness_min,
        angle_min,
        angle_max,
    ]
    .iter()
    .all(|x| x.is_finite())
}

/// Any mesh, at any size that single precision has, with texture coordinates, and closed half of the time.
fn any_mesh() -> impl Strategy<Value = Mesh> {
    let coordinate = prop_oneof![(-4i8..5).prop_map(f32::from), -1.0f32..1.0, Just(1e-6), Just(0.0)];
    let positions = prop::collection::vec([coordinate.clone(), coordinate.clone(), coordinate], 1..20);
    let scale = prop_oneof![3 => Just(1.0f32), 1 => Just(8e37), 1 => Just(1e-38), 1 => Just(1e-44)];
    (positions, scale, any::<bool>()).prop_flat_map(|(positions, scale, closed)| {
        let index = 0..positions.len() as u32;
        let triangles = prop::collection::vec([index.clone(), index.clone(), index], 0..30);
        triangles.prop_map(move |mut triangles| {
            if closed {
                // Each twice, one facing up and one facing down.
                let down: Vec<[u32; 3]> = triangles.iter().map(|&[a, b, c]| [a, c, b]).collect();
                triangles.extend(down);
            }
            let positions: Vec<[f32; 3]> = positions.iter().map(|p| p.map(|x| x * scale)).collect();
            with_uv(Mesh::new(positions, triangles).unwrap())
        })
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn every_measure_is_finite_or_says_why(a in any_mesh(), b in any_mesh(), part in 0usize..4) {
        if let Ok(d) = distance(&a, &b, &options()) {
            for one in [d.forward, d.backward] {
                prop_assert!(one.max.is_finite() && one.rms.is_finite() && one.mean <= one.max * (1.0 + 1e-9));
            }
            prop_assert!([d.hausdorff_percent(), d.mean_percent(), d.rms_percent()].iter().all(|x| x.is_finite()));
        }
        if let Ok(d) = vertex_distances(&a, &b) {
            prop_assert!(d.iter().all(|d| d.is_finite() && *d >= 0.0));
        }
        match signed_distance(&a, &b, &options()) {
            Ok(d) => for one in [d.forward, d.backward] {
                prop_assert!(one.outside.is_finite() && one.inside.is_finite());
                prop_assert!(-one.inside <= one.mean + 1e-9 * one.inside, "{one:?}");
                prop_assert!(one.mean <= one.outside * (1.0 + 1e-9), "{one:?}");
                prop_assert!((0.0..=1.0).contains(&one.inside_share));
            },
            Err(error) => prop_assert!(
                matches!(
                    error,
                    QualityError::NoSurface { .. } | QualityError::Open { .. } | QualityError::Orientation { .. }
                ),
                "{error}"
            ),
        }
        if let (Ok(plain), Ok(signed)) = (vertex_distances(&a, &b), vertex_signed_distances(&a, &b)) {
            prop_assert!(plain.iter().zip(&signed).all(|(p, s)| *p == s.abs()));
            prop_assert!(volume(&b).is_some());
        }
        if let Ok(d) = normal_deviation(&a, &b, &options()) {
            prop_assert!(d.forward.oriented.max <= 180.0 && d.forward.unoriented.max <= 90.0, "{d:?}");
            prop_assert!(d.backward.oriented.rms.is_finite() && d.backward.unoriented.mean.is_finite(), "{d:?}");
        }
        if let Ok(d) = texture_deviation(&a, &b, &options()) {
            prop_assert!(d.mean.is_finite() && d.rms.is_finite() && d.max.is_finite(), "{d:?}");
        }
        prop_assert!(volume_ratio(&a, &b).is_none_or(f64::is_finite));
        prop_assert!(area(&a).is_finite() && finite(&ShapeReport::new(&a)));
        let sequence = Simplifier::new().run(&a).unwrap();
        if let Ok(d) = parametric_deviation(&a, &sequence, sequence.len() * part / 3) {
            prop_assert!(d.mean.is_finite() && d.rms.is_finite() && d.mean <= d.max && d.rms <= d.max, "{d:?}");
        }
    }
}
