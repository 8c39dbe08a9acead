//! Why an instance could not be made or changed, or values not be arranged.

/// Why there is no such instance.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum LodError {
    /// As many values are needed as the structure has vertices.
    #[error("there are {found} values where {expected} are needed, one for each vertex of the structure")]
    Length {
        /// Values handed in.
        found: usize,
        /// Vertices of the structure.
        expected: usize,
    },
    /// Vertices would lie between others, and nobody said how values are mixed.
    #[error("{what} mixes vertices: hand in values with blending (`Values::with_blending`)")]
    NeedsBlending {
        /// What asks for it.
        what: &'static str,
    },
    /// The tables that instances share could not be made.
    #[error("{what}")]
    Table {
        /// Why.
        what: String,
    },
}
