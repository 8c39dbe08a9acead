//! Squared distances to the planes around the pair, plus springs (Southern 3.2.1, after Hoppe 1996).
//!
//! ```text
//!   E(x) = sum over triangles around both  (n . (x - p) / |n|)^2  +  kappa * sum over the points around  |x - w|^2
//! ```
//!
//! The distance divides by |n|; the paper's text divides by |n . q|, giving always 1. Springs keep triangles well shaped
//! on flat surfaces. Hoppe lets them fade as the mesh gets coarser, hence the schedule.

use std::fmt;

use glam::{DVec3, Vec3};

use crate::simplify::surface::WorkingSurface;

use super::region::{at, finite, for_region};
use super::solve::{Symmetric, nearest_minimum};
use super::stars::{StarSums, Sum, Weight};
use super::{AttributeQuadric, Batch, ErrorMetric, Loss, MetricEvent, MetricProperties, Optimum, Pair};

/// Weight of the planes upright on borders, feature edges and creases, relative to the plane of a triangle.
const UPRIGHT: f64 = 4.0;

/// Distances to planes plus springs.
///
/// ```
/// use multires::simplify::metric::ProgressiveMeshMetric;
/// use multires::{Placement, Simplifier, Target, mesh::shapes};
///
/// // Stiffer springs give rounder triangles.
/// let metric = ProgressiveMeshMetric::new().with_kappa(0.01);
/// let simplifier = Simplifier::new().metric(metric).placement(Placement::Optimal);
/// let mesh = shapes::rock(1_000, 1);
/// let sequence = { simplifier }.target(Target::Ratio(0.2)).run(&mesh)?;
/// assert!(5 * sequence.report().triangles <= mesh.triangles().len());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct ProgressiveMeshMetric {
    stars: StarSums,
    kappa: f64,
    schedule: Option<Box<dyn Fn(Batch) -> f32 + Send + Sync>>,
}

impl Default for ProgressiveMeshMetric {
    /// kappa = 1e-5.
    fn default() -> Self {
        Self { stars: StarSums::new(Weight::One, UPRIGHT), kappa: 1e-5, schedule: None }
    }
}

impl fmt::Debug for ProgressiveMeshMetric {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ProgressiveMeshMetric").field("kappa", &self.kappa).finish_non_exhaustive()
    }
}

impl ProgressiveMeshMetric {
    /// Creates the metric.
    pub fn new() -> Self {
        Self::default()
    }

    /// Sets the stiffness of the springs, 0 (none) and up; any other value counts as 0. Weighs squared lengths against
    /// squared distances: no unit. Default 0.00001: enough to decide on planes.
    #[must_use]
    pub fn with_kappa(mut self, kappa: f32) -> Self {
        self.kappa = stiffness(kappa);
        self.schedule = None;
        self
    }

    /// Sets the stiffness of each batch, evaluated at its start, 0 (none) and up; any other value counts as 0.
    #[must_use]
    pub fn with_schedule(mut self, schedule: impl Fn(Batch) -> f32 + Send + Sync + 'static) -> Self {
        self.schedule = Some(Box::new(schedule));
        self
    }

    /// Sums distances and springs, relative to the lost point.
    fn region(&self, surface: &WorkingSurface, pair: Pair) -> Sum {
        let mut sum = self.stars.region(surface, pair);
        if self.kappa > 0.0 {
            let origin = at(surface, pair.lost);
            let springs = springs(surface, pair, origin);
            sum.h.add(&springs.h.scaled(self.kappa));
            sum.c += self.kappa * springs.c;
            sum.constant += self.kappa * springs.constant;
        }
        sum
    }
}

/// Number of triangles around the two points; triangles on the edge count twice.
fn planes(surface: &WorkingSurface, pair: Pair) -> f64 {
    (surface.valence(pair.lost) + surface.valence(pair.kept)) as f64
}

fn stiffness(kappa: f32) -> f64 {
    if kappa.is_finite() && kappa > 0.0 { f64::from(kappa) } else { 0.0 }
}

/// Sums a spring from every point around the region, relative to `origin`. Each edge opposite either end carries half of
/// the springs of its points: around an interior edge every point lies on two of these edges and is counted once.
fn springs(surface: &WorkingSurface, pair: Pair, origin: DVec3) -> Sum {
    let mut sum = Sum::default();
    let mut add = |w: DVec3| {
        let w = w - origin;
        sum.h.add(&Symmetric::identity(0.5));
        sum.c += 0.5 * w;
        sum.constant += 0.5 * w.length_squared();
    };
    for_region(surface, pair, |facet| {
        if facet.survives {
            add(facet.q);
            add(facet.r);
        }
    });
    sum
}

impl ErrorMetric for ProgressiveMeshMetric {
    fn cost(&self, surface: &WorkingSurface, pair: Pair, position: [f32; 3]) -> f32 {
        let x = Vec3::from(position).as_dvec3() - at(surface, pair.lost);
        finite(self.region(surface, pair).at(x))
    }

    fn optimum(
        &self,
        surface: &WorkingSurface,
        pair: Pair,
        attributes: &AttributeQuadric,
    ) -> Option<Optimum> {
        let mut sum = self.region(surface, pair);
        if attributes.area > 0.0 {
            attributes.add_to(&mut sum, planes(surface, pair) / f64::from(attributes.area));
        }
        let lost = at(surface, pair.lost);
        let middle = 0.5 * (at(surface, pair.kept) - lost);
        let x = middle + nearest_minimum(&sum.h, sum.h.times(middle) - sum.c);
        Some(Optimum::of_both((lost + x).as_vec3().into(), finite(sum.at(x))))
    }

    /// Attributes: distances are not weighted by area, so the mean squared deviation counts for each plane around the pair.
    fn cost_of(&self, surface: &WorkingSurface, pair: Pair, loss: Loss) -> Option<f32> {
        match loss {
            Loss::Attributes(off) => Some(finite(off.mean() * planes(surface, pair))),
            Loss::Deviation | Loss::Part(_) => None,
        }
    }

    fn update(&mut self, surface: &WorkingSurface, event: MetricEvent<'_>) {
        if let (MetricEvent::Begin(batch), Some(schedule)) = (event, &self.schedule) {
            self.kappa = stiffness(schedule(batch));
        }
        self.stars.follow(surface, event);
    }

    fn properties(&self) -> MetricProperties<'_> {
        MetricProperties::named("progressive-mesh")
    }
}
