//! The shown mesh follows the wanted refinements: limited a frame, closed after every step, smoothly if asked for.
//!
//! ```text
//!     wanted, not shown   first all that it builds on, then itself; its vertices start where their substitutes are
//!     shown, not wanted   once nothing builds on it, or all that does is on its way out too: its vertices move to
//!                         their substitutes, then it goes, those that build on it first
//!     wanted again        turns round where it is
//! ```
//!
//! The wanted set is closed, so refinements which build on an unwanted refinement are unwanted too. An unwanted
//! refinement which must wait for others is not queued: the last of the others calls it.

use std::collections::VecDeque;

use crate::geometry::paged::Paged;

use super::refinements::Refinements;
use super::weights::{Transition, Weights};

/// The mesh which shows refinements, with its moving vertices.
pub(crate) trait RefinementSink {
    /// Triangles drawn.
    fn triangles(&self) -> usize;
    /// Reads what some refinements that come (`true`) or go next are going to read.
    fn look_ahead(&self, changes: &[(u32, bool)]) {
        let _ = changes;
    }
    /// Triangles added now by a refinement. For a shown refinement which may go: triangles removed.
    fn cost(&self, r: u32) -> usize;
    /// Places moving vertices by the advanced weights. Transitions which are over and open end afterwards.
    fn advance(&mut self, weights: &Weights);
    /// Adds a refinement. All refinements it builds on are shown. `there` tells shown refinements, itself included. If
    /// `smoothly`, its vertices start at their substitutes.
    fn refine(&mut self, r: u32, smoothly: bool, there: impl Fn(u32) -> bool + Copy);
    /// Removes a refinement. No shown refinement builds on it.
    fn coarsen(&mut self, r: u32);
    /// Turns a refinement's vertices, from their current values towards their substitutes or back.
    fn turn(&mut self, r: u32);
}

/// Limits of one frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Limits {
    /// Maximum number of refinements which come or go.
    pub operations: usize,
    /// Maximum number of triangles.
    pub triangles: usize,
    /// Whether new transitions take time.
    pub smooth: bool,
}

impl Limits {
    pub const NONE: Self = Self { operations: usize::MAX, triangles: usize::MAX, smooth: false };
}

const SHOWN: u8 = 1;
const WANTED: u8 = 2;
/// In the queue of refinements to come (`COMING`), or to go (`GOING`).
const COMING: u8 = 4;
const GOING: u8 = 8;
/// Moving to the substitutes of its vertices.
const CLOSING: u8 = 16;
/// `AIM`: wanted at the last call of `take_in`. `NOTED`: the wish may have changed since.
const AIM: u8 = 32;
const NOTED: u8 = 64;

#[derive(Debug, Clone)]
pub(crate) struct Transitions {
    state: Paged<u8, 9>,
    /// Per refinement, how many shown refinements build on it (`held`), and how many of them are closing (`closing`, empty
    /// without moving vertices).
    held: Paged<u32, 9>,
    closing: Paged<u32, 9>,
    weights: Weights,
    coming: VecDeque<u32>,
    going: VecDeque<u32>,
    stack: Vec<(u32, bool)>,
    noted: Vec<u32>,
    /// Number of refinements either shown or wanted, but not both.
    pending: usize,
    triangles: usize,
    splits: usize,
    collapses: usize,
}

impl Transitions {
    /// Starts with a set both shown and wanted, in `triangles` triangles. `moves`: whether there may be transitions.
    pub fn new<R: Refinements + ?Sized>(
        of: &R,
        shown: impl Iterator<Item = u32>,
        triangles: usize,
        moves: bool,
    ) -> Self {
        let count = of.len();
        let mut transitions = Self {
            state: Paged::of(count, 0),
            held: Paged::of(count, 0),
            closing: Paged::of(if moves { count } else { 0 }, 0),
            weights: Weights::new(count, moves),
            coming: VecDeque::new(),
            going: VecDeque::new(),
            stack: Vec::new(),
            noted: Vec::new(),
            pending: 0,
            triangles,
            splits: 0,
            collapses: 0,
        };
        for r in shown {
            *transitions.state.entry(r) = SHOWN | WANTED | AIM;
            of.parents(r).chain(of.dependencies(r)).for_each(|n| *transitions.held.entry(n) += 1);
        }
        transitions
    }

    pub fn shows(&self, r: u32) -> bool {
        self.state.get(r) & SHOWN != 0
    }

    /// Number of refinements either shown or wanted, but not both.
    pub fn pending(&self) -> usize {
        self.pending
    }

    /// Refinements in transition.
    pub fn weights(&self) -> &Weights {
        &self.weights
    }

    /// Triangles shown.
    pub fn triangles(&self) -> usize {
        self.triangles
    }

    fn is(&self, r: u32, flag: u8) -> bool {
        self.state.at(r) & flag != 0
    }

    fn set(&mut self, r: u32, flag: u8) {
        *self.state.entry(r) |= flag;
    }

    fn unset(&mut self, r: u32, flag: u8) {
        *self.state.entry(r) &= !flag;
    }

    fn call(&mut self, r: u32, queue: u8) {
        if !self.is(r, queue) {
            self.set(r, queue);
            if queue == COMING { &mut self.coming } else { &mut self.going }.push_back(r);
        }
    }

    /// Records a refinement as wanted, or as no longer wanted. Only the state at the next call of [`Transitions::run`]
    /// counts; the wanted set must then be closed.
    pub fn want(&mut self, r: u32, wanted: bool) {
        let state = self.state.entry(r);
        if *state & NOTED == 0 {
            self.noted.push(r);
        }
        *state = if wanted { *state | WANTED } else { *state & !WANTED } | NOTED;
    }

    /// Applies the recorded wishes.
    fn take_in<R: Refinements + ?Sized>(&mut self, of: &R, sink: &mut impl RefinementSink) {
        for at in 0..self.noted.len() {
            let r = self.noted[at];
            self.unset(r, NOTED);
            let wanted = self.is(r, WANTED);
            if wanted == self.is(r, AIM) {
                continue;
            }
            *self.state.entry(r) ^= AIM;
            if self.is(r, SHOWN) == wanted {
                self.pending -= 1;
            } else {
                self.pending += 1;
                self.call(r, if wanted { COMING } else { GOING });
            }
            if wanted && self.is(r, CLOSING) {
                self.unset(r, CLOSING);
                of.parents(r).chain(of.dependencies(r)).for_each(|n| *self.closing.entry(n) -= 1);
                self.weights.start(r, 0.0, 1.0);
                sink.turn(r);
            }
        }
        self.noted.clear();
    }

    /// Advances all transitions by a share of their way. Refinements which have finished closing are queued to go.
    pub fn advance(&mut self, progress: f32, sink: &mut impl RefinementSink) {
        self.weights.advance(progress);
        sink.advance(&self.weights);
        let mut at = 0;
        while let Some(&transition) = self.weights.all().get(at) {
            let r = transition.refinement;
            if transition.is_over() && !transition.is_closing() {
                self.weights.end(r);
                continue;
            }
            if transition.is_over() {
                self.call(r, GOING);
            }
            at += 1;
        }
    }

    /// Adds and removes refinements within the limits of a frame. `sees` tells whether a refinement's change may be seen.
    /// Returns the numbers of splits and collapses.
    pub fn run<R: Refinements + ?Sized>(
        &mut self,
        of: &R,
        limits: Limits,
        sees: impl Fn(u32) -> bool,
        sink: &mut impl RefinementSink,
    ) -> (usize, usize) {
        self.take_in(of, sink);
        (self.splits, self.collapses) = (0, 0);
        // Alternates, so neither queue starves the other.
        loop {
            let one_went = self.let_go(of, limits, &sees, sink);
            let one_came = self.let_come(of, limits, &sees, sink);
            if !one_went && !one_came {
                break;
            }
        }
        let Self { state, held, closing, weights, .. } = self;
        [held, closing].into_iter().for_each(Paged::sweep);
        state.sweep();
        weights.sweep();
        (self.splits, self.collapses)
    }

    fn is_spent(&self, limits: Limits) -> bool {
        self.splits + self.collapses >= limits.operations
    }

    /// Takes the first refinement of the queue to go. Returns `false` if the queue or the limit of operations is
    /// exhausted.
    fn let_go<R: Refinements + ?Sized>(
        &mut self,
        of: &R,
        limits: Limits,
        sees: &impl Fn(u32) -> bool,
        sink: &mut impl RefinementSink,
    ) -> bool {
        if self.is_spent(limits) {
            return false;
        }
        let Some(r) = self.going.pop_front() else { return false };
        self.unset(r, GOING);
        if self.is(r, WANTED) || !self.is(r, SHOWN) {
            return true;
        }
        let held = self.held.at(r);
        let closed = self.is(r, CLOSING) && self.weights.of(r).is_none_or(Transition::is_over);
        if closed || !self.is(r, CLOSING) && (!limits.smooth || held == 0 && !sees(r)) {
            if held == 0 {
                self.coarsen(of, r, sink);
            }
        } else if !self.is(r, CLOSING) && held == self.closing.at(r) {
            self.close(of, r, sink);
        }
        true
    }

    fn coarsen<R: Refinements + ?Sized>(&mut self, of: &R, r: u32, sink: &mut impl RefinementSink) {
        let was_closing = self.is(r, CLOSING);
        self.weights.end(r);
        self.unset(r, SHOWN | CLOSING);
        self.collapses += 1;
        self.pending -= 1;
        self.triangles -= sink.cost(r);
        sink.coarsen(r);
        for n in of.parents(r).chain(of.dependencies(r)) {
            *self.held.entry(n) -= 1;
            if was_closing {
                *self.closing.entry(n) -= 1;
            }
            self.call_if_free(n);
        }
    }

    fn close<R: Refinements + ?Sized>(&mut self, of: &R, r: u32, sink: &mut impl RefinementSink) {
        self.set(r, CLOSING);
        self.weights.start(r, 1.0, 0.0);
        sink.turn(r);
        for n in of.parents(r).chain(of.dependencies(r)) {
            *self.closing.entry(n) += 1;
            self.call_if_free(n);
        }
    }

    /// Queues an unwanted refinement to go, if all shown refinements building on it are closing.
    fn call_if_free(&mut self, r: u32) {
        let closing = self.closing.get(r);
        if !self.is(r, WANTED) && self.held.at(r) == closing {
            self.call(r, GOING);
        }
    }

    /// Takes the first refinement to come, and adds the missing refinements it builds on, then the refinement. Returns
    /// `false` if the queue is empty or a limit stops it.
    fn let_come<R: Refinements + ?Sized>(
        &mut self,
        of: &R,
        limits: Limits,
        sees: &impl Fn(u32) -> bool,
        sink: &mut impl RefinementSink,
    ) -> bool {
        let Some(&first) = self.coming.front() else { return false };
        if self.is(first, WANTED) {
            self.stack.push((first, false));
        }
        while let Some((r, ready)) = self.stack.pop() {
            if self.is(r, SHOWN) {
                continue;
            }
            if !ready {
                self.stack.push((r, true));
                let Self { state, stack, .. } = self;
                let missing = of.parents(r).chain(of.dependencies(r)).filter(|&n| state.at(n) & SHOWN == 0);
                stack.extend(missing.map(|n| (n, false)));
            } else if self.is_spent(limits) || self.triangles + sink.cost(r) > limits.triangles {
                self.stack.clear();
                return false;
            } else {
                self.refine(of, r, limits.smooth && sees(r), sink);
            }
        }
        self.coming.pop_front();
        self.unset(first, COMING);
        true
    }

    fn refine<R: Refinements + ?Sized>(
        &mut self,
        of: &R,
        r: u32,
        smoothly: bool,
        sink: &mut impl RefinementSink,
    ) {
        self.set(r, SHOWN);
        self.splits += 1;
        self.pending -= 1;
        self.triangles += sink.cost(r);
        of.parents(r).chain(of.dependencies(r)).for_each(|n| *self.held.entry(n) += 1);
        let state = &self.state;
        sink.refine(r, smoothly, |other| state.at(other) & SHOWN != 0);
        if smoothly {
            self.weights.start(r, 0.0, 1.0);
        }
    }

    /// Gives back memory if most of it is not in use.
    pub fn trim(&mut self) {
        let Self { state, held, closing, weights, coming, going, .. } = self;
        [held, closing].into_iter().for_each(Paged::trim);
        state.trim();
        weights.trim();
        [coming, going].into_iter().filter(|queue| queue.is_empty()).for_each(VecDeque::shrink_to_fit);
    }

    /// Bytes of the arrays.
    pub fn memory(&self) -> usize {
        let queues = self.coming.capacity() + self.going.capacity();
        self.state.memory()
            + self.held.memory()
            + self.closing.memory()
            + self.weights.memory()
            + queues * size_of::<u32>()
    }
}
