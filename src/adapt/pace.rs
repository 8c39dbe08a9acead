//! Between the cut that a view asks for and what is shown: a budget of triangles, and so much a frame.

use crate::view::{Criterion, Motion};

use super::balance::Budget;
use super::change::Change;
use super::cut::Cut;
use super::follow::{Follow, Limits, Picture};
use super::refinements::Refinements;

/// What a level of detail with limits, or with vertices that move, keeps besides its cut.
#[derive(Debug, Clone)]
pub(crate) struct Pace {
    operations: usize,
    triangles: usize,
    budget: Option<Budget>,
    follow: Follow,
}

impl Pace {
    /// Where the cut is what is shown, in so many triangles. `moves`: whether vertices may move.
    pub fn new<R: Refinements + ?Sized>(of: &R, cut: &Cut, triangles: usize, moves: bool) -> Self {
        let follow = Follow::new(of, |r| cut.holds(r), triangles, moves);
        Self { operations: usize::MAX, triangles: usize::MAX, budget: None, follow }
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
        self.follow.shows(r)
    }

    /// One frame: vertices go on by `progress`, the cut moves to what the criterion needs within the budget, and the picture
    /// follows as far as it may. `cost` is asked once for each refinement that comes into the cut or goes, in that order: the
    /// triangles that it then adds to the mesh at the cut or takes from it. It is not asked where there is no budget.
    pub fn update<R: Refinements + ?Sized, C: Criterion<R::Bounds> + ?Sized>(
        &mut self,
        (of, cut): (&R, &mut Cut),
        picture: &mut impl Picture,
        criterion: &C,
        motion: Motion,
        progress: f32,
        cost: impl FnMut(u32, bool) -> usize,
    ) -> Change {
        let Self { operations, triangles, budget, follow } = self;
        follow.advance(progress, picture);
        let mut report = match budget {
            Some(budget) => budget.update(cut, of, criterion, motion, cost, |r, comes| follow.want(r, comes)),
            None => cut.update(of, criterion, motion, |_, r, comes| follow.want(r, comes)),
        };
        let smooth = progress < 1.0;
        let limits = Limits { operations: *operations, triangles: *triangles, smooth };
        let sees = |r: u32| criterion.sees(&of.bounds(r));
        let (splits, collapses) = follow.run(of, limits, sees, picture);
        (report.splits, report.collapses) = (splits, collapses);
        if follow.triangles() > *triangles && follow.pending() > 0 {
            // The number of triangles was lowered: that cannot wait.
            let (splits, collapses) = settle(follow, of, picture);
            report.splits += splits;
            report.collapses += collapses;
        }
        Change {
            cut: report,
            triangles: follow.triangles(),
            pending: follow.pending(),
            moving: follow.transitions(),
            over_budget: follow.triangles() > *triangles,
        }
    }

    /// Shows what is wanted, at once.
    pub fn settle<R: Refinements + ?Sized>(&mut self, of: &R, picture: &mut impl Picture) {
        settle(&mut self.follow, of, picture);
    }

    /// Bytes of its arrays.
    pub fn memory(&self) -> usize {
        self.follow.memory() + self.budget.as_ref().map_or(0, Budget::memory)
    }
}

/// The numbers that came and went.
fn settle<R: Refinements + ?Sized>(
    follow: &mut Follow,
    of: &R,
    picture: &mut impl Picture,
) -> (usize, usize) {
    follow.advance(1.0, picture);
    follow.run(of, Limits::NONE, |_| false, picture)
}
