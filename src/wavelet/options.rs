//! Options of a wavelet mesh.

use crate::view::ErrorShape;

/// Errors covered by the bounds of a wavelet.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum ErrorBound {
    /// All possible errors, for any set of other wavelets: proven.
    #[default]
    Conservative,
    /// The error of leaving out all wavelets of the wavelet's level and finer (Azuma et al., section 3.3.3). Gives fewer
    /// triangles. With only some siblings left out, the error can be larger.
    WithoutSiblings,
}

/// Options for the bounds of a wavelet mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct WaveletOptions {
    /// Errors covered by the bounds.
    pub bound: ErrorBound,
    /// The shape around error vectors.
    pub shape: ErrorShape,
}

impl WaveletOptions {
    /// Sets the errors covered by the bounds.
    #[must_use]
    pub fn with_bound(mut self, bound: ErrorBound) -> Self {
        self.bound = bound;
        self
    }

    /// Sets the shape around error vectors.
    #[must_use]
    pub fn with_shape(mut self, shape: ErrorShape) -> Self {
        self.shape = shape;
        self
    }
}

/// Source of a mesh's normals.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Normals {
    /// The normals of the vertices at full resolution, kept like other attributes.
    #[default]
    Kept,
    /// Normals computed from the triangles of the mesh made.
    Recomputed,
}
