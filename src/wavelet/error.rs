//! Errors in a subdivision or in the values on it.

use crate::error::MeshError;

/// Why a wavelet mesh could not be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum WaveletError {
    /// More elements than their numbers can hold.
    #[error("{count} {what} are more than {limit}")]
    TooMany {
        /// The kind of element.
        what: &'static str,
        /// Number of elements found.
        count: usize,
        /// Largest number allowed.
        limit: usize,
    },
    /// Too many triangles on an edge.
    #[error("{count} triangles meet along an edge of triangle {triangle}, more than {limit}")]
    TooManyAlongEdge {
        /// A triangle at the edge.
        triangle: usize,
        /// Number of triangles found.
        count: usize,
        /// Largest number allowed.
        limit: usize,
    },
    /// The mesh is not a four-to-one subdivision of a coarser mesh.
    #[error("no part of the mesh is a four-to-one subdivision of a coarser one: {reason}")]
    NoConnectivity {
        /// The obstacle found.
        reason: String,
    },
    /// The texture is too small for its charts.
    #[error(
        "{charts} charts with gutters of {gutter} texels do not fit a texture of {resolution} texels a side, but one of {needed}"
    )]
    AtlasTooSmall {
        /// Number of charts.
        charts: usize,
        /// Texels around each chart.
        gutter: u32,
        /// Texels on each side of the texture.
        resolution: u32,
        /// Smallest sufficient number of texels on each side.
        needed: u64,
    },
    /// A number of elements does not fit the rest.
    #[error("there are {found} {what}, not {expected}")]
    Length {
        /// The kind of element.
        what: &'static str,
        /// Number of elements found.
        found: usize,
        /// Number of elements expected.
        expected: usize,
    },
    /// Parts do not fit together.
    #[error("{what} {at}")]
    Invalid {
        /// The fault.
        what: &'static str,
        /// The number of the element.
        at: usize,
    },
    /// The input or output mesh is not valid.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// The progress callback cancelled the build.
    #[error("the build was cancelled")]
    Cancelled,
}
