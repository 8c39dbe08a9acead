//! A drawn instance of a vertex hierarchy: the cut asked for by a view, with triangles and vertices.

use std::sync::Arc;

use crate::adapt::{Change, Cut, DirtyRanges};
use crate::lod::{
    Baked, Draws, Driver, Everything, Lod, LodError, LodOptions, Mix, Uploads, Values, Vertex, VertexBuffer,
};
use crate::mesh::{Mesh, NONE};
use crate::view::{Criterion, Motion, ObjectView};

use super::sink::Sink;
use super::vertices::Vertices;
use super::{CutSurface, VertexHierarchy};

/// A drawn instance of a [`VertexHierarchy`]. After every call the drawn mesh is [`HierarchyLod::cut`]. If [`LodOptions`]
/// set limits, it is the mesh reached on the way to the cut. The drawn splits are always a closed set.
///
/// If vertices move ([`LodOptions::geomorph`]), a vertex brought by a split starts where its substitute is drawn, and
/// moves to its own place. Before a collapse, its vertices move to where their substitutes are drawn. Transitions may
/// overlap in space and time, and may be reversed at any point. A change that [no view sees](Criterion::sees) is made at
/// once. Source of overlapping geomorphs: Hoppe 1998 (Smooth view-dependent level-of-detail control, section 5).
///
/// Without a type of values, an instance has triangles alone ([`HierarchyLod::new`]), and its vertex buffer has no bytes.
///
/// ```
/// use multires::hierarchy::{HierarchyLod, VertexHierarchy};
/// use multires::{Lod, Structure, mesh::shapes};
///
/// // Triangles alone, over a vertex buffer of the application's own.
/// let model = VertexHierarchy::bake(&shapes::icosphere(3))?;
/// let mut lod = HierarchyLod::new(model.structure().clone());
/// let base = lod.triangles(0).len();
/// lod.refine_fully();
/// assert!(lod.triangles(0).len() > base);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct HierarchyLod<V = ()> {
    hierarchy: Arc<VertexHierarchy>,
    /// The model, for its vertices; `None` for triangles alone.
    model: Option<Baked<VertexHierarchy>>,
    driver: Driver,
    surface: CutSurface,
    vertices: Vertices<V>,
}

impl HierarchyLod {
    /// Creates an instance of triangles alone, for a buffer of all vertices. Indices name vertices of the hierarchy.
    pub fn new(hierarchy: Arc<VertexHierarchy>) -> Self {
        Self::bare(hierarchy, VertexBuffer::Shared)
    }

    /// Creates an instance of triangles alone, for a buffer of the vertices in use. Indices name slots of
    /// [`Lod::vertices`].
    pub fn packed(hierarchy: Arc<VertexHierarchy>) -> Self {
        Self::bare(hierarchy, VertexBuffer::Packed)
    }

    fn bare(hierarchy: Arc<VertexHierarchy>, buffer: VertexBuffer) -> Self {
        let values = Values::none(hierarchy.vertex_count());
        Self::start(hierarchy, None, values, None, &LodOptions::default().with_buffer(buffer))
    }
}

impl<V: Vertex> HierarchyLod<V> {
    pub(super) fn of(
        model: &Baked<VertexHierarchy>,
        values: Values<V>,
        options: &LodOptions,
    ) -> Result<Self, LodError> {
        values.check(model.structure().vertex_count())?;
        let mix = values.mix_for(options)?;
        Ok(Self::start(Arc::clone(model.structure()), Some(model.clone()), values, mix, options))
    }

    /// Starts at the coarsest level of detail. There must be as many values as vertices.
    fn start(
        hierarchy: Arc<VertexHierarchy>,
        model: Option<Baked<VertexHierarchy>>,
        values: Values<V>,
        mix: Option<Mix<V>>,
        options: &LodOptions,
    ) -> Self {
        let cut = Cut::new(hierarchy.split_count(), hierarchy.diagonal(), hierarchy.has_dependencies());
        let mut surface = CutSurface::new(&hierarchy, options.buffer == VertexBuffer::Packed);
        let (places, shared) = (model.as_ref().map(Baked::vertices), options.buffer == VertexBuffer::Shared);
        let vertices = Vertices::new(values, places, &surface, mix, shared);
        surface.clean_vertices();
        let mut lod = Self { hierarchy, model, driver: Driver::new(cut), surface, vertices };
        lod.apply(options);
        lod
    }

    /// Applies options which need no new surface and no new vertices.
    fn apply(&mut self, options: &LodOptions) {
        let Self { hierarchy, driver, surface, vertices, .. } = self;
        let hierarchy = &**hierarchy;
        driver.set_options(hierarchy, options, &mut Sink { hierarchy, surface, vertices }, |cut| {
            hierarchy.base_triangle_count()
                + cut.refinements().map(|split| hierarchy.owned(split).len()).sum::<usize>()
        });
    }

    /// Builds surface and vertices anew for other options. All pending changes are drawn at once, with every vertex at
    /// its place.
    fn rebuild(&mut self, mix: Option<Mix<V>>, options: &LodOptions) {
        self.settle();
        let hierarchy = &*self.hierarchy;
        let packed = options.buffer == VertexBuffer::Packed;
        if packed != self.surface.vertices().is_some() {
            self.surface = CutSurface::at(hierarchy, packed, |split| self.driver.shows(split));
        }
        let values = self.vertices.values().clone();
        let places = self.model.as_ref().map(Baked::vertices);
        self.vertices =
            Vertices::new(values, places, &self.surface, mix, options.buffer == VertexBuffer::Shared);
        self.surface.clean_vertices();
        self.invalidate();
    }

    /// Writes the vertices that changed.
    fn write(&mut self) {
        let Self { surface, vertices, .. } = self;
        vertices.write(surface);
        surface.sweep();
    }

    /// Gives back memory if most of it is not in use.
    fn trim(&mut self) {
        let Self { driver, surface, vertices, .. } = self;
        driver.trim();
        surface.trim();
        vertices.trim(surface);
    }

    /// Returns the structure.
    pub fn hierarchy(&self) -> &Arc<VertexHierarchy> {
        &self.hierarchy
    }

    /// Returns the splits asked for by the last view, within the limit of triangles, and the splits they need.
    pub fn cut(&self) -> &Cut {
        self.driver.cut()
    }

    /// Whether a split is drawn.
    pub fn shows(&self, split: u32) -> bool {
        self.driver.shows(split)
    }

    /// Returns the vertex drawn in place of `vertex`. O(hops to it). Returns `vertex` itself if it is out of range.
    pub fn representative(&self, vertex: u32) -> u32 {
        if (vertex as usize) < self.hierarchy.vertex_count() {
            self.hierarchy.active(vertex, |split| self.shows(split))
        } else {
            vertex
        }
    }

    /// Returns the drawn triangles.
    pub fn surface(&self) -> &CutSurface {
        &self.surface
    }

    /// Returns the drawn values: of every vertex of the hierarchy, or, if vertices are packed, of every slot.
    pub fn values(&self) -> &[V] {
        self.vertices.drawn()
    }

    /// Returns the current value of a vertex, drawn or not; `None` if it is out of range.
    pub fn value(&self, vertex: u32) -> Option<V> {
        ((vertex as usize) < self.hierarchy.vertex_count()).then(|| self.vertices.shown(vertex))
    }

    /// Number of moving vertices.
    pub fn moving(&self) -> usize {
        self.vertices.moving()
    }

    /// Adapts to a custom criterion, `seconds` after the last call. `motion` is the criterion's motion since the last
    /// call ([`Criterion::motion`]). Use [`Motion::Other`] if the last call had another criterion.
    pub fn adapt_by<C: Criterion + ?Sized>(&mut self, criterion: &C, motion: Motion, seconds: f32) -> Change {
        let Self { hierarchy, driver, surface, vertices, .. } = self;
        let hierarchy = &**hierarchy;
        let mut sink = Sink { hierarchy, surface, vertices };
        let diagonal = hierarchy.diagonal();
        let cost = |split: u32, _| hierarchy.owned(split).len();
        let change = driver.adapt_by(hierarchy, (criterion, motion, seconds, diagonal), &mut sink, cost);
        self.write();
        change
    }
}

impl<V: Vertex> Lod for HierarchyLod<V> {
    fn adapt_at_rest(&mut self, views: &[ObjectView]) -> Option<Change> {
        let (change, waited) = self.driver.at_rest(views)?;
        if waited {
            self.trim();
        }
        Some(change)
    }

    fn adapt(&mut self, views: &[ObjectView], seconds: f32) -> Change {
        if let Some(change) = self.adapt_at_rest(views) {
            return change;
        }
        let Self { hierarchy, driver, surface, vertices, .. } = self;
        let hierarchy = &**hierarchy;
        let mut sink = Sink { hierarchy, surface, vertices };
        let cost = |split: u32, _| hierarchy.owned(split).len();
        let change = driver.adapt(hierarchy, (views, seconds, hierarchy.diagonal()), &mut sink, cost);
        self.write();
        if self.driver.waited(&change) {
            self.trim();
        }
        change
    }

    fn refine_fully(&mut self) -> Change {
        let change = self.adapt_by(&Everything, Motion::Other, f32::INFINITY);
        self.settle();
        Change { triangles: self.surface.triangle_count(), pending: 0, moving: 0, ..change }
    }

    fn settle(&mut self) {
        let Self { hierarchy, driver, surface, vertices, .. } = self;
        driver.settle(&**hierarchy, &mut Sink { hierarchy, surface, vertices });
        self.write();
    }

    fn options(&self) -> &LodOptions {
        self.driver.options()
    }

    fn set_options(&mut self, options: &LodOptions) -> Result<(), LodError> {
        let mix = self.vertices.values().mix_for(options)?;
        let before = self.driver.options();
        let moves = mix.is_some() != before.geomorph.is_some();
        if moves || options.buffer != before.buffer {
            self.rebuild(mix, options);
        }
        self.apply(options);
        self.write();
        Ok(())
    }

    fn tolerance_factor(&self) -> f32 {
        self.driver.tolerance_factor()
    }

    fn set_tolerance_factor(&mut self, factor: f32) {
        self.driver.set_tolerance_factor(factor);
    }

    fn refinements(&self) -> usize {
        self.cut().refinements().count()
    }

    fn groups(&self) -> usize {
        self.surface.groups()
    }

    fn material(&self, group: usize) -> u32 {
        self.hierarchy.materials().get(group).copied().unwrap_or(NONE)
    }

    fn triangles(&self, group: usize) -> &[[u32; 3]] {
        self.surface.triangles(group)
    }

    fn vertices(&self) -> Option<&[u32]> {
        self.surface.vertices()
    }

    fn vertex_bytes(&self) -> &[u8] {
        bytemuck::cast_slice(self.vertices.drawn())
    }

    fn vertex_size(&self) -> usize {
        size_of::<V>()
    }

    fn shares_vertices(&self) -> bool {
        self.vertices.is_shared()
    }

    fn dirty_triangles(&self, group: usize, gap: usize) -> DirtyRanges<'_> {
        self.surface.dirty_triangles(group, gap)
    }

    fn dirty_vertices(&self, gap: usize) -> DirtyRanges<'_> {
        self.vertices.dirty(gap)
    }

    fn uploads(&self) -> Uploads<'_> {
        Uploads::new(self)
    }

    fn draws(&self) -> Draws<'_> {
        Draws::new(self)
    }

    fn clean(&mut self) {
        self.surface.clean();
        self.vertices.clean();
    }

    fn invalidate(&mut self) {
        self.surface.invalidate();
        self.vertices.invalidate();
    }

    fn to_mesh(&self) -> Mesh {
        let model = self.model.as_ref();
        model.map_or_else(Mesh::default, |model| self.hierarchy.mesh_of(model.vertices(), &self.surface))
    }

    fn memory(&self) -> usize {
        self.driver.memory() + self.surface.memory() + self.vertices.memory()
    }
}
