//! Distance travelled by input points: an error known at no cost.
//!
//! Every point carries the largest distance of an input point merged into it. The map from each input triangle to its
//! image is linear, so no point of the triangle moves further than the farthest of its corners. So the distance travelled
//! bounds the distance between input and level, in both directions, and the sliding of textures.

use glam::Vec3;

use crate::simplify::metric::Pair;
use crate::simplify::surface::WorkingSurface;

/// Per point the largest distance of an input point merged into it, inner units.
#[derive(Debug, Clone, Default)]
pub(crate) struct ParametricError {
    reach: Vec<f32>,
}

impl ParametricError {
    pub fn new(surface: &WorkingSurface) -> Self {
        Self { reach: vec![0.0; surface.point_count()] }
    }

    /// Returns the reach of the merged point, by the triangle inequality; rounded up.
    pub fn measure(&self, surface: &WorkingSurface, pair: Pair, x: Vec3) -> f32 {
        let of = |point: u32| self.reach[point as usize] + surface.at(point).distance(x) * (1.0 + 1e-6);
        of(pair.lost).max(of(pair.kept))
    }

    /// Records a merge; returns the new reach.
    pub fn merge(&mut self, surface: &WorkingSurface, pair: Pair, x: Vec3) -> f32 {
        let reach = self.measure(surface, pair, x);
        self.reach[pair.kept as usize] = reach;
        reach
    }

    /// Returns the reach of `into` if `points` vanish and are merged into it.
    pub fn measure_vanishing(&self, surface: &WorkingSurface, points: &[u32], into: u32) -> f32 {
        let pairs = points.iter().map(|&lost| Pair { lost, kept: into });
        pairs.map(|pair| self.measure(surface, pair, surface.at(into))).fold(0.0, f32::max)
    }

    /// Records that `points` vanish into `into`; returns the new reach.
    pub fn vanish(&mut self, surface: &WorkingSurface, points: &[u32], into: u32) -> f32 {
        let reach = self.measure_vanishing(surface, points, into);
        self.reach[into as usize] = reach;
        reach
    }
}
