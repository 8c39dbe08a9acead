//! What a wavelet mesh is made for.

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
