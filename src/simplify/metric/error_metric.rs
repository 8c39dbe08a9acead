//! [`ErrorMetric`]: what the simplifier asks of a metric.

use crate::simplify::surface::WorkingSurface;

use super::{AttributeQuadric, Loss, MetricEvent, MetricProperties, PerBatch};

/// A candidate collapse: `lost` is merged into `kept`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Pair {
    /// The point removed by the collapse.
    pub lost: u32,
    /// The remaining point, which may move.
    pub kept: u32,
}

/// The position of least cost of a pair, and the cost there.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Optimum {
    /// Position, inner frame.
    pub position: [f32; 3],
    /// Cost at the position.
    pub cost: f32,
    /// Whether position and cost account for the attributes.
    pub counts_attributes: bool,
}

impl Optimum {
    /// Creates the optimum of a metric without a view on attributes. Their cost at the position is added by
    /// [`WithAttributes`](super::WithAttributes).
    pub const fn new(position: [f32; 3], cost: f32) -> Self {
        Self { position, cost, counts_attributes: false }
    }

    /// Creates the optimum of metric and attributes together. `cost` is their sum.
    pub const fn of_both(position: [f32; 3], cost: f32) -> Self {
        Self { position, cost, counts_attributes: true }
    }
}

/// The cost of a collapse.
///
/// Only [`cost`](Self::cost) is required, so a closure is a metric: `|surface: &WorkingSurface, pair: Pair, position:
/// [f32; 3]| -> f32`.
///
/// Positions and lengths are in the surface's inner frame ([`Frame`](crate::simplify::Frame)). Costs order collapses
/// and have no other meaning. They must not be NaN; negative costs count as 0. Costs of different metrics or
/// coefficients do not compare, so a metric may change its coefficients only at [`MetricEvent::Begin`].
///
/// ```
/// use multires::simplify::metric::{Dependence, ErrorMetric, MetricProperties, Pair};
/// use multires::simplify::WorkingSurface;
/// use multires::{Simplifier, Target, mesh::shapes};
///
/// /// The height of the merged point: what is low goes first.
/// struct Height;
///
/// impl ErrorMetric for Height {
///     fn cost(&self, _: &WorkingSurface, _: Pair, position: [f32; 3]) -> f32 {
///         1.0 + position[1]
///     }
///     fn properties(&self) -> MetricProperties<'_> {
///         MetricProperties::named("height").with_dependence(Dependence::Both)
///     }
/// }
///
/// let mesh = shapes::icosphere(3);
/// let by_type = Simplifier::new().metric(Height).target(Target::Ratio(0.5)).run(&mesh)?;
/// let closure = |_: &WorkingSurface, _: Pair, position: [f32; 3]| 1.0 + position[1];
/// let by_closure = Simplifier::new().metric(closure).target(Target::Ratio(0.5)).run(&mesh)?;
/// assert_eq!(by_type.report().triangles, by_closure.report().triangles);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait ErrorMetric: Send + Sync {
    /// Returns the cost of merging `pair` at `position`.
    fn cost(&self, surface: &WorkingSurface, pair: Pair, position: [f32; 3]) -> f32;

    /// Writes the costs of merging `lost` into each of `kept`, at the position of the kept point, to `costs`, which has the
    /// length of `kept`: the only costs that endpoint placement asks for. By default each is [`cost`](Self::cost); worth
    /// a formula of its own if cheaper. A cost must not depend on the other points of `kept`.
    fn costs_at_kept(&self, surface: &WorkingSurface, lost: u32, kept: &[u32], costs: &mut [f32]) {
        for (&kept, cost) in kept.iter().zip(costs) {
            *cost = self.cost(surface, Pair { lost, kept }, surface.position(kept));
        }
    }

    /// Returns the position of least cost, of this metric and `attributes` together if the metric can, and the cost there;
    /// `None` if the metric has no optimum (the midpoint is taken), which is the default. Without attributes, `attributes`
    /// is [`AttributeQuadric::NONE`].
    fn optimum(
        &self,
        surface: &WorkingSurface,
        pair: Pair,
        attributes: &AttributeQuadric,
    ) -> Option<Optimum> {
        let _ = (surface, pair, attributes);
        None
    }

    /// Returns the cost of a loss that no collapse of this metric accounts for, in this metric's own unit: the exchange
    /// rate between metric and measured errors, attributes and vanishing parts. `None`, the default, has the meaning given
    /// at each [`Loss`].
    fn cost_of(&self, surface: &WorkingSurface, pair: Pair, loss: Loss) -> Option<f32> {
        let _ = (surface, pair, loss);
        None
    }

    /// Keeps the metric's data up to date. By default does nothing: the metric has no data.
    fn update(&mut self, surface: &WorkingSurface, event: MetricEvent<'_>) {
        let _ = (surface, event);
    }

    /// Returns facts about the metric. By default [`MetricProperties::default`].
    fn properties(&self) -> MetricProperties<'_> {
        MetricProperties::default()
    }
}

/// Returns the cost of merging `pair` at the position of the kept point.
#[inline]
pub(crate) fn cost_at_kept<M: ErrorMetric + ?Sized>(metric: &M, surface: &WorkingSurface, pair: Pair) -> f32 {
    let mut cost = [0.0];
    metric.costs_at_kept(surface, pair.lost, &[pair.kept], &mut cost);
    cost[0]
}

impl<F: Fn(&WorkingSurface, Pair, [f32; 3]) -> f32 + Send + Sync> ErrorMetric for F {
    #[inline]
    fn cost(&self, surface: &WorkingSurface, pair: Pair, position: [f32; 3]) -> f32 {
        self(surface, pair, position)
    }
}

/// Reads everything from another metric: all of [`ErrorMetric`] but `update`.
macro_rules! read_from {
    (|$this:ident| $metric:expr) => {
        fn cost(&$this, surface: &WorkingSurface, pair: Pair, position: [f32; 3]) -> f32 {
            $metric.cost(surface, pair, position)
        }
        fn costs_at_kept(&$this, surface: &WorkingSurface, lost: u32, kept: &[u32], costs: &mut [f32]) {
            $metric.costs_at_kept(surface, lost, kept, costs);
        }
        fn optimum(
            &$this,
            surface: &WorkingSurface,
            pair: Pair,
            attributes: &AttributeQuadric,
        ) -> Option<Optimum> {
            $metric.optimum(surface, pair, attributes)
        }
        fn cost_of(&$this, surface: &WorkingSurface, pair: Pair, loss: Loss) -> Option<f32> {
            $metric.cost_of(surface, pair, loss)
        }
        fn properties(&$this) -> MetricProperties<'_> {
            $metric.properties()
        }
    };
}

impl ErrorMetric for Box<dyn ErrorMetric> {
    read_from!(|self| (**self));

    fn update(&mut self, surface: &WorkingSurface, event: MetricEvent<'_>) {
        (**self).update(surface, event);
    }
}

/// A borrowed metric. `&mut M` cannot be a metric beside closures: a later crate may implement `Fn` for it.
#[derive(Debug)]
pub(crate) struct Borrowed<'a, M>(pub &'a mut M);

impl<M: ErrorMetric> ErrorMetric for Borrowed<'_, M> {
    read_from!(|self| self.0);

    fn update(&mut self, surface: &WorkingSurface, event: MetricEvent<'_>) {
        self.0.update(surface, event);
    }
}

/// Reads from the metric of the batch.
impl ErrorMetric for PerBatch {
    read_from!(|self| self.current);

    fn update(&mut self, surface: &WorkingSurface, event: MetricEvent<'_>) {
        if let MetricEvent::Begin(batch) = event {
            self.choose(batch);
        }
        self.current.update(surface, event);
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Batch, NAMES, Quadric, by_name};
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
                metric.update(&surface, MetricEvent::Begin(batch));
                for lost in [0, 40] {
                    for kept in (0..10).map(|count| &points[50..50 + count]) {
                        let mut costs = vec![f32::NAN; kept.len()];
                        metric.costs_at_kept(&surface, lost, kept, &mut costs);
                        let one_by_one = kept.iter().map(|&kept| Pair { lost, kept });
                        let one_by_one = one_by_one.map(|pair| cost_at_kept(&metric, &surface, pair));
                        assert!(
                            costs.iter().copied().eq(one_by_one),
                            "{} {lost} {kept:?}",
                            metric.properties().name
                        );
                    }
                }
            }
        }
    }
}
