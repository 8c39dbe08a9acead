//! Between the cut that a view asks for and what is shown: a budget of triangles, and so much a frame.

use crate::view::{Criterion, Motion};

use super::budget::Budget;
use super::change::Change;
use super::cut::Cut;
use super::refinements::Refinements;
use super::transitions::{Limits, RefinementSink, Transitions};

/// What a level of detail with limits, or with vertices that move, keeps besides its cut.
#[derive(Debug, Clone)]
pub(crate) struct FrameLimits {
    operations: usize,
    triangles: usize,
    budget: Option<Budget>,
    transitions: Transitions,
}

impl FrameLimits {
    /// Where the cut is what is shown, in so many triangles. `moves`: whether vertices may move.
    pub fn new<R: Refinements + ?Sized>(of: &R, cut: &Cut, triangles: usize, moves: bool) -> Self {
        let transitions = Transitions::new(of, |r| cut.holds(r), triangles, moves);
        Self { operations: usize::MAX, triangles: usize::MAX, budget: None, transitions }
    }

    /// Sets the limits of triangles and of operations. The cut has `at_cut` triangles.
    pub fn set(&mut self, triangles: Option<usize>, operations: Option<usize>, at_cut: usize) {
        self.operations = operations.unwrap_or(usize::MAX);
        self.triangles = triangles.unwrap_or(usize::MAX);
        match (triangles, &mut self.budget) {
            (Some(limit), Some(budget)) => budget.set_limit(limit),
            (limit, budget) => *budget = limit.map(|limit| Budget::new(limit, at_cut)),
        }
    }

    /// Whether a refinement is shown.
    pub fn shows(&self, r: u32) -> bool {
        self.transitions.shows(r)
    }

    /// One frame: vertices go on by `progress`, the cut moves to what the criterion needs within the budget, and the picture
    /// follows as far as it may. `cost` is asked once for each refinement that comes into the cut or goes, in that order: the
    /// triangles that it then adds to the mesh at the cut or takes from it. It is not asked where there is no budget.
    pub fn update<R: Refinements + ?Sized, C: Criterion<R::Bounds> + ?Sized>(
        &mut self,
        (of, cut): (&R, &mut Cut),
        sink: &mut impl RefinementSink,
        criterion: &C,
        motion: Motion,
        progress: f32,
        cost: impl FnMut(u32, bool) -> usize,
    ) -> Change {
        let Self { operations, triangles, budget, transitions } = self;
        transitions.advance(progress, sink);
        let mut report = match budget {
            Some(budget) => {
                budget.update(cut, of, criterion, motion, cost, |r, comes| transitions.want(r, comes))
            }
            None => cut.update(of, criterion, motion, |_, r, comes| transitions.want(r, comes)),
        };
        let smooth = progress < 1.0;
        let limits = Limits { operations: *operations, triangles: *triangles, smooth };
        let sees = |r: u32| criterion.sees(&of.bounds(r));
        let (splits, collapses) = transitions.run(of, limits, sees, sink);
        (report.splits, report.collapses) = (splits, collapses);
        if transitions.triangles() > *triangles && transitions.pending() > 0 {
            // The number of triangles was lowered: that cannot wait.
            let (splits, collapses) = settle(transitions, of, sink);
            report.splits += splits;
            report.collapses += collapses;
        }
        Change {
            cut: report,
            triangles: transitions.triangles(),
            pending: transitions.pending(),
            moving: transitions.transitions(),
            over_budget: transitions.triangles() > *triangles,
        }
    }

    /// Shows what is wanted, at once.
    pub fn settle<R: Refinements + ?Sized>(&mut self, of: &R, sink: &mut impl RefinementSink) {
        settle(&mut self.transitions, of, sink);
    }

    /// Bytes of its arrays.
    pub fn memory(&self) -> usize {
        self.transitions.memory() + self.budget.as_ref().map_or(0, Budget::memory)
    }
}

/// The numbers that came and went.
fn settle<R: Refinements + ?Sized>(
    transitions: &mut Transitions,
    of: &R,
    sink: &mut impl RefinementSink,
) -> (usize, usize) {
    transitions.advance(1.0, sink);
    transitions.run(of, Limits::NONE, |_| false, sink)
}
