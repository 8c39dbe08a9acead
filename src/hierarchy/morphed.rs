//! An instance whose vertices do not jump: they move to where they belong.

use std::sync::Arc;

use crate::adapt::{Blend, Change, DirtyRanges, Geomorph, LevelOfDetail, LodOptions};
use crate::error::MeshError;
use crate::view::{Criterion, Motion, ObjectView};

use super::moving::Moving;
use super::{HierarchyLod, VertexHierarchy};

/// A [`HierarchyLod`] with the values of its vertices, which move: a vertex that a split brings starts where its substitute is
/// drawn and moves to its own place; one that is to go moves to where its substitute is drawn, then the collapse takes
/// place. Transitions may overlap in space and time, and turn round from where they are. How long they take: [`Geomorph`]. A
/// change that [no view sees](Criterion::sees) is made at once.
///
/// ```text
///     every frame   adapt_in(views, seconds)  ->  upload what is dirty of values() and triangles()  ->  clean()
/// ```
///
/// Values may be of any type with [`Blend`]; normals come out a little short on their way. Memory for each vertex: 4 bytes, and
/// a value for each in the buffer that is drawn. Time in a frame: O(vertices that move), and what [`HierarchyLod`] takes.
///
/// Source: Hoppe 1998 (Smooth view-dependent level-of-detail control, section 5) for geomorphs that overlap.
#[derive(Debug, Clone)]
pub struct MorphedLod<V> {
    lod: HierarchyLod,
    moving: Moving<V>,
    geomorph: Geomorph,
}

impl<V: Blend + Copy> MorphedLod<V> {
    /// For a buffer of all vertices: `values` are those of the hierarchy's vertices
    /// ([`HierarchyBuild::arrange_with`](super::HierarchyBuild::arrange_with)), shared by instances.
    ///
    /// # Errors
    /// As many values as vertices are needed.
    pub fn new(hierarchy: Arc<VertexHierarchy>, values: Arc<[V]>) -> Result<Self, MeshError> {
        Self::with(hierarchy, values, false)
    }

    /// For a buffer of the vertices in use alone.
    ///
    /// # Errors
    /// As many values as vertices are needed.
    pub fn packed(hierarchy: Arc<VertexHierarchy>, values: Arc<[V]>) -> Result<Self, MeshError> {
        Self::with(hierarchy, values, true)
    }

    fn with(hierarchy: Arc<VertexHierarchy>, values: Arc<[V]>, packed: bool) -> Result<Self, MeshError> {
        let (found, expected) = (values.len(), hierarchy.vertex_count());
        if found != expected {
            return Err(MeshError::LengthMismatch { what: "values".to_owned(), found, expected });
        }
        let mut lod = HierarchyLod::with(hierarchy, packed, true);
        let moving = Moving::new(values, lod.surface());
        lod.surface_mut().clean_vertices();
        Ok(Self { lod, moving, geomorph: Geomorph::default() })
    }

    /// With this duration.
    #[must_use]
    pub fn with_geomorph(mut self, geomorph: Geomorph) -> Self {
        self.geomorph = geomorph;
        self
    }

    /// With these limits.
    #[must_use]
    pub fn with_options(mut self, options: LodOptions) -> Self {
        self.set_options(options);
        self
    }

    /// Sets the limits for calls to come.
    pub fn set_options(&mut self, options: LodOptions) {
        self.lod.change_options(options, &mut self.moving);
    }

    /// Draws all that the last view asked for, every vertex at its place: after a cut to another camera, say.
    pub fn settle(&mut self) {
        self.lod.settle_with(&mut self.moving);
        self.moving.write(self.lod.surface_mut());
    }

    /// The instance without values.
    pub fn lod(&self) -> &HierarchyLod {
        &self.lod
    }

    /// The values that are drawn: of every vertex of the hierarchy, or where vertices are packed, of every slot.
    pub fn values(&self) -> &[V] {
        self.moving.drawn()
    }

    /// Where a vertex is, or would be if it were drawn; `None` out of range.
    pub fn value(&self, vertex: u32) -> Option<V> {
        ((vertex as usize) < self.lod.hierarchy().vertex_count()).then(|| self.moving.shown(vertex))
    }

    /// Number of vertices that move.
    pub fn moving(&self) -> usize {
        self.moving.len()
    }

    /// Moves to what a criterion of your own needs, `seconds` after the last call. `motion` is what has happened to the
    /// criterion since then.
    pub fn adapt_by<C: Criterion + ?Sized>(&mut self, criterion: &C, motion: Motion, seconds: f32) -> Change {
        let progress = self.geomorph.progress(seconds, motion, self.lod.hierarchy().diagonal());
        let change = self.lod.update_by(criterion, motion, progress, &mut self.moving);
        self.moving.write(self.lod.surface_mut());
        change
    }

    /// Bytes of this instance, what it shares with others not counted.
    pub fn memory(&self) -> usize {
        self.lod.memory() + self.moving.memory()
    }
}

impl<V: Blend + Copy> LevelOfDetail for MorphedLod<V> {
    fn adapt(&mut self, views: &[ObjectView]) -> Change {
        self.adapt_in(views, 1.0 / 60.0)
    }

    fn adapt_in(&mut self, views: &[ObjectView], seconds: f32) -> Change {
        let motion = self.lod.motion(views);
        let progress = self.geomorph.progress(seconds, motion, self.lod.hierarchy().diagonal());
        let change = self.lod.update_views(views, progress, &mut self.moving);
        self.moving.write(self.lod.surface_mut());
        change
    }

    fn groups(&self) -> usize {
        self.lod.groups()
    }

    fn triangles(&self, group: usize) -> &[[u32; 3]] {
        self.lod.triangles(group)
    }

    fn vertices(&self) -> Option<&[u32]> {
        self.lod.vertices()
    }

    fn dirty_triangles(&self, group: usize, gap: usize) -> DirtyRanges<'_> {
        self.lod.dirty_triangles(group, gap)
    }

    /// Of [`MorphedLod::values`], packed or not.
    fn dirty_vertices(&self, gap: usize) -> DirtyRanges<'_> {
        self.moving.dirty(gap)
    }

    fn clean(&mut self) {
        self.lod.clean();
        self.moving.clean();
    }
}
