//! [`ErrorMetric`]: what the simplifier asks of a metric.

use crate::sequence::NewVertex;
use crate::simplify::surface::WorkingSurface;

use super::{AttributeQuadric, AttributeSum};

/// A candidate collapse: `lost` is merged into `kept`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Pair {
    /// The point removed by the collapse.
    pub lost: u32,
    /// The remaining point, which may move.
    pub kept: u32,
}

/// State at the start of a batch. In linear order the whole simplification is a single batch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct Batch {
    /// Number of the batch, from 0.
    pub index: usize,
    /// Live triangles at the start of the batch.
    pub triangles: usize,
    /// Triangles of the input.
    pub input_triangles: usize,
    /// Whether costs are verified ([`ErrorMeasure::Verified`](crate::simplify::ErrorMeasure::Verified)).
    pub verified: bool,
}

impl Batch {
    /// Returns the first batch on a surface, for using a metric outside of a simplification.
    pub fn first(surface: &WorkingSurface) -> Self {
        let (triangles, input_triangles) = (surface.live_triangles(), surface.triangle_count());
        Self { index: 0, triangles, input_triangles, verified: false }
    }
}

/// Vertex substitutions made by a collapse.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Substitutions<'a> {
    /// Position of the merged point, inner frame.
    pub position: [f32; 3],
    /// `[from, to]`: every removed vertex and the vertex replacing it.
    pub pairs: &'a [[u32; 2]],
    /// Number of the first of `new_vertices`.
    pub first_new: u32,
    /// Vertices created by this collapse: some of the `to`.
    pub new_vertices: &'a [NewVertex],
}

/// The cost of a collapse.
///
/// Positions and lengths are in the surface's inner frame ([`Frame`](crate::simplify::Frame)). Costs order collapses
/// and have no other meaning. They must not be NaN; negative costs count as 0. Costs of different metrics or
/// coefficients do not compare, so a metric may change its coefficients only in [`begin`](ErrorMetric::begin).
pub trait ErrorMetric: Send + Sync {
    /// Name on the command line.
    fn name(&self) -> &'static str;

    /// Called before the first candidate of each batch is evaluated: the place to build accumulators and to change
    /// coefficients. Accumulators must be rebuilt if `batch.index` is 0 (another mesh) or if they were never built (a
    /// metric taking over in a later batch, see [`PerBatch`](super::PerBatch)).
    fn begin(&mut self, surface: &WorkingSurface, batch: Batch);

    /// Returns the cost of merging `pair` at `position`.
    fn cost(&self, surface: &WorkingSurface, pair: Pair, position: [f32; 3]) -> f32;

    /// Returns the cost of merging `pair` at the position of `kept`, as used by endpoint placement. Worth its own formula
    /// if cheaper.
    fn cost_at_kept(&self, surface: &WorkingSurface, pair: Pair) -> f32 {
        self.cost(surface, pair, surface.position(pair.kept))
    }

    /// Writes the costs of merging `lost` into each of `kept` at the position of the kept point to `costs`, which has the
    /// length of `kept`. The costs must equal [`cost_at_kept`](ErrorMetric::cost_at_kept). By default each is computed
    /// separately.
    fn costs_at_kept(&self, surface: &WorkingSurface, lost: u32, kept: &[u32], costs: &mut [f32]) {
        for (&kept, cost) in kept.iter().zip(costs) {
            *cost = self.cost_at_kept(surface, Pair { lost, kept });
        }
    }

    /// Returns the position of least cost and its cost; `None` if the metric has no optimum (the midpoint is taken).
    fn optimum(&self, surface: &WorkingSurface, pair: Pair) -> Option<([f32; 3], f32)>;

    /// Called just before `pair` is merged at `position`.
    fn collapsing(&mut self, surface: &WorkingSurface, pair: Pair, position: [f32; 3]) {
        let _ = (surface, pair, position);
    }

    /// Called just after `pair` was merged: the place to update the data of `kept` and of the points around it.
    fn collapsed(&mut self, surface: &WorkingSurface, pair: Pair) {
        let _ = (surface, pair);
    }

    /// Called after [`collapsing`](ErrorMetric::collapsing), still before the surface changes, with the vertex
    /// substitutions of the collapse: for metrics with data per vertex (wedge).
    fn substituting(&mut self, surface: &WorkingSurface, substitutions: Substitutions<'_>) {
        let _ = (surface, substitutions);
    }

    /// Returns the cost of 1 unit of the integral of squared distance over area (inner units): the exchange rate between
    /// this metric and measured errors or attributes
    /// ([`ErrorMeasure::Verified`](crate::simplify::ErrorMeasure::Verified),
    /// [`WithAttributes`](super::WithAttributes)). `None` if costs are no squared distances.
    fn cost_per_deviation(&self, surface: &WorkingSurface, pair: Pair) -> Option<f32> {
        let _ = (surface, pair);
        None
    }

    /// Returns the cost of a vanishing part of the surface, for metrics without
    /// [`cost_per_deviation`](ErrorMetric::cost_per_deviation) whose costs still compare with such a loss; otherwise
    /// `None`.
    fn vanishing_cost(&self, loss: VanishingLoss) -> Option<f32> {
        let _ = loss;
        None
    }

    /// Returns the cost of attribute deviations in this metric's own unit: the exchange rate of
    /// [`WithAttributes`](super::WithAttributes). By default `off.sum * rate / 6`, with `rate` from
    /// [`cost_per_deviation`](ErrorMetric::cost_per_deviation): `off.sum` counts every triangle at its three corners
    /// with twice its area, which is 6 times the integral. Without a rate, `off.sum`.
    fn attribute_cost(&self, surface: &WorkingSurface, pair: Pair, off: AttributeSum) -> f32 {
        off.sum * self.cost_per_deviation(surface, pair).map_or(1.0, |rate| rate / 6.0)
    }

    /// Returns the position of least total cost of this metric and the attributes, and the total cost there; `None` if
    /// the metric has no optimum. By default the position is [`optimum`](ErrorMetric::optimum), whatever the attributes.
    fn optimum_with(
        &self,
        surface: &WorkingSurface,
        pair: Pair,
        attributes: &AttributeQuadric,
    ) -> Option<([f32; 3], f32)> {
        let (x, cost) = self.optimum(surface, pair)?;
        Some((x, cost + self.attribute_cost(surface, pair, attributes.at(x))))
    }

    /// Whether these costs count attributes already, so that a simplifier does not add them again.
    fn counts_attributes(&self) -> bool {
        false
    }

    /// Names of the mesh's attributes counted by this metric. Vertices created by collapses get values of these
    /// attributes fitted to the surface. Values of all other attributes are blended.
    fn attribute_names(&self) -> &[String] {
        &[]
    }

    /// Returns the attribute deviation if vertex `to`, unchanged, replaces vertex `from` and its point lies at `position`
    /// (inner frame); `None` if the metric keeps no attributes.
    fn substitution_deviation(&self, from: u32, to: u32, position: [f32; 3]) -> Option<AttributeSum> {
        let _ = (from, to, position);
        None
    }

    /// The data that costs depend on besides the two positions. Limits how many costs are recomputed after a collapse.
    fn dependence(&self) -> Dependence {
        Dependence::Triangles
    }
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

/// The data that the cost of a pair depends on, besides the positions of its points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dependence {
    /// Data accumulated at the lost point; data of the kept point only if the merged point is placed elsewhere. Costs of
    /// pairs must not fall when their points absorb other points.
    Lost,
    /// Data accumulated at both points.
    Both,
    /// The current triangles around both points: every collapse makes the costs around it stale.
    Triangles,
}

/// Forwards every call to the pointee.
macro_rules! pass_on {
    ($($header:tt)*) => {
        $($header)* {
            fn name(&self) -> &'static str {
                (**self).name()
            }
            fn begin(&mut self, surface: &WorkingSurface, batch: Batch) {
                (**self).begin(surface, batch);
            }
            fn cost(&self, surface: &WorkingSurface, pair: Pair, position: [f32; 3]) -> f32 {
                (**self).cost(surface, pair, position)
            }
            fn cost_at_kept(&self, surface: &WorkingSurface, pair: Pair) -> f32 {
                (**self).cost_at_kept(surface, pair)
            }
            fn costs_at_kept(&self, surface: &WorkingSurface, lost: u32, kept: &[u32], costs: &mut [f32]) {
                (**self).costs_at_kept(surface, lost, kept, costs);
            }
            fn optimum(&self, surface: &WorkingSurface, pair: Pair) -> Option<([f32; 3], f32)> {
                (**self).optimum(surface, pair)
            }
            fn collapsing(&mut self, surface: &WorkingSurface, pair: Pair, position: [f32; 3]) {
                (**self).collapsing(surface, pair, position);
            }
            fn collapsed(&mut self, surface: &WorkingSurface, pair: Pair) {
                (**self).collapsed(surface, pair);
            }
            fn substituting(&mut self, surface: &WorkingSurface, substitutions: Substitutions<'_>) {
                (**self).substituting(surface, substitutions);
            }
            fn cost_per_deviation(&self, surface: &WorkingSurface, pair: Pair) -> Option<f32> {
                (**self).cost_per_deviation(surface, pair)
            }
            fn vanishing_cost(&self, loss: VanishingLoss) -> Option<f32> {
                (**self).vanishing_cost(loss)
            }
            fn attribute_cost(&self, surface: &WorkingSurface, pair: Pair, off: AttributeSum) -> f32 {
                (**self).attribute_cost(surface, pair, off)
            }
            fn optimum_with(
                &self,
                surface: &WorkingSurface,
                pair: Pair,
                attributes: &AttributeQuadric,
            ) -> Option<([f32; 3], f32)> {
                (**self).optimum_with(surface, pair, attributes)
            }
            fn counts_attributes(&self) -> bool {
                (**self).counts_attributes()
            }
            fn attribute_names(&self) -> &[String] {
                (**self).attribute_names()
            }
            fn substitution_deviation(&self, from: u32, to: u32, position: [f32; 3]) -> Option<AttributeSum> {
                (**self).substitution_deviation(from, to, position)
            }
            fn dependence(&self) -> Dependence {
                (**self).dependence()
            }
        }
    };
}

pass_on!(impl ErrorMetric for Box<dyn ErrorMetric>);
pass_on!(impl<M: ErrorMetric + ?Sized> ErrorMetric for &mut M);

#[cfg(test)]
mod tests {
    use super::super::{NAMES, PerBatch, Quadric, by_name};
    use super::*;
    use crate::mesh::{Topology, shapes};

    /// Also tests boxes and [`PerBatch`], for every number of neighbours modulo the four lanes.
    #[test]
    fn costs_together_are_the_costs_one_by_one() {
        let mesh = shapes::terrain(8, 3);
        let surface = WorkingSurface::new(&mesh, &Topology::new(&mesh));
        let points: Vec<u32> = (0..surface.point_count() as u32).collect();
        for verified in [false, true] {
            let batch = Batch { verified, ..Batch::first(&surface) };
            let named = NAMES.iter().filter_map(|name| by_name(name));
            let passed_on = PerBatch::new(|_| Box::new(Quadric::new()));
            for mut metric in named.chain([Box::new(passed_on) as Box<dyn ErrorMetric>]) {
                metric.begin(&surface, batch);
                for lost in [0, 40] {
                    for kept in (0..10).map(|count| &points[50..50 + count]) {
                        let mut costs = vec![f32::NAN; kept.len()];
                        metric.costs_at_kept(&surface, lost, kept, &mut costs);
                        let one_by_one = kept.iter().map(|&kept| Pair { lost, kept });
                        let one_by_one = one_by_one.map(|pair| metric.cost_at_kept(&surface, pair));
                        assert!(costs.iter().copied().eq(one_by_one), "{} {lost} {kept:?}", metric.name());
                    }
                }
            }
        }
    }
}
