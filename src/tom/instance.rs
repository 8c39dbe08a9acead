//! A drawn instance of a totally ordered mesh: a single resolution for all of the model, set by the model's nearest point.
//!
//! ```text
//!     where vertices move: one transition at a time between two resolutions, drawn with the finer one's triangles
//!
//!     coarse  |----o=====================>|  fine       vertices between the two move from their targets to their own
//!             0   share of the way        1             places, or back; turned round where the view turns round
//! ```

use std::sync::Arc;

use crate::adapt::{Change, CutReport, Dirty, DirtyRanges};
use crate::lod::{
    Allowed, Baked, Draws, Level, Lod, LodError, LodOptions, Mix, Uploads, Values, Vertex, VertexBuffer,
    Whole,
};
use crate::mesh::{Mesh, NONE};
use crate::view::ObjectView;

use super::indices::Indices;
use super::{Resolution, TotallyOrderedMesh};

/// A drawn instance of a [`TotallyOrderedMesh`], at the coarsest resolution with an error bound within the tolerance at the
/// point of the model's bounding sphere nearest to the eye.
///
/// Vertices in use come first in the total order, so a packed vertex buffer is a prefix of the whole buffer, and an uploaded
/// vertex is not uploaded again. A vanished triangle keeps its place behind the drawn triangles, and is not uploaded again
/// either.
#[derive(Debug, Clone)]
pub struct TomLod<V> {
    model: Baked<TotallyOrderedMesh>,
    options: LodOptions,
    factor: f32,
    views: Vec<ObjectView>,
    whole: Whole,
    /// Resolution asked for by the views, within the triangle limit.
    wanted: Resolution,
    indices: Indices,
    /// Written places of triangles, drawn or not.
    dirty_triangles: Dirty,
    values: Values<V>,
    /// Written vertices, in use or not.
    dirty_vertices: Dirty,
    moving: Option<Moving<V>>,
}

/// State of moving vertices.
#[derive(Debug, Clone)]
struct Moving<V> {
    mix: Mix<V>,
    /// Drawn value of each vertex.
    drawn: Vec<V>,
    transition: Option<Transition>,
    /// Target of each vertex between the two resolutions of the transition.
    targets: Vec<u32>,
}

#[derive(Debug, Clone, Copy)]
struct Transition {
    coarse: Resolution,
    fine: Resolution,
    /// Share of the way from coarse to fine.
    share: f32,
    opening: bool,
}

impl<V: Vertex> TomLod<V> {
    /// Makes an instance at the coarsest resolution. Needs as many values as vertices.
    pub(super) fn of(
        model: &Baked<TotallyOrderedMesh>,
        values: Values<V>,
        options: &LodOptions,
    ) -> Result<Self, LodError> {
        values.check(model.structure().vertex_count())?;
        let mix = values.mix_for(options)?;
        let mut indices = Indices::new(Arc::clone(model.table()?));
        let coarsest = model.structure().coarsest();
        indices.seek(coarsest, |_| {});
        let mut lod = Self {
            model: model.clone(),
            options: *options,
            factor: 1.0,
            views: Vec::new(),
            whole: Whole::new(model.bounds()),
            wanted: coarsest,
            indices,
            dirty_triangles: Dirty::default(),
            moving: mix.map(|mix| Moving::new(mix, &values)),
            values,
            dirty_vertices: Dirty::default(),
        };
        lod.invalidate();
        Ok(lod)
    }

    /// Returns the structure.
    pub fn tom(&self) -> &Arc<TotallyOrderedMesh> {
        self.model.structure()
    }

    /// Returns the drawn resolution.
    pub fn resolution(&self) -> Resolution {
        self.indices.resolution()
    }

    /// Returns the drawn values of all vertices of the structure.
    pub fn values(&self) -> &[V] {
        self.moving.as_ref().map_or(&self.values, |moving| &moving.drawn)
    }

    /// Sets the wanted resolution and moves towards it. A running transition advances by `progress`.
    fn follow(&mut self, wanted: Resolution, progress: f32) -> Change {
        let before = self.indices.resolution();
        self.wanted = wanted;
        if progress < 1.0 && self.moving.is_some() && !self.is_above_limit() {
            self.advance(progress);
            self.turn();
            if self.transition().is_none() {
                let to = self.step_towards(wanted);
                self.start(to, progress);
            }
        } else {
            self.rest();
            let to = if self.is_above_limit() { wanted } else { self.step_towards(wanted) };
            self.seek(to);
        }
        self.change(before)
    }

    /// Reports the change from resolution `before` to the drawn resolution.
    fn change(&self, before: Resolution) -> Change {
        let now = self.indices.resolution();
        Change {
            cut: CutReport {
                tests: self.views.len(),
                splits: now.vertices().saturating_sub(before.vertices()),
                collapses: before.vertices().saturating_sub(now.vertices()),
            },
            triangles: now.triangles(),
            pending: now.vertices().abs_diff(self.wanted.vertices()),
            moving: self.transition().map_or(0, |t| t.fine.vertices() - t.coarse.vertices()),
            over_budget: self.options.triangles.is_some_and(|most| now.triangles() > most),
        }
    }

    /// Returns `wanted`, or if it has too many triangles, the finest resolution within the triangle limit.
    fn within_limit(&self, wanted: Resolution) -> Resolution {
        let Some(most) = self.options.triangles else { return wanted };
        if wanted.triangles() <= most { wanted } else { self.tom().at(Level::Triangles(most)) }
    }

    /// Holds while more triangles are drawn than the limit allows, and fewer are possible.
    fn is_above_limit(&self) -> bool {
        let now = self.indices.resolution();
        self.options.triangles.is_some_and(|most| now.triangles() > most)
            && now.vertices() > self.tom().coarsest().vertices()
    }

    /// Returns the resolution reached towards `wanted` in a single call: at most `operations` vertices away, at least a step.
    fn step_towards(&self, wanted: Resolution) -> Resolution {
        let (tom, now) = (self.tom(), self.indices.resolution());
        let Some(most) = self.options.operations else { return wanted };
        if now.vertices().abs_diff(wanted.vertices()) <= most {
            return wanted;
        }
        if wanted.vertices() > now.vertices() {
            let to = tom.at(Level::Vertices(now.vertices() + most));
            return if to.vertices() > now.vertices() { to } else { tom.finer(now).unwrap_or(now) };
        }
        let to = tom.at(Level::Vertices(now.vertices().saturating_sub(most)));
        // Whole groups: a group cut in two is left for the next call, unless it is the first.
        let to = if to.vertices() + most < now.vertices() { tom.finer(to).unwrap_or(to) } else { to };
        if to.vertices() < now.vertices() { to } else { tom.coarser(now).unwrap_or(now) }
    }

    fn transition(&self) -> Option<&Transition> {
        self.moving.as_ref().and_then(|moving| moving.transition.as_ref())
    }

    /// Advances the transition by a share of its way, and ends it on arrival.
    fn advance(&mut self, progress: f32) {
        let Some(Moving { transition: Some(transition), .. }) = &mut self.moving else { return };
        let Transition { share, opening, coarse, .. } = transition;
        *share = (*share + if *opening { progress } else { -progress }).clamp(0.0, 1.0);
        let (share, opening, coarse) = (*share, *opening, *coarse);
        if opening && share >= 1.0 {
            self.rest();
        } else if !opening && share <= 0.0 {
            self.rest();
            self.seek(coarse);
        } else {
            self.place();
        }
    }

    /// Reverses the transition where the wanted resolution lies on its other side.
    fn turn(&mut self) {
        let wanted = self.wanted.vertices();
        let Some(Moving { transition: Some(t), .. }) = &mut self.moving else { return };
        if t.opening && wanted <= t.coarse.vertices() || !t.opening && wanted >= t.fine.vertices() {
            t.opening = !t.opening;
        }
    }

    /// Starts a transition, to be advanced by the next call. Out of view, or if `progress >= 1`, moves there at once.
    fn start(&mut self, to: Resolution, progress: f32) {
        let now = self.indices.resolution();
        if to.vertices() == now.vertices() {
            return;
        }
        if !self.whole.is_seen(&self.views) || progress >= 1.0 {
            return self.seek(to);
        }
        let opening = to.vertices() > now.vertices();
        let (coarse, fine) = if opening { (now, to) } else { (to, now) };
        let tom = Arc::clone(self.tom());
        let Some(moving) = &mut self.moving else { return };
        tom.geomorph(coarse, fine, &mut moving.targets);
        let share = if opening { 0.0 } else { 1.0 };
        moving.transition = Some(Transition { coarse, fine, share, opening });
        if opening {
            self.seek(fine);
            self.place();
        }
    }

    /// Writes the blended values of the transition's vertices.
    fn place(&mut self) {
        let Some(Moving { mix, drawn, transition: Some(t), targets }) = &mut self.moving else { return };
        for (vertex, &target) in (t.coarse.vertices..t.fine.vertices).zip(&*targets) {
            let [from, own] = [target, vertex].map(|v| self.values[v as usize]);
            drawn[vertex as usize] = (mix.blend)(&from, &own, t.share);
            self.dirty_vertices.mark(vertex);
        }
    }

    /// Ends the transition, every vertex at its own place.
    fn rest(&mut self) {
        let Some(Moving { drawn, transition, .. }) = &mut self.moving else { return };
        let Some(t) = transition.take() else { return };
        for vertex in t.coarse.vertices..t.fine.vertices {
            drawn[vertex as usize] = self.values[vertex as usize];
            self.dirty_vertices.mark(vertex);
        }
    }

    fn seek(&mut self, to: Resolution) {
        let Self { indices, dirty_triangles, .. } = self;
        indices.seek(to, |place| dirty_triangles.mark(place / 3));
    }

    /// Returns the places of a group's drawn triangles.
    fn places(&self, group: usize) -> std::ops::Range<usize> {
        let range = self.indices.ranges().get(group).copied().unwrap_or_default();
        range.start as usize / 3..(range.start + range.count) as usize / 3
    }

    /// Returns the number of vertices in the buffer.
    fn buffered(&self) -> usize {
        match self.options.buffer {
            VertexBuffer::Packed => self.indices.resolution().vertices(),
            _ => self.values.len(),
        }
    }
}

impl<V: Vertex> Moving<V> {
    fn new(mix: Mix<V>, values: &[V]) -> Self {
        Self { mix, drawn: values.to_vec(), transition: None, targets: Vec::new() }
    }
}

impl<V: Vertex> Lod for TomLod<V> {
    fn adapt(&mut self, views: &[ObjectView], seconds: f32) -> Change {
        let motion = Whole::motion(views, &self.views);
        self.views.clear();
        self.views.extend_from_slice(views);
        let tom = self.tom();
        let vertices = match self.whole.allowed(views, self.factor) {
            Allowed::Nothing => tom.finest().vertices,
            Allowed::Error(error) => tom.vertices_within(error),
            Allowed::Anything => tom.base_vertices,
        };
        // To count the triangles of a resolution takes longer than all the rest of a still frame.
        let wanted = if vertices == self.wanted.vertices { self.wanted } else { tom.resolution(vertices) };
        let wanted = self.within_limit(wanted);
        let diagonal = f64::from(self.whole.diagonal());
        let progress =
            self.options.geomorph.map_or(1.0, |geomorph| geomorph.progress(seconds, motion, diagonal));
        self.follow(wanted, progress)
    }

    fn refine_fully(&mut self) -> Change {
        self.views.clear();
        let before = self.indices.resolution();
        self.wanted = self.within_limit(self.tom().finest());
        self.settle();
        self.change(before)
    }

    fn settle(&mut self) {
        self.rest();
        self.seek(self.wanted);
    }

    fn options(&self) -> &LodOptions {
        &self.options
    }

    fn set_options(&mut self, options: &LodOptions) -> Result<(), LodError> {
        let mix = self.values.mix_for(options)?;
        let moves = mix.is_some() != self.moving.is_some();
        let rebuilt = moves || options.buffer != self.options.buffer;
        if rebuilt || options.is_immediate() {
            self.settle();
        }
        self.options = *options;
        if moves {
            self.moving = mix.map(|mix| Moving::new(mix, &self.values));
        }
        if rebuilt {
            self.invalidate();
        }
        Ok(())
    }

    fn tolerance_factor(&self) -> f32 {
        self.factor
    }

    fn set_tolerance_factor(&mut self, factor: f32) {
        if factor > 0.0 && factor.is_finite() {
            self.factor = factor;
        }
    }

    fn refinements(&self) -> usize {
        self.wanted.vertices() - self.tom().coarsest().vertices()
    }

    fn groups(&self) -> usize {
        self.indices.ranges().len().max(1)
    }

    fn material(&self, group: usize) -> u32 {
        self.indices.ranges().get(group).map_or(NONE, |range| range.material)
    }

    fn triangles(&self, group: usize) -> &[[u32; 3]] {
        let places = self.places(group);
        bytemuck::cast_slice(&self.indices.buffer()[3 * places.start..3 * places.end])
    }

    fn vertices(&self) -> Option<&[u32]> {
        None
    }

    fn vertex_bytes(&self) -> &[u8] {
        bytemuck::cast_slice(&self.values()[..self.buffered()])
    }

    fn vertex_size(&self) -> usize {
        size_of::<V>()
    }

    fn shares_vertices(&self) -> bool {
        self.options.buffer == VertexBuffer::Shared && self.moving.is_none()
    }

    fn dirty_triangles(&self, group: usize, gap: usize) -> DirtyRanges<'_> {
        self.dirty_triangles.ranges_of(self.places(group), gap)
    }

    fn dirty_vertices(&self, gap: usize) -> DirtyRanges<'_> {
        self.dirty_vertices.ranges(self.buffered(), gap)
    }

    fn uploads(&self) -> Uploads<'_> {
        Uploads::new(self)
    }

    fn draws(&self) -> Draws<'_> {
        Draws::new(self)
    }

    /// Clears the marks of drawn triangles and buffered vertices. All others keep their marks: nobody uploaded them.
    fn clean(&mut self) {
        for group in 0..self.groups() {
            let places = self.places(group);
            self.dirty_triangles.clear_range(places);
        }
        let buffered = self.buffered();
        self.dirty_vertices.clear_range(0..buffered);
    }

    fn invalidate(&mut self) {
        self.dirty_triangles.mark_all(self.tom().triangle_count());
        self.dirty_vertices.clear();
        if !self.shares_vertices() {
            self.dirty_vertices.mark_all(self.values.len());
        }
    }

    fn to_mesh(&self) -> Mesh {
        self.model.mesh_at(self.indices.resolution())
    }

    fn memory(&self) -> usize {
        let moving = self.moving.as_ref().map_or(0, |moving| {
            size_of_val(&moving.drawn[..]) + moving.targets.capacity() * size_of::<u32>()
        });
        self.indices.memory() + self.dirty_triangles.memory() + self.dirty_vertices.memory() + moving
    }
}
