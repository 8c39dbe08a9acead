//! Promise: targets are met, stop reasons are right, bad options are errors, every mesh is legal, and the same input
//! gives the same sequence wherever it lies, whatever its size, on any number of threads.

use std::ops::ControlFlow;

use crate::meshes::*;
use multires::mesh::{Attribute, Mesh, names};
use multires::simplify::metric::{Attributes, Quadric, WithAttributes};
use multires::simplify::{
    CollapseSequence, OptionError, Order, Parts, Placement, Simplifier, StopReason, Target,
};

const PLACEMENTS: [Placement; 4] =
    [Placement::Endpoint, Placement::Midpoint, Placement::Subset, Placement::Optimal];

fn bumpy() -> Mesh {
    seamed_grid(10, 20, |u, v| 0.1 * (9.0 * u).sin() * (7.0 * v).cos())
}

fn to(mesh: &Mesh, placement: Placement, target: Target) -> CollapseSequence {
    Simplifier::new().placement(placement).target(target).run(mesh).unwrap()
}

fn used_vertices(sequence: &CollapseSequence, mesh: &Mesh, steps: usize) -> usize {
    sequence.extract(mesh, steps.max(1)).positions().len()
}

#[test]
fn triangles_and_ratio() {
    let mesh = bumpy();
    let all = mesh.triangles().len();
    for placement in PLACEMENTS {
        for (target, most) in
            [(Target::Triangles(100), 100), (Target::Triangles(99), 99), (Target::Ratio(0.25), all / 4)]
        {
            let sequence = to(&mesh, placement, target);
            let report = sequence.report();
            assert_eq!(report.stop, StopReason::Target);
            assert!(
                report.triangles <= most && report.triangles + 2 > most,
                "{} of {most}",
                report.triangles
            );
            assert!(sequence.triangles_after(sequence.len() - 1) > most, "one step too many");
        }
        let nothing = to(&mesh, placement, Target::Ratio(1.0));
        assert!(nothing.is_empty() && nothing.report().stop == StopReason::Target);
    }
}

#[test]
fn vertices_and_bytes() {
    for mesh in [bumpy(), cube(5), torus(14, 9)] {
        for placement in PLACEMENTS {
            let most = mesh.positions().len() / 3;
            let sequence = to(&mesh, placement, Target::Vertices(most));
            assert_eq!(sequence.report().stop, StopReason::Target);
            assert_eq!(sequence.report().vertices, used_vertices(&sequence, &mesh, sequence.len()));
            assert!(sequence.report().vertices <= most);
            assert!(used_vertices(&sequence, &mesh, sequence.len() - 1) > most, "one step too many");

            let bytes = 12 * mesh.triangles().len() / 3 + 20 * most;
            let size = |s: &CollapseSequence, steps: usize| {
                12 * s.triangles_after(steps) + 20 * used_vertices(s, &mesh, steps)
            };
            let sequence = to(&mesh, placement, Target::Bytes { bytes, per_vertex: 20 });
            assert_eq!(sequence.report().stop, StopReason::Target);
            assert!(size(&sequence, sequence.len()) <= bytes);
            assert!(size(&sequence, sequence.len() - 1) > bytes, "one step too many");
        }
    }
}

#[test]
fn error_is_kept_and_used() {
    let mesh = bumpy();
    for placement in PLACEMENTS {
        let mut before = usize::MAX;
        for error in [0.001f32, 0.01, 0.05] {
            let sequence = to(&mesh, placement, Target::Error(error));
            assert_eq!(sequence.report().stop, StopReason::Error);
            assert!(sequence.report().error <= error);
            assert!(sequence.report().triangles < before);
            before = sequence.report().triangles;
            assert!(sequence.report().refusals.iter().any(|r| r.oracle == "error" && r.count > 0));
        }
    }
}

#[test]
fn the_first_target_reached_stops() {
    let mesh = bumpy();
    let run = |targets: &[Target]| {
        let mut simplifier = Simplifier::new();
        for &target in targets {
            simplifier = simplifier.target(target);
        }
        simplifier.run(&mesh).unwrap()
    };
    let few = run(&[Target::Triangles(10), Target::Error(0.001)]);
    assert_eq!(few.report().stop, StopReason::Error);
    let many = run(&[Target::Triangles(500), Target::Error(1.0), Target::Triangles(10)]);
    assert_eq!(many.report().stop, StopReason::Target);
    assert!(many.report().triangles > 450);
}

#[test]
fn without_targets_nothing_legal_is_left() {
    let sequence = Simplifier::new().run(&cube(4)).unwrap();
    assert_eq!(sequence.report().stop, StopReason::NothingLegal);
    assert!(sequence.report().refusals.iter().any(|r| r.count > 0));
}

#[test]
fn cancelling_leaves_a_usable_sequence() {
    let mesh = grid(90, 90, |u, v| 0.1 * (20.0 * u).sin() * (20.0 * v).sin());
    let mut calls = 0;
    let sequence = Simplifier::new()
        .run_with(&mesh, |progress| {
            calls += 1;
            assert!(progress.fraction() > 0.0 && progress.fraction() <= 1.0);
            ControlFlow::Break(())
        })
        .unwrap();
    assert_eq!(calls, 1);
    assert_eq!(sequence.report().stop, StopReason::Cancelled);
    assert!(!sequence.is_empty());
    let whole = Simplifier::new().run(&mesh).unwrap();
    assert!(whole.len() > sequence.len());
    assert!((0..sequence.len()).all(|s| sequence.substitutions(s) == whole.substitutions(s)));
    let coarse = sequence.extract(&mesh, sequence.len());
    assert_eq!(coarse.triangles().len(), sequence.report().triangles);
}

#[test]
fn bad_options_are_errors() {
    let mesh = bumpy();
    let bad = |simplifier: Simplifier, name: &str| match { simplifier }.run(&mesh) {
        Err(OptionError::OutOfRange { option, .. }) => assert_eq!(option, name),
        other => panic!("{name}: {other:?}"),
    };
    for ratio in [f64::NAN, -0.1, 1.5, f64::INFINITY] {
        bad(Simplifier::new().target(Target::Ratio(ratio)), "ratio");
    }
    for error in [f32::NAN, -1.0] {
        bad(Simplifier::new().target(Target::Error(error)), "error");
    }
    for distance in [f32::NAN, -1.0] {
        bad(Simplifier::new().join_distance(distance), "join distance");
    }
    for weight in [f32::NAN, -1.0, f32::INFINITY] {
        let attributes = Attributes::new(&mesh).uv(weight);
        assert!(matches!(
            WithAttributes::with(Quadric::new(), &attributes),
            Err(OptionError::OutOfRange { option: "attribute weight", .. })
        ));
    }
    let missing = WithAttributes::with(Quadric::new(), &Attributes::new(&mesh).custom("heat", 1.0));
    assert_eq!(missing.unwrap_err(), OptionError::NoAttribute { name: "heat".to_owned() });
    let short = WithAttributes::with(Quadric::new(), &Attributes::new(&mesh).values(&[0.0; 7], 1, 1.0));
    assert!(matches!(short, Err(OptionError::OutOfRange { option: "attribute values", .. })));
}

#[test]
fn every_mesh_is_legal() {
    let line = |n: usize| (0..n).map(|i| [i as f32, 0.0, 0.0]).collect::<Vec<_>>();
    let same = vec![[1.0f32; 3]; 6];
    type Case = (&'static str, Vec<[f32; 3]>, Vec<[u32; 3]>);
    let meshes: [Case; 9] = [
        ("empty", vec![], vec![]),
        ("points only", line(5), vec![]),
        ("one triangle", vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]]),
        ("isolated vertices", vec![[9.0; 3], [0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[1, 2, 3]]),
        ("equal corners", line(4), vec![[0, 0, 1], [1, 1, 1], [2, 3, 2]]),
        ("needles", line(6), vec![[0, 1, 2], [1, 2, 3], [2, 3, 4], [3, 4, 5]]),
        ("one place", same, vec![[0, 1, 2], [3, 4, 5]]),
        (
            "huge",
            vec![[-3e38; 3], [3e38, 0.0, 0.0], [0.0, 3e38, 3e38], [3e38; 3]],
            vec![[0, 1, 2], [1, 3, 2]],
        ),
        (
            "tiny",
            vec![[0.0; 3], [1e-45, 0.0, 0.0], [0.0, 1e-45, 0.0], [1e-45; 3]],
            vec![[0, 1, 2], [1, 3, 2]],
        ),
    ];
    for (name, positions, triangles) in meshes {
        let mesh = Mesh::new(positions, triangles).unwrap();
        let values: Vec<[f32; 3]> = (0..mesh.positions().len())
            .map(|i| [[f32::NAN, 0.0, 1.0], [f32::INFINITY, -3e38, 3e38]][i % 2])
            .collect();
        let valued = mesh
            .clone()
            .with_attribute(Attribute::floats(names::NORMAL, &values))
            .unwrap()
            .with_attribute(Attribute::floats(names::COLOR, &values))
            .unwrap();
        for placement in PLACEMENTS {
            for order in [Order::Linear, Order::Batched] {
                for join in [0.0, 0.5, f32::MAX, f32::INFINITY] {
                    let simplifier =
                        || Simplifier::new().placement(placement).order(order).join_distance(join);
                    let plain = simplifier().run(&mesh).unwrap();
                    let weighed = simplifier().metric(WithAttributes::new(&valued)).run(&valued).unwrap();
                    for (sequence, mesh) in [(plain, &mesh), (weighed, &valued)] {
                        let report = sequence.report();
                        assert_eq!(report.steps, sequence.len(), "{name}");
                        assert!(!report.error.is_nan() && report.error >= 0.0, "{name}");
                        let coarse = sequence.extract(mesh, sequence.len());
                        assert!(coarse.triangles().len() <= mesh.triangles().len(), "{name}");
                        assert!(coarse.positions().as_flattened().iter().all(|x| x.is_finite()), "{name}");
                        if mesh.triangles().is_empty() {
                            assert_eq!(report.stop, StopReason::Target, "{name}");
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn the_same_again_and_on_any_number_of_threads() {
    let plain = grid(70, 70, |u, v| 0.1 * (20.0 * u).sin() * (20.0 * v).sin());
    let normals: Vec<[f32; 3]> = plain.positions().iter().map(|p| [p[2], p[1], 1.0]).collect();
    let mesh = plain.with_attribute(Attribute::floats(names::NORMAL, &normals)).unwrap();
    for placement in [Placement::Endpoint, Placement::Midpoint] {
        for order in [Order::Linear, Order::Batched] {
            let run = || {
                let simplifier = Simplifier::new().placement(placement).order(order);
                let weighed = simplifier.metric(WithAttributes::new(&mesh)).run(&mesh).unwrap();
                let plain = Simplifier::new().placement(placement).order(order).run(&mesh).unwrap();
                [weighed, plain]
            };
            let first = run();
            assert_eq!(first, run());
            #[cfg(feature = "parallel")]
            for threads in [1, 4] {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                assert_eq!(first, pool.install(run), "{threads} threads");
            }
        }
    }
}

/// Positions on a lattice, so that the offsets and scales are exact.
#[test]
fn place_and_size_do_not_matter() {
    let snap = |x: f32| (x * 1024.0).round() / 1024.0;
    let lattice = mapped(&bumpy(), |p| p.map(snap));
    for placement in PLACEMENTS {
        for attributes in [false, true] {
            let run = |mesh: &Mesh| {
                let simplifier = Simplifier::new().placement(placement);
                if attributes {
                    simplifier.metric(WithAttributes::new(mesh)).run(mesh).unwrap()
                } else {
                    { simplifier }.run(mesh).unwrap()
                }
            };
            let substitutions = |mesh: &Mesh| {
                let sequence = run(mesh);
                (0..sequence.len()).map(|s| sequence.substitutions(s).to_vec()).collect::<Vec<_>>()
            };
            let expected = substitutions(&lattice);
            for power in [-20, 20] {
                let scaled = mapped(&lattice, |p| p.map(|x| x * 2f32.powi(power)));
                assert_eq!(substitutions(&scaled), expected, "2^{power}, {placement:?}");
            }
            // New positions are rounded to what single precision has there; kept ones are not.
            if placement == Placement::Endpoint {
                let far = mapped(&lattice, |p| [p[0] + 8192.0, p[1] - 4096.0, p[2] + 2048.0]);
                assert_eq!(substitutions(&far), expected, "far from the origin");
            }
        }
    }
}

#[test]
fn joining_needs_a_distance() {
    let patch = grid_positions(6, 6, |_, _| 0.0);
    let mut positions = patch.clone();
    positions.extend(patch.iter().map(|p| [p[0], p[1], 0.05]));
    let mut triangles = grid_triangles(6, 6, 0);
    triangles.extend(grid_triangles(6, 6, patch.len() as u32));
    let mesh = Mesh::new(positions, triangles).unwrap();
    let parts = |distance: f32, placement: Placement| {
        let simplifier = Simplifier::new().placement(placement).parts(Parts::Keep);
        let sequence = simplifier.join_distance(distance).run(&mesh).unwrap();
        let point = points(&mesh, &sequence);
        (0..=sequence.len())
            .map(|steps| components(&level(&mesh, &sequence, &point, steps).points))
            .collect::<Vec<_>>()
    };
    for placement in PLACEMENTS {
        assert!(parts(0.0, placement).iter().all(|&n| n == 2), "{placement:?}");
        assert!(parts(0.04, placement).iter().all(|&n| n == 2), "{placement:?}");
        assert_eq!(parts(0.06, placement).last(), Some(&1), "{placement:?}");
    }
}
