//! What a wavelet mesh is made for, and how it is drawn.

use crate::adapt::Geomorph;
use crate::view::ErrorShape;

/// Which errors the bounds of a wavelet hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum ErrorBound {
    /// All that can come about, whatever else is in the mesh: proven.
    #[default]
    Conservative,
    /// That of leaving out all wavelets of its level and finer ones (Azuma et al., section 3.3.3). Fewer triangles; a wavelet
    /// that is in while its sibling is out can make the error larger.
    WithoutSiblings,
}

/// How bounds of a wavelet mesh are made.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct WaveletOptions {
    /// Which errors they hold.
    pub bound: ErrorBound,
    /// The shape around error vectors.
    pub shape: ErrorShape,
}

impl WaveletOptions {
    /// With bounds of these errors.
    #[must_use]
    pub fn with_bound(mut self, bound: ErrorBound) -> Self {
        self.bound = bound;
        self
    }

    /// With this shape around them.
    #[must_use]
    pub fn with_shape(mut self, shape: ErrorShape) -> Self {
        self.shape = shape;
        self
    }
}

/// Triangles of a set of wavelets. Neither has T-vertices.
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

/// Where normals of a mesh come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Normals {
    /// From the vertices, like other attributes: those of the full resolution.
    #[default]
    Kept,
    /// From the triangles as they are.
    Recomputed,
}

/// How an instance is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct Drawing {
    /// Which triangles.
    pub triangulation: Triangulation,
    /// Whether only vertices in use are in the buffer.
    pub packed: bool,
    /// How vertices move to where they belong; `None`: at once.
    pub geomorph: Option<Geomorph>,
}

impl Drawing {
    /// With these triangles.
    #[must_use]
    pub fn with_triangulation(mut self, triangulation: Triangulation) -> Self {
        self.triangulation = triangulation;
        self
    }

    /// With a buffer of the vertices in use alone, or of all.
    #[must_use]
    pub fn with_packed(mut self, packed: bool) -> Self {
        self.packed = packed;
        self
    }

    /// With vertices that move.
    #[must_use]
    pub fn with_geomorph(mut self, geomorph: Option<Geomorph>) -> Self {
        self.geomorph = geomorph;
        self
    }
}
