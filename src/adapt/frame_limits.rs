//! Limits between the cut asked for by a view and the shown mesh: a budget of triangles, and operations a frame.

use crate::view::{Criterion, Motion};

use super::budget::Budget;
use super::change::Change;
use super::cut::Cut;
use super::refinements::Refinements;
use super::states::States;
use super::transitions::{Limits, RefinementSink, Transitions};
use super::weights::Weights;

/// State kept besides the cut, if a level of detail has limits or moving vertices.
#[derive(Debug, Clone)]
pub(crate) struct FrameLimits {
    operations: usize,
    triangles: usize,
    budget: Option<Budget>,
    transitions: Transitions,
}

impl FrameLimits {
    /// Starts with the cut shown, in `triangles` triangles. `moves`: whether vertices may move.
    pub fn new<R: Refinements + ?Sized>(of: &R, cut: &Cut<R::Bounds>, triangles: usize, moves: bool) -> Self {
        let transitions = Transitions::new(of, cut.refinements(), triangles, moves);
        Self { operations: usize::MAX, triangles: usize::MAX, budget: None, transitions }
    }

    /// Sets the limits of triangles and of operations a frame. `at_cut` is the number of triangles of the cut.
    pub fn set(&mut self, triangles: Option<usize>, operations: Option<usize>, at_cut: usize) {
        self.operations = operations.unwrap_or(usize::MAX);
        self.triangles = triangles.unwrap_or(usize::MAX);
        match (triangles, &mut self.budget) {
            (Some(limit), Some(budget)) => budget.set_limit(limit),
            (limit, budget) => *budget = limit.map(|limit| Budget::new(limit, at_cut)),
        }
    }

    /// Returns the factor of all tolerances by which the triangles are within their limit; 1 without a limit.
    #[cfg(all(feature = "stream", feature = "io"))]
    pub fn factor(&self) -> f64 {
        self.budget.as_ref().map_or(1.0, Budget::factor)
    }

    /// Whether a refinement is shown.
    pub fn shows(&self, r: u32) -> bool {
        self.transitions.shows(r)
    }

    /// Refinements in transition.
    pub fn weights(&self) -> &Weights {
        self.transitions.weights()
    }

    /// Runs one frame. Vertices advance by `progress`, the cut moves to the refinements needed within the budget, and the
    /// shown mesh follows the cut within the limits.
    ///
    /// `cost` is called once for each refinement which comes into the cut or goes, in order. It returns the number of
    /// triangles added to the mesh at the cut, or removed from it, by this step. Without a budget it is not called.
    pub fn update<R: Refinements + ?Sized, C: Criterion<R::Bounds> + ?Sized>(
        &mut self,
        (of, cut): (&R, &mut Cut<R::Bounds>),
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
            None => cut.update(of, criterion, motion, &mut |_: &States, r, comes| {
                transitions.want(r, comes);
                true
            }),
        };
        let smooth = progress < 1.0;
        let limits = Limits { operations: *operations, triangles: *triangles, smooth };
        let sees = |r: u32| criterion.sees(&of.bounds(r));
        let (splits, collapses) = transitions.run(of, limits, sees, sink);
        (report.splits, report.collapses) = (splits, collapses);
        if transitions.triangles() > *triangles && transitions.pending() > 0 {
            // The limit of triangles was lowered: it must hold in this frame.
            let (splits, collapses) = settle(transitions, of, sink);
            report.splits += splits;
            report.collapses += collapses;
        }
        Change {
            cut: report,
            triangles: transitions.triangles(),
            pending: transitions.pending(),
            moving: transitions.weights().len(),
            over_budget: transitions.triangles() > *triangles,
        }
    }

    /// Shows all wanted refinements, at once.
    pub fn settle<R: Refinements + ?Sized>(&mut self, of: &R, sink: &mut impl RefinementSink) {
        settle(&mut self.transitions, of, sink);
    }

    /// Gives back memory if most of it is not in use.
    pub fn trim(&mut self) {
        self.transitions.trim();
    }

    /// Bytes of the arrays.
    pub fn memory(&self) -> usize {
        self.transitions.memory() + self.budget.as_ref().map_or(0, Budget::memory)
    }
}

/// Shows all wanted refinements at once. Returns the numbers of splits and collapses.
fn settle<R: Refinements + ?Sized>(
    transitions: &mut Transitions,
    of: &R,
    sink: &mut impl RefinementSink,
) -> (usize, usize) {
    transitions.advance(1.0, sink);
    transitions.run(of, Limits::NONE, |_| false, sink)
}
