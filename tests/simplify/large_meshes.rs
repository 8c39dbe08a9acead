//! Meshes too large for the cache are served tile by tile and put in order afterwards: nobody can tell.

use multires::mesh::{Report, shapes};
use multires::simplify::{CollapseSequence, Order, Placement, Simplifier, StopReason, Target};
use multires::tom::TotallyOrderedMesh;

/// More points than are served as one tile, three times over.
fn large() -> multires::mesh::Mesh {
    let ball = shapes::icosphere(7);
    let bumpy = ball.positions().iter().map(|&[x, y, z]| {
        let r = 1.0 + 0.02 * (17.0 * x).sin() * (13.0 * y).cos() * (11.0 * z).sin();
        [r * x, r * y, r * z]
    });
    multires::mesh::Mesh::new(bumpy.collect::<Vec<_>>(), ball.triangles()).expect("a ball")
}

/// The sequence is whole: as many triangles as it says, each level closed, the errors as they should be.
fn check(mesh: &multires::mesh::Mesh, sequence: &CollapseSequence) {
    sequence.validate().expect("a valid sequence");
    for part in [0.5, 0.1, 0.01] {
        let steps = sequence.steps_for_triangles((mesh.triangles().len() as f64 * part) as usize);
        let level = sequence.extract(mesh, steps);
        assert_eq!(level.triangles().len(), sequence.triangles_after(steps));
        let report = Report::welded(&level);
        assert!(report.is_closed() && report.euler_characteristic == 2, "{report}");
    }
    assert!((1..=sequence.len()).all(|k| sequence.error_after(k) >= sequence.error_after(k - 1)));
    assert!((1..=sequence.len()).all(|k| sequence.triangles_after(k) <= sequence.triangles_after(k - 1)));
}

#[test]
fn endpoint_sequences_hold_together() {
    let mesh = large();
    let sequence = Simplifier::new().run(&mesh).expect("options");
    check(&mesh, &sequence);
    let built = TotallyOrderedMesh::build(&mesh, &sequence).expect("an endpoint sequence");
    built.tom.validate().expect("a valid structure");
    // Errors come nearly in order: the tiles' steps were sorted.
    let half = sequence.len() / 2;
    assert!(sequence.error_after(half) < 0.01 * sequence.error_after(sequence.len()));
}

#[test]
fn new_vertices_are_renumbered_in_order() {
    let mesh = large();
    for order in [Order::Linear, Order::Batched] {
        let mut simplifier = Simplifier::new().placement(Placement::Midpoint).order(order);
        let sequence = simplifier.run(&mesh).expect("options");
        check(&mesh, &sequence);
        let first = sequence.input_vertices() as u32;
        for (number, new) in (first..).zip(sequence.new_vertices()) {
            assert!(new.from.iter().all(|&v| v < number));
        }
    }
}

#[test]
fn targets_are_met_as_on_small_meshes() {
    let mesh = large();
    let full = Simplifier::new().run(&mesh).expect("options");
    for triangles in [200_000, 50_000, 1000] {
        let mut simplifier = Simplifier::new().target(Target::Triangles(triangles));
        let sequence = simplifier.run(&mesh).expect("options");
        let report = sequence.report();
        assert_eq!(report.stop, StopReason::Target);
        assert!((triangles - 2..=triangles).contains(&report.triangles), "{report:?}");
        assert_eq!(report.triangles, sequence.extract(&mesh, sequence.len()).triangles().len());
        assert_eq!(report.vertices, sequence.extract(&mesh, sequence.len()).positions().len());
        // Not one tile simplified to the bone and the others untouched: an even level, as the whole sequence has.
        let even = full.error_after(full.steps_for_triangles(triangles));
        assert!(report.error < 3.0 * even + 1e-6, "{} where {even} will do", report.error);
    }
}
