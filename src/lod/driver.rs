//! Common parts of instances refined by view: the cut asked for by the views, and the refinements drawn on the way
//! there.

use crate::adapt::{
    AT_REST, Apply, Change, Cut, FrameLimits, RefinementSink, Refinements, States, Tolerance, Weights,
};
use crate::view::{Answer, Bounds, Criterion, Motion, ObjectView};

use super::LodOptions;
use super::patience::Patience;

/// Moves a cut by views, and draws the way there within limits.
#[derive(Debug, Clone)]
pub(crate) struct Driver<B = Bounds> {
    cut: Cut<B>,
    views: Vec<ObjectView>,
    options: LodOptions,
    /// `None` if the cut is drawn at once.
    limits: Option<Box<FrameLimits>>,
    tolerance: Tolerance,
    /// Set if no answer of the cut holds any more.
    forgets: bool,
    /// The last change, if the same views change nothing more.
    rest: Option<Change>,
    patience: Patience,
}

impl<B: Copy> Driver<B> {
    /// Starts at the coarsest cut, with default options.
    pub fn new(cut: Cut<B>) -> Self {
        Self {
            cut,
            views: Vec::new(),
            options: LodOptions::default(),
            limits: None,
            tolerance: Tolerance::default(),
            forgets: false,
            rest: None,
            patience: Patience::default(),
        }
    }

    pub fn cut(&self) -> &Cut<B> {
        &self.cut
    }

    pub fn options(&self) -> &LodOptions {
        &self.options
    }

    pub fn tolerance_factor(&self) -> f32 {
        self.tolerance.factor()
    }

    pub fn set_tolerance_factor(&mut self, factor: f32) {
        let before = self.tolerance.factor();
        self.tolerance.set(factor);
        if self.tolerance.factor() != before {
            self.rest = None;
        }
    }

    /// Holds if refinement `r` is drawn. Under limits, this may differ from being in the cut.
    pub fn shows(&self, r: u32) -> bool {
        self.limits.as_ref().map_or_else(|| self.cut.holds(r), |limits| limits.shows(r))
    }

    /// Refinements in transition.
    pub fn weights(&self) -> &Weights {
        self.limits.as_ref().map_or(&AT_REST, |limits| limits.weights())
    }

    /// Asks again about refinements which waited for others to arrive. Within a limit of triangles, asks about every refinement.
    #[cfg(all(feature = "stream", feature = "io"))]
    pub fn arrived(&mut self) {
        self.cut.arrived();
        self.rest = None;
        self.forgets |= self.options.triangles.is_some();
    }

    /// Returns the factor of tolerances by which the limit of triangles is kept; 1 without a limit.
    #[cfg(all(feature = "stream", feature = "io"))]
    pub fn limit_factor(&self) -> f64 {
        self.limits.as_ref().map_or(1.0, |limits| limits.factor())
    }

    /// Asks about every refinement in the next call.
    pub fn forget(&mut self) {
        self.forgets = true;
        self.rest = None;
    }

    /// Sets new options. `wanted` counts the triangles at the cut.
    pub fn set_options<R: Refinements<Bounds = B> + ?Sized>(
        &mut self,
        of: &R,
        options: &LodOptions,
        sink: &mut impl RefinementSink,
        wanted: impl FnOnce(&Cut<B>) -> usize,
    ) {
        self.rest = None;
        self.forgets |= options.triangles != self.options.triangles;
        let moves = options.geomorph.is_some();
        let counts_anew = options.triangulation != self.options.triangulation;
        if (options.is_immediate() || moves != self.options.geomorph.is_some() || counts_anew)
            && let Some(mut limits) = self.limits.take()
        {
            limits.settle(of, sink);
            // A new budget has given no answers yet.
            self.forgets = true;
        }
        self.options = *options;
        if options.is_immediate() {
            return;
        }
        let cut = &self.cut;
        let limits =
            self.limits.get_or_insert_with(|| Box::new(FrameLimits::new(of, cut, sink.triangles(), moves)));
        limits.set(options.triangles, options.operations, wanted(cut));
    }

    /// Draws the whole cut at once.
    pub fn settle<R: Refinements<Bounds = B> + ?Sized>(&mut self, of: &R, sink: &mut impl RefinementSink) {
        if let Some(limits) = &mut self.limits {
            limits.settle(of, sink);
        }
    }

    /// Returns the change of a call that changes nothing: with the same views as the last call, which has left nothing to do. Reads
    /// little else than the views, so instances at rest cost next to nothing. And whether to give back memory.
    #[inline]
    pub fn at_rest(&mut self, views: &[ObjectView]) -> Option<(Change, bool)> {
        let change = self.rest.filter(|_| self.views == views)?;
        Some((change, self.patience.frame(change.triangles, false)))
    }

    /// Corrects the triangles of a rest: where they were counted before the change was drawn.
    pub fn rest_at(&mut self, triangles: usize) {
        if let Some(rest) = &mut self.rest {
            rest.triangles = triangles;
        }
    }

    /// Counts a frame with changes. Returns whether to give back memory.
    pub fn waited(&mut self, change: &Change) -> bool {
        self.patience.frame(change.triangles, true)
    }

    /// Gives back memory if most of it is not in use.
    pub fn trim(&mut self) {
        self.cut.trim();
        if let Some(limits) = &mut self.limits {
            limits.trim();
        }
    }

    /// Moves to the cut asked for by views. `diagonal` is the object's.
    pub fn adapt<R: Refinements<Bounds = B> + ?Sized>(
        &mut self,
        of: &R,
        (views, seconds, diagonal): (&[ObjectView], f32, f64),
        sink: &mut impl RefinementSink,
        cost: impl FnMut(u32, bool) -> usize,
    ) -> Change
    where
        [ObjectView]: Criterion<B>,
    {
        let motion = if self.views.is_empty() { Motion::Other } else { views.motion(&self.views) };
        let change = self.adapt_by(of, (views, motion, seconds, diagonal), sink, cost);
        self.views.extend_from_slice(views);
        if change.pending == 0 && change.moving == 0 && !change.over_budget {
            self.rest = Some(Change { cut: self.cut.asleep(), ..change });
        }
        change
    }

    /// Moves to the cut needed by a criterion. The next views are asked about every refinement.
    pub fn adapt_by<R: Refinements<Bounds = B> + ?Sized, C: Criterion<B> + ?Sized>(
        &mut self,
        of: &R,
        (criterion, motion, seconds, diagonal): (&C, Motion, f32, f64),
        sink: &mut impl RefinementSink,
        cost: impl FnMut(u32, bool) -> usize,
    ) -> Change {
        self.views.clear();
        self.rest = None;
        let progress =
            self.options.geomorph.map_or(1.0, |geomorph| geomorph.progress(seconds, motion, diagonal));
        let motion = if std::mem::take(&mut self.forgets) { Motion::Other } else { motion };
        if self.tolerance.is_one() {
            return self.move_to(of, (criterion, motion, progress), sink, cost);
        }
        let (scaled, motion) = self.tolerance.scale(criterion, motion);
        self.move_to(of, (&scaled, motion, progress), sink, cost)
    }

    fn move_to<R: Refinements<Bounds = B> + ?Sized, C: Criterion<B> + ?Sized>(
        &mut self,
        of: &R,
        (criterion, motion, progress): (&C, Motion, f32),
        sink: &mut impl RefinementSink,
        cost: impl FnMut(u32, bool) -> usize,
    ) -> Change {
        let Self { cut, limits, .. } = self;
        match limits {
            None => direct(of, cut, (criterion, motion), sink),
            Some(limits) => limits.update((of, cut), sink, criterion, motion, progress, cost),
        }
    }

    /// Returns the bytes of its arrays.
    pub fn memory(&self) -> usize {
        self.cut.memory() + self.limits.as_ref().map_or(0, |limits| limits.memory())
    }
}

/// Draws what comes, and removes what goes.
struct Drawn<'a, S>(&'a mut S);

impl<S: RefinementSink> Apply for Drawn<'_, S> {
    fn look_ahead(&mut self, changes: &[(u32, bool)]) {
        self.0.look_ahead(changes);
    }

    fn apply(&mut self, states: &States, refinement: u32, comes: bool) -> bool {
        if comes {
            self.0.refine(refinement, false, |other| states.is_done(other));
        } else {
            self.0.coarsen(refinement);
        }
        true
    }
}

/// Draws the cut at once: the fast way, without limits.
fn direct<R: Refinements + ?Sized, C: Criterion<R::Bounds> + ?Sized>(
    of: &R,
    cut: &mut Cut<R::Bounds>,
    (criterion, motion): (&C, Motion),
    sink: &mut impl RefinementSink,
) -> Change {
    let cut = cut.update(of, criterion, motion, &mut Drawn(&mut *sink));
    Change { cut, triangles: sink.triangles(), ..Change::default() }
}

/// A criterion to need every refinement, from everywhere.
pub(crate) struct Everything;

impl<B> Criterion<B> for Everything {
    fn test(&self, _: &B) -> Answer {
        Answer::ALWAYS
    }

    fn motion(&self, _: &Self) -> Motion {
        Motion::Moved { distance: 0.0, angle: 0.0 }
    }
}
