//! Promise: within a distance asked for, separate parts grow together by themselves, however many lie there, and what has grown
//! together goes as far as is asked.
#![cfg(feature = "quality")]

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use multires::mesh::{Mesh, Report, shapes};
use multires::simplify::{
    ErrorMetric, MetricEvent, MetricProperties, Order, Pair, Parts, Placement, Simplifier, StopReason,
    Target, WorkingSurface, metric,
};
use multires::tom::TotallyOrderedMesh;

/// Spheres on a grid, 3 apart.
fn spheres(side: u32) -> Mesh {
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    let part = shapes::icosphere(1);
    for i in 0..side * side {
        let first = positions.len() as u32;
        let [x, z] = [i % side, i / side].map(|n| (3 * n) as f32);
        positions.extend(part.positions().iter().map(|p| [p[0] + x, p[1], p[2] + z]));
        triangles.extend(part.triangles().iter().map(|t| t.map(|v| v + first)));
    }
    Mesh::new(positions, triangles).unwrap()
}

/// Joining alone, with all the rules.
fn joining(distance: f32) -> Simplifier {
    Simplifier::new().parts(Parts::Keep).join_distance(distance)
}

#[test]
fn no_rule_has_to_go() {
    let mesh = spheres(8);
    let kept = joining(0.0).run(&mesh).unwrap();
    assert_eq!(kept.report().triangles, 4 * 64);
    for order in [Order::Linear, Order::Batched] {
        for placement in [Placement::Endpoint, Placement::Midpoint, Placement::Subset, Placement::Optimal] {
            let mut simplifier =
                joining(1.5).order(order).placement(placement).target(Target::Triangles(100));
            let sequence = simplifier.run(&mesh).unwrap();
            eprintln!("{order:?} {placement:?} {:?}", sequence.report());
            sequence.validate().unwrap();
            if order == Order::Linear {
                assert_eq!(
                    sequence.report().stop,
                    StopReason::Target,
                    "{placement:?} {:?}",
                    sequence.report()
                );
            }
        }
    }
    let sequence = joining(1.5).run(&mesh).unwrap();
    TotallyOrderedMesh::build(&mesh, &sequence).unwrap().tom.validate().unwrap();
}

#[test]
fn nothing_is_joined_across_more() {
    let mesh = spheres(4);
    // The spheres are 1 apart.
    let near = joining(0.9).run(&mesh).unwrap();
    assert_eq!(near.report().triangles, 4 * 16);
    assert_eq!(Report::welded(&near.extract(&mesh, near.len())).components, 16);
}

/// Parts with a crowd of their own points around every one of them: eight nearest points of one part would be all that is seen.
#[test]
fn a_crowd_does_not_hide_the_next_part() {
    let fine = shapes::icosphere(4);
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for i in 0..6u32 {
        let first = positions.len() as u32;
        positions.extend(fine.positions().iter().map(|p| [p[0] + 2.3 * i as f32, p[1], p[2]]));
        triangles.extend(fine.triangles().iter().map(|t| t.map(|v| v + first)));
    }
    let mesh = Mesh::new(positions, triangles).unwrap();
    let sequence = joining(0.8).target(Target::Triangles(12)).run(&mesh).unwrap();
    assert_eq!(sequence.report().stop, StopReason::Target, "{:?}", sequence.report());
}

struct Counting(metric::Quadric, Arc<AtomicU64>);

impl ErrorMetric for Counting {
    fn cost(&self, surface: &WorkingSurface, pair: Pair, position: [f32; 3]) -> f32 {
        self.1.fetch_add(1, Ordering::Relaxed);
        self.0.cost(surface, pair, position)
    }
    fn update(&mut self, surface: &WorkingSurface, event: MetricEvent<'_>) {
        self.0.update(surface, event);
    }
    fn properties(&self) -> MetricProperties<'_> {
        self.0.properties()
    }
}

/// A distance beyond the mesh makes all points near: candidates stay few.
#[test]
fn work_grows_with_the_mesh_for_any_distance() {
    let work = |side: u32, distance: f32| {
        let mesh = spheres(side);
        let asked = Arc::new(AtomicU64::new(0));
        let counting = Counting(metric::Quadric::new(), asked.clone());
        joining(distance).metric(counting).target(Target::Ratio(0.02)).run(&mesh).unwrap();
        asked.load(Ordering::Relaxed)
    };
    for distance in [1.5, 1e6] {
        let (few, many) = (work(7, distance), work(21, distance));
        assert!(many < 12 * few, "{many} for {few} at {distance}");
    }
}
