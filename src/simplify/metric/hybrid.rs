//! Swept volume times the largest rotation of a normal (Southern 3.2.4, E_hybrid = E_uvol E_norm).
//!
//! `E_norm = max (1 - o . n)` over the surviving triangles, with unit normals `o` before and `n` after: 0 without
//! rotation, 1 at a right angle, 2 upside down. Removed triangles have no normal afterwards and do not count. Rims
//! (borders, borders between materials, creases, and seams by a tenth) add the length of the edge times their swept area:
//! cutting off a corner of a plane turns no normal and sweeps no volume.

use glam::{DVec3, Vec3};

use crate::simplify::surface::WorkingSurface;

use super::region::{Facet, at, cheapest_place, finite, for_lost, for_region, length, swept_by_rims};
use super::unsigned_volume::{swept, swept_to_kept};
use super::{AttributeQuadric, ErrorMetric, Loss, MetricProperties, Optimum, Pair};

/// The unsigned swept volume times the largest deviation of a normal.
#[derive(Debug, Clone, Copy, Default)]
pub struct Hybrid;

impl Hybrid {
    /// Creates the metric.
    pub fn new() -> Self {
        Self
    }
}

/// Returns `1 - o . n` of a triangle if the collapse goes to `x`. A triangle without area before cannot turn; a triangle
/// without area afterwards counts as a right angle.
fn turn(facet: &Facet, x: DVec3) -> f64 {
    let (old, new) = (facet.cross(), facet.cross_at(x));
    let lengths = (old.length_squared() * new.length_squared()).sqrt();
    if !facet.survives || old == DVec3::ZERO {
        0.0
    } else if lengths > 0.0 {
        // Rounding must not make a cost negative in a flat neighbourhood.
        (1.0 - old.dot(new) / lengths).clamp(0.0, 2.0)
    } else {
        1.0
    }
}

impl ErrorMetric for Hybrid {
    fn cost(&self, surface: &WorkingSurface, pair: Pair, position: [f32; 3]) -> f32 {
        let x = Vec3::from(position).as_dvec3();
        let mut largest: f64 = 0.0;
        for_region(surface, pair, |facet| largest = largest.max(turn(&facet, x)));
        finite(swept(surface, pair, x) * largest + length(surface, pair) * swept_by_rims(surface, pair, x))
    }

    fn costs_at_kept(&self, surface: &WorkingSurface, lost: u32, kept: &[u32], costs: &mut [f32]) {
        for (&kept, cost) in kept.iter().zip(costs) {
            let pair = Pair { lost, kept };
            let x = at(surface, kept);
            let mut largest: f64 = 0.0;
            for_lost(surface, pair, |facet| largest = largest.max(turn(&facet, x)));
            let rims = length(surface, pair) * swept_by_rims(surface, pair, x);
            *cost = finite(swept_to_kept(surface, pair) * largest + rims);
        }
    }

    fn optimum(
        &self,
        surface: &WorkingSurface,
        pair: Pair,
        attributes: &AttributeQuadric,
    ) -> Option<Optimum> {
        cheapest_place(self, surface, pair, attributes)
    }

    /// Attributes: the volume between the surface and a copy offset by the deviation, times the rotation of a normal if the
    /// surface deviates by this distance at a single end of the edge: half of the squared slope.
    fn cost_of(&self, surface: &WorkingSurface, pair: Pair, loss: Loss) -> Option<f32> {
        let Loss::Attributes(off) = loss else { return None };
        let length2 = f64::from(surface.at(pair.lost).distance_squared(surface.at(pair.kept)));
        let turn = off.mean() / (2.0 * length2).max(f64::MIN_POSITIVE);
        Some(finite(off.volume() * turn.min(2.0)))
    }

    fn properties(&self) -> MetricProperties<'_> {
        MetricProperties::named("hybrid")
    }
}
