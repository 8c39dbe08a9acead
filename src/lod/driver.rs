//! What instances that refine by view have in common: the cut that views ask for, and what is drawn on the way there.

use crate::adapt::{Change, Cut, Pace, Picture, Refinements, Tolerance, is_done};
use crate::view::{Answer, Criterion, Motion, ObjectView};

use super::LodOptions;

/// Drives a picture by views.
#[derive(Debug, Clone)]
pub(crate) struct Driver {
    cut: Cut,
    views: Vec<ObjectView>,
    options: LodOptions,
    /// `None` where what is asked for is drawn at once.
    pace: Option<Box<Pace>>,
    tolerance: Tolerance,
    /// Whether no answer of the cut holds any more.
    forgets: bool,
}

impl Driver {
    /// At the coarsest cut, with default options.
    pub fn new(cut: Cut) -> Self {
        Self {
            cut,
            views: Vec::new(),
            options: LodOptions::default(),
            pace: None,
            tolerance: Tolerance::default(),
            forgets: false,
        }
    }

    pub fn cut(&self) -> &Cut {
        &self.cut
    }

    pub fn options(&self) -> &LodOptions {
        &self.options
    }

    pub fn tolerance_factor(&self) -> f32 {
        self.tolerance.factor()
    }

    pub fn set_tolerance_factor(&mut self, factor: f32) {
        self.tolerance.set(factor);
    }

    /// Whether a refinement is drawn, where that may differ from being in the cut.
    pub fn shows(&self, r: u32) -> bool {
        self.pace.as_ref().map_or_else(|| self.cut.holds(r), |pace| pace.shows(r))
    }

    /// Asks about everything in the next call.
    pub fn forget(&mut self) {
        self.forgets = true;
    }

    /// Takes new options. `wanted` counts the triangles at the cut.
    pub fn set_options<R: Refinements + ?Sized>(
        &mut self,
        of: &R,
        options: &LodOptions,
        picture: &mut impl Picture,
        wanted: impl FnOnce(&Cut) -> usize,
    ) {
        self.forgets |= options.triangles != self.options.triangles;
        let moves = options.geomorph.is_some();
        if options.is_immediate() || moves != self.options.geomorph.is_some() {
            if let Some(mut pace) = self.pace.take() {
                pace.settle(of, picture);
            }
        }
        self.options = *options;
        if options.is_immediate() {
            return;
        }
        let cut = &self.cut;
        let pace = self.pace.get_or_insert_with(|| Box::new(Pace::new(of, cut, picture.triangles(), moves)));
        pace.set(options.triangles, options.operations, wanted(cut));
    }

    /// Draws all that was last asked for, at once.
    pub fn settle<R: Refinements + ?Sized>(&mut self, of: &R, picture: &mut impl Picture) {
        if let Some(pace) = &mut self.pace {
            pace.settle(of, picture);
        }
    }

    /// Moves to what views ask for. `diagonal` is the object's.
    pub fn adapt<R: Refinements + ?Sized>(
        &mut self,
        of: &R,
        (views, seconds, diagonal): (&[ObjectView], f32, f64),
        picture: &mut impl Picture,
        cost: impl FnMut(u32, bool) -> usize,
    ) -> Change
    where
        [ObjectView]: Criterion<R::Bounds>,
    {
        let motion = if self.views.is_empty() { Motion::Other } else { views.motion(&self.views) };
        let change = self.adapt_by(of, (views, motion, seconds, diagonal), picture, cost);
        self.views.extend_from_slice(views);
        change
    }

    /// Moves to what a criterion needs. The next views are asked about everything.
    pub fn adapt_by<R: Refinements + ?Sized, C: Criterion<R::Bounds> + ?Sized>(
        &mut self,
        of: &R,
        (criterion, motion, seconds, diagonal): (&C, Motion, f32, f64),
        picture: &mut impl Picture,
        cost: impl FnMut(u32, bool) -> usize,
    ) -> Change {
        self.views.clear();
        let progress =
            self.options.geomorph.map_or(1.0, |geomorph| geomorph.progress(seconds, motion, diagonal));
        let motion = if std::mem::take(&mut self.forgets) { Motion::Other } else { motion };
        if self.tolerance.is_one() {
            return self.move_to(of, (criterion, motion, progress), picture, cost);
        }
        let (scaled, motion) = self.tolerance.scale(criterion, motion);
        self.move_to(of, (&scaled, motion, progress), picture, cost)
    }

    fn move_to<R: Refinements + ?Sized, C: Criterion<R::Bounds> + ?Sized>(
        &mut self,
        of: &R,
        (criterion, motion, progress): (&C, Motion, f32),
        picture: &mut impl Picture,
        cost: impl FnMut(u32, bool) -> usize,
    ) -> Change {
        let Self { cut, pace, .. } = self;
        match pace {
            None => direct(of, cut, (criterion, motion), picture),
            Some(pace) => pace.update((of, cut), picture, criterion, motion, progress, cost),
        }
    }

    /// Bytes of its arrays.
    pub fn memory(&self) -> usize {
        self.cut.memory() + self.pace.as_ref().map_or(0, |pace| pace.memory())
    }
}

/// The fast way: what is asked for is drawn at once.
fn direct<R: Refinements + ?Sized, C: Criterion<R::Bounds> + ?Sized>(
    of: &R,
    cut: &mut Cut,
    (criterion, motion): (&C, Motion),
    picture: &mut impl Picture,
) -> Change {
    let cut = cut.update(of, criterion, motion, |state, r, comes| {
        if comes {
            picture.refine(r, false, |other| is_done(state, other));
        } else {
            picture.coarsen(r);
        }
    });
    Change { cut, triangles: picture.triangles(), ..Change::default() }
}

/// Needs everything, from everywhere.
pub(crate) struct Everything;

impl<B> Criterion<B> for Everything {
    fn needs(&self, _: &B) -> Answer {
        Answer::ALWAYS
    }

    fn motion(&self, _: &Self) -> Motion {
        Motion::Moved { distance: 0.0, angle: 0.0 }
    }
}
