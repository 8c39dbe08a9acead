//! The squared length of the edge (Southern 3.2.3, Berkey 3.1).
//!
//! Ignores the shape of the surface: dense regions go first, so points end up evenly spread and slivers are rare. Rims
//! (borders, borders between materials, creases, and seams by a tenth) do count: their swept area is weighed
//! [`RIM`]-fold, so that corners are not cut off.

use glam::Vec3;

use crate::simplify::surface::WorkingSurface;

use super::region::{finite, swept_by_rims};
use super::{Dependence, ErrorMetric, Loss, MetricProperties, Pair};

/// Weight of the area swept by rims, relative to the squared length.
const RIM: f64 = 64.0;

/// The squared length of the edge, plus the area swept by rims. Has no optimum: the midpoint is taken.
#[derive(Debug, Clone, Copy, Default)]
pub struct EdgeLength;

/// Length of an edge over the assumed deviation of the surface between its ends.
const LENGTHS: f64 = 16.0;

impl EdgeLength {
    /// Creates the metric.
    pub fn new() -> Self {
        Self
    }
}

impl ErrorMetric for EdgeLength {
    fn cost(&self, surface: &WorkingSurface, pair: Pair, position: [f32; 3]) -> f32 {
        let length = surface.at(pair.lost).distance_squared(surface.at(pair.kept));
        if surface.is_on_curve(pair.lost) || surface.is_on_curve(pair.kept) {
            let x = Vec3::from(position).as_dvec3();
            return finite(f64::from(length) + RIM * swept_by_rims(surface, pair, x));
        }
        length
    }

    /// Attributes: the squared length of an edge with this deviation on a curved surface. On a sphere, the middle of an edge
    /// half as long as the radius lies 1/16 of its length off the surface.
    fn cost_of(&self, _: &WorkingSurface, _: Pair, loss: Loss) -> Option<f32> {
        match loss {
            Loss::Attributes(off) => Some((off.mean() * LENGTHS * LENGTHS) as f32),
            Loss::Deviation | Loss::Part(_) => None,
        }
    }

    /// Only edges at the merged point change their length. Rims elsewhere hardly sweep other areas.
    fn properties(&self) -> MetricProperties<'_> {
        MetricProperties::named("edge-length").with_dependence(Dependence::Both)
    }
}
