//! Why a totally ordered mesh could not be built, or its parts not be taken.

use crate::simplify::{OptionError, SequenceError};

/// Why a [`TotallyOrderedMesh`](super::TotallyOrderedMesh) could not be built from a sequence or taken from parts.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TomError {
    /// The sequence makes new vertices; vertex substitution needs endpoint placement, which makes none.
    #[error("the sequence makes {count} new vertices; a totally ordered mesh needs endpoint placement")]
    NewVertices {
        /// How many new vertices there are.
        count: usize,
    },
    /// The sequence does not hold together, or belongs to another mesh.
    #[error(transparent)]
    Sequence(#[from] SequenceError),
    /// An array is longer or shorter than the others ask for.
    #[error("there are {found} {what} where {expected} are needed")]
    Length {
        /// What was counted.
        what: &'static str,
        /// How many there are.
        found: usize,
        /// How many are needed, or the most that are supported.
        expected: usize,
    },
    /// A base vertex is not its own substitute.
    #[error("base vertex {vertex} is not its own substitute")]
    BaseSubstitute {
        /// The vertex.
        vertex: usize,
    },
    /// A vertex is substituted by itself or by a later one.
    #[error("vertex {vertex} is substituted by {substitute}, which does not come before it")]
    LateSubstitute {
        /// The vertex.
        vertex: usize,
        /// Its substitute.
        substitute: u32,
    },
    /// A vertex is joined to the one before it, but is in the base, the first after it, or not there.
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
        /// The vertex it names.
        vertex: u32,
        /// How many vertices there are.
        vertices: usize,
    },
    /// A triangle has two equal corners at full resolution.
    #[error("triangle {triangle} has two equal corners")]
    Degenerate {
        /// Index of the triangle.
        triangle: usize,
    },
    /// A triangle vanishes later than the one before it.
    #[error("triangle {triangle} vanishes at a coarser resolution than the one before it")]
    TriangleOrder {
        /// Index of the triangle.
        triangle: usize,
    },
    /// An error mark is out of order, not at a step's end, below zero, NaN, or above a coarser one.
    #[error("error mark {mark} is out of order, not at a resolution of the mesh, or not a falling bound")]
    ErrorMark {
        /// Index of the mark.
        mark: usize,
    },
    /// A triangle's material has no entry in the list of materials, or that list is not strictly ascending.
    #[error("material entry {entry} does not fit the list of material ids")]
    Material {
        /// Index of the triangle, or of the entry in the list.
        entry: usize,
    },
    /// The corners that all steps together rewrite are more than can be numbered.
    #[error("the steps rewrite {count} corners, more than the {limit} supported")]
    TooManyMoves {
        /// How many there are.
        count: u64,
        /// How many are supported.
        limit: u64,
    },
    /// An option of the simplification makes no sense.
    #[error(transparent)]
    Option(#[from] OptionError),
    /// Whoever was told of the progress said to stop.
    #[error("the build was cancelled")]
    Cancelled,
}
