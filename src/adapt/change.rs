//! What one move of an instance did.

use super::CutReport;

/// What one call of [`Lod::adapt`](crate::lod::Lod::adapt) did.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub struct Change {
    /// Tests, and the splits and collapses of what is drawn.
    pub cut: CutReport,
    /// Triangles drawn now.
    pub triangles: usize,
    /// Splits and collapses that are still to come before what is drawn is what the view asks for.
    pub pending: usize,
    /// Splits and collapses whose vertices are moving.
    pub moving: usize,
    /// Whether even the coarsest mesh, drawn now, has more triangles than the budget.
    pub over_budget: bool,
}
