//! Errors of building a totally ordered mesh or of taking its parts.

use crate::sequence::SequenceError;
use crate::simplify::OptionError;

/// Why a [`TotallyOrderedMesh`](super::TotallyOrderedMesh) could not be built from a sequence or taken from parts.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TomError {
    /// The sequence makes new vertices. Vertex substitution needs endpoint placement, which makes none.
    #[error("the sequence makes {count} new vertices; a totally ordered mesh needs endpoint placement")]
    NewVertices {
        /// Number of new vertices.
        count: usize,
    },
    /// The sequence does not hold together, or belongs to another mesh.
    #[error(transparent)]
    Sequence(#[from] SequenceError),
    /// An array's length does not match the other arrays, or exceeds the supported limit.
    #[error("there are {found} {what} where {expected} are needed")]
    Length {
        /// The elements counted.
        what: &'static str,
        /// Number of elements found.
        found: usize,
        /// Number needed, or the most supported.
        expected: usize,
    },
    /// A base vertex is not its own substitute.
    #[error("base vertex {vertex} is not its own substitute")]
    BaseSubstitute {
        /// The vertex.
        vertex: usize,
    },
    /// A vertex is substituted by itself or by a later vertex.
    #[error("vertex {vertex} is substituted by {substitute}, which does not come before it")]
    LateSubstitute {
        /// The vertex.
        vertex: usize,
        /// Its substitute.
        substitute: u32,
    },
    /// A vertex is joined to the vertex before it, but is in the base, comes first after the base, or does not
    /// exist.
    #[error("vertex {vertex} is joined to the one before it, but one of the two is never removed")]
    Group {
        /// The vertex.
        vertex: usize,
    },
    /// A triangle names a vertex that does not exist.
    #[error("triangle {triangle} names vertex {vertex}, but there are {vertices}")]
    Corner {
        /// Index of the triangle.
        triangle: usize,
        /// The vertex named.
        vertex: u32,
        /// Number of vertices.
        vertices: usize,
    },
    /// A triangle has two equal corners at full resolution.
    #[error("triangle {triangle} has two equal corners")]
    Degenerate {
        /// Index of the triangle.
        triangle: usize,
    },
    /// A triangle vanishes later than the triangle before it.
    #[error("triangle {triangle} vanishes at a coarser resolution than the one before it")]
    TriangleOrder {
        /// Index of the triangle.
        triangle: usize,
    },
    /// An error mark is out of order, not at a step's end, below zero, NaN, or above a coarser mark.
    #[error("error mark {mark} is out of order, not at a resolution of the mesh, or not a falling bound")]
    ErrorMark {
        /// Index of the mark.
        mark: usize,
    },
    /// A triangle's material has no entry in the list of materials, or the list is not strictly ascending.
    #[error("material entry {entry} does not fit the list of material ids")]
    Material {
        /// Index of the triangle, or of the entry in the list.
        entry: usize,
    },
    /// The steps together rewrite more corners than a table of a size in proportion to the mesh holds.
    #[error(
        "the steps rewrite {count} corners or more, and at most {limit} are supported for a mesh of this size"
    )]
    TooManyMoves {
        /// Number of corners found to be rewritten.
        count: u64,
        /// Most corners supported.
        limit: u64,
    },
    /// An option of the simplification makes no sense.
    #[error(transparent)]
    Option(#[from] OptionError),
    /// The progress callback asked to stop.
    #[error("the build was cancelled")]
    Cancelled,
}
