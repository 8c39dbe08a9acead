//! The guard during a simplification: limits the error by the number of triangles left.

use crate::geometry::boxes;
use crate::simplify::options::{ErrorMeasure, Guard};
use crate::simplify::surface::WorkingSurface;

/// Limit of [`Guard`], and refusals.
pub(super) struct Watch {
    on: bool,
    diagonal: f32,
    /// Largest error so far, inner units.
    pub largest: f32,
    /// Number of candidates refused.
    pub refused: u64,
    /// Number of refused candidates of the final mesh; counted only where nothing else was left.
    pub standing: u64,
    /// Limit when refused candidates were last tried again.
    tried: f32,
}

/// Factor by which the limit must have grown before refused candidates are tried again.
const GROWN: f32 = 1.25;

impl Watch {
    pub fn new(surface: &WorkingSurface, guard: Guard, measure: ErrorMeasure) -> Self {
        // Distances travelled along the surface do not show ruin.
        let on = guard == Guard::On && measure != ErrorMeasure::Parametric;
        Self { on, diagonal: diagonal(surface), largest: 0.0, refused: 0, standing: 0, tried: 0.0 }
    }

    /// Returns the largest error allowed for a level of `triangles` triangles, inner units.
    pub fn limit(&self, triangles: usize) -> f32 {
        if self.on { Guard::limit(self.diagonal, triangles) } else { f32::INFINITY }
    }

    /// Records the error of a step.
    pub fn reached(&mut self, error: f32) {
        self.largest = self.largest.max(error);
    }

    /// Records a refusal at a limit.
    pub fn refuse(&mut self, limit: f32) {
        self.tried = if self.refused == 0 { limit } else { self.tried };
        self.refused += 1;
    }

    /// Whether to try refused candidates again: the limit has grown enough.
    pub fn has_grown(&mut self, triangles: usize) -> bool {
        let limit = self.limit(triangles);
        let grown = self.refused > 0 && limit > GROWN * self.tried;
        self.tried = if grown { limit } else { self.tried };
        grown
    }
}

/// Returns the diagonal of the box around all points used by triangles, inner units.
fn diagonal(surface: &WorkingSurface) -> f32 {
    let used = (0..surface.point_count() as u32).filter(|&point| surface.valence(point) > 0);
    let [low, high] = boxes::around(used.map(|point| surface.at(point)));
    if low.x <= high.x { low.distance(high) } else { 0.0 }
}
