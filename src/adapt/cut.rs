//! A cut through a structure's refinements: the smallest closed set that holds all that a view asks for.

use crate::view::{Criterion, Motion};

use super::closure::Closure;
use super::front::{ASKED, DONE, Front};
use super::refinements::Refinements;

/// What one move of a cut did.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub struct CutReport {
    /// Refinements whose need was tested.
    pub tests: usize,
    /// Refinements that came into the mesh.
    pub splits: usize,
    /// Refinements that went out of it.
    pub collapses: usize,
}

/// Which refinements are in the mesh.
///
/// After [`Cut::update`] it is the smallest set that holds every refinement that the criterion needs and is closed under
/// parents and needs. It depends on the criterion alone, not on where the cut was before.
#[derive(Debug, Clone)]
pub struct Cut {
    pub(super) front: Front,
    pub(super) closure: Closure,
}

impl Cut {
    /// The coarsest cut: no refinement. `size` is the length over which the object extends, object units; `dependencies` is whether
    /// any refinement has needs besides its parents. 5 bytes a refinement, 9 with needs.
    pub fn new(count: usize, size: f64, dependencies: bool) -> Self {
        Self { front: Front::new(count, size), closure: Closure::new(count, dependencies) }
    }

    /// Whether a refinement is in the mesh.
    pub fn holds(&self, refinement: u32) -> bool {
        self.front.state.get(refinement as usize).is_some_and(|s| s & DONE != 0)
    }

    /// Whether the view asks for a refinement (it may also be there because others need it).
    pub fn asks_for(&self, refinement: u32) -> bool {
        self.front.state.get(refinement as usize).is_some_and(|s| s & ASKED != 0)
    }

    /// Moves the cut to what `criterion` needs now. `motion` is what has happened to it since the last call. `apply` is told
    /// each refinement that comes (`true`) or goes, and may ask by the function it is handed which are there; after every
    /// call the set is closed.
    ///
    /// Cost: one test for each refinement at the cut whose answer may have changed, plus what changes.
    pub fn update<R: Refinements + ?Sized, C: Criterion<R::Bounds> + ?Sized>(
        &mut self,
        of: &R,
        criterion: &C,
        motion: Motion,
        mut apply: impl FnMut(&[u8], u32, bool),
    ) -> CutReport {
        let (mut splits, mut collapses) = (0, 0);
        let (_, tests) = self.update_while(of, criterion, motion, |state, r, comes| {
            if comes {
                splits += 1;
            } else {
                collapses += 1;
            }
            apply(state, r, comes);
            true
        });
        CutReport { tests, splits, collapses }
    }

    /// The same, but `apply` may say no to go on; then the set is closed, and nothing else is promised of it. Whether it
    /// never did, and the number of tests.
    pub(super) fn update_while<R: Refinements + ?Sized, C: Criterion<R::Bounds> + ?Sized>(
        &mut self,
        of: &R,
        criterion: &C,
        motion: Motion,
        mut apply: impl FnMut(&[u8], u32, bool) -> bool,
    ) -> (bool, usize) {
        let Self { front, closure } = self;
        let before = front.tests;
        let all = front.update(of, criterion, motion, |state, r, asked| {
            let mut go_on = true;
            closure.change(of, state, r, asked, &mut |state, r, comes| go_on &= apply(state, r, comes));
            go_on
        });
        (all, (front.tests - before) as usize)
    }

    /// Bytes of its arrays.
    pub fn memory(&self) -> usize {
        self.front.memory() + self.closure.memory()
    }
}

/// Whether a refinement is in the mesh, by the flags that [`Cut::update`] hands out.
#[inline]
pub(crate) fn is_done(state: &[u8], refinement: u32) -> bool {
    state[refinement as usize] & DONE != 0
}
