//! Keeps a cut within a number of triangles: of the refinements asked for by a view, the most urgent are kept.
//!
//! ```text
//!     urgency    o----o---o-o-----o---o-----.---.--.------.--> 1     what is asked for is all above the factor;
//!                |  asked for     |   ^ factor                       the factor moves only when triangles are too
//!                                                                     many, or so few that more would fit
//! ```
//!
//! The factor stays from frame to frame, and with it all sleeping answers. To move the factor, rim and fringe are put in
//! two heaps. While there are too many triangles, the least urgent refinement goes. While the most urgent refinement
//! fits, it comes. If it does not fit, less urgent refinements make room (the dual queues of Duchaineau et al. 1997,
//! ROAM, section 5). The result is the longest prefix of the refinements by urgency within the limit, with some triangles
//! to spare. A larger limit gives a superset. The result does not depend on the previous cut.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use crate::view::{Answer, Criterion, Factors, Motion};

use super::cut::{Cut, CutReport};
use super::front::Front;
use super::refinements::Refinements;
use super::states::States;
use super::urgency::Key;

/// Shares of the budget. Below `ROOM * limit` triangles the budget tries to add refinements. When the factor moves, it is
/// set for `AIM * limit` triangles, so it need not move again soon.
const ROOM: f64 = 0.95;
const AIM: f64 = 0.975;
/// Raises the factor above the rounding error of an urgency.
const MARGIN: f64 = 1.0 + 1e-9;

/// A criterion with its tolerances multiplied by `factor`.
struct Coarsened<'a, C: ?Sized> {
    criterion: &'a C,
    factor: f64,
}

impl<B, C: Criterion<B> + ?Sized> Criterion<B> for Coarsened<'_, C> {
    fn test(&self, bounds: &B) -> Answer {
        if self.factor > 1.0 {
            self.criterion.test_at(bounds, self.factor)
        } else {
            self.criterion.test(bounds)
        }
    }

    fn test_each(&self, bounds: &[B], _: Factors, answers: &mut [Answer]) {
        let factors = Factors { budget: self.factor.max(1.0), ..Factors::NONE };
        self.criterion.test_each(bounds, factors, answers);
    }

    fn motion(&self, _: &Self) -> Motion {
        Motion::Other
    }
}

#[derive(Debug, Clone)]
pub(crate) struct Budget {
    limit: usize,
    /// Factor of all tolerances.
    factor: f64,
    /// Triangles of the cut.
    triangles: usize,
    /// Heaps of refinements asked for (`rim`, least urgent first) and not asked for (`fringe`, most urgent first).
    /// Entries may be out of date.
    rim: BinaryHeap<Reverse<Key>>,
    fringe: BinaryHeap<Key>,
}

impl Budget {
    /// Creates a budget of `limit` triangles for a cut with `triangles` triangles.
    pub fn new(limit: usize, triangles: usize) -> Self {
        Self { limit, factor: 1.0, triangles, rim: BinaryHeap::new(), fringe: BinaryHeap::new() }
    }

    /// Returns the factor of all tolerances.
    #[cfg(all(feature = "stream", feature = "io"))]
    pub fn factor(&self) -> f64 {
        self.factor
    }

    /// Sets the limit of triangles.
    pub fn set_limit(&mut self, limit: usize) {
        self.limit = limit;
    }

    /// Moves a cut to the most urgent refinements needed by the criterion, within the limit. The cut is within the budget
    /// only after the call.
    ///
    /// `cost` is called once for each refinement which comes (`true`) or goes (`false`), in order. It returns the number
    /// of triangles added or removed by this step, which may depend on the refinements then in the mesh. It must not
    /// remove more triangles than there are. `apply` is called with each refinement which comes or goes.
    pub fn update<R: Refinements + ?Sized, C: Criterion<R::Bounds> + ?Sized>(
        &mut self,
        cut: &mut Cut<R::Bounds>,
        of: &R,
        criterion: &C,
        motion: Motion,
        mut cost: impl FnMut(u32, bool) -> usize,
        mut apply: impl FnMut(u32, bool),
    ) -> CutReport {
        let mut report = CutReport::default();
        let mut count = |triangles: &mut usize, r: u32, comes: bool| {
            if comes {
                *triangles += cost(r, true);
                report.splits += 1;
            } else {
                *triangles -= cost(r, false);
                report.collapses += 1;
            }
            apply(r, comes);
        };
        let mut tests = 0;
        // Above the cap, the heaps are cheaper than adding all refinements asked for and removing most of them.
        let cap = self.limit.saturating_add(self.limit / 4);
        // At an infinite factor no answers sleep.
        let mut settled = self.factor.is_finite();
        if settled {
            let wanted = Coarsened { criterion, factor: self.factor };
            let (all, asked) = cut.update_while(of, &wanted, motion, &mut |_: &States, r, comes| {
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
                // Puts all refinements to sleep with the new factor. Refinements as urgent as the first excluded
                // refinement go too.
                let wanted = Coarsened { criterion, factor: self.factor };
                let (_, asked) = cut.update_while(of, &wanted, Motion::Other, &mut |_: &States, r, comes| {
                    count(&mut self.triangles, r, comes);
                    true
                });
                tests += asked;
            }
        }
        report.tests = tests;
        [report.blocks, report.asleep] = cut.front.blocks;
        report
    }

    fn balance<R: Refinements + ?Sized, C: Criterion<R::Bounds> + ?Sized>(
        &mut self,
        cut: &mut Cut<R::Bounds>,
        of: &R,
        criterion: &C,
        count: &mut impl FnMut(&mut usize, u32, bool),
    ) -> usize {
        let Self { limit, triangles, rim, fringe, .. } = self;
        let mut aim = (*limit as f64 * AIM) as usize;
        let Cut { front, closure } = cut;
        let mut tests = 0;
        let mut key = |r: u32| {
            tests += 1;
            let urgency = criterion.urgency(&of.bounds(r));
            Key { urgency: if urgency > 0.0 { urgency } else { 0.0 }, error: of.error(r), refinement: r }
        };
        rim.clear();
        fringe.clear();
        for (r, asked) in front.all(of) {
            match asked {
                true => rim.push(Reverse(key(r))),
                false => fringe.push(key(r)),
            }
        }
        if R::PARTIAL {
            fringe.retain(|top| front.may_come(of, top.refinement));
        }
        let factor = loop {
            while rim.peek().is_some_and(|Reverse(top)| front.asked_at(top.refinement) != Some(true)) {
                rim.pop();
            }
            while fringe.peek().is_some_and(|top| front.asked_at(top.refinement) != Some(false)) {
                fringe.pop();
            }
            let least = rim.peek().map(|top| top.0);
            let most = fringe.peek().copied().filter(|top| top.urgency > 1.0);
            let mut toggle = |front: &mut Front<R::Bounds>, triangles: &mut usize, r: u32, asked: bool| {
                front.force(of, r);
                closure
                    .change(of, &mut front.states, r, asked, &mut |_, r, comes| count(triangles, r, comes));
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
                            if front.asked_at(child) == Some(false) && front.may_come(of, child) {
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
                if front.asked_at(parent) == Some(true) {
                    rim.push(Reverse(key(parent)));
                }
            }
        };
        self.factor = factor;
        tests
    }

    /// Bytes of the heaps.
    pub fn memory(&self) -> usize {
        (self.rim.capacity() + self.fringe.capacity()) * size_of::<Key>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A binary tree: the children of `r` are `2 r + 1` and `2 r + 2`.
    struct Tree(u32);

    impl Refinements for Tree {
        type Bounds = u32;

        fn len(&self) -> usize {
            self.0 as usize
        }

        fn roots(&self) -> impl Iterator<Item = u32> {
            0..1
        }

        fn bounds(&self, r: u32) -> u32 {
            r
        }

        fn parents(&self, r: u32) -> impl Iterator<Item = u32> {
            r.checked_sub(1).map(|r| r / 2).into_iter()
        }

        fn children(&self, r: u32) -> impl Iterator<Item = u32> {
            (2 * r + 1..2 * r + 3).filter(|&child| child < self.0)
        }

        fn dependencies(&self, _: u32) -> impl Iterator<Item = u32> {
            std::iter::empty()
        }
    }

    /// A criterion with urgency falling from the root to the leaves, and `left` as the share of left children.
    struct Towards {
        left: f64,
        tolerance: f64,
    }

    impl Criterion<u32> for Towards {
        fn test(&self, r: &u32) -> Answer {
            Answer::once(self.urgency(r) > 1.0)
        }

        fn motion(&self, _: &Self) -> Motion {
            Motion::Other
        }

        fn urgency(&self, r: &u32) -> f64 {
            let (mut r, mut urgency) = (*r, 1e4 / self.tolerance);
            while r > 0 {
                urgency *= if r % 2 == 1 { self.left } else { 1.0 - self.left };
                r = (r - 1) / 2;
            }
            urgency
        }
    }

    /// Two siblings together add more triangles than each alone.
    fn adds(there: &[bool], r: u32) -> usize {
        let beside = if r == 0 { false } else { there[((r - 1) ^ 1) as usize + 1] };
        2 + usize::from(beside)
    }

    #[test]
    fn costs_are_asked_once_as_things_come_and_go() {
        let tree = Tree(1023);
        let mut cut = Cut::new(tree.len(), 1.0, false);
        let mut budget = Budget::new(150, 10);
        let mut there = vec![false; tree.len()];
        let mut triangles = 10;
        let mut whole = 0;
        for step in 0..60 {
            let sway = f64::from(step % 11) / 11.0;
            let criterion =
                Towards { left: 0.2 + 0.6 * sway, tolerance: [1.0, 30.0, 3000.0][step as usize / 4 % 3] };
            if step == 40 {
                budget.set_limit(60);
            }
            let limit = if step < 40 { 150 } else { 60 };
            let mut asked = Vec::new();
            let mut told = Vec::new();
            let cost = |r: u32, comes: bool| {
                assert_eq!(there[r as usize], !comes);
                let triangles_of_it = if comes {
                    let adds = adds(&there, r);
                    triangles += adds;
                    adds
                } else {
                    let takes = adds(&there, r);
                    triangles -= takes;
                    takes
                };
                there[r as usize] = comes;
                asked.push((r, comes));
                triangles_of_it
            };
            let report = budget
                .update(&mut cut, &tree, &criterion, Motion::Other, cost, |r, comes| told.push((r, comes)));
            assert_eq!(asked, told);
            assert_eq!(report.splits + report.collapses, told.len());
            assert_eq!(budget.triangles, triangles);
            assert!(triangles <= limit, "{triangles}");
            assert!((0..1023).all(|r| cut.holds(r) == there[r as usize]));
            whole += usize::from(triangles as f64 > ROOM * limit as f64 - 3.0);
        }
        assert!(whole > 10, "{whole} steps used the budget");
    }
}
