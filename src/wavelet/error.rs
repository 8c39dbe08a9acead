//! What can be wrong with a subdivision or the values on it.

use crate::error::MeshError;

/// Why a wavelet mesh could not be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum WaveletError {
    /// More of something than its numbers can hold.
    #[error("{count} {what} are more than {limit}")]
    TooMany {
        /// Of what.
        what: &'static str,
        /// How many there are.
        count: usize,
        /// How many there may be.
        limit: usize,
    },
    /// Too many triangles on one edge.
    #[error("{count} triangles meet along an edge of triangle {triangle}, more than {limit}")]
    TooManyAlongEdge {
        /// One of them.
        triangle: usize,
        /// How many there are.
        count: usize,
        /// How many there may be.
        limit: usize,
    },
    /// The mesh is no four-to-one subdivision of a coarser one.
    #[error("no part of the mesh is a four-to-one subdivision of a coarser one: {reason}")]
    NoConnectivity {
        /// What was found instead.
        reason: String,
    },
    /// A texture too small for its charts.
    #[error(
        "{charts} charts with gutters of {gutter} texels do not fit a texture of {resolution} texels a side, but one of {needed}"
    )]
    AtlasTooSmall {
        /// Number of charts.
        charts: usize,
        /// Texels around each of them.
        gutter: u32,
        /// Texels a side.
        resolution: u32,
        /// Texels a side that are enough.
        needed: u64,
    },
    /// A number of something that does not fit the rest.
    #[error("there are {found} {what}, not {expected}")]
    Length {
        /// Of what.
        what: &'static str,
        /// How many there are.
        found: usize,
        /// How many there should be.
        expected: usize,
    },
    /// Parts that do not fit together.
    #[error("{what} {at}")]
    Invalid {
        /// What is wrong.
        what: &'static str,
        /// The number of the element.
        at: usize,
    },
    /// The mesh that comes out, or went in, is not valid.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// Whoever was told of the progress said to stop.
    #[error("the build was cancelled")]
    Cancelled,
}
