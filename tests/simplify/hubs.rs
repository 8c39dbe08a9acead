//! Promise: points with very many triangles cost steps in proportion to their triangles: what is looked at grows at most
//! 2.3 times when a fan doubles.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use crate::strips::*;
use multires::mesh::{Attribute, Mesh, names, shapes};
use multires::simplify::metric::{ErrorMetric, MetricEvent, MetricProperties, Quadric};
use multires::simplify::oracle::default_oracles;
use multires::simplify::{Collapse, Oracle, Pair, Reads, Simplifier, Target, WorkingSurface};

/// Counts candidates and the facets of their patches; refuses nothing.
struct Facets(Arc<AtomicU64>, Reads);

impl Oracle for Facets {
    fn name(&self) -> &str {
        match self.1 {
            Reads::Patch => "count whole patches",
            _ => "count",
        }
    }

    fn allows(&self, _: &WorkingSurface, collapse: &Collapse) -> bool {
        self.0.fetch_add(1 + collapse.patch.facets().len() as u64, Ordering::Relaxed);
        true
    }

    fn reads(&self) -> Reads {
        self.1
    }
}

/// Counts costs asked for.
struct Counted(Quadric, Arc<AtomicU64>);

impl ErrorMetric for Counted {
    fn cost(&self, surface: &WorkingSurface, pair: Pair, position: [f32; 3]) -> f32 {
        self.1.fetch_add(1, Ordering::Relaxed);
        self.0.cost(surface, pair, position)
    }
    fn costs_at_kept(&self, surface: &WorkingSurface, lost: u32, kept: &[u32], costs: &mut [f32]) {
        self.1.fetch_add(kept.len() as u64, Ordering::Relaxed);
        self.0.costs_at_kept(surface, lost, kept, costs);
    }
    fn update(&mut self, surface: &WorkingSurface, event: MetricEvent<'_>) {
        self.0.update(surface, event);
    }
    fn properties(&self) -> MetricProperties<'_> {
        self.0.properties()
    }
}

/// Facets and costs looked at, to a tenth of the triangles.
fn work(mesh: &Mesh) -> u64 {
    let count = Arc::new(AtomicU64::new(0));
    let mut oracles: Vec<Box<dyn Oracle>> = vec![Box::new(Facets(Arc::clone(&count), Reads::Facets))];
    oracles.push(Box::new(Facets(Arc::clone(&count), Reads::Patch)));
    oracles.extend(default_oracles());
    let sequence = Simplifier::new()
        .metric(Counted(Quadric::new(), Arc::clone(&count)))
        .oracles(oracles)
        .target(Target::Ratio(0.1))
        .run(mesh)
        .unwrap();
    assert!(sequence.report().error.is_finite());
    count.load(Ordering::Relaxed)
}

/// Every triangle with a normal of its own: seams everywhere.
fn with_face_values(mesh: &Mesh) -> Mesh {
    let positions: Vec<[f32; 3]> =
        mesh.triangles().iter().flatten().map(|&v| mesh.positions()[v as usize]).collect();
    let count = positions.len() as u32;
    let triangles: Vec<[u32; 3]> = (0..count / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    let values: Vec<[f32; 2]> = (0..count).map(|v| [v as f32, 0.5]).collect();
    let mesh = Mesh::new(positions, triangles).unwrap();
    mesh.with_attribute(Attribute::floats(names::UV, &values)).unwrap()
}

fn doubles(name: &str, shape: impl Fn(u32) -> Mesh) {
    let works: Vec<u64> = [2000, 4000, 8000].into_iter().map(|n| work(&shape(n))).collect();
    for pair in works.windows(2) {
        assert!(pair[1] as f64 <= 2.3 * pair[0] as f64, "{name}: {works:?}");
    }
    assert!(works[2] < 8000 * 4000, "{name}: {works:?}");
}

#[test]
fn fans() {
    doubles("hub", shapes::hub);
    doubles("disc", disc);
}

/// Whether the hub itself is asked about depends on costs that are all rounding, so that work does not grow evenly: it stays
/// within so many looks a triangle.
#[test]
fn a_disc_of_slivers() {
    for sides in [1000, 2000, 4000, 8000, 16_000] {
        let work = work(&sliver_disc(sides));
        assert!(work < 100 * u64::from(sides), "{sides}: {work}");
    }
}

#[test]
fn closed_fans() {
    doubles("spindle", shapes::spindle);
    doubles("cylinder", cylinder);
}

#[test]
fn books() {
    doubles("book", shapes::book);
    doubles("book with seams", |n| with_face_values(&shapes::book(n)));
}

#[test]
fn fans_with_seams() {
    doubles("hub with seams", |n| with_face_values(&shapes::hub(n)));
}

/// Backing off leaves nothing undone that it need not: a fan and its rim still reach their least.
#[test]
fn nothing_is_left_asleep() {
    for (mesh, most) in [(disc(2000), 1), (shapes::spindle(2000), 4), (cylinder(1000), 4)] {
        let sequence = Simplifier::new().guard(multires::simplify::Guard::Off).run(&mesh).unwrap();
        assert!(sequence.report().triangles <= most, "{} of {most}", sequence.report().triangles);
    }
}
