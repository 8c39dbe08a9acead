//! [`Loss`]: what compares with the costs of collapses, at a metric's own exchange rate.

use crate::simplify::surface::WorkingSurface;

use super::{AttributeSum, ErrorMetric, Pair};

/// A loss that must compare with the costs of collapses ([`ErrorMetric::cost_of`]). Inner units.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Loss {
    /// A deviation of the surface: 1 unit of the integral of squared distance over area. `None` as its cost: the metric's
    /// costs are no squared distances, and [`ErrorMeasure::Verified`](crate::simplify::ErrorMeasure::Verified) measures
    /// as `Measured` does.
    Deviation,
    /// Deviations of attributes. `None` as their cost: `sum * rate / 6`, with `rate` the cost of
    /// [`Deviation`](Self::Deviation), because `sum` counts every triangle at its three corners with twice its area,
    /// which is 6 times the integral. Without a rate, `sum`.
    Attributes(AttributeSum),
    /// A vanishing part of the surface, for metrics without a cost of [`Deviation`](Self::Deviation). The pair is a
    /// point of the part, twice. `None` as its cost: the part vanishes last.
    Part(VanishingLoss),
}

/// The loss caused by a vanishing part of the surface, inner units.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct VanishingLoss {
    /// Integral over the part's area of the squared distance to the remaining surface. While the part waits: a lower
    /// bound from the part's size alone.
    pub integral: f32,
    /// Area of the part, in the input.
    pub area: f32,
    /// Number of triangles of the part. Triangles over equal points count once, estimated by their share in the whole
    /// surface.
    pub triangles: usize,
    /// Area of all parts in the input, per remaining triangle.
    pub mean_area: f32,
}

/// Returns the cost of attribute deviations in a metric's own unit, by the default of [`Loss::Attributes`] if the metric
/// has no rate.
#[inline]
pub(super) fn attribute_cost<M: ErrorMetric + ?Sized>(
    metric: &M,
    surface: &WorkingSurface,
    pair: Pair,
    off: AttributeSum,
) -> f32 {
    metric.cost_of(surface, pair, Loss::Attributes(off)).unwrap_or_else(|| {
        off.sum * metric.cost_of(surface, pair, Loss::Deviation).map_or(1.0, |rate| rate / 6.0)
    })
}
