//! Attribute deviations caused by merging a pair, in a form that every metric can weigh against its own costs.
//!
//! ```text
//!   sum   = sum over the triangles merged so far of  2 * area * (deviation)^2        deviations are inner lengths
//!   area  = sum of  2 * area                                                         so sum / area is their mean square
//! ```

use glam::{DVec3, Vec3};

use super::solve::Symmetric;
use super::stars::Sum;

/// Squared deviations of attributes at a position, summed over area. A deviation is converted to a length of the inner
/// frame by the attribute's weight.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[non_exhaustive]
pub struct AttributeSum {
    /// Sum of `2 * area * deviation^2`.
    pub sum: f32,
    /// Sum of `2 * area`.
    pub area: f32,
    /// Whether the sum holds only the deviations added by merging into the kept point as it is
    /// ([`costs_at_kept`](super::ErrorMetric::costs_at_kept)), rather than all deviations carried by the merged point.
    pub added: bool,
}

impl AttributeSum {
    /// Mean squared deviation `sum / area`; 0 without an area.
    #[inline]
    pub fn mean(&self) -> f64 {
        if self.area > 0.0 { f64::from(self.sum) / f64::from(self.area) } else { 0.0 }
    }

    /// Volume between the surface and a copy offset by the deviations: `area / 3` times the root mean square, since each
    /// triangle is counted at three corners.
    #[inline]
    pub fn volume(&self) -> f64 {
        (f64::from(self.sum) * f64::from(self.area)).max(0.0).sqrt() / 6.0
    }
}

/// Squared deviations of attributes as a function of the merged position, with the best values at each position:
/// `d'hd + 2 b'd + constant` at `d` from `origin`.
#[derive(Debug, Clone, Copy, Default)]
pub struct AttributeQuadric {
    /// Position of the lost point, inner frame.
    pub(super) origin: Vec3,
    pub(super) h: Symmetric,
    pub(super) b: DVec3,
    pub(super) constant: f64,
    pub(super) area: f32,
}

impl AttributeQuadric {
    /// No attributes: no deviation anywhere.
    pub const NONE: Self =
        Self { origin: Vec3::ZERO, h: Symmetric::ZERO, b: DVec3::ZERO, constant: 0.0, area: 0.0 };

    /// Half the gradient at a position.
    #[inline]
    pub(super) fn gradient(&self, position: Vec3) -> DVec3 {
        self.h.times((position - self.origin).as_dvec3()) + self.b
    }

    /// Adds the deviations, times `rate`, to a metric's sum relative to the lost point.
    #[inline]
    pub(super) fn add_to(&self, sum: &mut Sum, rate: f64) {
        sum.h.add(&self.h.scaled(rate));
        sum.c -= self.b * rate;
        sum.constant += self.constant * rate;
    }

    /// Returns the deviations if the pair is merged at `position` (inner frame), with the best values there.
    #[inline]
    pub fn at(&self, position: [f32; 3]) -> AttributeSum {
        let d = (Vec3::from(position) - self.origin).as_dvec3();
        let sum = d.dot(self.h.times(d)) + 2.0 * self.b.dot(d) + self.constant;
        AttributeSum { sum: super::region::finite(sum), area: self.area, added: false }
    }
}
