//! Promise: a coarse level lies as near to its input as its error says, also where the level covers what was empty: in the
//! hollows that its large triangles span no point of the input lies far from the level, but the level lies far from the input.
#![cfg(feature = "quality")]

use multires::mesh::{Mesh, shapes};
use multires::quality::{DistanceOptions, distance};
use multires::simplify::{ErrorMeasure, Simplifier, Target};

/// What a level is said to lie away, and the sampled largest distances from the input to the level and back.
fn levels(mesh: &Mesh, measure: ErrorMeasure, percents: &[usize]) -> Vec<[f64; 3]> {
    let sequence = Simplifier::new().error_measure(measure).run(mesh).unwrap();
    let level = |percent: &usize| {
        let steps = sequence.steps_for_triangles(mesh.triangles().len() * percent / 100);
        let options = DistanceOptions::default().with_samples(20_000);
        let apart = distance(mesh, &sequence.extract(mesh, steps), &options).unwrap();
        [f64::from(sequence.error_after(steps)), apart.forward.max, apart.backward.max]
    };
    percents.iter().map(level).collect()
}

fn hollow_meshes() -> [(&'static str, Mesh); 5] {
    [
        ("trefoil", shapes::torus_knot(2, 3, 400, 16)),
        ("tight knot", shapes::torus_knot(3, 7, 900, 12)),
        ("thick ring", shapes::torus(1.0, 0.9, 120, 80)),
        ("rock", shapes::rock(20_000, 7)),
        ("terrain", shapes::terrain(100, 3)),
    ]
}

#[test]
fn coarse_levels_lie_as_near_as_is_said() {
    for (name, mesh) in hollow_meshes() {
        for measure in [ErrorMeasure::Measured, ErrorMeasure::Verified] {
            for [said, out, back] in levels(&mesh, measure, &[12, 5, 2, 1]) {
                let slack = 2e-6 * mesh.diagonal();
                assert!(out.max(back) <= 1.25 * said + slack, "{name}, {measure:?}: {said}, {out}, {back}");
            }
        }
    }
}

#[test]
fn an_error_asked_for_is_kept_on_coarse_levels() {
    for (name, mesh) in hollow_meshes() {
        for share in [0.002, 0.01, 0.03] {
            let asked = (share * mesh.diagonal()) as f32;
            let sequence = Simplifier::new().target(Target::Error(asked)).run(&mesh).unwrap();
            let said = sequence.error_after(sequence.len());
            assert!(said <= asked && said > 0.0, "{name}: {said} of {asked}");
        }
    }
}
