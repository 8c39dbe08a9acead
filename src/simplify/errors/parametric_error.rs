//! Distance travelled by input points: an error known at no cost.
//!
//! Every point carries the largest distance of an input point merged into it. The map from each input triangle to its
//! image is linear, so no point of the triangle moves further than the farthest of its corners. So the distance travelled
//! bounds the distance between input and level, in both directions, and the sliding of textures.
//!
//! Input points merged into a point that a collapse leaves without triangles go on to where the surface still is.

use glam::Vec3;

use crate::simplify::metric::Pair;
use crate::simplify::surface::WorkingSurface;
use crate::simplify::surface::patch::Patch;

use super::left_alone::{left_alone, still_there};

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
    pub fn measure(&self, surface: &WorkingSurface, patch: &Patch, pair: Pair, x: Vec3) -> f32 {
        let to = heir(surface, patch, pair).map_or(x, |corner| surface.at(corner));
        let merged = self.farthest(surface, &[pair.lost, pair.kept], to);
        left_alone(surface, patch, pair)
            .fold(merged, |most, point| most.max(self.farthest(surface, &[point], to)))
    }

    /// Records a merge; returns the new reach.
    pub fn merge(&mut self, surface: &WorkingSurface, patch: &Patch, pair: Pair, x: Vec3) -> f32 {
        let reach = self.measure(surface, patch, pair, x);
        let heir = heir(surface, patch, pair).unwrap_or(pair.kept) as usize;
        self.reach[heir] = self.reach[heir].max(reach);
        reach
    }

    /// Returns the reach of `into` if `points` vanish and are merged into it.
    pub fn measure_vanishing(&self, surface: &WorkingSurface, points: &[u32], into: u32) -> f32 {
        self.farthest(surface, points, surface.at(into)).max(self.reach[into as usize])
    }

    /// Returns the reach of the merged point if `points` vanish into `pair.lost` before the merge.
    pub fn measure_reaching(&self, surface: &WorkingSurface, pair: Pair, x: Vec3, points: &[u32]) -> f32 {
        let before = self.measure_vanishing(surface, points, pair.lost);
        before + surface.at(pair.lost).distance(x) * (1.0 + 1e-6)
    }

    /// Records that `points` vanish into `into`; returns the new reach.
    pub fn vanish(&mut self, surface: &WorkingSurface, points: &[u32], into: u32) -> f32 {
        let reach = self.measure_vanishing(surface, points, into);
        self.reach[into as usize] = reach;
        reach
    }

    fn farthest(&self, surface: &WorkingSurface, points: &[u32], to: Vec3) -> f32 {
        let of = |&point: &u32| self.reach[point as usize] + surface.at(point).distance(to) * (1.0 + 1e-6);
        points.iter().map(of).fold(0.0, f32::max)
    }
}

/// Returns where the surface still is, beside a merged point that is left alone.
fn heir(surface: &WorkingSurface, patch: &Patch, pair: Pair) -> Option<u32> {
    let is_alone =
        patch.facets().is_empty() && left_alone(surface, patch, pair).any(|point| point == pair.kept);
    if is_alone { still_there(surface, patch, pair) } else { None }
}
