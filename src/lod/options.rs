//! Options of following the view, common to all structures.

use crate::adapt::Geomorph;

/// Choice of the vertices in an instance's vertex buffer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum VertexBuffer {
    /// Vertices in use alone: small buffers and small indices. Vertices are uploaded as they come into use.
    #[default]
    Packed,
    /// All vertices of the structure, uploaded with the first frame.
    Whole,
    /// All vertices of the structure, in a single buffer for all instances, uploaded once by the caller from
    /// [`Values`](super::Values). An instance whose vertices move, or of a wavelet mesh, still has a whole buffer of its own:
    /// [`Lod::shares_vertices`](super::Lod::shares_vertices) tells.
    Shared,
}

/// Triangles by which a set of wavelets is drawn. Neither choice has T-vertices.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Triangulation {
    /// The sum of the hats, exactly: a face is split in four where any of its sides carries a wavelet. Bounds are proven for
    /// this choice.
    #[default]
    Exact,
    /// No vertices but the wavelets': the smallest triangulation. Vertices leave their places only to morph.
    Minimal,
}

/// How an instance follows the view. Defaults: vertices in use alone, no limits, vertices jump.
///
/// All options may change while the instance lives ([`Lod::set_options`](super::Lod::set_options)).
///
/// Limits hold for the drawn level. A split comes before all splits built on it. Work not done yet, or no longer fitting, is
/// carried over. With both limits, the level asked for is the most urgent within the triangle budget. The drawn level goes
/// there as quickly as the operations allow, never above the budget; the earliest request comes first.
///
/// ```
/// use multires::adapt::Geomorph;
/// use multires::lod::{LodOptions, VertexBuffer};
///
/// let options = LodOptions::default()
///     .with_buffer(VertexBuffer::Whole)
///     .with_geomorph(Geomorph::default().with_duration(0.3))
///     .with_triangles(20_000);
/// assert_eq!(options.triangles, Some(20_000));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct LodOptions {
    /// Vertices in the vertex buffer.
    pub buffer: VertexBuffer,
    /// Motion of vertices to their places; `None`: they jump.
    pub geomorph: Option<Geomorph>,
    /// Most triangles drawn, or the coarsest mesh's if it has more. Tolerances grow together until the most urgent refinements
    /// fit ([`Criterion::urgency`](crate::view::Criterion::urgency)). While the view moves, 95 to 100 % of the limit is used.
    pub triangles: Option<usize>,
    /// Most splits and collapses in a call: bounds the time of a frame after the tests. For a totally ordered mesh: most
    /// vertices to come or go in a call, but at least a step; with geomorphs, per transition.
    pub operations: Option<usize>,
    /// Triangulation of a wavelet mesh. Other structures have a single triangulation.
    pub triangulation: Triangulation,
}

impl LodOptions {
    /// Sets the vertices in the vertex buffer.
    #[must_use]
    pub fn with_buffer(mut self, buffer: VertexBuffer) -> Self {
        self.buffer = buffer;
        self
    }

    /// Lets vertices move, or (`None`) jump.
    #[must_use]
    pub fn with_geomorph(mut self, geomorph: impl Into<Option<Geomorph>>) -> Self {
        self.geomorph = geomorph.into();
        self
    }

    /// Limits the triangles, or (`None`) lifts the limit.
    #[must_use]
    pub fn with_triangles(mut self, most: impl Into<Option<usize>>) -> Self {
        self.triangles = most.into();
        self
    }

    /// Limits the splits and collapses in a call, or (`None`) lifts the limit.
    #[must_use]
    pub fn with_operations(mut self, most: impl Into<Option<usize>>) -> Self {
        self.operations = most.into();
        self
    }

    /// Sets the triangulation of a wavelet mesh.
    #[must_use]
    pub fn with_triangulation(mut self, triangulation: Triangulation) -> Self {
        self.triangulation = triangulation;
        self
    }

    /// Holds if the level asked for is drawn at once, whole.
    pub(crate) fn is_immediate(&self) -> bool {
        self.geomorph.is_none() && self.triangles.is_none() && self.operations.is_none()
    }
}
