//! A drawn instance of a totally ordered mesh: a single resolution for all of the model, set by the model's nearest point.
//!
//! ```text
//!     where vertices move: one transition at a time between two resolutions, drawn with the finer one's triangles
//!
//!     coarse  |----o=====================>|  fine       vertices between the two move from their targets to their own
//!             0   share of the way        1             places, or back; turned round where the view turns round
//! ```

use std::ops::Range;
use std::sync::Arc;

use crate::adapt::{Change, CutReport, Dirty, DirtyRanges};
use crate::lod::{
    Allowed, Baked, Draws, Level, Lod, LodError, LodOptions, Uploads, Values, Vertex, Whole, WholeInstance,
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
    /// Views are kept only where vertices move.
    shared: WholeInstance<V>,
    whole: Whole,
    /// Number of views tested by the last call.
    tests: usize,
    /// Resolution asked for by the views, within the triangle limit.
    wanted: Resolution,
    indices: Indices,
    /// Written places of triangles, drawn or not.
    dirty_triangles: Dirty,
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
        let shared = WholeInstance::new(values, model.structure().vertex_count(), options)?;
        let mut indices = Indices::new(Arc::clone(model.table()?));
        let coarsest = model.structure().coarsest();
        indices.seek(coarsest, |_| {});
        let mut lod = Self {
            model: model.clone(),
            shared,
            whole: Whole::new(model.bounds()),
            tests: 0,
            wanted: coarsest,
            indices,
            dirty_triangles: Dirty::default(),
            transition: None,
            targets: Vec::new(),
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
        self.shared.values()
    }

    /// Sets the wanted resolution and moves towards it. A running transition advances by `progress`.
    fn follow(&mut self, wanted: Resolution, progress: f32) -> Change {
        let before = self.indices.resolution();
        self.wanted = wanted;
        if progress < 1.0 && self.shared.moves() && !self.is_above_limit() {
            self.advance(progress);
            self.turn();
            if self.transition.is_none() {
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
                tests: self.tests,
                splits: now.vertices().saturating_sub(before.vertices()),
                collapses: before.vertices().saturating_sub(now.vertices()),
                ..CutReport::default()
            },
            triangles: now.triangles(),
            pending: now.vertices().abs_diff(self.wanted.vertices()),
            moving: self.transition.map_or(0, |t| t.fine.vertices() - t.coarse.vertices()),
            over_budget: self.shared.options().triangles.is_some_and(|most| now.triangles() > most),
        }
    }

    /// Returns `wanted`, or if it has too many triangles, the finest resolution within the triangle limit.
    fn within_limit(&self, wanted: Resolution) -> Resolution {
        let Some(most) = self.shared.options().triangles else { return wanted };
        if wanted.triangles() <= most { wanted } else { self.tom().at(Level::Triangles(most)) }
    }

    /// Holds while more triangles are drawn than the limit allows, and fewer are possible.
    fn is_above_limit(&self) -> bool {
        let now = self.indices.resolution();
        self.shared.options().triangles.is_some_and(|most| now.triangles() > most)
            && now.vertices() > self.tom().coarsest().vertices()
    }

    /// Returns the resolution reached towards `wanted` in a single call: at most `operations` vertices away, at least a step.
    fn step_towards(&self, wanted: Resolution) -> Resolution {
        let (tom, now) = (self.tom(), self.indices.resolution());
        let Some(most) = self.shared.options().operations else { return wanted };
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

    /// Advances the transition by a share of its way, and ends it on arrival.
    fn advance(&mut self, progress: f32) {
        let Some(transition) = &mut self.transition else { return };
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
        let Some(t) = &mut self.transition else { return };
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
        if !self.whole.is_seen(&self.shared.views) || progress >= 1.0 {
            return self.seek(to);
        }
        let opening = to.vertices() > now.vertices();
        let (coarse, fine) = if opening { (now, to) } else { (to, now) };
        let tom = Arc::clone(self.tom());
        tom.geomorph(coarse, fine, &mut self.targets);
        let share = if opening { 0.0 } else { 1.0 };
        self.transition = Some(Transition { coarse, fine, share, opening });
        if opening {
            self.seek(fine);
            self.place();
        }
    }

    /// Writes the blended values of the transition's vertices.
    fn place(&mut self) {
        let Some(t) = self.transition else { return };
        let vertices = (t.coarse.vertices..t.fine.vertices).zip(&self.targets);
        self.shared.blend(vertices.map(|(vertex, &target)| (vertex, [target, vertex])), t.share);
    }

    /// Ends the transition, every vertex at its own place.
    fn rest(&mut self) {
        let Some(t) = self.transition.take() else { return };
        self.shared.rest(t.coarse.vertices..t.fine.vertices);
    }

    fn seek(&mut self, to: Resolution) {
        let Self { indices, dirty_triangles, .. } = self;
        indices.seek(to, |place| dirty_triangles.mark(place / 3));
    }

    /// Returns the places of a group's drawn triangles.
    fn places(&self, group: usize) -> Range<usize> {
        let range = self.indices.ranges().get(group).copied().unwrap_or_default();
        range.start as usize / 3..(range.start + range.count) as usize / 3
    }

    /// Returns the number of vertices in use.
    fn prefix(&self) -> usize {
        self.indices.resolution().vertices()
    }
}

impl<V: Vertex> Lod for TomLod<V> {
    fn adapt(&mut self, views: &[ObjectView], seconds: f32) -> Change {
        self.tests = views.len();
        let tom = self.tom();
        let vertices = match self.whole.allowed(views, self.shared.factor()) {
            Allowed::Nothing => tom.finest().vertices,
            Allowed::Error(error) => tom.vertices_within(error),
            Allowed::Anything => tom.base_vertices,
        };
        // To count the triangles of a resolution takes longer than all the rest of a still frame.
        let wanted = if vertices == self.wanted.vertices { self.wanted } else { tom.resolution(vertices) };
        let wanted = self.within_limit(wanted);
        let mut progress = 1.0;
        if let Some(geomorph) = self.shared.options().geomorph {
            let motion = Whole::motion(views, &self.shared.views);
            progress = geomorph.progress(seconds, motion, f64::from(self.whole.diagonal()));
            self.shared.look(views);
        }
        self.follow(wanted, progress)
    }

    fn refine_fully(&mut self) -> Change {
        self.shared.views.clear();
        self.tests = 0;
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
        self.shared.options()
    }

    fn set_options(&mut self, options: &LodOptions) -> Result<(), LodError> {
        let accepted = self.shared.accept(options)?;
        let (moves, rebuilds) = (accepted.moves, accepted.rebuilds);
        if accepted.settles {
            self.settle();
        }
        self.shared.set_options(accepted);
        if moves {
            self.shared.views.clear();
        }
        if rebuilds {
            self.invalidate();
        }
        Ok(())
    }

    fn tolerance_factor(&self) -> f32 {
        self.shared.factor()
    }

    fn set_tolerance_factor(&mut self, factor: f32) {
        self.shared.set_factor(factor);
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

    fn drawn_range(&self, group: usize) -> Range<usize> {
        0..self.places(group).len()
    }

    fn vertices(&self) -> Option<&[u32]> {
        None
    }

    fn vertex_bytes(&self) -> &[u8] {
        self.shared.vertex_bytes(self.prefix())
    }

    fn vertex_size(&self) -> usize {
        size_of::<V>()
    }

    fn shares_vertices(&self) -> bool {
        self.shared.shares_vertices()
    }

    fn dirty_triangles(&self, group: usize, gap: usize) -> DirtyRanges<'_> {
        self.dirty_triangles.ranges_of(self.places(group), gap)
    }

    fn dirty_vertices(&self, gap: usize) -> DirtyRanges<'_> {
        self.shared.dirty_vertices(self.prefix(), gap)
    }

    fn uploads(&self) -> Uploads<'_> {
        Uploads::new(self)
    }

    fn draws(&self) -> Draws<'_> {
        Draws::new(self)
    }

    /// Clears the marks of drawn triangles and buffered vertices. All others keep theirs: nobody uploaded them.
    fn clean(&mut self) {
        for group in 0..self.groups() {
            let places = self.places(group);
            self.dirty_triangles.clear_range(places);
        }
        self.shared.clean(self.prefix());
    }

    fn invalidate(&mut self) {
        self.dirty_triangles.mark_all(self.tom().triangle_count());
        self.shared.invalidate();
    }

    fn to_mesh(&self) -> Mesh {
        self.model.mesh_at(self.indices.resolution())
    }

    fn memory(&self) -> usize {
        let targets = self.targets.capacity() * size_of::<u32>();
        self.indices.memory() + self.dirty_triangles.memory() + self.shared.memory() + targets
    }
}
