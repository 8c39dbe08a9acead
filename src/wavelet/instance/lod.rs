//! A drawn instance of a wavelet mesh: the cut requested by a view, its triangles and its vertices.

use std::sync::Arc;

use crate::adapt::{AT_REST, Change, Cut, DirtyRanges, RefinementSink, Weights};
use crate::lod::{
    Draws, Driver, Everything, Lod, LodError, LodOptions, Triangulation, Uploads, Values, Vertex,
    VertexBuffer,
};
use crate::mesh::{Mesh, NONE};
use crate::view::{Criterion, DeviationBounds, Motion, ObjectView};
use crate::wavelet::{DetailFrame, Edited, Normals, WaveletError, WaveletMesh};

use super::surface::WaveletSurface;
use super::use_counts::UseCounts;
use super::vertices::Vertices;

/// A drawn instance of a [`WaveletMesh`], with the values of its vertices.
///
/// A vertex may be in use only because a neighbouring wavelet splits a face. It then lies on the surface, in the middle of its
/// ends. So values change even without geomorphs, and must be blendable ([`Values::with_blending`]). With
/// [`Triangulation::Minimal`] no such vertices exist. Blended normals are slightly shorter than 1.
///
/// With [`LodOptions::geomorph`] coefficients grow and shrink (Azuma et al., equation 6). Transitions may overlap in space and
/// time, and may reverse midway. Changes [seen by no view](Criterion::sees) happen at once.
///
/// ```
/// use multires::{Lod, LodOptions, Structure, adapt::Geomorph, mesh::shapes, wavelet::WaveletMesh};
///
/// let mesh = shapes::icosphere(3);
/// let model = WaveletMesh::bake(&mesh)?;
/// let values = model.arrange(mesh.positions())?.with_blending();
/// let mut lod = model.instance(values, &LodOptions::default().with_geomorph(Geomorph::default()))?;
/// assert_eq!(lod.triangles(0).len(), 20);
/// lod.refine_fully();
/// assert_eq!(lod.triangles(0).len(), mesh.triangles().len());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct WaveletLod<V> {
    mesh: Arc<WaveletMesh>,
    driver: Driver<DeviationBounds>,
    shown: Shown<V>,
    /// Use counts of the cut; only with a limit of triangles.
    asked: Option<Box<UseCounts>>,
}

/// The triangles and vertices drawn.
#[derive(Debug, Clone)]
struct Shown<V> {
    surface: WaveletSurface,
    vertices: Vertices<V>,
}

impl<V: Vertex> Shown<V> {
    fn new(mesh: &WaveletMesh, values: Values<V>, options: &LodOptions) -> Self {
        let of = mesh.subdivision();
        let packed = options.buffer == VertexBuffer::Packed;
        let mut shown = Self {
            surface: WaveletSurface::new(of, options.triangulation, mesh.groups()),
            vertices: Vertices::new(of, values, packed),
        };
        shown.write(mesh, &AT_REST);
        shown
    }

    fn change(&mut self, mesh: &WaveletMesh, wavelet: u32, comes: bool) {
        self.surface.change(mesh.subdivision(), wavelet, comes);
        self.vertices.set(wavelet, comes);
    }

    fn write(&mut self, mesh: &WaveletMesh, weights: &Weights) {
        let Self { surface, vertices } = self;
        vertices.update(mesh.subdivision(), surface, weights);
        surface.write(mesh.subdivision(), |vertex| vertices.name(vertex), |base_face| mesh.group(base_face));
    }
}

/// A mesh, and what is drawn of it.
struct Sink<'a, V> {
    mesh: &'a WaveletMesh,
    shown: &'a mut Shown<V>,
}

impl<V: Vertex> RefinementSink for Sink<'_, V> {
    fn triangles(&self) -> usize {
        self.shown.surface.triangle_count()
    }

    fn cost(&self, wavelet: u32) -> usize {
        let comes = !self.shown.vertices.is_set(wavelet);
        self.shown.surface.uses().cost(self.mesh.subdivision(), wavelet, comes)
    }

    fn advance(&mut self, weights: &Weights) {
        self.shown.vertices.advance(self.mesh.subdivision(), weights);
    }

    fn refine(&mut self, wavelet: u32, _smoothly: bool, _: impl Fn(u32) -> bool + Copy) {
        self.shown.change(self.mesh, wavelet, true);
    }

    fn coarsen(&mut self, wavelet: u32) {
        self.shown.change(self.mesh, wavelet, false);
    }

    /// Nothing to do: vertices are placed by the weight, which turns by itself.
    fn turn(&mut self, _: u32) {}
}

/// Fails if the options need blending and the values cannot be blended.
fn check<V>(values: &Values<V>, options: &LodOptions) -> Result<(), LodError> {
    let what = match options {
        LodOptions { geomorph: Some(_), .. } => "a geomorph",
        LodOptions { triangulation: Triangulation::Exact, .. } => "the exact triangulation of a wavelet mesh",
        _ => return Ok(()),
    };
    if values.can_blend() { Ok(()) } else { Err(LodError::NeedsBlending { what }) }
}

impl<V: Vertex> WaveletLod<V> {
    /// Makes an instance drawing the base mesh. `values` has a value for each vertex of the mesh at its own place, in the order
    /// of [`WaveletMesh::vertices`]; instances share it.
    ///
    /// # Errors
    /// The number of values differs from the number of vertices, or the options need blending and the values cannot be blended.
    pub fn new(
        mesh: Arc<WaveletMesh>,
        values: impl Into<Values<V>>,
        options: &LodOptions,
    ) -> Result<Self, LodError> {
        let values = values.into();
        values.check(mesh.subdivision().vertex_count())?;
        check(&values, options)?;
        let cut = Cut::new(mesh.subdivision().wavelet_count(), mesh.diagonal(), false);
        let shown = Shown::new(&mesh, values, options);
        let mut lod = Self { driver: Driver::new(cut), shown, asked: None, mesh };
        lod.apply(options);
        Ok(lod)
    }

    /// Applies options without rebuilding triangles and vertices.
    fn apply(&mut self, options: &LodOptions) {
        let Self { mesh, driver, shown, asked, .. } = self;
        let of = mesh.subdivision();
        driver.set_options(&**mesh, options, &mut Sink { mesh, shown }, |cut| {
            let mut triangles = 0;
            *asked = options.triangles.map(|_| {
                let mut uses = UseCounts::new(of, options.triangulation);
                triangles = of.base_face_count();
                for wavelet in (0..of.wavelet_count() as u32).filter(|&wavelet| cut.holds(wavelet)) {
                    triangles += uses.change(of, wavelet, true, &mut ());
                }
                Box::new(uses)
            });
            triangles
        });
        if options.triangles.is_none() {
            self.asked = None;
        }
        self.shown.write(&self.mesh, self.driver.weights());
    }

    /// Gives back memory if most of it is not in use.
    fn trim(&mut self) {
        self.driver.trim();
        if let Some(asked) = &mut self.asked {
            asked.trim();
        }
        self.shown.surface.trim();
        self.shown.vertices.trim();
    }

    /// Rebuilds triangles and vertices for other options. Finishes transitions: the cut is drawn, every vertex at its place.
    fn rebuild(&mut self, options: &LodOptions) {
        self.settle();
        let values = self.shown.vertices.values_at_rest().clone();
        let mut shown = Shown::new(&self.mesh, values, options);
        let wavelets = 0..self.mesh.subdivision().wavelet_count() as u32;
        for wavelet in wavelets.filter(|&wavelet| self.shown.vertices.is_set(wavelet)) {
            shown.change(&self.mesh, wavelet, true);
        }
        shown.write(&self.mesh, &AT_REST);
        shown.surface.invalidate();
        shown.vertices.invalidate();
        self.shown = shown;
    }

    /// Edits the mesh ([`WaveletMesh::edit`]) and draws the result; `value` returns the new values of moved vertices. The next
    /// adapt call tests everything drawn.
    ///
    /// Edits in place where nothing else shares the mesh and the values. Otherwise edits a copy, O(n), kept by this instance:
    /// pass it to other instances by [`replace`](Self::replace).
    ///
    /// # Errors
    /// The errors of [`WaveletMesh::edit`]; then nothing has changed.
    pub fn edit(
        &mut self,
        level: usize,
        moves: &[(u32, [f32; 3])],
        frame: DetailFrame,
        mut value: impl FnMut(&WaveletMesh, u32) -> V,
    ) -> Result<Edited, WaveletError> {
        let edited = Arc::make_mut(&mut self.mesh).edit(level, moves, frame)?;
        let values = Arc::make_mut(self.shown.vertices.own_values().shared_mut());
        for &vertex in &edited.vertices {
            values[vertex as usize] = value(&self.mesh, vertex);
        }
        self.revalue(&edited.vertices);
        Ok(edited)
    }

    /// Draws an edited mesh of the same connectivity instead. `changed` lists the vertices with new values, in any order. The
    /// cut and transitions stay. The next adapt call tests everything drawn.
    ///
    /// O(changed); if `mesh` is another allocation, connectivities are compared, O(n).
    ///
    /// # Errors
    /// The mesh has another connectivity or other materials, the number of values differs from the number of vertices, or
    /// `changed` has a missing vertex. Then nothing has changed.
    pub fn replace(
        &mut self,
        mesh: Arc<WaveletMesh>,
        values: impl Into<Arc<[V]>>,
        changed: &[u32],
    ) -> Result<(), WaveletError> {
        let values = values.into();
        if !Arc::ptr_eq(&mesh, &self.mesh) && !mesh.is_like(&self.mesh) {
            return Err(WaveletError::Invalid { what: "another connectivity or other materials", at: 0 });
        }
        let (found, expected) = (values.len(), mesh.subdivision().vertex_count());
        if found != expected {
            return Err(WaveletError::Length { what: "values", found, expected });
        }
        if let Some(&vertex) = changed.iter().find(|&&vertex| vertex as usize >= expected) {
            return Err(WaveletError::Invalid { what: "there is no such vertex", at: vertex as usize });
        }
        self.mesh = mesh;
        *self.shown.vertices.own_values().shared_mut() = values;
        self.revalue(changed);
        Ok(())
    }

    /// Handles new values of vertices, and possibly new bounds.
    fn revalue(&mut self, changed: &[u32]) {
        let Shown { surface, vertices } = &mut self.shown;
        vertices.revalue(self.mesh.subdivision(), surface, changed);
        self.shown.write(&self.mesh, self.driver.weights());
        self.driver.forget();
    }

    /// Values of all vertices at their own places, drawn or not.
    pub fn own_values(&self) -> &Values<V> {
        self.shown.vertices.values_at_rest()
    }

    /// The mesh drawn.
    pub fn mesh(&self) -> &Arc<WaveletMesh> {
        &self.mesh
    }

    /// Wavelets requested by the last view, within the limit of triangles.
    pub fn cut(&self) -> &Cut<DeviationBounds> {
        self.driver.cut()
    }

    /// Whether a wavelet is drawn, including wavelets in transition.
    pub fn shows(&self, wavelet: u32) -> bool {
        (wavelet as usize) < self.mesh.subdivision().wavelet_count() && self.shown.vertices.is_set(wavelet)
    }

    /// Values as drawn. Unpacked: of every vertex of the mesh, possibly out of date for vertices of no triangle. Packed: of
    /// every slot.
    pub fn values(&self) -> &[V] {
        self.shown.vertices.drawn()
    }

    /// Returns the value of a vertex as drawn; at its own place if it is not drawn. `None` out of range.
    pub fn value(&self, vertex: u32) -> Option<V> {
        let known = (vertex as usize) < self.mesh.subdivision().vertex_count();
        known.then(|| self.shown.vertices.value(&self.shown.surface, self.mesh.subdivision(), vertex))
    }

    /// Number of wavelets in transition.
    pub fn moving(&self) -> usize {
        self.driver.weights().len()
    }

    /// Per triangle of a group, its base face, for textures by base face. O(level) a triangle.
    pub fn base_faces(&self, group: usize) -> impl Iterator<Item = u32> + '_ {
        self.shown.surface.faces(group).map(|face| self.mesh.subdivision().base_face_of(face))
    }

    /// Per triangle of a group, the level of its face.
    pub fn levels(&self, group: usize) -> impl Iterator<Item = usize> + '_ {
        self.shown.surface.faces(group).map(|face| self.mesh.subdivision().level_of_face(face))
    }

    /// Copies what is drawn to a mesh, with transitions finished: equal cuts give equal meshes. O(n).
    pub fn to_mesh_with(&self, normals: Normals) -> Mesh {
        self.mesh.extract(|wavelet| self.shows(wavelet), self.driver.options().triangulation, normals)
    }

    /// Adapts the cut to your own criterion, `seconds` after the last call. `motion` describes how the criterion has changed
    /// since then ([`Criterion::motion`]); pass [`Motion::Other`] after a call with another criterion.
    pub fn adapt_by<C: Criterion<DeviationBounds> + ?Sized>(
        &mut self,
        criterion: &C,
        motion: Motion,
        seconds: f32,
    ) -> Change {
        let diagonal = self.mesh.diagonal();
        self.drive(|driver, mesh, sink, cost| {
            driver.adapt_by(mesh, (criterion, motion, seconds, diagonal), sink, cost)
        })
    }

    /// Runs the driver on what is drawn.
    fn drive(
        &mut self,
        go: impl FnOnce(
            &mut Driver<DeviationBounds>,
            &WaveletMesh,
            &mut Sink<'_, V>,
            &mut dyn FnMut(u32, bool) -> usize,
        ) -> Change,
    ) -> Change {
        let Self { mesh, driver, shown, asked } = self;
        let mut cost = |wavelet: u32, comes: bool| {
            let uses = asked.as_mut();
            uses.map_or(0, |uses| uses.change(mesh.subdivision(), wavelet, comes, &mut ()))
        };
        let mut change = go(driver, mesh, &mut Sink { mesh, shown }, &mut cost);
        shown.write(mesh, driver.weights());
        change.triangles = shown.surface.triangle_count();
        change
    }
}

impl<V: Vertex> Lod for WaveletLod<V> {
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
        let diagonal = self.mesh.diagonal();
        let change =
            self.drive(|driver, mesh, sink, cost| driver.adapt(mesh, (views, seconds, diagonal), sink, cost));
        self.driver.rest_at(change.triangles);
        if self.driver.waited(&change) {
            self.trim();
        }
        change
    }

    fn refine_fully(&mut self) -> Change {
        let change = self.adapt_by(&Everything, Motion::Other, f32::INFINITY);
        self.settle();
        Change { triangles: self.shown.surface.triangle_count(), pending: 0, moving: 0, ..change }
    }

    fn settle(&mut self) {
        let Self { mesh, driver, shown, .. } = self;
        driver.settle(&**mesh, &mut Sink { mesh, shown });
        self.shown.write(&self.mesh, self.driver.weights());
    }

    fn options(&self) -> &LodOptions {
        self.driver.options()
    }

    fn set_options(&mut self, options: &LodOptions) -> Result<(), LodError> {
        check(self.own_values(), options)?;
        let before = *self.driver.options();
        let packed = |options: &LodOptions| options.buffer == VertexBuffer::Packed;
        if packed(options) != packed(&before)
            || options.triangulation != before.triangulation
            || options.geomorph.is_some() != before.geomorph.is_some()
        {
            self.rebuild(options);
        } else if options.buffer != before.buffer {
            self.invalidate();
        }
        self.apply(options);
        Ok(())
    }

    fn tolerance_factor(&self) -> f32 {
        self.driver.tolerance_factor()
    }

    fn set_tolerance_factor(&mut self, factor: f32) {
        self.driver.set_tolerance_factor(factor);
    }

    fn refinements(&self) -> usize {
        let wavelets = 0..self.mesh.subdivision().wavelet_count() as u32;
        wavelets.filter(|&wavelet| self.cut().holds(wavelet)).count()
    }

    fn groups(&self) -> usize {
        self.shown.surface.groups()
    }

    fn material(&self, group: usize) -> u32 {
        self.mesh.materials().get(group).copied().unwrap_or(NONE)
    }

    fn triangles(&self, group: usize) -> &[[u32; 3]] {
        self.shown.surface.triangles(group)
    }

    fn vertices(&self) -> Option<&[u32]> {
        self.shown.vertices.vertices()
    }

    fn vertex_bytes(&self) -> &[u8] {
        bytemuck::cast_slice(self.shown.vertices.drawn())
    }

    fn vertex_size(&self) -> usize {
        size_of::<V>()
    }

    /// Returns false: values depend on the neighbouring wavelets drawn.
    fn shares_vertices(&self) -> bool {
        false
    }

    fn dirty_triangles(&self, group: usize, gap: usize) -> DirtyRanges<'_> {
        self.shown.surface.dirty(group, gap)
    }

    fn dirty_vertices(&self, gap: usize) -> DirtyRanges<'_> {
        self.shown.vertices.dirty(gap)
    }

    fn uploads(&self) -> Uploads<'_> {
        Uploads::new(self)
    }

    fn draws(&self) -> Draws<'_> {
        Draws::new(self)
    }

    fn clean(&mut self) {
        self.shown.surface.clean();
        self.shown.vertices.clean();
    }

    fn invalidate(&mut self) {
        self.shown.surface.invalidate();
        self.shown.vertices.invalidate();
    }

    fn to_mesh(&self) -> Mesh {
        self.to_mesh_with(Normals::Kept)
    }

    fn memory(&self) -> usize {
        self.driver.memory()
            + self.shown.surface.memory()
            + self.shown.vertices.memory()
            + self.asked.as_ref().map_or(0, |asked| asked.memory())
    }
}
