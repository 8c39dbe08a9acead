//! Promise: what becomes of rims, borders, seams and borders between materials is part of the error, also where the surface
//! is flat and none the wiser; and an error of 0 takes away what is redundant and nothing else.
#![cfg(feature = "quality")]

use crate::apart::Input;
use multires::mesh::{Mesh, shapes};
use multires::quality::area;
use multires::simplify::{CollapseSequence, ErrorMeasure, Placement, Simplifier, Target};

const MEASURES: [ErrorMeasure; 2] = [ErrorMeasure::Measured, ErrorMeasure::Verified];

fn at_error(mesh: &Mesh, error: f64, measure: ErrorMeasure) -> (CollapseSequence, Mesh) {
    let simplifier = Simplifier::new().error_measure(measure).target(Target::Error(error as f32));
    let sequence = { simplifier }.run(mesh).unwrap();
    let level = sequence.extract(mesh, sequence.len());
    (sequence, level)
}

/// Sheets and solids with one round curve of `sides` sides, and how many triangles are left of each at least and at an
/// error of 0.
fn round(sides: u32) -> [(&'static str, Mesh, usize); 5] {
    let n = sides as usize;
    [
        ("sheet", shapes::plate_with_hole(sides, 0.0), n + 4),
        ("plate", shapes::plate_with_hole(sides, 0.3), 4 * n + 16),
        ("washer", shapes::washer(sides, 0.5, 0.0), 2 * n),
        ("two materials", shapes::two_material_plate(sides, 0.4), 2 * n + 2),
        ("seam", shapes::plate_with_seam_island(sides, 0.4), 2 * n + 2),
    ]
}

#[test]
fn no_error_keeps_every_corner_of_a_round_curve() {
    for measure in MEASURES {
        for (name, plain, left) in round(32) {
            // Cut finer, there is something redundant to take away.
            let fine = shapes::cut_in_four(&shapes::cut_in_four(&plain));
            let meshes = if name == "seam" { vec![plain] } else { vec![plain, fine] };
            for mesh in meshes {
                let (sequence, level) = at_error(&mesh, 0.0, measure);
                let what = format!("{name} of {}, {measure:?}", mesh.triangles().len());
                assert_eq!(sequence.report().error, 0.0, "{what}");
                assert_eq!(level.triangles().len(), left, "{what}");
                assert!((area(&level) - area(&mesh)).abs() < 1e-5 * area(&mesh), "{what}");
                let apart = Input::new(&mesh, 0.75).apart(&sequence, sequence.len());
                assert!(apart.largest() < 1e-6 * mesh.diagonal(), "{what}: {apart:?}");
            }
        }
    }
}

#[test]
fn no_error_takes_flat_faces_with_straight_borders_to_the_minimum() {
    let tilted = |mesh: &Mesh| {
        let turn = |[x, y, z]: [f32; 3]| [0.6 * x - 0.8 * y + 7.0, 0.8 * x + 0.6 * y - 3.0, 1.7 * z];
        let positions: Vec<[f32; 3]> = mesh.positions().iter().map(|&p| turn(p)).collect();
        Mesh::new(positions, mesh.triangles()).unwrap()
    };
    let boxed = (0..4).fold(shapes::cube(), |mesh, _| shapes::cut_in_four(&mesh));
    for (name, mesh, left) in
        [("square", shapes::plane(16), 2), ("large square", shapes::plane(60), 2), ("box", boxed, 12)]
    {
        for mesh in [tilted(&mesh), mesh] {
            for measure in MEASURES {
                let (sequence, level) = at_error(&mesh, 0.0, measure);
                assert_eq!(level.triangles().len(), left, "{name}, {measure:?}");
                assert_eq!(sequence.report().error, 0.0);
            }
            // So does the sequence of every level: what costs nothing goes first.
            let all = Simplifier::new().run(&mesh).unwrap();
            let level = all.triangles_after(all.steps_for_error(0.0));
            assert_eq!(level, left, "{name}, all levels");
        }
    }
}

#[test]
fn an_error_asked_for_holds_along_curves() {
    for measure in MEASURES {
        for (name, mesh, _) in round(48) {
            for share in [0.002, 0.01, 0.05] {
                let most = share * mesh.diagonal();
                let (sequence, level) = at_error(&mesh, most, measure);
                let apart = Input::new(&mesh, 0.75).apart(&sequence, sequence.len());
                let what = format!("{name}, {share}, {measure:?}: {apart:?}");
                assert!(apart.largest() <= 1.05 * most, "{what}");
                assert!(level.triangles().len() < mesh.triangles().len(), "{what}");
                let report = sequence.report();
                assert_eq!(report.error, report.surface_error.max(report.curve_error), "{what}");
                assert!(apart.curves <= 1.05 * f64::from(report.curve_error), "{what}");
            }
        }
    }
}

#[test]
fn a_hole_that_shrinks_and_an_island_that_vanishes_are_no_small_errors() {
    for placement in [Placement::Endpoint, Placement::Optimal] {
        for (name, mesh, _) in round(32) {
            let sequence = Simplifier::new().placement(placement).run(&mesh).unwrap();
            let input = Input::new(&mesh, 0.75);
            for steps in (1..=sequence.len()).step_by(3).chain([sequence.len()]) {
                let apart = input.apart(&sequence, steps);
                let said = f64::from(sequence.error_after(steps));
                assert!(
                    apart.largest() <= 1.1 * said + 1e-6,
                    "{name}, {placement:?}, {steps}: {apart:?} of {said}"
                );
            }
        }
    }
}
