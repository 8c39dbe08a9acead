//! Errors from building a vertex hierarchy, or from its parts.

use crate::sequence::SequenceError;
use crate::simplify::OptionError;

/// Error from building a [`VertexHierarchy`](super::VertexHierarchy), or from its parts.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum HierarchyError {
    /// The sequence is inconsistent, or belongs to another mesh.
    #[error(transparent)]
    Sequence(#[from] SequenceError),
    /// An option of the simplification is invalid.
    #[error(transparent)]
    Option(#[from] OptionError),
    /// There are more elements than can be numbered.
    #[error("there are {count} {what}, more than the {limit} supported")]
    TooMany {
        /// Name of the counted elements.
        what: &'static str,
        /// Number of elements.
        count: usize,
        /// Maximum number of elements.
        limit: usize,
    },
    /// An array's length does not match the other arrays.
    #[error("there are {found} {what} where {expected} are needed")]
    Length {
        /// Name of the counted elements.
        what: &'static str,
        /// Number of elements.
        found: usize,
        /// Number of elements needed.
        expected: usize,
    },
    /// An index is out of range.
    #[error("entry {at} of {what} is {found}, but there are {limit}")]
    OutOfRange {
        /// Name of the array.
        what: &'static str,
        /// Index of the entry.
        at: usize,
        /// The entry.
        found: u32,
        /// Exclusive upper bound of the entry.
        limit: usize,
    },
    /// An invariant of the structure does not hold.
    #[error("{what} {at} is wrong")]
    Broken {
        /// Name of the wrong part.
        what: &'static str,
        /// Index of the element.
        at: usize,
    },
    /// The progress callback asked to stop.
    #[error("the build was cancelled")]
    Cancelled,
}
