//! A cut within a number of triangles: the most urgent refinements of those that a view asks for.
//!
//! ```text
//!     urgency    o----o---o-o-----o---o-----.---.--.------.--> 1     what is asked for is all above the factor;
//!                |  asked for     |   ^ factor                       the factor moves only when triangles are too
//!                                                                     many, or so few that more would fit
//! ```
//!
//! From frame to frame the factor stays, and with it all answers that sleep. When it must move, rim and fringe are put in two
//! heaps: the least urgent goes while there are too many, the most urgent comes while it fits, and where the most urgent does
//! not fit, what is less urgent makes room (the dual queues of Duchaineau et al. 1997, ROAM, section 5). The result is the
//! longest run of the most urgent that fits, with some triangles to spare: nested in the number of triangles, and the same
//! whatever it was before.

use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

use crate::view::{Answer, Bounds, Criterion, Motion};

use super::cut::{Cut, CutReport};
use super::front::ASKED;
use super::refinements::Refinements;

/// Shares of the budget: below the first more is tried, and the second is what the factor is set for when it moves, so that it
/// need not move again soon.
const ROOM: f64 = 0.95;
const AIM: f64 = 0.975;
/// Sets the factor beyond what rounding may do to an urgency.
const MARGIN: f64 = 1.0 + 1e-9;

/// Order of urgency: parents always come before children, if the criterion is monotone.
#[derive(Debug, Clone, Copy)]
struct Key {
    urgency: f64,
    error: f32,
    refinement: u32,
}

impl Ord for Key {
    fn cmp(&self, other: &Self) -> Ordering {
        let urgency = self.urgency.total_cmp(&other.urgency);
        let error = self.error.total_cmp(&other.error);
        urgency.then(error).then(other.refinement.cmp(&self.refinement))
    }
}

impl PartialOrd for Key {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Key {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Key {}

/// A criterion with its tolerances multiplied.
struct Coarsened<'a, C: ?Sized> {
    criterion: &'a C,
    factor: f64,
}

impl<C: Criterion + ?Sized> Criterion for Coarsened<'_, C> {
    fn needs(&self, bounds: &Bounds) -> Answer {
        if self.factor > 1.0 {
            self.criterion.needs_at(bounds, self.factor)
        } else {
            self.criterion.needs(bounds)
        }
    }

    fn motion(&self, _: &Self) -> Motion {
        Motion::Other
    }
}

#[derive(Debug, Clone)]
pub(crate) struct Budget {
    limit: usize,
    /// Tolerances are multiplied by it.
    factor: f64,
    /// Triangles of the cut.
    triangles: usize,
    /// Asked for, least urgent first, and not asked for, most urgent first. Entries may be out of date.
    rim: BinaryHeap<Reverse<Key>>,
    fringe: BinaryHeap<Key>,
}

impl Budget {
    /// `triangles`: what the cut has now.
    pub fn new(limit: usize, triangles: usize) -> Self {
        Self { limit, factor: 1.0, triangles, rim: BinaryHeap::new(), fringe: BinaryHeap::new() }
    }

    /// Changes the number of triangles.
    pub fn set_limit(&mut self, limit: usize) {
        self.limit = limit;
    }

    /// Moves a cut to the most urgent of what the criterion needs that fits. `cost` is the triangles that a refinement adds;
    /// `apply` is told what comes and goes. Only after the call is the cut within the budget.
    pub fn update<R: Refinements + ?Sized, C: Criterion + ?Sized>(
        &mut self,
        cut: &mut Cut,
        of: &R,
        criterion: &C,
        motion: Motion,
        cost: impl Fn(u32) -> usize,
        mut apply: impl FnMut(u32, bool),
    ) -> CutReport {
        let mut report = CutReport::default();
        let mut count = |triangles: &mut usize, r: u32, comes: bool| {
            if comes {
                *triangles += cost(r);
                report.splits += 1;
            } else {
                *triangles -= cost(r);
                report.collapses += 1;
            }
            apply(r, comes);
        };
        let mut tests = 0;
        // Beyond this it is no use to take in all that is asked for before letting most of it go.
        let cap = self.limit.saturating_add(self.limit / 4);
        // An endless factor has no answers that sleep.
        let mut settled = self.factor.is_finite();
        if settled {
            let wanted = Coarsened { criterion, factor: self.factor };
            let (all, asked) = cut.update_while(of, &wanted, motion, |_, r, comes| {
                count(&mut self.triangles, r, comes);
                !comes || self.triangles <= cap
            });
            tests += asked;
            let still = motion == Motion::Moved { distance: 0.0, angle: 0.0 };
            let room = self.factor > 1.0 && (self.triangles as f64) < ROOM * self.limit as f64 && !still;
            settled = all && self.triangles <= self.limit && !room;
        }
        if !settled {
            tests += self.balance(cut, of, criterion, &mut count);
            if self.factor.is_finite() {
                // Puts all to sleep by the new factor; what is as urgent as what did not fit goes too.
                let wanted = Coarsened { criterion, factor: self.factor };
                let (_, asked) = cut.update_while(of, &wanted, Motion::Other, |_, r, comes| {
                    count(&mut self.triangles, r, comes);
                    true
                });
                tests += asked;
            }
        }
        report.tests = tests;
        report
    }

    fn balance<R: Refinements + ?Sized, C: Criterion + ?Sized>(
        &mut self,
        cut: &mut Cut,
        of: &R,
        criterion: &C,
        count: &mut impl FnMut(&mut usize, u32, bool),
    ) -> usize {
        let Self { limit, triangles, rim, fringe, .. } = self;
        let mut aim = (*limit as f64 * AIM) as usize;
        let Cut { front, closure } = cut;
        let mut tests = 0;
        let mut key = |r: u32| {
            let bounds = of.bounds(r);
            tests += 1;
            let urgency = criterion.urgency(bounds);
            Key { urgency: if urgency > 0.0 { urgency } else { 0.0 }, error: bounds.error, refinement: r }
        };
        rim.clear();
        fringe.clear();
        front.candidates(of);
        for at in 0..front.work.len() {
            let r = front.work[at];
            if front.is_due(of, r) {
                if front.state[r as usize] & ASKED != 0 {
                    rim.push(Reverse(key(r)));
                } else {
                    fringe.push(key(r));
                }
            }
        }
        front.forget();
        let factor = loop {
            let is_asked = |front: &super::front::Front, r: u32| front.state[r as usize] & ASKED != 0;
            while rim.peek().is_some_and(|Reverse(top)| {
                !is_asked(front, top.refinement) || !front.is_due(of, top.refinement)
            }) {
                rim.pop();
            }
            while fringe
                .peek()
                .is_some_and(|top| is_asked(front, top.refinement) || !front.is_due(of, top.refinement))
            {
                fringe.pop();
            }
            let least = rim.peek().map(|top| top.0);
            let most = fringe.peek().copied().filter(|top| top.urgency > 1.0);
            let mut toggle = |front: &mut super::front::Front, triangles: &mut usize, r: u32, asked: bool| {
                front.state[r as usize] ^= ASKED;
                closure.change(of, &mut front.state, r, asked, &mut |_, r, comes| count(triangles, r, comes));
            };
            let goes = match (least, most) {
                (Some(least), _) if *triangles > aim || least.urgency <= 1.0 => least,
                (None, _) if *triangles > *limit => break f64::INFINITY,
                (None, _) if *triangles > aim => {
                    aim = *limit;
                    continue;
                }
                (_, None) => break 1.0,
                (least, Some(most)) => {
                    toggle(front, triangles, most.refinement, true);
                    if *triangles <= aim {
                        fringe.pop();
                        rim.push(Reverse(most));
                        for child in of.children(most.refinement) {
                            if front.is_due(of, child) {
                                fringe.push(key(child));
                            }
                        }
                        continue;
                    }
                    toggle(front, triangles, most.refinement, false);
                    match least {
                        Some(least) if least < most => least,
                        _ => break most.urgency * MARGIN,
                    }
                }
            };
            rim.pop();
            toggle(front, triangles, goes.refinement, false);
            fringe.push(goes);
            for parent in of.parents(goes.refinement) {
                if front.is_due(of, parent) {
                    rim.push(Reverse(key(parent)));
                }
            }
        };
        self.factor = factor;
        tests
    }

    /// Bytes of its heaps.
    pub fn memory(&self) -> usize {
        (self.rim.capacity() + self.fringe.capacity()) * size_of::<Key>()
    }
}
