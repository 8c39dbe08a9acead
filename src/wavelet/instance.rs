//! One drawn instance of a wavelet mesh: the cut that a view asks for, its triangles and its vertices.

use std::sync::Arc;

use crate::adapt::{Blend, Change, Cut, DirtyRanges, LevelOfDetail, LodOptions, Pace, Picture};
use crate::error::MeshError;
use crate::mesh::Mesh;
use crate::view::{Criterion, DeviationBounds, Motion, ObjectView};

#[cfg(doc)]
use super::Triangulation;
use super::surface::Surface;
use super::tally::Tally;
use super::vertices::Vertices;
use super::{DetailFrame, Drawing, Edited, Normals, WaveletError, WaveletMesh};

/// One drawn instance, with the values of its vertices. Many share one mesh and its values; each is independent, and may
/// move to another thread.
///
/// ```text
///     every frame   adapt(views)  ->  upload what is dirty of values() and triangles()  ->  clean()
/// ```
///
/// Starts at the base mesh, all of it dirty. Vertices that are there only because a neighbouring wavelet splits a face lie on the
/// surface, in the middle of their ends, so values change even where nothing morphs; with
/// [`Triangulation::Minimal`] there are none such. Values may be of any type with [`Blend`]; normals between two
/// others come out a little short.
///
/// With [`Drawing::geomorph`] coefficients grow and shrink (Azuma et al., equation 6): transitions may overlap in space and
/// time and turn round where they are; what [no view sees](Criterion::sees) changes at once.
#[derive(Debug, Clone)]
pub struct WaveletLod<V> {
    mesh: Arc<WaveletMesh>,
    cut: Cut,
    shown: Shown<V>,
    views: Vec<ObjectView>,
    options: LodOptions,
    drawing: Drawing,
    /// `None` where what is asked for is drawn at once.
    pace: Option<Box<Pace>>,
    /// What the cut has, where triangles are limited.
    asked: Option<Box<Tally>>,
    /// Whether no answer of the cut holds any more.
    forgets: bool,
}

/// What is drawn.
#[derive(Debug, Clone)]
struct Shown<V> {
    surface: Surface,
    vertices: Vertices<V>,
}

impl<V: Blend + Copy> Shown<V> {
    fn new(mesh: &WaveletMesh, values: Arc<[V]>, drawing: &Drawing) -> Self {
        let of = mesh.subdivision();
        let mut shown = Self {
            surface: Surface::new(of, drawing.triangulation, mesh.groups()),
            vertices: Vertices::new(of, values, drawing.packed, drawing.geomorph.is_some()),
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
struct Drawn<'a, V> {
    mesh: &'a WaveletMesh,
    shown: &'a mut Shown<V>,
}

impl<V: Blend + Copy> Picture for Drawn<'_, V> {
    fn cost(&self, wavelet: u32) -> usize {
        let comes = !self.shown.vertices.is_set(wavelet);
        self.shown.surface.tally().cost(self.mesh.subdivision(), wavelet, comes)
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

impl<V: Blend + Copy> WaveletLod<V> {
    /// An instance. `values` are those of the mesh's vertices, each at its own place, as
    /// [`WaveletMesh::vertices`] has them; shared by instances.
    ///
    /// # Errors
    /// As many values as vertices are needed.
    pub fn new(mesh: Arc<WaveletMesh>, values: Arc<[V]>, drawing: &Drawing) -> Result<Self, MeshError> {
        let (found, expected) = (values.len(), mesh.subdivision().vertex_count());
        if found != expected {
            return Err(MeshError::LengthMismatch { what: "values".to_owned(), found, expected });
        }
        let mut lod = Self {
            cut: Cut::new(mesh.subdivision().wavelet_count(), mesh.diagonal(), false),
            shown: Shown::new(&mesh, values, drawing),
            views: Vec::new(),
            options: LodOptions::default(),
            drawing: *drawing,
            pace: None,
            asked: None,
            forgets: false,
            mesh,
        };
        lod.set_options(LodOptions::default());
        Ok(lod)
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
        let values = Arc::make_mut(self.shown.vertices.own_values());
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
        values: Arc<[V]>,
        changed: &[u32],
    ) -> Result<(), WaveletError> {
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
        *self.shown.vertices.own_values() = values;
        self.revalue(changed);
        Ok(())
    }

    /// Takes in new values of vertices, and that bounds may be others.
    fn revalue(&mut self, changed: &[u32]) {
        let Shown { surface, vertices } = &mut self.shown;
        vertices.revalue(self.mesh.subdivision(), surface, changed);
        self.shown.write(&self.mesh);
        self.forgets = true;
    }

    /// The values of vertices at their own places, drawn or not.
    pub fn own_values(&self) -> &Arc<[V]> {
        self.shown.vertices.values_at_rest()
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
        self.forgets |= options.triangles != self.options.triangles;
        self.options = options;
        let Self { mesh, cut, shown, pace, asked, .. } = self;
        let of = mesh.subdivision();
        if options == LodOptions::default() && self.drawing.geomorph.is_none() {
            *asked = None;
            if pace.is_some() {
                self.settle();
                self.pace = None;
            }
            return;
        }
        let moves = self.drawing.geomorph.is_some();
        let pace = pace
            .get_or_insert_with(|| Box::new(Pace::new(&**mesh, cut, shown.surface.triangle_count(), moves)));
        let mut triangles = 0;
        *asked = options.triangles.map(|_| {
            let mut tally = Tally::new(of, self.drawing.triangulation);
            triangles = of.base_face_count();
            for wavelet in (0..of.wavelet_count() as u32).filter(|&wavelet| cut.holds(wavelet)) {
                triangles += tally.change(of, wavelet, true, &mut ());
            }
            Box::new(tally)
        });
        pace.set(&options, triangles);
    }

    /// The limits.
    pub fn options(&self) -> &LodOptions {
        &self.options
    }

    /// How it is drawn.
    pub fn drawing(&self) -> &Drawing {
        &self.drawing
    }

    /// Draws all that the last view asked for, every vertex at its place: after a cut to another camera, say.
    pub fn settle(&mut self) {
        let Self { mesh, shown, pace, .. } = self;
        if let Some(pace) = pace {
            pace.settle(&**mesh, &mut Drawn { mesh, shown });
        }
        self.shown.write(&self.mesh);
    }

    /// The structure.
    pub fn mesh(&self) -> &Arc<WaveletMesh> {
        &self.mesh
    }

    /// Which wavelets the last view asked for, within the budget of triangles.
    pub fn cut(&self) -> &Cut {
        &self.cut
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
    pub fn to_mesh(&self, normals: Normals) -> Mesh {
        self.mesh.extract(|wavelet| self.shows(wavelet), self.drawing.triangulation, normals)
    }

    /// Moves the cut to what a criterion of your own needs, `seconds` after the last call. `motion` is what has happened to the
    /// criterion since then ([`Criterion::motion`]); [`Motion::Other`] where the last call was another's.
    pub fn adapt_by<C: Criterion<DeviationBounds> + ?Sized>(
        &mut self,
        criterion: &C,
        motion: Motion,
        seconds: f32,
    ) -> Change {
        self.views.clear();
        self.update(criterion, motion, seconds)
    }

    fn update<C: Criterion<DeviationBounds> + ?Sized>(
        &mut self,
        criterion: &C,
        motion: Motion,
        seconds: f32,
    ) -> Change {
        let progress = match &self.drawing.geomorph {
            Some(geomorph) => geomorph.progress(seconds, motion, self.mesh.diagonal()),
            None => 1.0,
        };
        let motion = if std::mem::take(&mut self.forgets) { Motion::Other } else { motion };
        let Self { mesh, cut, shown, pace, asked, .. } = self;
        let mut change = match pace {
            None => {
                let cut = cut.update(&**mesh, criterion, motion, |_, wavelet, comes| {
                    shown.change(mesh, wavelet, comes);
                });
                Change { cut, ..Change::default() }
            }
            Some(pace) => {
                let cost = |wavelet: u32, comes: bool| {
                    let tally = asked.as_mut();
                    tally.map_or(0, |tally| tally.change(mesh.subdivision(), wavelet, comes, &mut ()))
                };
                pace.update((&**mesh, cut), &mut Drawn { mesh, shown }, criterion, motion, progress, cost)
            }
        };
        shown.write(mesh);
        change.triangles = shown.surface.triangle_count();
        change
    }

    /// Bytes of this instance, what it shares with others not counted.
    pub fn memory(&self) -> usize {
        self.cut.memory()
            + self.shown.surface.memory()
            + self.shown.vertices.memory()
            + self.pace.as_ref().map_or(0, |pace| pace.memory())
            + self.asked.as_ref().map_or(0, |asked| asked.memory())
    }
}

impl<V: Blend + Copy> LevelOfDetail for WaveletLod<V> {
    fn adapt(&mut self, views: &[ObjectView]) -> Change {
        self.adapt_in(views, 1.0 / 60.0)
    }

    fn adapt_in(&mut self, views: &[ObjectView], seconds: f32) -> Change {
        let motion = if self.views.is_empty() { Motion::Other } else { motion(views, &self.views) };
        let change = self.update(views, motion, seconds);
        self.views.clear();
        self.views.extend_from_slice(views);
        change
    }

    fn groups(&self) -> usize {
        self.shown.surface.groups()
    }

    fn triangles(&self, group: usize) -> &[[u32; 3]] {
        self.shown.surface.triangles(group)
    }

    fn vertices(&self) -> Option<&[u32]> {
        self.shown.vertices.vertices()
    }

    fn dirty_triangles(&self, group: usize, gap: usize) -> DirtyRanges<'_> {
        self.shown.surface.dirty(group, gap)
    }

    /// Of [`WaveletLod::values`], packed or not.
    fn dirty_vertices(&self, gap: usize) -> DirtyRanges<'_> {
        self.shown.vertices.dirty(gap)
    }

    fn clean(&mut self) {
        self.shown.surface.clean();
        self.shown.vertices.clean();
    }
}

fn motion(now: &[ObjectView], before: &[ObjectView]) -> Motion {
    Criterion::<DeviationBounds>::motion(now, before)
}
