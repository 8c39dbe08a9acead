//! Errors of building a g-mesh or of taking its parts.

use crate::sequence::SequenceError;
use crate::simplify::OptionError;

/// Why a [`Gmesh`](super::Gmesh) could not be built from a sequence or taken from parts.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GmeshError {
    /// The sequence does not hold together, or belongs to another mesh.
    #[error(transparent)]
    Sequence(#[from] SequenceError),
    /// An option makes no sense.
    #[error(transparent)]
    Option(#[from] OptionError),
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
    /// A level has more vertices than the level before it, or an error that is smaller, negative or not finite.
    #[error("level {level} has more vertices, or a smaller error, than the level before it")]
    Level {
        /// Index of the level.
        level: usize,
    },
    /// A level has too many triangles beside the level before it.
    #[error("level {level} removes too few triangles: all levels together would take {triangles}")]
    TooLittle {
        /// Index of the level.
        level: usize,
        /// Triangles of all levels up to this level.
        triangles: usize,
    },
    /// A vertex's target is not drawn in the level in which the vertex moves, or a vertex of the coarsest level has one.
    #[error("vertex {vertex} cannot move to {target}")]
    Target {
        /// The vertex.
        vertex: usize,
        /// Its target.
        target: u32,
    },
    /// A triangle names a vertex that does not exist, or has two equal corners.
    #[error("triangle {triangle} names a vertex that does not exist, or one vertex twice")]
    Triangle {
        /// Index of the triangle.
        triangle: usize,
    },
    /// The groups of triangles do not ascend, or do not fit the list of material ids.
    #[error("group {group} does not fit the triangles or the list of material ids")]
    Group {
        /// Index of the group.
        group: usize,
    },
    /// The progress callback asked to stop.
    #[error("the build was cancelled")]
    Cancelled,
}
