//! The volume between the old and the new surface, without signs (Southern 3.2.4, E_uvol).
//!
//! ```text
//!            x            each triangle around the edge spans a tetrahedron with the new position;
//!          / | \          the sum of their volumes is what the surface sweeps over
//!        a --|-- b
//!          \ | /
//!            c
//! ```
//!
//! Rims (borders, borders between materials, creases, and seams by a tenth) add the length of the edge times their swept
//! area: cutting off a corner of a plane sweeps no volume.

use glam::{DVec3, Vec3};

use crate::simplify::surface::WorkingSurface;

use super::region::{at, cheapest_place, finite, for_lost, for_region, length, swept_by_rims};
use super::{AttributeQuadric, ErrorMetric, Loss, MetricProperties, Optimum, Pair};

/// The sum of the volumes of the tetrahedra between the new position and the triangles around both points.
#[derive(Debug, Clone, Copy, Default)]
pub struct UnsignedVolume;

impl UnsignedVolume {
    /// Creates the metric.
    pub fn new() -> Self {
        Self
    }
}

/// Returns the unsigned volume swept if both points go to `x`.
pub(super) fn swept(surface: &WorkingSurface, pair: Pair, x: DVec3) -> f64 {
    let mut sum = 0.0;
    for_region(surface, pair, |facet| sum += facet.cross().dot(x - facet.p).abs());
    sum / 6.0
}

/// Returns the unsigned volume swept if `lost` goes to `kept`: the triangles around `kept` sweep nothing.
pub(super) fn swept_to_kept(surface: &WorkingSurface, pair: Pair) -> f64 {
    let x = at(surface, pair.kept);
    let mut sum = 0.0;
    for_lost(surface, pair, |facet| sum += facet.cross().dot(x - facet.p).abs());
    sum / 6.0
}

impl ErrorMetric for UnsignedVolume {
    fn cost(&self, surface: &WorkingSurface, pair: Pair, position: [f32; 3]) -> f32 {
        let x = Vec3::from(position).as_dvec3();
        finite(swept(surface, pair, x) + length(surface, pair) * swept_by_rims(surface, pair, x))
    }

    fn costs_at_kept(&self, surface: &WorkingSurface, lost: u32, kept: &[u32], costs: &mut [f32]) {
        for (&kept, cost) in kept.iter().zip(costs) {
            let pair = Pair { lost, kept };
            let rims = swept_by_rims(surface, pair, at(surface, kept));
            *cost = finite(swept_to_kept(surface, pair) + length(surface, pair) * rims);
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

    /// Attributes: the volume between the surface and a copy offset by the deviation.
    fn cost_of(&self, _: &WorkingSurface, _: Pair, loss: Loss) -> Option<f32> {
        match loss {
            Loss::Attributes(off) => Some(finite(off.volume())),
            Loss::Deviation | Loss::Part(_) => None,
        }
    }

    fn properties(&self) -> MetricProperties<'_> {
        MetricProperties::named("unsigned-volume")
    }
}
