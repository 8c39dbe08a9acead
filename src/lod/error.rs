//! Errors of making or changing an instance.

/// Why an instance could not be made or changed.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum LodError {
    /// The number of values is not the structure's number of vertices.
    #[error("there are {found} values where {expected} are needed, one for each vertex of the structure")]
    Length {
        /// Number of values passed.
        found: usize,
        /// Number of vertices of the structure.
        expected: usize,
    },
    /// Vertices would lie between others, but the values have no blending.
    #[error("{what} mixes vertices: hand in values with blending (`Values::with_blending`)")]
    NeedsBlending {
        /// The feature to need blending.
        what: &'static str,
    },
    /// The data shared by instances could not be made.
    #[error("{what}")]
    Table {
        /// The reason.
        what: String,
    },
}
