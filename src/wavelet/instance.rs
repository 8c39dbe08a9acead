//! One drawn instance of a wavelet mesh: the cut that a view asks for, its triangles and its vertices.

use std::sync::Arc;

use crate::adapt::{Change, Cut, DirtyRanges, RefinementSink};
use crate::lod::{
    Draws, Driver, Everything, Lod, LodError, LodOptions, Triangulation, Uploads, Values, Vertex,
    VertexBuffer,
};
use crate::mesh::{Mesh, NONE};
use crate::view::{Criterion, DeviationBounds, Motion, ObjectView};

use super::surface::WaveletSurface;
use super::use_counts::UseCounts;
use super::vertices::Vertices;
use super::{DetailFrame, Edited, Normals, WaveletError, WaveletMesh};

/// One drawn instance of a [`WaveletMesh`], with the values of its vertices.
///
/// Vertices that are there only because a neighbouring wavelet splits a face lie on the surface, in the middle of their ends, so
/// values change even where nothing morphs, and instances must know how two are mixed ([`Values::with_blending`]); with
/// [`Triangulation::Minimal`] there are none such. Normals between two others come out a little short.
///
/// With [`LodOptions::geomorph`] coefficients grow and shrink (Azuma et al., equation 6): transitions may overlap in space and
/// time and turn round where they are; what [no view sees](Criterion::sees) changes at once.
#[derive(Debug, Clone)]
pub struct WaveletLod<V> {
    mesh: Arc<WaveletMesh>,
    driver: Driver,
    shown: Shown<V>,
    /// What the cut has, where triangles are limited.
    asked: Option<Box<UseCounts>>,
}

/// What is drawn.
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
            vertices: Vertices::new(of, values, packed, options.geomorph.is_some()),
        };
        shown.write(mesh);
        shown
    }

    fn change(&mut self, mesh: &WaveletMesh, wavelet: u32, comes: bool) {
        self.surface.change(mesh.subdivision(), wavelet, comes);
        self.vertices.set(wavelet, comes);
    }

    fn write(&mut self, mesh: &WaveletMesh) {
        let Self { surface, vertices } = self;
        vertices.update(mesh.subdivision(), surface);
        surface.write(mesh.subdivision(), |vertex| vertices.name(vertex), |base_face| mesh.group(base_face));
    }
}

/// What is drawn, of which mesh.
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

    fn advance(&mut self, progress: f32) {
        self.shown.vertices.advance(self.mesh.subdivision(), progress);
    }

    fn refine(&mut self, wavelet: u32, smoothly: bool, _: impl Fn(u32) -> bool + Copy) {
        self.shown.change(self.mesh, wavelet, true);
        if smoothly {
            self.shown.vertices.start(wavelet, 1.0, true);
        }
    }

    fn coarsen(&mut self, wavelet: u32) {
        self.shown.vertices.end(wavelet);
        self.shown.change(self.mesh, wavelet, false);
    }

    fn close(&mut self, wavelet: u32) {
        self.shown.vertices.start(wavelet, 0.0, false);
    }

    fn reopen(&mut self, wavelet: u32) {
        self.shown.vertices.start(wavelet, 1.0, false);
    }
}

/// Whether values can be mixed where options ask for that.
fn check<V>(values: &Values<V>, options: &LodOptions) -> Result<(), LodError> {
    let what = match options {
        LodOptions { geomorph: Some(_), .. } => "a geomorph",
        LodOptions { triangulation: Triangulation::Exact, .. } => "the exact triangulation of a wavelet mesh",
        _ => return Ok(()),
    };
    if values.can_blend() { Ok(()) } else { Err(LodError::NeedsBlending { what }) }
}

impl<V: Vertex> WaveletLod<V> {
    /// An instance. `values` are those of the mesh's vertices, each at its own place, as
    /// [`WaveletMesh::vertices`] has them; shared by instances.
    ///
    /// # Errors
    /// There are not as many values as vertices, or they would have to be mixed and cannot be.
    pub fn new(
        mesh: Arc<WaveletMesh>,
        values: impl Into<Values<V>>,
        options: &LodOptions,
    ) -> Result<Self, LodError> {
        let values = values.into();
        let (found, expected) = (values.len(), mesh.subdivision().vertex_count());
        if found != expected {
            return Err(LodError::Length { found, expected });
        }
        check(&values, options)?;
        let cut = Cut::new(mesh.subdivision().wavelet_count(), mesh.diagonal(), false);
        let shown = Shown::new(&mesh, values, options);
        let mut lod = Self { driver: Driver::new(cut), shown, asked: None, mesh };
        lod.apply(options);
        Ok(lod)
    }

    /// Takes options that ask for nothing but what is drawn already.
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
        self.shown.write(&self.mesh);
    }

    /// Makes triangles and vertices anew for other options. What was asked for is drawn, every vertex at its place.
    fn rebuild(&mut self, options: &LodOptions) {
        self.settle();
        let values = self.shown.vertices.values_at_rest().clone();
        let mut shown = Shown::new(&self.mesh, values, options);
        let wavelets = 0..self.mesh.subdivision().wavelet_count() as u32;
        for wavelet in wavelets.filter(|&wavelet| self.shown.vertices.is_set(wavelet)) {
            shown.change(&self.mesh, wavelet, true);
        }
        shown.write(&self.mesh);
        shown.surface.invalidate();
        shown.vertices.invalidate();
        self.shown = shown;
    }

    /// Edits the mesh ([`WaveletMesh::edit`]) and draws it as it is then; `value` gives vertices that are elsewhere their new values.
    /// The next call asks a view about all that is drawn.
    ///
    /// In place where no one else holds the mesh, or the values; else in a copy, O(n), which this instance keeps: hand it to others
    /// by [`replace`](Self::replace).
    ///
    /// # Errors
    /// Those of [`WaveletMesh::edit`]; then nothing has changed.
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

    /// Draws a mesh of the same connectivity instead: one that was edited. `changed` are the vertices whose values differ from those
    /// so far, in any order; cuts and what is on its way stay. The next call asks a view about all that is drawn.
    ///
    /// O(what changed); where the mesh is another in memory, connectivities are compared, O(n).
    ///
    /// # Errors
    /// The mesh has another connectivity or other materials, there are not as many values as vertices, or a vertex that changed is not
    /// there; then nothing has changed.
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

    /// Takes in new values of vertices, and that bounds may be others.
    fn revalue(&mut self, changed: &[u32]) {
        let Shown { surface, vertices } = &mut self.shown;
        vertices.revalue(self.mesh.subdivision(), surface, changed);
        self.shown.write(&self.mesh);
        self.driver.forget();
    }

    /// The values of vertices at their own places, drawn or not.
    pub fn own_values(&self) -> &Values<V> {
        self.shown.vertices.values_at_rest()
    }

    /// The structure.
    pub fn mesh(&self) -> &Arc<WaveletMesh> {
        &self.mesh
    }

    /// Which wavelets the last view asked for, within the limit of triangles.
    pub fn cut(&self) -> &Cut {
        self.driver.cut()
    }

    /// Whether a wavelet is drawn, be it on its way.
    pub fn shows(&self, wavelet: u32) -> bool {
        (wavelet as usize) < self.mesh.subdivision().wavelet_count() && self.shown.vertices.is_set(wavelet)
    }

    /// The values that are drawn: of every vertex of the mesh (those that no triangle names may be out of date), or where vertices
    /// are packed, of every slot.
    pub fn values(&self) -> &[V] {
        self.shown.vertices.drawn()
    }

    /// The value of a vertex where it is drawn; at its own place where it is not. `None` out of range.
    pub fn value(&self, vertex: u32) -> Option<V> {
        let known = (vertex as usize) < self.mesh.subdivision().vertex_count();
        known.then(|| self.shown.vertices.value(&self.shown.surface, self.mesh.subdivision(), vertex))
    }

    /// Number of wavelets on their way.
    pub fn moving(&self) -> usize {
        self.shown.vertices.moving()
    }

    /// Per triangle of a group the base face that it is a part of, for textures by base face. O(1) a triangle and level.
    pub fn base_faces(&self, group: usize) -> impl Iterator<Item = u32> + '_ {
        self.shown.surface.faces(group).map(|face| self.mesh.subdivision().base_face_of(face))
    }

    /// Per triangle of a group the level of the face that it is a part of.
    pub fn levels(&self, group: usize) -> impl Iterator<Item = usize> + '_ {
        self.shown.surface.faces(group).map(|face| self.mesh.subdivision().level_of_face(face))
    }

    /// What is drawn as a mesh of its own, all vertices where they come to rest: the same mesh for the same cut. O(n).
    pub fn to_mesh_with(&self, normals: Normals) -> Mesh {
        self.mesh.extract(|wavelet| self.shows(wavelet), self.driver.options().triangulation, normals)
    }

    /// Moves the cut to what a criterion of your own needs, `seconds` after the last call. `motion` is what has happened to the
    /// criterion since then ([`Criterion::motion`]); [`Motion::Other`] where the last call was another's.
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

    /// Lets the driver move what is drawn.
    fn drive(
        &mut self,
        go: impl FnOnce(&mut Driver, &WaveletMesh, &mut Sink<'_, V>, &mut dyn FnMut(u32, bool) -> usize) -> Change,
    ) -> Change {
        let Self { mesh, driver, shown, asked } = self;
        let mut cost = |wavelet: u32, comes: bool| {
            let uses = asked.as_mut();
            uses.map_or(0, |uses| uses.change(mesh.subdivision(), wavelet, comes, &mut ()))
        };
        let mut change = go(driver, mesh, &mut Sink { mesh, shown }, &mut cost);
        shown.write(mesh);
        change.triangles = shown.surface.triangle_count();
        change
    }
}

impl<V: Vertex> Lod for WaveletLod<V> {
    fn adapt(&mut self, views: &[ObjectView], seconds: f32) -> Change {
        let diagonal = self.mesh.diagonal();
        self.drive(|driver, mesh, sink, cost| driver.adapt(mesh, (views, seconds, diagonal), sink, cost))
    }

    fn refine_fully(&mut self) -> Change {
        let change = self.adapt_by(&Everything, Motion::Other, f32::INFINITY);
        self.settle();
        Change { triangles: self.shown.surface.triangle_count(), pending: 0, moving: 0, ..change }
    }

    fn settle(&mut self) {
        let Self { mesh, driver, shown, .. } = self;
        driver.settle(&**mesh, &mut Sink { mesh, shown });
        self.shown.write(&self.mesh);
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

    /// Never: values change with what is beside them.
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
