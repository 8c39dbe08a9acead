//! Area-weighted squared distances to the planes of the current triangles around the pair (Southern 3.2.2, Hoppe 1999).
//!
//! Unlike the accumulated quadric it counts each triangle once and knows nothing of the input. Errors do not accumulate,
//! which Hoppe found to give better meshes.

use glam::Vec3;

use crate::simplify::surface::WorkingSurface;

use super::region::{at, finite};
use super::solve::nearest_minimum;
use super::stars::{StarSums, Sum, Weight};
use super::{AttributeQuadric, ErrorMetric, Loss, MetricEvent, MetricProperties, Optimum, Pair};

/// Weight of the planes upright on borders, feature edges and creases, relative to triangles of equal area.
const UPRIGHT: f64 = 4.0;

/// Squared distances to the planes of the triangles around both points, each triangle once, weighted by twice its area;
/// and to planes upright on borders, feature edges and creases.
#[derive(Debug, Clone)]
pub struct MemorylessQuadric {
    stars: StarSums,
}

impl Default for MemorylessQuadric {
    fn default() -> Self {
        Self { stars: StarSums::new(Weight::Area, UPRIGHT) }
    }
}

impl MemorylessQuadric {
    /// Creates the metric.
    pub fn new() -> Self {
        Self::default()
    }

    fn region(&self, surface: &WorkingSurface, pair: Pair) -> Sum {
        self.stars.region(surface, pair)
    }
}

impl ErrorMetric for MemorylessQuadric {
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
        attributes.add_to(&mut sum, 1.0);
        let lost = at(surface, pair.lost);
        let middle = 0.5 * (at(surface, pair.kept) - lost);
        let x = middle + nearest_minimum(&sum.h, sum.h.times(middle) - sum.c);
        Some(Optimum::of_both((lost + x).as_vec3().into(), finite(sum.at(x))))
    }

    /// A deviation: the patch changed by a collapse has the form of a tent, whose mean squared height is 1/6 of the squared
    /// peak. Each triangle counts once. The rate leaves out the factor 2 of the weight, which is twice the area.
    fn cost_of(&self, _: &WorkingSurface, _: Pair, loss: Loss) -> Option<f32> {
        match loss {
            Loss::Deviation => Some(6.0),
            Loss::Attributes(off) => Some(off.sum),
            Loss::Part(_) => None,
        }
    }

    fn update(&mut self, surface: &WorkingSurface, event: MetricEvent<'_>) {
        self.stars.follow(surface, event);
    }

    fn properties(&self) -> MetricProperties<'_> {
        MetricProperties::named("memoryless-quadric")
    }
}
