//! How an instance follows the view, the same for every structure.

use crate::adapt::Geomorph;

/// Which vertices lie in the vertex buffer of an instance.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum VertexBuffer {
    /// Those in use alone: small buffers and small indices; vertices are uploaded as they come into use.
    #[default]
    Packed,
    /// All vertices of the structure, uploaded with the first frame.
    Whole,
    /// All vertices of the structure in one buffer for all instances, which the caller uploads once from
    /// [`Values`](super::Values). An instance whose vertices do not stay where they are (they move, or are those of a wavelet
    /// mesh) still has a whole buffer of its own: [`Lod::shares_vertices`](super::Lod::shares_vertices) says which.
    Shared,
}

/// Which triangles a set of wavelets is drawn with. Neither has T-vertices.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Triangulation {
    /// The sum of the hats, exactly: a face is split in four where any of its sides carries a wavelet. What bounds are proven
    /// for.
    #[default]
    Exact,
    /// No vertex but those of the wavelets: the smallest triangulation. Vertices never leave their places but to morph.
    Minimal,
}

/// How an instance follows the view. Defaults: vertices in use alone, no limits, vertices jump.
///
/// All of it may change while the instance lives ([`Lod::set_options`](super::Lod::set_options)).
///
/// Limits hold for what is drawn: splits come before all that builds on them, and what is not yet done, or no longer fits, is
/// carried over. With both limits, what is asked for is the most urgent within the budget, and what is drawn goes there as
/// quickly as the operations allow, never above the budget. What was asked for earliest comes first.
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
    /// Which vertices lie in the vertex buffer.
    pub buffer: VertexBuffer,
    /// How vertices move to where they belong; `None`: they jump.
    pub geomorph: Option<Geomorph>,
    /// Most triangles drawn; where the coarsest mesh has more, that. Tolerances grow together until the most urgent of what is
    /// asked for fits ([`Criterion::urgency`](crate::view::Criterion::urgency)); while the view moves, 95 to 100 of a hundred
    /// are used.
    pub triangles: Option<usize>,
    /// Most splits and collapses in one call: a bound for the time that a frame takes, after the tests. Of a totally ordered
    /// mesh: most vertices that come or go, but no fewer than go in one step. A transition of moving vertices is one call there.
    pub operations: Option<usize>,
    /// Which triangles a wavelet mesh is drawn with. Other structures have one triangulation.
    pub triangulation: Triangulation,
}

impl LodOptions {
    /// With these vertices in the vertex buffer.
    #[must_use]
    pub fn with_buffer(mut self, buffer: VertexBuffer) -> Self {
        self.buffer = buffer;
        self
    }

    /// With vertices that move, or (`None`) jump.
    #[must_use]
    pub fn with_geomorph(mut self, geomorph: impl Into<Option<Geomorph>>) -> Self {
        self.geomorph = geomorph.into();
        self
    }

    /// With at most this many triangles, or (`None`) as many as are asked for.
    #[must_use]
    pub fn with_triangles(mut self, most: impl Into<Option<usize>>) -> Self {
        self.triangles = most.into();
        self
    }

    /// With at most this many splits and collapses in one call, or (`None`) as many as it takes.
    #[must_use]
    pub fn with_operations(mut self, most: impl Into<Option<usize>>) -> Self {
        self.operations = most.into();
        self
    }

    /// With these triangles of a wavelet mesh.
    #[must_use]
    pub fn with_triangulation(mut self, triangulation: Triangulation) -> Self {
        self.triangulation = triangulation;
        self
    }

    /// Whether what is asked for is drawn at once, whole.
    pub(crate) fn is_immediate(&self) -> bool {
        self.geomorph.is_none() && self.triangles.is_none() && self.operations.is_none()
    }
}
