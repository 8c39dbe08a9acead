//! Promise: where a size is asked for that the topology does not allow, the topology gives, last of all, is counted, and what
//! was closed stays closed; where it may not, it holds.

use multires::mesh::{Mesh, Topology, shapes};
use multires::simplify::{CollapseSequence, Guard, Permissive, Simplifier, StopReason, Target};
use multires::tom::TotallyOrderedMesh;

fn to(mesh: &Mesh, triangles: usize, permissive: Permissive) -> CollapseSequence {
    let simplifier = Simplifier::new().permissive(permissive).guard(Guard::Off);
    simplifier.target(Target::Triangles(triangles)).run(mesh).unwrap()
}

/// Edges of an odd number of triangles: a closed surface has none.
fn open_edges(mesh: &Mesh) -> usize {
    let topology = Topology::new(mesh);
    let point = |v: u32| topology.point_of()[v as usize];
    let mut edges: Vec<[u32; 2]> = Vec::new();
    for t in mesh.triangles() {
        for i in 0..3 {
            let [a, b] = [point(t[i]), point(t[(i + 1) % 3])];
            edges.push([a.min(b), a.max(b)]);
        }
    }
    edges.sort_unstable();
    edges.chunk_by(|a, b| a == b).filter(|run| run.len() % 2 == 1).count()
}

#[test]
fn a_torus_becomes_smaller_than_a_torus_can_be() {
    let mesh = shapes::torus(1.0, 0.4, 24, 12);
    for permissive in [Permissive::Auto, Permissive::On] {
        let sequence = to(&mesh, 8, permissive);
        let report = sequence.report();
        assert_eq!(report.stop, StopReason::Target, "{report:?}");
        assert!(report.triangles <= 8 && report.given_up.topology > 0, "{report:?}");
        for steps in 0..=sequence.len() {
            let level = sequence.extract(&mesh, steps);
            assert!(!level.triangles().is_empty());
            assert_eq!(open_edges(&level), 0, "after {steps} of {}", sequence.len());
        }
        // Structures show what was done.
        let tom = TotallyOrderedMesh::build(&mesh, &sequence).unwrap().tom;
        assert_eq!(tom.index_count(tom.coarsest()), 3 * report.triangles);
    }
    let held = to(&mesh, 8, Permissive::Off);
    assert_eq!(held.report().stop, StopReason::NothingLegal);
    assert!(held.report().triangles >= 14 && held.report().given_up.is_none());
}

#[test]
fn it_holds_where_a_size_can_be_reached() {
    let mesh = shapes::torus(1.0, 0.4, 24, 12);
    assert!(to(&mesh, 40, Permissive::Auto).report().given_up.is_none());
    // Without a size everything holds down to the base mesh.
    let all = Simplifier::new().permissive(Permissive::On).run(&mesh).unwrap();
    assert_eq!(all.report().given_up.topology, 0);
}

#[test]
fn a_part_with_a_hole_reaches_its_size() {
    let mesh = shapes::plate_with_hole(32, 0.3);
    let sequence = to(&mesh, mesh.triangles().len() / 20, Permissive::Auto);
    assert_eq!(sequence.report().stop, StopReason::Target, "{:?}", sequence.report());
    let level = sequence.extract(&mesh, sequence.len());
    assert_eq!(open_edges(&level), 0);
}
