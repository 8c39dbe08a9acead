//! A drawn instance of a g-mesh: a position between the finest and the coarsest level, from the error that the views allow.
//!
//! ```text
//!     views -> allowed error -> position      0      1      2      3
//!                                 level 1, share 0.6 |---o--|
//! ```

use std::ops::Range;
use std::sync::Arc;

use crate::adapt::{Change, CutReport, DirtyRanges};
use crate::lod::{
    Allowed, Baked, Draws, Lod, LodError, LodOptions, MorphUniform, Uploads, Values, Vertex, Whole,
    WholeInstance,
};
use crate::mesh::{Mesh, NONE};
use crate::view::ObjectView;

use super::{Gmesh, Morph};

/// Share of the errors between two levels over which the finer turns into the coarser.
const WAY: f64 = 0.5;

/// Data shared by instances: the model's sphere, and the levels' errors.
#[derive(Debug, Clone)]
pub struct Table {
    whole: Whole,
    /// Never falling.
    errors: Vec<f32>,
    /// The way into each level; `None` into the finest, and into levels of its error.
    ways: Vec<Option<Way>>,
}

/// The way into a level, where errors are allowed from the level's error on.
#[derive(Debug, Clone, Copy)]
struct Way {
    /// Level that turns into this one: the last with a smaller error.
    from: usize,
    /// Length: a share of the errors between this level and the next.
    length: f64,
}

impl Table {
    pub(super) fn new(model: &Baked<Gmesh>) -> Self {
        let errors: Vec<f32> = model.structure().levels().iter().map(|level| level.error).collect();
        let way = |(level, &own): (usize, &f32)| {
            let next = errors.get(level + 1).map_or(2.0 * f64::from(own), |&next| f64::from(next));
            let from = errors.partition_point(|&error| error < own).checked_sub(1)?;
            Some(Way { from, length: WAY * (next - f64::from(own)) })
        };
        let ways = errors.iter().enumerate().map(way).collect();
        Self { whole: Whole::new(model.bounds()), errors, ways }
    }

    /// Returns the coarsest state with an error within the allowed error.
    ///
    /// ```text
    ///     allowed error    e_1 ------------------------- e_2 ---------------- e_3
    ///     state             0 --> 1 | 1 at rest           1 --> 2 | 2 at rest
    /// ```
    ///
    /// While level `i - 1` turns into level `i`, the bound is the error of level `i`, so the way begins where this error is
    /// allowed. Levels of equal error are passed on one way.
    #[inline]
    fn state(&self, allowed: Allowed) -> Morph {
        let (levels, error) = match allowed {
            Allowed::Nothing => return Morph::default(),
            Allowed::Anything => return Morph { level: self.errors.len() - 1, share: 0.0 },
            Allowed::Error(error) => (self.errors.len(), error),
        };
        // Level `to` is within the error, and the level behind it is not. The comparison is false for NaN.
        let within = self.errors.partition_point(|&e| e <= error);
        let Some(to) = within.checked_sub(1) else { return Morph::default() };
        let Some(Way { from, length }) = self.ways[to] else { return Morph { level: to, share: 0.0 } };
        let gone = ((f64::from(error) - f64::from(self.errors[to])) / length).min(1.0);
        if gone < 1.0 {
            Morph::at(from as f32 + gone as f32 * (to - from) as f32, levels)
        } else {
            Morph { level: to, share: 0.0 }
        }
    }
}

/// A drawn instance of a [`Gmesh`], at the coarsest state with an error bound within the tolerance at the point of the
/// model's bounding sphere nearest to the eye.
///
/// Index buffers hold all levels and are written once. With [`LodOptions::geomorph`], vertices are moved by the processor, and
/// the vertex buffer is written as they move; the state then moves at most one level per duration while it is seen (motion of the
/// eye adds to the time, and a single call moves at most one level). Without,
/// the vertex buffer holds the vertices at rest and is written once: draw with a shader that moves them by
/// [`Lod::morph`], or leave them at rest.
#[derive(Debug, Clone)]
pub struct GmeshLod<V> {
    model: Baked<Gmesh>,
    table: Arc<Table>,
    /// Views are kept only where vertices move.
    shared: WholeInstance<V>,
    /// Number of views tested by the last call.
    tests: usize,
    /// State drawn.
    now: Morph,
    /// State asked for, within the triangle limit.
    wanted: Morph,
    /// State of the vertices that the processor moves.
    at: Morph,
    /// Set until the index buffers are uploaded.
    unwritten: bool,
}

impl<V: Vertex> GmeshLod<V> {
    /// Makes an instance at the coarsest level. Needs as many values as vertices.
    pub(super) fn of(
        model: &Baked<Gmesh>,
        values: Values<V>,
        options: &LodOptions,
    ) -> Result<Self, LodError> {
        let shared = WholeInstance::new(values, model.structure().vertex_count(), options)?;
        let coarsest = Morph { level: model.structure().levels().len() - 1, share: 0.0 };
        Ok(Self {
            model: model.clone(),
            table: Arc::clone(model.table()?),
            shared,
            tests: 0,
            now: coarsest,
            wanted: coarsest,
            at: coarsest,
            unwritten: true,
        })
    }

    /// Returns the structure.
    pub fn gmesh(&self) -> &Arc<Gmesh> {
        self.model.structure()
    }

    /// Returns the drawn state.
    pub fn state(&self) -> Morph {
        self.now
    }

    /// Returns the drawn values of all vertices of the structure.
    pub fn values(&self) -> &[V] {
        self.shared.values()
    }

    /// Draws a state at once, within the triangle limit, whatever the views: for a T of your own
    /// ([`Partition::at`](super::Partition::at)), by distance or by a controller. Forgets the views: the next
    /// [`adapt`](Lod::adapt) takes no time for a geomorph.
    ///
    /// ```
    /// use multires::gmesh::{DistanceRange, Gmesh, Partition};
    /// use multires::prelude::*;
    ///
    /// let mesh = multires::mesh::shapes::rock(2_000, 1);
    /// let model = Gmesh::bake(&mesh)?;
    /// let mut lod = model.instance(model.arrange(mesh.positions())?, &LodOptions::default())?;
    /// let partition = Partition::even(lod.gmesh().levels().len());
    /// let range = DistanceRange { near: 2.0, far: 20.0 };
    /// let change = lod.show(partition.at(range.t(11.0)));
    /// assert!(change.triangles < mesh.triangles().len() / 4);
    /// # Ok::<(), Error>(())
    /// ```
    pub fn show(&mut self, state: Morph) -> Change {
        let before = self.now;
        self.shared.views.clear();
        self.tests = 0;
        self.wanted = self.within_limit(self.gmesh().clamped(state));
        self.place(self.wanted);
        self.change(before)
    }

    /// Reports the change from state `before` to the drawn state.
    fn change(&self, before: Morph) -> Change {
        let levels = self.gmesh().levels();
        let [was, now, wanted] = [before, self.now, self.wanted].map(|morph| &levels[morph.level]);
        let (was, is, wanted, triangles) = (was.vertices, now.vertices, wanted.vertices, now.triangles);
        let is_under_way = self.now != self.wanted;
        let moves = self.shared.moves() && self.now.share > 0.0 && is_under_way;
        Change {
            cut: CutReport {
                tests: self.tests,
                splits: is.saturating_sub(was),
                collapses: was.saturating_sub(is),
                ..CutReport::default()
            },
            triangles,
            pending: is.abs_diff(wanted).max(usize::from(is_under_way)),
            moving: if moves { self.gmesh().moving(self.now.level).len() } else { 0 },
            over_budget: self.shared.options().triangles.is_some_and(|most| triangles > most),
        }
    }

    /// Returns a state, or if it has too many triangles, the finest level within the triangle limit.
    fn within_limit(&self, state: Morph) -> Morph {
        let gmesh = self.gmesh();
        match self.shared.options().triangles {
            Some(most) if gmesh.levels()[state.level].triangles > most => {
                Morph { level: gmesh.level_within(most), share: 0.0 }
            }
            _ => state,
        }
    }

    /// Holds while more triangles are drawn than the limit allows, and fewer are possible.
    fn is_above_limit(&self) -> bool {
        let gmesh = self.gmesh();
        let now = gmesh.levels()[self.now.level].triangles;
        let most = self.shared.options().triangles;
        most.is_some_and(|most| now > most) && self.now.level + 1 < gmesh.levels().len()
    }

    /// Returns the state reached towards the wanted state in a single call: at most `progress` levels away (`None`: any number),
    /// and at most the allowed number of vertices, but at least a level.
    fn towards(&self, progress: Option<f32>) -> Morph {
        let is_free = progress.is_none() && self.shared.options().operations.is_none();
        if is_free || self.is_above_limit() {
            return self.wanted;
        }
        let (levels, now, wanted) = (self.gmesh().levels(), self.now.position(), self.wanted.position());
        let mut to = wanted;
        if let Some(progress) = progress {
            to = wanted.clamp(now - progress, now + progress);
        }
        if let Some(most) = self.shared.options().operations {
            let here = levels[self.now.level].vertices;
            let near = |level: &usize| levels[*level].vertices.abs_diff(here) <= most;
            let finest = (0..self.now.level).find(near).unwrap_or(self.now.level.saturating_sub(1));
            let coarsest = (self.now.level + 1..levels.len()).rev().find(near).unwrap_or(self.now.level + 1);
            to = to.clamp(finest as f32, coarsest as f32);
        }
        if to == wanted { self.wanted } else { Morph::at(to, levels.len()) }
    }

    /// Draws a state.
    #[inline]
    fn place(&mut self, to: Morph) {
        self.now = to;
        if self.shared.moves() && self.at != to {
            self.move_vertices(to);
        }
    }

    /// Moves the vertices to their places in a state.
    fn move_vertices(&mut self, to: Morph) {
        let at = self.at;
        let gmesh = Arc::clone(self.model.structure());
        let numbers = |level: usize| gmesh.moving(level).map(|vertex| vertex as u32);
        if at.level != to.level && at.share > 0.0 {
            self.shared.rest(numbers(at.level));
        }
        if to.share > 0.0 || at.level == to.level {
            let ends = |vertex: u32| (vertex, [vertex, gmesh.targets()[vertex as usize]]);
            self.shared.blend(numbers(to.level).map(ends), to.share);
        }
        self.at = to;
    }

    /// Returns the number of vertices in use.
    fn prefix(&self) -> usize {
        self.gmesh().levels()[self.now.level].vertices
    }
}

impl<V: Vertex> Lod for GmeshLod<V> {
    fn adapt(&mut self, views: &[ObjectView], seconds: f32) -> Change {
        let before = self.now;
        let allowed = self.table.whole.allowed(views, self.shared.factor());
        self.wanted = self.within_limit(self.table.state(allowed));
        self.tests = views.len();
        let mut progress = None;
        if let Some(geomorph) = self.shared.options().geomorph {
            // Out of view before or now, vertices jump.
            let (whole, before) = (&self.table.whole, &self.shared.views);
            if geomorph.duration > 0.0 && whole.is_seen(before) && whole.is_seen(views) {
                let motion = Whole::motion(views, before);
                progress = Some(geomorph.progress(seconds, motion, f64::from(whole.diagonal())));
            }
            self.shared.look(views);
        }
        self.place(self.towards(progress));
        self.change(before)
    }

    fn refine_fully(&mut self) -> Change {
        self.shared.views.clear();
        let before = self.now;
        self.wanted = self.within_limit(Morph::default());
        self.settle();
        self.change(before)
    }

    fn settle(&mut self) {
        self.place(self.wanted);
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
            self.at = Morph { share: 0.0, ..self.now };
            self.shared.views.clear();
            self.place(self.now);
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
        let levels = self.gmesh().levels();
        levels[self.wanted.level].vertices - levels[levels.len() - 1].vertices
    }

    fn groups(&self) -> usize {
        self.gmesh().groups()
    }

    fn material(&self, group: usize) -> u32 {
        self.gmesh().material_ids().get(group).copied().unwrap_or(NONE)
    }

    fn triangles(&self, group: usize) -> &[[u32; 3]] {
        self.gmesh().triangles(self.now.level, group)
    }

    fn buffered_triangles(&self, group: usize) -> &[[u32; 3]] {
        self.gmesh().index_buffer(group)
    }

    fn first_triangle(&self, group: usize) -> usize {
        self.gmesh().range(self.now.level, group).start
    }

    fn drawn_range(&self, group: usize) -> Range<usize> {
        self.gmesh().range(self.now.level, group)
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

    fn shares_triangles(&self) -> bool {
        true
    }

    fn morph(&self) -> Option<MorphUniform> {
        (!self.shared.moves()).then(|| self.gmesh().uniform(self.now))
    }

    fn dirty_triangles(&self, group: usize, _: usize) -> DirtyRanges<'_> {
        let count = if self.unwritten { self.gmesh().index_buffer(group).len() } else { 0 };
        DirtyRanges::whole(count)
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

    fn clean(&mut self) {
        self.unwritten = false;
        self.shared.clean(self.prefix());
    }

    fn invalidate(&mut self) {
        self.unwritten = true;
        self.shared.invalidate();
    }

    fn to_mesh(&self) -> Mesh {
        // Without moving vertices, the buffer holds them at rest.
        let share = if self.shared.moves() { self.now.share } else { 0.0 };
        self.model.mesh_at(Morph { share, ..self.now })
    }

    fn memory(&self) -> usize {
        self.shared.memory()
    }
}
