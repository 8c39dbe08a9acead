//! A metric replaced in each batch (Southern 3.3): for example cheap and even first, careful later.

use std::fmt;

use crate::simplify::surface::WorkingSurface;

use super::{
    AttributeQuadric, AttributeSum, Batch, Dependence, EdgeLength, ErrorMetric, Pair, Substitutions,
    VanishingLoss,
};

/// A metric chosen anew for each batch.
///
/// ```
/// use multires::simplify::metric::{EdgeLength, ErrorMetric, PerBatch, Quadric};
///
/// let metric = PerBatch::new(|batch| -> Box<dyn ErrorMetric> {
///     if batch.triangles > 10_000 { Box::new(EdgeLength::new()) } else { Box::new(Quadric::new()) }
/// });
/// ```
///
/// Every batch starts with a new metric: accumulated data, as in [`Quadric`](super::Quadric), starts from the current
/// mesh. In linear order the metric starts anew only where seams, materials or the
/// topology give.
pub struct PerBatch {
    choose: Box<dyn FnMut(Batch) -> Box<dyn ErrorMetric> + Send + Sync>,
    current: Box<dyn ErrorMetric>,
}

impl fmt::Debug for PerBatch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("PerBatch").field("current", &self.current.name()).finish_non_exhaustive()
    }
}

impl PerBatch {
    /// Uses the metric returned by `choose` for each batch.
    pub fn new(choose: impl FnMut(Batch) -> Box<dyn ErrorMetric> + Send + Sync + 'static) -> Self {
        Self { choose: Box::new(choose), current: Box::new(EdgeLength) }
    }
}

impl ErrorMetric for PerBatch {
    fn name(&self) -> &'static str {
        "per-batch"
    }

    fn begin(&mut self, surface: &WorkingSurface, batch: Batch) {
        self.current = (self.choose)(batch);
        self.current.begin(surface, batch);
    }

    fn cost(&self, surface: &WorkingSurface, pair: Pair, position: [f32; 3]) -> f32 {
        self.current.cost(surface, pair, position)
    }

    fn cost_at_kept(&self, surface: &WorkingSurface, pair: Pair) -> f32 {
        self.current.cost_at_kept(surface, pair)
    }

    fn costs_at_kept(&self, surface: &WorkingSurface, lost: u32, kept: &[u32], costs: &mut [f32]) {
        self.current.costs_at_kept(surface, lost, kept, costs);
    }

    fn optimum(&self, surface: &WorkingSurface, pair: Pair) -> Option<([f32; 3], f32)> {
        self.current.optimum(surface, pair)
    }

    fn collapsing(&mut self, surface: &WorkingSurface, pair: Pair, position: [f32; 3]) {
        self.current.collapsing(surface, pair, position);
    }

    fn collapsed(&mut self, surface: &WorkingSurface, pair: Pair) {
        self.current.collapsed(surface, pair);
    }

    fn substituting(&mut self, surface: &WorkingSurface, substitutions: Substitutions<'_>) {
        self.current.substituting(surface, substitutions);
    }

    fn cost_per_deviation(&self, surface: &WorkingSurface, pair: Pair) -> Option<f32> {
        self.current.cost_per_deviation(surface, pair)
    }

    fn vanishing_cost(&self, loss: VanishingLoss) -> Option<f32> {
        self.current.vanishing_cost(loss)
    }

    fn attribute_cost(&self, surface: &WorkingSurface, pair: Pair, off: AttributeSum) -> f32 {
        self.current.attribute_cost(surface, pair, off)
    }

    fn optimum_with(
        &self,
        surface: &WorkingSurface,
        pair: Pair,
        attributes: &AttributeQuadric,
    ) -> Option<([f32; 3], f32)> {
        self.current.optimum_with(surface, pair, attributes)
    }

    fn counts_attributes(&self) -> bool {
        self.current.counts_attributes()
    }

    fn attribute_names(&self) -> &[String] {
        self.current.attribute_names()
    }

    fn substitution_deviation(&self, from: u32, to: u32, position: [f32; 3]) -> Option<AttributeSum> {
        self.current.substitution_deviation(from, to, position)
    }

    fn dependence(&self) -> Dependence {
        self.current.dependence()
    }
}
