//! [`MetricEvent`]: what a metric hears of a simplification.

use crate::sequence::NewVertex;
use crate::simplify::surface::WorkingSurface;

use super::Pair;

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
    /// `[from, to]`: every removed vertex and the vertex replacing it.
    pub pairs: &'a [[u32; 2]],
    /// Number of the first of `new_vertices`.
    pub first_new: u32,
    /// Vertices created by this collapse: some of the `to`.
    pub new_vertices: &'a [NewVertex],
}

/// Events of a simplification, in the order in which a metric hears of them ([`update`](super::ErrorMetric::update)).
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum MetricEvent<'a> {
    /// A batch begins; none of its candidates is evaluated yet. The only event at which a metric may change its
    /// coefficients. Accumulators must be rebuilt if `index` is 0 (another mesh) or if they were never built (a metric
    /// taking over in a later batch, see [`PerBatch`](super::PerBatch)).
    Begin(Batch),
    /// `pair` is about to be merged at `position`. The surface is unchanged.
    Collapsing {
        /// The points.
        pair: Pair,
        /// Position of the merged point, inner frame.
        position: [f32; 3],
        /// Vertices replaced, for metrics with data per vertex (wedge).
        substitutions: Substitutions<'a>,
    },
    /// `pair` has been merged: `pair.kept` and the triangles around it have changed.
    Collapsed {
        /// The points. `pair.lost` has no triangles any more.
        pair: Pair,
    },
}
