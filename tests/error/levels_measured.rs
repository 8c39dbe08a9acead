//! Promise: what a sequence says of its levels is what a measurement finds; and the volume-area metric lies below the
//! means that its authors published for the bunny, at every row of their table.
//!
//! The models lie in `$MULTIRES_MODELS`, `../shared/models` by default; what is missing is skipped by name.
#![cfg(all(feature = "quality", feature = "io"))]

use multires::{
    Simplifier,
    mesh::{Mesh, shapes},
    quality::{DistanceOptions, Surface},
    simplify::{ErrorMeasure, Placement, Target, metric::VolumeArea},
};

fn model(file: &str) -> Option<Mesh> {
    crate::models::read("error/levels_measured", file)
}

fn options() -> DistanceOptions {
    DistanceOptions::default().with_samples(20_000)
}

/// The largest distance of a used vertex from a level.
fn farthest_vertex(mesh: &Mesh, level: &Surface<'_>) -> f64 {
    let used: Vec<[f32; 3]> = mesh.indices().iter().map(|&v| mesh.positions()[v as usize]).collect();
    level.point_distances(&used).into_iter().fold(0.0, f64::max)
}

fn assert_errors_hold(name: &str, mesh: &Mesh, placement: Placement, measure: ErrorMeasure) {
    let sequence = Simplifier::new().placement(placement).error_measure(measure).run(mesh).unwrap();
    let original = Surface::new(mesh).unwrap();
    let slack = 1e-6 * original.diagonal();
    for percent in [50, 20, 5, 2] {
        let steps = sequence.steps_for_triangles(mesh.triangles().len() * percent / 100);
        let level = sequence.extract(mesh, steps);
        let surface = Surface::new(&level).unwrap();
        // What becomes of curves is measured in curve_error.rs and cad_honesty.rs.
        let bound = f64::from(sequence.surface_error_after(steps));
        assert!(bound <= f64::from(sequence.error_after(steps)));
        let what = format!("{name}, {placement:?}, {measure:?}, {percent} %");
        let farthest = farthest_vertex(mesh, &surface);
        assert!(farthest <= bound + slack, "{what}: a vertex is {farthest} away, not {bound}");
        if measure == ErrorMeasure::Parametric {
            let sampled = original.distance(&surface, &options()).unwrap().hausdorff();
            assert!(sampled <= bound + slack, "{what}: a sample is {sampled} away, not {bound}");
        } else {
            // A measurement, not a bound that is merely safe: some vertex has been that far at some level.
            // Or some place of the level, where the way back is looked at.
            let farthest = if farthest >= 0.5 * bound {
                farthest
            } else {
                original.distance(&surface, &options()).unwrap().hausdorff()
            };
            assert!(farthest >= 0.5 * bound, "{what}: nothing is beyond {farthest}, of {bound}");
        }
    }
}

#[test]
fn errors_of_levels_hold_at_every_vertex() {
    for (name, mesh) in
        [("demo", shapes::demo()), ("terrain", shapes::terrain(80, 5)), ("rock", shapes::rock(8_000, 2))]
    {
        for measure in [ErrorMeasure::Measured, ErrorMeasure::Verified, ErrorMeasure::Parametric] {
            for placement in [Placement::Endpoint, Placement::Optimal] {
                assert_errors_hold(name, &mesh, placement, measure);
            }
        }
    }
}

#[test]
fn errors_of_real_models_hold_at_every_vertex() {
    for file in ["real/stanford-bunny.ply", "real/fandisk.obj", "real/rocker-arm.obj"] {
        let Some(mesh) = model(file) else { continue };
        for measure in [ErrorMeasure::Measured, ErrorMeasure::Parametric] {
            assert_errors_hold(file, &mesh, Placement::Endpoint, measure);
        }
    }
}

#[test]
fn an_error_asked_for_is_an_error_kept() {
    let mesh = shapes::demo();
    for share in [1e-4, 1e-3, 1e-2] {
        let most = share * mesh.diagonal();
        let sequence = Simplifier::new().target(Target::Error(most as f32)).run(&mesh).unwrap();
        let level = sequence.extract(&mesh, sequence.len());
        let farthest = farthest_vertex(&mesh, &Surface::new(&level).unwrap());
        assert!(farthest <= most * (1.0 + 1e-4), "{farthest} beyond {most}");
        assert!(level.triangles().len() < mesh.triangles().len());
    }
}

/// Bouvier and Gobbetti, "TOM: Totally Ordered Mesh", table 2: triangles, and average error in percent of the diagonal.
const TABLE_2: [(usize, f64); 7] = [
    (34_653, 0.01009),
    (16_006, 0.01631),
    (6_873, 0.02583),
    (3_428, 0.04387),
    (1_361, 0.09544),
    (675, 0.18555),
    (337, 0.34466),
];

#[test]
fn volume_and_area_lie_below_the_published_means() {
    let Some(mesh) = model("real/stanford-bunny.ply") else { return };
    let sequence = Simplifier::new().metric(VolumeArea::new()).run(&mesh).unwrap();
    let original = Surface::new(&mesh).unwrap();
    for (triangles, published) in TABLE_2 {
        let level = sequence.extract(&mesh, sequence.steps_for_triangles(triangles));
        assert!(level.triangles().len() <= triangles);
        let apart = original.distance(&Surface::new(&level).unwrap(), &options()).unwrap();
        let mean = apart.mean_percent();
        assert!(mean < published, "{triangles} triangles: {mean} %, published {published} %");
    }
}
