//! One drawn instance of a vertex hierarchy: the cut that a view asks for, its triangles and its vertices.

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

/// One drawn instance of a [`VertexHierarchy`]. What is drawn is [`HierarchyLod::cut`] after every call, or where
/// [`LodOptions`] set limits, what has been reached on the way there: always a closed set of splits.
///
/// Where vertices move ([`LodOptions::geomorph`]), one that a split brings starts where its substitute is drawn and moves to
/// its own place; one that is to go moves to where its substitute is drawn, then the collapse takes place. Transitions may
/// overlap in space and time, and turn round from where they are. A change that [no view sees](Criterion::sees) is made at
/// once. Source: Hoppe 1998 (Smooth view-dependent level-of-detail control, section 5) for geomorphs that overlap.
///
/// Without a type of values it is of triangles alone ([`HierarchyLod::new`]): its vertex buffer has no bytes.
#[derive(Debug, Clone)]
pub struct HierarchyLod<V = ()> {
    hierarchy: Arc<VertexHierarchy>,
    /// The model that it is an instance of, for its vertices; `None` for triangles alone.
    model: Option<Baked<VertexHierarchy>>,
    driver: Driver,
    surface: CutSurface,
    vertices: Vertices<V>,
}

impl HierarchyLod {
    /// Triangles alone, for a buffer of all vertices of the hierarchy: indices name its vertices.
    pub fn new(hierarchy: Arc<VertexHierarchy>) -> Self {
        Self::bare(hierarchy, VertexBuffer::Shared)
    }

    /// Triangles alone, for a buffer of the vertices in use: indices name slots of [`Lod::vertices`].
    pub fn packed(hierarchy: Arc<VertexHierarchy>) -> Self {
        Self::bare(hierarchy, VertexBuffer::Packed)
    }

    fn bare(hierarchy: Arc<VertexHierarchy>, buffer: VertexBuffer) -> Self {
        let values = Values::none(hierarchy.vertex_count());
        Self::start(hierarchy, None, values, None, &LodOptions::default().with_buffer(buffer))
    }
}

/// How values are mixed, where options ask for that.
fn mix_for<V: Vertex>(values: &Values<V>, options: &LodOptions) -> Result<Option<Mix<V>>, LodError> {
    if options.geomorph.is_none() {
        return Ok(None);
    }
    values.mix().map(Some).ok_or(LodError::NeedsBlending { what: "a geomorph" })
}

impl<V: Vertex> HierarchyLod<V> {
    pub(super) fn of(
        model: &Baked<VertexHierarchy>,
        values: Values<V>,
        options: &LodOptions,
    ) -> Result<Self, LodError> {
        let (found, expected) = (values.len(), model.structure().vertex_count());
        if found != expected {
            return Err(LodError::Length { found, expected });
        }
        let mix = mix_for(&values, options)?;
        Ok(Self::start(Arc::clone(model.structure()), Some(model.clone()), values, mix, options))
    }

    /// At the coarsest level of detail. There are as many values as vertices.
    fn start(
        hierarchy: Arc<VertexHierarchy>,
        model: Option<Baked<VertexHierarchy>>,
        values: Values<V>,
        mix: Option<Mix<V>>,
        options: &LodOptions,
    ) -> Self {
        let cut = Cut::new(hierarchy.split_count(), hierarchy.diagonal(), hierarchy.has_dependencies());
        let mut surface = CutSurface::new(&hierarchy, options.buffer == VertexBuffer::Packed);
        let vertices = Vertices::new(values, &surface, mix, options.buffer == VertexBuffer::Shared);
        surface.clean_vertices();
        let mut lod = Self { hierarchy, model, driver: Driver::new(cut), surface, vertices };
        lod.apply(options);
        lod
    }

    /// Takes options that ask for nothing but what vertices and surface are made for.
    fn apply(&mut self, options: &LodOptions) {
        let Self { hierarchy, driver, surface, vertices, .. } = self;
        let hierarchy = &**hierarchy;
        driver.set_options(hierarchy, options, &mut Sink { hierarchy, surface, vertices }, |cut| {
            let splits = (0..hierarchy.split_count() as u32).filter(|&split| cut.holds(split));
            hierarchy.base_triangle_count() + splits.map(|split| hierarchy.owned(split).len()).sum::<usize>()
        });
    }

    /// Makes surface and vertices anew for other options. What was asked for is drawn, every vertex at its place.
    fn rebuild(&mut self, mix: Option<Mix<V>>, options: &LodOptions) {
        self.settle();
        let hierarchy = &*self.hierarchy;
        let packed = options.buffer == VertexBuffer::Packed;
        if packed != self.surface.vertices().is_some() {
            self.surface = CutSurface::at(hierarchy, packed, |split| self.driver.shows(split));
        }
        let values = self.vertices.values().clone();
        self.vertices = Vertices::new(values, &self.surface, mix, options.buffer == VertexBuffer::Shared);
        self.surface.clean_vertices();
        self.invalidate();
    }

    /// The structure.
    pub fn hierarchy(&self) -> &Arc<VertexHierarchy> {
        &self.hierarchy
    }

    /// Which splits the last view asked for, within the limit of triangles.
    pub fn cut(&self) -> &Cut {
        self.driver.cut()
    }

    /// Whether a split is drawn.
    pub fn shows(&self, split: u32) -> bool {
        self.driver.shows(split)
    }

    /// The vertex that stands for a vertex in what is drawn. O(hops to it); the vertex itself out of range.
    pub fn representative(&self, vertex: u32) -> u32 {
        if (vertex as usize) < self.hierarchy.vertex_count() {
            self.hierarchy.active(vertex, |split| self.shows(split))
        } else {
            vertex
        }
    }

    /// Its triangles.
    pub fn surface(&self) -> &CutSurface {
        &self.surface
    }

    /// The values that are drawn: of every vertex of the hierarchy, or where vertices are packed, of every slot.
    pub fn values(&self) -> &[V] {
        self.vertices.drawn()
    }

    /// Where a vertex is, or would be if it were drawn; `None` out of range.
    pub fn value(&self, vertex: u32) -> Option<V> {
        ((vertex as usize) < self.hierarchy.vertex_count()).then(|| self.vertices.shown(vertex))
    }

    /// Number of vertices that move.
    pub fn moving(&self) -> usize {
        self.vertices.moving()
    }

    /// Moves to what a criterion of your own needs, `seconds` after the last call. `motion` is what has happened to the
    /// criterion since then ([`Criterion::motion`]); [`Motion::Other`] where the last call was another's.
    pub fn adapt_by<C: Criterion + ?Sized>(&mut self, criterion: &C, motion: Motion, seconds: f32) -> Change {
        let Self { hierarchy, driver, surface, vertices, .. } = self;
        let hierarchy = &**hierarchy;
        let mut sink = Sink { hierarchy, surface, vertices };
        let diagonal = hierarchy.diagonal();
        let cost = |split: u32, _| hierarchy.owned(split).len();
        let change = driver.adapt_by(hierarchy, (criterion, motion, seconds, diagonal), &mut sink, cost);
        self.vertices.write(&mut self.surface);
        change
    }
}

impl<V: Vertex> Lod for HierarchyLod<V> {
    fn adapt(&mut self, views: &[ObjectView], seconds: f32) -> Change {
        let Self { hierarchy, driver, surface, vertices, .. } = self;
        let hierarchy = &**hierarchy;
        let mut sink = Sink { hierarchy, surface, vertices };
        let cost = |split: u32, _| hierarchy.owned(split).len();
        let change = driver.adapt(hierarchy, (views, seconds, hierarchy.diagonal()), &mut sink, cost);
        self.vertices.write(&mut self.surface);
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
        self.vertices.write(&mut self.surface);
    }

    fn options(&self) -> &LodOptions {
        self.driver.options()
    }

    fn set_options(&mut self, options: &LodOptions) -> Result<(), LodError> {
        let mix = mix_for(self.vertices.values(), options)?;
        let before = self.driver.options();
        let moves = mix.is_some() != before.geomorph.is_some();
        if moves || options.buffer != before.buffer {
            self.rebuild(mix, options);
        }
        self.apply(options);
        self.vertices.write(&mut self.surface);
        Ok(())
    }

    fn tolerance_factor(&self) -> f32 {
        self.driver.tolerance_factor()
    }

    fn set_tolerance_factor(&mut self, factor: f32) {
        self.driver.set_tolerance_factor(factor);
    }

    fn refinements(&self) -> usize {
        let splits = 0..self.hierarchy.split_count() as u32;
        splits.filter(|&split| self.cut().holds(split)).count()
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
