//! The squared length of the edge (Southern 3.2.3, Berkey 3.1).
//!
//! Blind to shape: dense regions go first whatever they look like, so points end up evenly spread and slivers are rare.
//! But not to rims (borders, borders between materials, creases, and seams by a tenth): the area that they sweep counts [`RIM`]-fold, so that
//! corners are not cut off.

use glam::Vec3;

use super::region::{finite, swept_by_rims};
use super::{AttributeSum, Batch, Dependence, ErrorMetric, Pair};
use crate::simplify::surface::WorkingSurface;

/// Weight of the area that rims sweep against the squared length.
const RIM: f64 = 64.0;

/// The squared length of the edge, and the area that rims sweep. There is no optimum: the midpoint is taken.
#[derive(Debug, Clone, Copy, Default)]
pub struct EdgeLength;

/// Length of an edge over the distance that the surface between its ends is taken to be off by.
const LENGTHS: f64 = 16.0;

impl EdgeLength {
    /// The metric.
    pub fn new() -> Self {
        Self
    }
}

impl ErrorMetric for EdgeLength {
    fn name(&self) -> &'static str {
        "edge-length"
    }

    fn begin(&mut self, _: &WorkingSurface, _: Batch) {}

    fn cost(&self, surface: &WorkingSurface, pair: Pair, position: [f32; 3]) -> f32 {
        let length = surface.at(pair.lost).distance_squared(surface.at(pair.kept));
        if surface.is_on_curve(pair.lost) || surface.is_on_curve(pair.kept) {
            let x = Vec3::from(position).as_dvec3();
            return finite(f64::from(length) + RIM * swept_by_rims(surface, pair, x));
        }
        length
    }

    fn optimum(&self, _: &WorkingSurface, _: Pair) -> Option<([f32; 3], f32)> {
        None
    }

    /// The square of the length of an edge on which a surface that bends is off by as much: on a sphere, the middle of
    /// an edge half as long as the radius lies a sixteenth of its length off.
    fn attribute_cost(&self, _: &WorkingSurface, _: Pair, off: AttributeSum) -> f32 {
        (off.mean() * LENGTHS * LENGTHS) as f32
    }

    /// Only edges at the merged point change their length; rims hardly sweep other areas.
    fn dependence(&self) -> Dependence {
        Dependence::Both
    }
}
