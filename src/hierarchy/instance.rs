//! One drawn instance of a vertex hierarchy: the cut that a view asks for, and its triangles.

use std::sync::Arc;

use crate::adapt::{Change, Cut, DirtyRanges, LevelOfDetail, LodOptions, Pace};
use crate::view::{Bounds, Criterion, Motion, ObjectView};

use super::drawn::{Drawn, Movement, direct};
use super::{Surface, VertexHierarchy};

/// One drawn instance. Many share one hierarchy; each is independent, and may move to another thread.
///
/// Starts at the coarsest level of detail, all of it dirty. What is drawn is [`HierarchyLod::cut`] after every call, or with
/// [`LodOptions`] what has been reached on the way there: always a closed set of splits.
#[derive(Debug, Clone)]
pub struct HierarchyLod {
    hierarchy: Arc<VertexHierarchy>,
    cut: Cut,
    surface: Surface,
    views: Vec<ObjectView>,
    options: LodOptions,
    /// `None` where what is asked for is drawn at once.
    pace: Option<Box<Pace>>,
    /// Whether vertices may move.
    moves: bool,
    /// Whether no answer of the cut holds any more.
    forgets: bool,
}

impl HierarchyLod {
    /// For a buffer of all vertices of the hierarchy, uploaded once: indices name its vertices.
    pub fn new(hierarchy: Arc<VertexHierarchy>) -> Self {
        Self::with(hierarchy, false, false)
    }

    /// For a buffer of the vertices in use alone: indices name slots of [`LevelOfDetail::vertices`].
    pub fn packed(hierarchy: Arc<VertexHierarchy>) -> Self {
        Self::with(hierarchy, true, false)
    }

    pub(super) fn with(hierarchy: Arc<VertexHierarchy>, packed: bool, moves: bool) -> Self {
        let mut lod = Self {
            cut: Cut::new(hierarchy.split_count(), hierarchy.diagonal(), hierarchy.has_needs()),
            surface: Surface::new(&hierarchy, packed),
            views: Vec::new(),
            options: LodOptions::default(),
            pace: None,
            moves,
            forgets: false,
            hierarchy,
        };
        lod.set_options(LodOptions::default());
        lod
    }

    /// With these limits.
    #[must_use]
    pub fn with_options(mut self, options: LodOptions) -> Self {
        self.set_options(options);
        self
    }

    /// Sets the limits for calls to come. Where they are lifted, what is still to come is drawn at once; where triangles are
    /// fewer than drawn, what is too much goes in the next call, whatever the number of operations.
    pub fn set_options(&mut self, options: LodOptions) {
        self.change_options(options, &mut ());
    }

    pub(super) fn change_options(&mut self, options: LodOptions, movement: &mut impl Movement) {
        let Self { hierarchy, cut, surface, pace, .. } = self;
        self.forgets |= options.triangles != self.options.triangles;
        self.options = options;
        if options == LodOptions::default() && !self.moves {
            if let Some(mut pace) = pace.take() {
                pace.settle(&**hierarchy, &mut Drawn { hierarchy, surface, movement });
            }
            return;
        }
        let drawn = surface.triangle_count();
        let pace = pace.get_or_insert_with(|| Box::new(Pace::new(&**hierarchy, cut, drawn, self.moves)));
        let splits = (0..hierarchy.split_count() as u32).filter(|&split| cut.holds(split));
        let wanted = splits.map(|split| hierarchy.owned(split).len()).sum::<usize>();
        pace.set(&options, hierarchy.base_triangle_count() + wanted);
    }

    /// The limits.
    pub fn options(&self) -> &LodOptions {
        &self.options
    }

    /// Draws all that the last view asked for, at once: after a cut to another camera, say.
    pub fn settle(&mut self) {
        self.settle_with(&mut ());
    }

    pub(super) fn settle_with(&mut self, movement: &mut impl Movement) {
        let Self { hierarchy, surface, pace, .. } = self;
        if let Some(pace) = pace {
            pace.settle(&**hierarchy, &mut Drawn { hierarchy, surface, movement });
        }
    }

    /// The structure.
    pub fn hierarchy(&self) -> &Arc<VertexHierarchy> {
        &self.hierarchy
    }

    /// Which splits the last view asked for, within the budget of triangles.
    pub fn cut(&self) -> &Cut {
        &self.cut
    }

    /// Whether a split is drawn.
    pub fn shows(&self, split: u32) -> bool {
        self.pace.as_ref().map_or_else(|| self.cut.holds(split), |pace| pace.shows(split))
    }

    /// The vertex that stands for a vertex in what is drawn. O(hops to it); the vertex itself out of range.
    pub fn stand_in(&self, vertex: u32) -> u32 {
        if (vertex as usize) < self.hierarchy.vertex_count() {
            self.hierarchy.active(vertex, |split| self.shows(split))
        } else {
            vertex
        }
    }

    /// Its triangles.
    pub fn surface(&self) -> &Surface {
        &self.surface
    }

    pub(super) fn surface_mut(&mut self) -> &mut Surface {
        &mut self.surface
    }

    /// Moves the cut to what a criterion of your own needs. `motion` is what has happened to the criterion since the last
    /// call ([`Criterion::motion`]); [`Motion::Other`] where the last call was another's.
    pub fn adapt_by<C: Criterion + ?Sized>(&mut self, criterion: &C, motion: Motion) -> Change {
        self.update_by(criterion, motion, 1.0, &mut ())
    }

    pub(super) fn update_by<C: Criterion + ?Sized>(
        &mut self,
        criterion: &C,
        motion: Motion,
        progress: f32,
        movement: &mut impl Movement,
    ) -> Change {
        self.views.clear();
        self.update(criterion, motion, progress, movement)
    }

    /// What has happened to the views since the last call.
    pub(super) fn motion(&self, views: &[ObjectView]) -> Motion {
        if self.views.is_empty() { Motion::Other } else { Criterion::<Bounds>::motion(views, &self.views) }
    }

    pub(super) fn update_views(
        &mut self,
        views: &[ObjectView],
        progress: f32,
        movement: &mut impl Movement,
    ) -> Change {
        let change = self.update(views, self.motion(views), progress, movement);
        self.views.clear();
        self.views.extend_from_slice(views);
        change
    }

    fn update<C: Criterion + ?Sized>(
        &mut self,
        criterion: &C,
        motion: Motion,
        progress: f32,
        movement: &mut impl Movement,
    ) -> Change {
        let motion = if std::mem::take(&mut self.forgets) { Motion::Other } else { motion };
        let Self { hierarchy, cut, surface, pace, .. } = self;
        let hierarchy = &**hierarchy;
        let Some(pace) = pace else { return direct((hierarchy, cut, surface), criterion, motion) };
        let cost = |split: u32, _| hierarchy.owned(split).len();
        let mut picture = Drawn { hierarchy, surface, movement };
        pace.update((hierarchy, cut), &mut picture, criterion, motion, progress, cost)
    }

    /// Bytes of this instance, the shared hierarchy not counted.
    pub fn memory(&self) -> usize {
        self.cut.memory() + self.surface.memory() + self.pace.as_ref().map_or(0, |pace| pace.memory())
    }
}

impl LevelOfDetail for HierarchyLod {
    fn adapt(&mut self, views: &[ObjectView]) -> Change {
        self.update_views(views, 1.0, &mut ())
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
