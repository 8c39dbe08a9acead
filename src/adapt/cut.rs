//! A cut through a structure's refinements: the smallest closed set containing all refinements asked for by a view.

use crate::view::{Bounds, Criterion, Motion};

use super::closure::Closure;
use super::front::{ASKED, Changes, DONE, Front};
use super::refinements::Refinements;

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
    /// says whether any refinement has dependencies besides its parents. Takes 5 bytes a refinement, 9 with dependencies, and 48 for each that may come or
    /// go.
    pub(crate) fn new(count: usize, size: f64, dependencies: bool) -> Self {
        Self { front: Front::new(count, size), closure: Closure::new(count, dependencies) }
    }

    /// Whether a refinement is in the mesh.
    pub fn holds(&self, refinement: u32) -> bool {
        self.front.state.get(refinement as usize).is_some_and(|s| s & DONE != 0)
    }

    /// Whether the view asks for a refinement. A refinement not asked for may still be in the mesh, if others need it.
    pub fn asks_for(&self, refinement: u32) -> bool {
        self.front.state.get(refinement as usize).is_some_and(|s| s & ASKED != 0)
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
        (all, (front.tests - before) as usize)
    }

    /// Asks again, in the next update, about refinements which waited for others to arrive.
    #[cfg(all(feature = "stream", feature = "io"))]
    pub(crate) fn arrived(&mut self) {
        self.front.arrived();
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
    fn apply(&mut self, state: &[u8], refinement: u32, comes: bool) -> bool;
}

impl<F: FnMut(&[u8], u32, bool) -> bool> Apply for F {
    fn apply(&mut self, state: &[u8], refinement: u32, comes: bool) -> bool {
        self(state, refinement, comes)
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

    fn apply(&mut self, state: &[u8], refinement: u32, comes: bool) -> bool {
        if comes {
            self.splits += 1;
        } else {
            self.collapses += 1;
        }
        self.apply.apply(state, refinement, comes)
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

    fn change(&mut self, state: &mut [u8], r: u32, asked: bool) -> bool {
        let Self { of, closure, apply } = self;
        let mut go_on = true;
        closure.change(*of, state, r, asked, &mut |state, r, comes| go_on &= apply.apply(state, r, comes));
        go_on
    }
}

/// Whether a refinement is in the mesh, by the flags passed to [`Apply::apply`].
#[inline]
pub(crate) fn is_done(state: &[u8], refinement: u32) -> bool {
    state[refinement as usize] & DONE != 0
}
