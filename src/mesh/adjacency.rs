//! The corners around every point, in flat arrays.

/// The corners around every point.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Adjacency {}
