//! The squared length of the edge (Southern 3.2.3, Berkey 3.1).
//!
//! Blind to shape: dense regions go first whatever they look like, so points end up evenly spread and slivers are rare.

use super::{Batch, Dependence, ErrorMetric, Pair};
use crate::simplify::surface::Surface;

/// The squared length of the edge; the same wherever the merged point goes, so the optimum is the midpoint.
#[derive(Debug, Clone, Copy, Default)]
pub struct EdgeLength;

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

    fn begin(&mut self, _: &Surface, _: Batch) {}

    fn cost(&self, surface: &Surface, pair: Pair, _: [f32; 3]) -> f32 {
        surface.at(pair.lost).distance_squared(surface.at(pair.kept))
    }

    fn optimum(&self, _: &Surface, _: Pair) -> Option<([f32; 3], f32)> {
        None
    }

    /// Only edges at the merged point change their length.
    fn dependence(&self) -> Dependence {
        Dependence::Both
    }
}
