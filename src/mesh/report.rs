//! Counts, borders and non-manifold parts of a mesh.

/// Counts of a mesh.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Report {}
