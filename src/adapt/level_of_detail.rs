//! What an engine needs to know of a level of detail that follows the view, whatever the structure.

use crate::view::ObjectView;

use super::{CutReport, DirtyRanges};

/// What one call of [`LevelOfDetail::adapt`] did.
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

/// A drawn instance whose level of detail follows the view.
///
/// ```text
///     every frame     adapt(views)  ->  upload what is dirty  ->  clean()  ->  draw triangles(group) for every group
/// ```
///
/// Dirty ranges gather until [`clean`](Self::clean), so frames may go by without an upload. Once buffers are as large as they get,
/// nothing allocates.
pub trait LevelOfDetail {
    /// Moves to the smallest closed cut that refines what any of the views needs. Without views, to the coarsest.
    fn adapt(&mut self, views: &[ObjectView]) -> Change;

    /// The same, `seconds` after the last call: as far as vertices move, they go on by that. [`adapt`](Self::adapt) takes a
    /// sixtieth.
    fn adapt_in(&mut self, views: &[ObjectView], seconds: f32) -> Change {
        let _ = seconds;
        self.adapt(views)
    }

    /// Number of groups of triangles: one for each material, at least one.
    fn groups(&self) -> usize;

    /// Corners of the drawn triangles of a group, dense; empty where there is no such group. Use
    /// [`as_flattened`](slice::as_flattened) for one flat slice of indices.
    fn triangles(&self, group: usize) -> &[[u32; 3]];

    /// The structure's vertex in every slot of a packed vertex buffer; `None` where indices name the structure's vertices.
    fn vertices(&self) -> Option<&[u32]>;

    /// Triangles of a group written since the last [`clean`](Self::clean), as ascending ranges; those that at most `gap`
    /// unwritten triangles part are one.
    fn dirty_triangles(&self, group: usize, gap: usize) -> DirtyRanges<'_>;

    /// Slots written since the last [`clean`](Self::clean), as ascending ranges; none where vertices are not packed.
    fn dirty_vertices(&self, gap: usize) -> DirtyRanges<'_>;

    /// Forgets what was written: call it when it is uploaded.
    fn clean(&mut self);
}
