//! A metric replaced in each batch (Southern 3.3): for example cheap and even first, careful later.

use std::fmt;

use super::{Batch, EdgeLength, ErrorMetric};

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
    pub(super) current: Box<dyn ErrorMetric>,
}

impl fmt::Debug for PerBatch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("PerBatch").field("current", &self.current.properties().name).finish_non_exhaustive()
    }
}

impl PerBatch {
    /// Uses the metric returned by `choose` for each batch.
    pub fn new(choose: impl FnMut(Batch) -> Box<dyn ErrorMetric> + Send + Sync + 'static) -> Self {
        Self { choose: Box::new(choose), current: Box::new(EdgeLength) }
    }

    /// Takes the metric for a batch.
    pub(super) fn choose(&mut self, batch: Batch) {
        self.current = (self.choose)(batch);
    }
}
