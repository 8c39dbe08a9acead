//! Promise: by default no collapse brings the error beyond what the triangles left explain; whole shapes are not touched by
//! that rule at any level.
#![cfg(feature = "quality")]

use multires::mesh::{Mesh, shapes};
use multires::simplify::{
    CollapseSequence, ErrorMeasure, Guard, Parts, Permissive, Placement, Simplifier, StopReason, Target,
};

/// A house of 12 triangles, and so many ornaments on its walls that cannot be simplified: tetrahedra.
fn house(ornaments: u32) -> Mesh {
    let cube = shapes::cube();
    let mut positions: Vec<[f32; 3]> = cube.positions().to_vec();
    let mut triangles = cube.triangles().to_vec();
    let [low, high] = cube.bounds().unwrap();
    let side = high[0] - low[0];
    for i in 0..ornaments {
        let (u, v) = ((i % 25) as f32 / 25.0 + 0.02, (i / 25) as f32 / 25.0 + 0.02);
        let at = [low[0] + u * side, low[1] + v * side, high[2] + 0.01 * side];
        let first = positions.len() as u32;
        let size = 0.004 * side;
        positions.extend(
            shapes::tetrahedron().positions().iter().map(|p| std::array::from_fn(|k| at[k] + size * p[k])),
        );
        triangles.extend(shapes::tetrahedron().triangles().iter().map(|t| t.map(|v| v + first)));
    }
    Mesh::new(positions, triangles).unwrap()
}

fn to(mesh: &Mesh, ratio: f64, guard: Guard) -> CollapseSequence {
    // Tetrahedra can go nowhere while the topology holds.
    let simplifier = Simplifier::new().parts(Parts::Keep).permissive(Permissive::Off);
    let simplifier = simplifier.target(Target::Ratio(ratio));
    simplifier.guard(guard).run(mesh).unwrap()
}

/// The formula of [`Guard`].
fn limit(mesh: &Mesh, triangles: usize) -> f64 {
    mesh.diagonal() * (2.5 / (triangles as f64).sqrt()).max(0.01)
}

#[test]
fn walls_stand_where_ornaments_cannot_go() {
    let mesh = house(400);
    let ruined = to(&mesh, 0.5, Guard::Off);
    assert!(f64::from(ruined.report().error) > 0.3 * mesh.diagonal(), "{}", ruined.report().error);
    let kept = to(&mesh, 0.5, Guard::On);
    let report = kept.report();
    assert_eq!(report.stop, StopReason::Guard);
    assert!(f64::from(report.error) <= limit(&mesh, report.triangles));
    let guard = report.refusals.iter().find(|r| r.oracle == "guard").expect("counted");
    assert!(guard.count > 0 && guard.standing > 0, "{guard:?}");
    let level = kept.extract(&mesh, kept.len());
    let share = multires::quality::volume_ratio(&mesh, &level).unwrap();
    assert!((0.9..1.1).contains(&share), "volume {share}");
}

#[test]
fn every_level_keeps_the_limit() {
    for mesh in [house(100), shapes::soup(300, 4), shapes::demo(), shapes::book(500)] {
        for placement in [Placement::Endpoint, Placement::Optimal] {
            let sequence = Simplifier::new().placement(placement).run(&mesh).unwrap();
            for steps in 1..=sequence.len() {
                let error = f64::from(sequence.surface_error_after(steps));
                let limit = limit(&mesh, sequence.triangles_after(steps));
                // Steps of large meshes are put in order once they are done: there were a few triangles fewer then.
                assert!(error <= 1.05 * limit, "{steps} of {}: {error} of {limit}", sequence.len());
            }
        }
    }
}

#[test]
fn whole_shapes_do_not_meet_the_guard() {
    let meshes = [
        shapes::terrain(48, 1),
        shapes::rock(6000, 3),
        shapes::icosphere(4),
        shapes::torus(1.0, 0.4, 60, 30),
    ];
    for mesh in meshes {
        for measure in [ErrorMeasure::Measured, ErrorMeasure::Verified] {
            let run = |guard| {
                let sequence = Simplifier::new().error_measure(measure).guard(guard).run(&mesh).unwrap();
                (sequence.report().stop, sequence.report().triangles, sequence.report().error)
            };
            assert_eq!(run(Guard::On), run(Guard::Off));
        }
    }
}

/// Distances travelled tell nothing of ruin.
#[test]
fn the_guard_has_no_say_without_a_distance() {
    let mesh = house(400);
    let run = |guard| {
        let simplifier = Simplifier::new().error_measure(ErrorMeasure::Parametric).guard(guard);
        simplifier.target(Target::Ratio(0.5)).run(&mesh).unwrap()
    };
    assert_eq!(run(Guard::On).report(), run(Guard::Off).report());
}
