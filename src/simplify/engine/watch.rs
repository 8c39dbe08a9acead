//! The guard while a simplification runs: the largest error that the triangles left explain.

use glam::Vec3;

use super::super::options::{ErrorMeasure, Guard};
use super::super::surface::WorkingSurface;

/// The limit of [`Guard`] and what it refused.
pub(super) struct Watch {
    on: bool,
    diagonal: f32,
    /// The largest error so far, inner units.
    pub largest: f32,
    /// Candidates refused.
    pub refused: u64,
    /// Those of the final mesh, counted only where nothing else was left.
    pub standing: u64,
    /// The limit when what had been refused was tried again.
    tried: f32,
}

/// What the limit must have grown by before what was refused is tried again.
const GROWN: f32 = 1.25;

impl Watch {
    pub fn new(surface: &WorkingSurface, guard: Guard, measure: ErrorMeasure) -> Self {
        // Distances travelled along the surface tell nothing of ruin.
        let on = guard == Guard::On && measure != ErrorMeasure::Parametric;
        Self { on, diagonal: diagonal(surface), largest: 0.0, refused: 0, standing: 0, tried: 0.0 }
    }

    /// The largest error that a level of so many triangles may have, inner units.
    pub fn limit(&self, triangles: usize) -> f32 {
        if self.on { Guard::limit(self.diagonal, triangles) } else { f32::INFINITY }
    }

    /// Takes down the error of a step.
    pub fn reached(&mut self, error: f32) {
        self.largest = self.largest.max(error);
    }

    /// Takes down a refusal at a limit.
    pub fn refuse(&mut self, limit: f32) {
        self.tried = if self.refused == 0 { limit } else { self.tried };
        self.refused += 1;
    }

    /// Whether it is worth while to try again what was refused.
    pub fn has_grown(&mut self, triangles: usize) -> bool {
        let limit = self.limit(triangles);
        let grown = self.refused > 0 && limit > GROWN * self.tried;
        self.tried = if grown { limit } else { self.tried };
        grown
    }
}

/// The diagonal of the box around what triangles use, inner units.
fn diagonal(surface: &WorkingSurface) -> f32 {
    let used = (0..surface.point_count() as u32).filter(|&point| surface.valence(point) > 0);
    let (low, high) = used.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), point| {
        (low.min(surface.at(point)), high.max(surface.at(point)))
    });
    if low.x <= high.x { low.distance(high) } else { 0.0 }
}
