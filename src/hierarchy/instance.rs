//! One drawn instance of a vertex hierarchy: the cut that a view asks for, and its triangles.

use std::sync::Arc;

use crate::adapt::{Change, Cut, DirtyRanges, LevelOfDetail, is_done};
use crate::view::{Criterion, Motion, ObjectView};

use super::{Surface, VertexHierarchy};

/// One drawn instance. Many share one hierarchy; each is independent, and may move to another thread.
///
/// Starts at the coarsest level of detail, all of it dirty.
#[derive(Debug, Clone)]
pub struct HierarchyLod {
    hierarchy: Arc<VertexHierarchy>,
    cut: Cut,
    surface: Surface,
    views: Vec<ObjectView>,
}

impl HierarchyLod {
    /// For a buffer of all vertices of the hierarchy, uploaded once: indices name its vertices.
    pub fn new(hierarchy: Arc<VertexHierarchy>) -> Self {
        Self::with(hierarchy, false)
    }

    /// For a buffer of the vertices in use alone: indices name slots of [`LevelOfDetail::vertices`].
    pub fn packed(hierarchy: Arc<VertexHierarchy>) -> Self {
        Self::with(hierarchy, true)
    }

    fn with(hierarchy: Arc<VertexHierarchy>, packed: bool) -> Self {
        Self {
            cut: Cut::new(hierarchy.split_count(), hierarchy.diagonal(), hierarchy.has_needs()),
            surface: Surface::new(&hierarchy, packed),
            views: Vec::new(),
            hierarchy,
        }
    }

    /// The structure.
    pub fn hierarchy(&self) -> &Arc<VertexHierarchy> {
        &self.hierarchy
    }

    /// Which splits are in the mesh.
    pub fn cut(&self) -> &Cut {
        &self.cut
    }

    /// Its triangles.
    pub fn surface(&self) -> &Surface {
        &self.surface
    }

    /// Moves the cut to what a criterion of your own needs. `motion` is what has happened to the criterion since the last
    /// call ([`Criterion::motion`]); [`Motion::Other`] where the last call was another's.
    pub fn adapt_by<C: Criterion + ?Sized>(&mut self, criterion: &C, motion: Motion) -> Change {
        self.views.clear();
        self.update(criterion, motion)
    }

    fn update<C: Criterion + ?Sized>(&mut self, criterion: &C, motion: Motion) -> Change {
        let Self { hierarchy, cut, surface, .. } = self;
        let report = cut.update(&**hierarchy, criterion, motion, |state, split, comes| {
            if comes {
                surface.split(hierarchy, split, |other| is_done(state, other));
            } else {
                surface.collapse(hierarchy, split);
            }
        });
        Change { cut: report, triangles: surface.triangle_count() }
    }

    /// Bytes of this instance, the shared hierarchy not counted.
    pub fn memory(&self) -> usize {
        self.cut.memory() + self.surface.memory()
    }
}

impl LevelOfDetail for HierarchyLod {
    fn adapt(&mut self, views: &[ObjectView]) -> Change {
        let motion = if self.views.is_empty() { Motion::Other } else { views.motion(&self.views) };
        let change = self.update(views, motion);
        self.views.clear();
        self.views.extend_from_slice(views);
        change
    }

    fn groups(&self) -> usize {
        self.surface.groups()
    }

    fn triangles(&self, group: usize) -> &[[u32; 3]] {
        self.surface.triangles(group)
    }

    fn vertices(&self) -> Option<&[u32]> {
        self.surface.vertices()
    }

    fn dirty_triangles(&self, group: usize, gap: usize) -> DirtyRanges<'_> {
        self.surface.dirty_triangles(group, gap)
    }

    fn dirty_vertices(&self, gap: usize) -> DirtyRanges<'_> {
        self.surface.dirty_vertices(gap)
    }

    fn clean(&mut self) {
        self.surface.clean();
    }
}
