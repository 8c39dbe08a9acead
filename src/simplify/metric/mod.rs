//! What a collapse costs: the seam between the simplifier and its error metrics.
//!
//! | metric | cost of a collapse | source |
//! |---|---|---|
//! | [`EdgeLength`] | squared length of the edge | Southern 3.2.3, Berkey 3.1 |
//! | [`UnsignedVolume`] | volume swept by the surface, unsigned | Southern 3.2.4 |
//! | [`Hybrid`] | that volume times the largest normal deviation | Southern 3.2.4 |
//! | [`ProgressiveMeshMetric`] | distances to the planes around, plus springs | Southern 3.2.1 |
//! | [`MemorylessQuadric`] | area-weighted squared distances to the planes around | Southern 3.2.2 |
//! | [`Quadric`] | the same, accumulated since the input | Garland and Heckbert 1997 |
//! | [`VolumeArea`] | volume and area change | TOM 4.1 |
//! | [`LindstromTurk`] | volume, boundary and shape objectives | Lindstrom and Turk 1998 |
//! | [`WithAttributes`] | any of them plus squared attribute deviations | Hoppe 1999 |

mod attributes;
mod by_name;
mod deviation;
mod edge_length;
mod hybrid;
mod lindstrom_turk;
mod memoryless_quadric;
mod per_batch;
mod progressive_mesh;
mod quadric;
mod region;
mod solve;
mod stars;
mod unsigned_volume;
mod volume_area;

pub use attributes::{Attributes, WithAttributes};
pub use by_name::{NAMES, by_name};
pub use deviation::{AttributeQuadric, AttributeSum};
pub use edge_length::EdgeLength;
pub use hybrid::Hybrid;
pub use lindstrom_turk::LindstromTurk;
pub use memoryless_quadric::MemorylessQuadric;
pub use per_batch::PerBatch;
pub use progressive_mesh::ProgressiveMeshMetric;
pub use quadric::Quadric;
pub use unsigned_volume::UnsignedVolume;
pub use volume_area::VolumeArea;

use super::sequence::NewVertex;
use super::surface::WorkingSurface;

/// A candidate: `lost` would be merged into `kept`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Pair {
    /// The point that goes.
    pub lost: u32,
    /// The point that stays (and may move).
    pub kept: u32,
}

/// What is known when a batch begins. Linear order is one batch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct Batch {
    /// Its number, from 0.
    pub index: usize,
    /// Live triangles at its start.
    pub triangles: usize,
    /// Triangles of the input.
    pub input_triangles: usize,
    /// Whether costs will be verified ([`ErrorMeasure::Verified`](super::ErrorMeasure::Verified)).
    pub verified: bool,
}

impl Batch {
    /// The first batch on a surface, to ask a metric outside of a simplification.
    pub fn first(surface: &WorkingSurface) -> Self {
        let (triangles, input_triangles) = (surface.live_triangles(), surface.triangle_count());
        Self { index: 0, triangles, input_triangles, verified: false }
    }
}

/// What a collapse does to vertices.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Substitutions<'a> {
    /// Where the merged point will lie, inner frame.
    pub position: [f32; 3],
    /// `[from, to]`: every vertex that goes and the one it becomes.
    pub pairs: &'a [[u32; 2]],
    /// The number of the first of `new_vertices`.
    pub first_new: u32,
    /// The vertices that this collapse makes: some of the `to`.
    pub new_vertices: &'a [NewVertex],
}

/// What a collapse costs.
///
/// Positions and lengths are in the surface's inner frame ([`Frame`](super::Frame)). Costs order collapses and have no
/// other meaning; they must not be NaN and are taken as 0 where negative. Costs of different metrics do not compare,
/// so a metric may change its coefficients only in [`begin`](ErrorMetric::begin).
pub trait ErrorMetric: Send + Sync {
    /// The name that the command line uses.
    fn name(&self) -> &'static str;

    /// Called before the first candidate of each batch is looked at: the place to build accumulators and to change
    /// coefficients. What accumulates must be built anew when `batch.index` is 0 (another mesh) and when nothing was
    /// built yet (a metric that takes over in a later batch, see [`PerBatch`]).
    fn begin(&mut self, surface: &WorkingSurface, batch: Batch);

    /// The cost of merging `pair` at `position`.
    fn cost(&self, surface: &WorkingSurface, pair: Pair, position: [f32; 3]) -> f32;

    /// The cost of merging `pair` where `kept` lies: what endpoint placement asks for. Worth its own formula where
    /// that is cheaper.
    fn cost_at_kept(&self, surface: &WorkingSurface, pair: Pair) -> f32 {
        self.cost(surface, pair, surface.position(pair.kept))
    }

    /// The costs of merging `lost` into each of `kept` where those lie, into `costs` (of the same length): the same
    /// numbers as [`cost_at_kept`](ErrorMetric::cost_at_kept), which is asked one by one unless there is a quicker way.
    fn costs_at_kept(&self, surface: &WorkingSurface, lost: u32, kept: &[u32], costs: &mut [f32]) {
        for (&kept, cost) in kept.iter().zip(costs) {
            *cost = self.cost_at_kept(surface, Pair { lost, kept });
        }
    }

    /// The position of least cost and its cost; `None` where the metric has no opinion (the midpoint is taken).
    fn optimum(&self, surface: &WorkingSurface, pair: Pair) -> Option<([f32; 3], f32)>;

    /// Called just before `pair` is merged at `position`.
    fn collapsing(&mut self, surface: &WorkingSurface, pair: Pair, position: [f32; 3]) {
        let _ = (surface, pair, position);
    }

    /// Called just after `pair` was merged: the place to bring up to date what is known of `kept` and of the points
    /// around it.
    fn collapsed(&mut self, surface: &WorkingSurface, pair: Pair) {
        let _ = (surface, pair);
    }

    /// Called after [`collapsing`](ErrorMetric::collapsing), still before the surface changes, with what the collapse
    /// does to vertices: for metrics that keep something per vertex (wedge).
    fn substituting(&mut self, surface: &WorkingSurface, substitutions: Substitutions<'_>) {
        let _ = (surface, substitutions);
    }

    /// What one unit of the integral of squared distance over area (inner units) costs here: the exchange rate between
    /// this metric and what is measured or added ([`ErrorMeasure::Verified`](super::ErrorMeasure::Verified),
    /// [`WithAttributes`]). `None` where costs are no squared distances.
    fn cost_per_deviation(&self, surface: &WorkingSurface, pair: Pair) -> Option<f32> {
        let _ = (surface, pair);
        None
    }

    /// What it costs that a part of the surface vanishes, where that compares with this metric's costs but is no matter of
    /// [`cost_per_deviation`](ErrorMetric::cost_per_deviation).
    fn vanishing_cost(&self, loss: VanishingLoss) -> Option<f32> {
        let _ = loss;
        None
    }

    /// What attributes that are off cost here, in this metric's own unit: the exchange rate of [`WithAttributes`]. By
    /// default squared deviations times area, at the rate of [`cost_per_deviation`](ErrorMetric::cost_per_deviation)
    /// where there is one: the sum counts every triangle at its three corners with twice its area, which is six times
    /// the integral.
    fn attribute_cost(&self, surface: &WorkingSurface, pair: Pair, off: AttributeSum) -> f32 {
        off.sum * self.cost_per_deviation(surface, pair).map_or(1.0, |rate| rate / 6.0)
    }

    /// The position where this metric and attributes cost least together, and what both cost there; `None` where the
    /// metric has no opinion. By default [`optimum`](ErrorMetric::optimum), whatever the attributes say.
    fn optimum_with(
        &self,
        surface: &WorkingSurface,
        pair: Pair,
        attributes: &AttributeQuadric,
    ) -> Option<([f32; 3], f32)> {
        let (x, cost) = self.optimum(surface, pair)?;
        Some((x, cost + self.attribute_cost(surface, pair, attributes.at(x))))
    }

    /// Whether attributes count in these costs already, so that a simplifier does not add them once more.
    fn counts_attributes(&self) -> bool {
        false
    }

    /// The names of the mesh's attributes that count here. Vertices that collapses make get values of these that fit the
    /// surface; values of others are blends.
    fn attribute_names(&self) -> &[String] {
        &[]
    }

    /// What attributes would be off by if the vertex `from` was substituted by `to` as it is, its point lying at
    /// `position` (inner frame); `None` where the metric keeps no attributes.
    fn substitution_deviation(&self, from: u32, to: u32, position: [f32; 3]) -> Option<AttributeSum> {
        let _ = (from, to, position);
        None
    }

    /// What costs depend on besides the two positions, so that no more is looked at again than must be.
    fn dependence(&self) -> Dependence {
        Dependence::Triangles
    }
}

/// What is lost where a part of the surface vanishes, inner units.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct VanishingLoss {
    /// The integral of squared distance from what is left over the part's area; while it waits at least that, by its size alone.
    pub integral: f32,
    /// The part's area, in the input.
    pub area: f32,
    /// How many triangles it has, those over the same points counted once.
    pub triangles: usize,
    /// The area of all parts in the input, for each triangle that is left.
    pub mean_area: f32,
}

/// What the cost of a pair depends on, besides where its points are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dependence {
    /// What was accumulated at the lost point, and at the kept one only where the merged point is not put there.
    /// Costs of pairs must not fall as their points take in others.
    Lost,
    /// What was accumulated at both points.
    Both,
    /// The triangles around both points as they are now: every collapse makes the costs around it stale.
    Triangles,
}

/// Passes every call on to what the type points to.
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
    use super::*;
    use crate::mesh::{Topology, shapes};

    /// Also behind a box and through [`PerBatch`], for every number of neighbours that lanes of four can meet.
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
