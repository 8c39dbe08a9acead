//! Volume change plus area change (TOM 4.1).
//!
//! ```text
//!   penalty = sum |volume| of the tetrahedra swept  +  3 |their signed sum|
//!           + |v1 - v2| * (1/2 |change of area|  +  area turned upside down  +  area that rims sweep)
//!           + a millionth of |v1 - v2|^3
//! ```
//!
//! The paper's formula ignores borders (no volume changes when a border point slides along the sheet) and leaves the
//! order on a plane to chance. Two terms mend this: the area swept by rims (borders, borders between materials, creases,
//! and seams by a tenth) and the last term. The paper's volume variation can be read as the signed change or as the swept
//! volume. Either alone is worse than both: the swept volume measures the present distance, and the signed change adds up
//! over the collapses to come.

use glam::{DVec3, Vec3};

use crate::simplify::surface::WorkingSurface;

use super::region::{Facet, at, cheapest_place, finite, for_lost, for_region, length, swept_by_rims};
use super::{AttributeQuadric, ErrorMetric, Loss, MetricProperties, Optimum, Pair, VanishingLoss};

/// The penalty of TOM: volume and area change, made for [`Placement::Endpoint`](crate::simplify::Placement::Endpoint).
#[derive(Debug, Clone, Copy, Default)]
pub struct VolumeArea;

impl VolumeArea {
    /// Creates the metric.
    pub fn new() -> Self {
        Self
    }
}

/// Weights relative to the swept volume, found on the meshes of the quality tables.
const SIGNED: f64 = 3.0;
const AREA: f64 = 0.5;
const INVERSION: f64 = 1.0;
const RIM: f64 = 1.0;
const TIE: f64 = 1e-6;

/// Changes of a region by a collapse. The fields hold 6 times the volumes and twice the areas.
#[derive(Default)]
struct Change {
    volume: f64,
    signed: f64,
    area: f64,
    inverted: f64,
}

impl Change {
    #[inline]
    fn add(&mut self, facet: &Facet, x: DVec3) {
        let old = facet.cross();
        let volume = old.dot(x - facet.p);
        self.volume += volume.abs();
        self.signed += volume;
        self.area -= old.length();
        if facet.survives {
            let new = facet.cross_at(x);
            let area = new.length();
            self.area += area;
            if old.dot(new) < 0.0 {
                self.inverted += area;
            }
        }
    }
}

fn penalty(surface: &WorkingSurface, pair: Pair, change: &Change, x: DVec3) -> f32 {
    let length = length(surface, pair);
    let rims = 2.0 * swept_by_rims(surface, pair, x);
    let volumes = change.volume + SIGNED * change.signed.abs();
    let areas = AREA * change.area.abs() + INVERSION * change.inverted + RIM * rims;
    finite(volumes / 6.0 + length * areas / 2.0 + TIE * length.powi(3))
}

impl ErrorMetric for VolumeArea {
    fn cost(&self, surface: &WorkingSurface, pair: Pair, position: [f32; 3]) -> f32 {
        let x = Vec3::from(position).as_dvec3();
        let mut change = Change::default();
        for_region(surface, pair, |facet| change.add(&facet, x));
        penalty(surface, pair, &change, x)
    }

    fn costs_at_kept(&self, surface: &WorkingSurface, lost: u32, kept: &[u32], costs: &mut [f32]) {
        for (&kept, cost) in kept.iter().zip(costs) {
            let pair = Pair { lost, kept };
            let x = at(surface, kept);
            let mut change = Change::default();
            for_lost(surface, pair, |facet| change.add(&facet, x));
            *cost = penalty(surface, pair, &change, x);
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

    /// Attributes: the volume between the surface and a copy offset by the deviation to a single side, counted as swept
    /// volume and as signed change.
    ///
    /// A part: the volume between the part and the remaining surface if the area of its triangles were the geometric mean
    /// of their own area and the surface's mean. With their own area alone small parts cost next to nothing; with the
    /// surface's mean alone they wait until all go at once.
    fn cost_of(&self, _: &WorkingSurface, _: Pair, loss: Loss) -> Option<f32> {
        match loss {
            Loss::Attributes(off) => Some(finite((1.0 + SIGNED) * off.volume())),
            Loss::Part(VanishingLoss { integral, area, triangles, mean_area }) => {
                let distance = (f64::from(integral) / f64::from(area)).sqrt();
                let area = (f64::from(area) * f64::from(mean_area) * triangles as f64).sqrt();
                Some(finite((1.0 + SIGNED) * distance * area))
            }
            Loss::Deviation => None,
        }
    }

    fn properties(&self) -> MetricProperties<'_> {
        MetricProperties::named("volume-area")
    }
}
