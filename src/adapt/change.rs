//! Report of one call of an instance's `adapt`.

use super::CutReport;

/// Counts from one call of [`Lod::adapt`](crate::lod::Lod::adapt).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub struct Change {
    /// Tests, and the splits and collapses applied to the drawn mesh.
    pub cut: CutReport,
    /// Triangles drawn after the call.
    pub triangles: usize,
    /// Splits and collapses still to come until the drawn mesh is the mesh asked for by the view.
    pub pending: usize,
    /// Splits and collapses whose vertices are moving.
    pub moving: usize,
    /// Whether the drawn mesh has more triangles than the budget; then it is the coarsest mesh.
    pub over_budget: bool,
}
