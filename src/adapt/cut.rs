//! A cut through a structure's refinements: the smallest closed set containing all refinements asked for by a view.

use crate::view::{Bounds, Criterion, Motion};

use super::closure::Closure;
use super::front::{Changes, Front};
use super::refinements::Refinements;
use super::states::{ASKED, States};

/// Counts from one update of a cut.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub struct CutReport {
    /// Refinements tested by the criterion.
    pub tests: usize,
    /// Refinements added to the mesh.
    pub splits: usize,
    /// Refinements removed from the mesh.
    pub collapses: usize,
    /// Blocks of 64 refinements that may come or go.
    pub blocks: usize,
    /// Blocks asleep: none of their answers can have changed, and none was looked at.
    pub asleep: usize,
}

/// A set of refinements: the refinements in the mesh.
///
/// After every call of [`Lod::adapt`](crate::lod::Lod::adapt) it is the smallest set containing every refinement needed by the criterion and closed under
/// parents and dependencies. It depends on the criterion alone, not on the previous cut.
#[derive(Debug, Clone)]
pub struct Cut<B = Bounds> {
    pub(super) front: Front<B>,
    pub(super) closure: Closure,
}

impl<B: Copy> Cut<B> {
    /// Creates the coarsest cut, without refinements. `size` is the length of the object, object units. `dependencies`
    /// says whether any refinement has dependencies besides its parents. Takes 4 bytes for each page of 512 refinements (8 with
    /// dependencies), 4 (8) for each refinement of a page that holds some of the cut, and 48 for each that may come or go.
    pub(crate) fn new(count: usize, size: f64, dependencies: bool) -> Self {
        Self { front: Front::new(count, size, dependencies), closure: Closure::new(count, dependencies) }
    }

    /// Whether a refinement is in the mesh.
    pub fn holds(&self, refinement: u32) -> bool {
        self.front.states.is_done(refinement)
    }

    /// Returns the refinements in the mesh, in ascending order. O(refinements in the mesh + all / 512).
    pub fn refinements(&self) -> impl Iterator<Item = u32> + '_ {
        self.front.states.done()
    }

    /// Whether the view asks for a refinement. A refinement not asked for may still be in the mesh, if others need it.
    pub fn asks_for(&self, refinement: u32) -> bool {
        self.front.states.has(refinement, ASKED)
    }

    /// Moves the cut to the refinements now needed by `criterion`. `motion` is the criterion's motion since the last
    /// call.
    ///
    /// `apply` is called with the flags of all refinements, a refinement, and `true` if the refinement comes or `false`
    /// if it goes. The set is closed after each call.
    ///
    /// Cost: one test for each refinement at the cut with an answer due, plus the refinements which come and go.
    pub(crate) fn update<R: Refinements<Bounds = B> + ?Sized, C: Criterion<B> + ?Sized>(
        &mut self,
        of: &R,
        criterion: &C,
        motion: Motion,
        apply: &mut impl Apply,
    ) -> CutReport {
        let mut counted = Counted { apply, splits: 0, collapses: 0 };
        let (_, tests) = self.update_while(of, criterion, motion, &mut counted);
        let [blocks, asleep] = self.front.blocks;
        CutReport { tests, splits: counted.splits, collapses: counted.collapses, blocks, asleep }
    }

    /// Moves the cut as [`Cut::update`] does, until `apply` returns `false`. If stopped, the cut is closed, but need not
    /// be the cut of the criterion. Returns whether the update was completed, and the number of tests.
    pub(super) fn update_while<R: Refinements<Bounds = B> + ?Sized, C: Criterion<B> + ?Sized>(
        &mut self,
        of: &R,
        criterion: &C,
        motion: Motion,
        apply: &mut impl Apply,
    ) -> (bool, usize) {
        let Self { front, closure } = self;
        let before = front.tests;
        let all = front.update(of, criterion, motion, &mut Closed { of, closure, apply });
        closure.sweep();
        (all, (front.tests - before) as usize)
    }

    /// Asks again, in the next update, about refinements which waited for others to arrive.
    #[cfg(all(feature = "stream", feature = "io"))]
    pub(crate) fn arrived(&mut self) {
        self.front.arrived();
    }

    /// Returns the report of an update that finds everything asleep.
    pub(crate) fn asleep(&self) -> CutReport {
        let blocks = self.front.blocks_now();
        CutReport { blocks, asleep: blocks, ..CutReport::default() }
    }

    /// Gives back memory if most of it is not in use.
    pub(crate) fn trim(&mut self) {
        self.front.trim();
        self.closure.trim();
    }

    /// Bytes of the cut's arrays.
    pub fn memory(&self) -> usize {
        self.front.memory() + self.closure.memory()
    }
}

/// What follows the changes of a cut.
pub(crate) trait Apply {
    /// Called with some refinements that are likely to come (`true`) or go next.
    fn look_ahead(&mut self, changes: &[(u32, bool)]) {
        let _ = changes;
    }

    /// Called with each refinement which comes (`true`) or goes, and the flags of all: the set is closed after each call. If it
    /// returns `false`, the update stops.
    fn apply(&mut self, states: &States, refinement: u32, comes: bool) -> bool;
}

impl<F: FnMut(&States, u32, bool) -> bool> Apply for F {
    fn apply(&mut self, states: &States, refinement: u32, comes: bool) -> bool {
        self(states, refinement, comes)
    }
}

/// Counts what comes and goes.
struct Counted<'a, A> {
    apply: &'a mut A,
    splits: usize,
    collapses: usize,
}

impl<A: Apply> Apply for Counted<'_, A> {
    fn look_ahead(&mut self, changes: &[(u32, bool)]) {
        self.apply.look_ahead(changes);
    }

    fn apply(&mut self, states: &States, refinement: u32, comes: bool) -> bool {
        if comes {
            self.splits += 1;
        } else {
            self.collapses += 1;
        }
        self.apply.apply(states, refinement, comes)
    }
}

/// Closes the set asked for.
struct Closed<'a, R: ?Sized, A> {
    of: &'a R,
    closure: &'a mut Closure,
    apply: &'a mut A,
}

impl<R: Refinements + ?Sized, A: Apply> Changes for Closed<'_, R, A> {
    fn look_ahead(&mut self, changes: &[(u32, bool)]) {
        self.apply.look_ahead(changes);
    }

    fn change(&mut self, states: &mut States, r: u32, asked: bool) -> bool {
        let Self { of, closure, apply } = self;
        let mut go_on = true;
        closure.change(*of, states, r, asked, &mut |states, r, comes| go_on &= apply.apply(states, r, comes));
        go_on
    }
}
