//! What attributes are off by when a pair is merged, in a form that every metric can weigh against its own costs.
//!
//! ```text
//!   sum   = sum over the triangles merged so far of  2 * area * (deviation)^2        deviations are inner lengths
//!   area  = sum of  2 * area                                                         so sum / area is their mean square
//! ```

use glam::{DVec3, Vec3};

use super::solve::Symmetric;
use super::stars::Sum;

/// Squared deviations of attributes at one place, summed over area. A deviation is a length of the inner frame: the
/// distance that it is worth.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[non_exhaustive]
pub struct AttributeSum {
    /// The sum of twice the area times the squared deviation.
    pub sum: f32,
    /// The sum of twice the area.
    pub area: f32,
    /// Whether it is what merging into the kept point, which stays as it is, adds
    /// ([`cost_at_kept`](super::ErrorMetric::cost_at_kept)), rather than all that the merged point carries.
    pub added: bool,
}

impl AttributeSum {
    /// The mean squared deviation; 0 without an area.
    #[inline]
    pub fn mean(&self) -> f64 {
        if self.area > 0.0 { f64::from(self.sum) / f64::from(self.area) } else { 0.0 }
    }

    /// The volume between the surface and one that is off by these deviations: a third of the area times the root
    /// mean square, as each triangle is counted at three corners.
    #[inline]
    pub fn volume(&self) -> f64 {
        (f64::from(self.sum) * f64::from(self.area)).max(0.0).sqrt() / 6.0
    }
}

/// Squared deviations of attributes as a function of where a pair is merged, with the best values for each place:
/// `d'hd + 2 b'd + constant` at `d` from `origin`.
#[derive(Debug, Clone, Copy, Default)]
pub struct AttributeQuadric {
    /// Where the lost point lies, inner frame.
    pub(super) origin: Vec3,
    pub(super) h: Symmetric,
    pub(super) b: DVec3,
    pub(super) constant: f64,
    pub(super) area: f32,
}

impl AttributeQuadric {
    /// Half the slope at a position.
    #[inline]
    pub(super) fn gradient(&self, position: Vec3) -> DVec3 {
        self.h.times((position - self.origin).as_dvec3()) + self.b
    }

    /// Adds these deviations, at a price of `rate`, to what a metric sums up relative to the lost point.
    #[inline]
    pub(super) fn add_to(&self, sum: &mut Sum, rate: f64) {
        sum.h.add(&self.h.scaled(rate));
        sum.c -= self.b * rate;
        sum.constant += self.constant * rate;
    }

    /// The deviations where the pair is merged at `position` (inner frame) with the values that are best there.
    #[inline]
    pub fn at(&self, position: [f32; 3]) -> AttributeSum {
        let d = (Vec3::from(position) - self.origin).as_dvec3();
        let sum = d.dot(self.h.times(d)) + 2.0 * self.b.dot(d) + self.constant;
        AttributeSum { sum: super::region::finite(sum), area: self.area, added: false }
    }
}
