//! Why a vertex hierarchy could not be built, or its parts not be taken.

use crate::simplify::{OptionError, SequenceError};

/// Why a [`VertexHierarchy`](super::VertexHierarchy) could not be built.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum HierarchyError {
    /// The sequence does not hold together, or belongs to another mesh.
    #[error(transparent)]
    Sequence(#[from] SequenceError),
    /// An option of the simplification makes no sense.
    #[error(transparent)]
    Option(#[from] OptionError),
    /// More elements than can be numbered.
    #[error("there are {count} {what}, more than the {limit} supported")]
    TooMany {
        /// What was counted.
        what: &'static str,
        /// How many there are.
        count: usize,
        /// How many are supported.
        limit: usize,
    },
    /// An array is longer or shorter than the others ask for.
    #[error("there are {found} {what} where {expected} are needed")]
    Length {
        /// What was counted.
        what: &'static str,
        /// How many there are.
        found: usize,
        /// How many are needed.
        expected: usize,
    },
    /// An index names nothing.
    #[error("entry {at} of {what} is {found}, but there are {limit}")]
    OutOfRange {
        /// The array.
        what: &'static str,
        /// Index of the entry.
        at: usize,
        /// The entry.
        found: u32,
        /// What it must be below.
        limit: usize,
    },
    /// A promise of the structure does not hold.
    #[error("{what} {at} is wrong")]
    Broken {
        /// What is wrong.
        what: &'static str,
        /// Index of the element.
        at: usize,
    },
    /// Whoever was told of the progress said to stop.
    #[error("the build was cancelled")]
    Cancelled,
}
