//! The refinements asked for by a view, kept up to date by testing only refinements with answers due.
//!
//! ```text
//!              o          asked for: all that it needs is asked for too
//!            /   \
//!          o       o      the rim: asked for, with nothing asked for above it     -> may go
//!         / \     / \
//!        .   .   .   .    the fringe: not asked for, but all that it needs is     -> may come
//! ```
//!
//! Each answer has a slack: how far the eye may move and turn before the answer can change. Until then the refinement
//! sleeps. There is an odometer for each of several *arms*. It advances by the larger of the distance moved by the eye
//! and the arc swept by the end of the arm. A refinement sleeps by the odometer with the longest sleep, if the motion
//! continues as in the last frame.
//!
//! Tests are monotone in nested bounds, so testing rim and fringe finds all refinements needed. An answer depends on the
//! view alone, so the set does not depend on its previous state.

use crate::view::{Answer, Criterion, Motion};

use super::closure::may_come;
use super::refinements::Refinements;
use super::wheel::Wheel;

/// Asked for by the view.
pub(super) const ASKED: u8 = 1;
/// The last answer still holds.
const ASLEEP: u8 = 2;
/// In the mesh: asked for, or needed by a refinement in the mesh.
pub(super) const DONE: u8 = 4;

/// Known to be on the rim or the fringe, so most woken sleepers need not look at their neighbours.
const AT_FRONT: u8 = 8;

/// Number of arms, each half as long as the previous arm. The longest arm is the object's size times `2^LONGEST`.
const ARMS: usize = 16;
const LONGEST: i32 = 3;
/// About `1 / KEPT` of every slack is kept for changes in the direction of motion.
const KEPT: f64 = 16.0;

/// Shrinks slacks by more than the rounding error of sums.
const CAUTION: f64 = 1.0 - 1e-9;

/// Shrinks a slack for waiting. Returns 0 if the slack is NaN, as when both of its parts are 0.
fn caution(slack: f64) -> f64 {
    if slack > 0.0 { slack * CAUTION } else { 0.0 }
}

#[derive(Debug, Clone)]
pub(super) struct Front {
    /// Flags of every refinement.
    pub state: Vec<u8>,
    next: Vec<u32>,
    /// Wheel of the sleepers woken by moving alone, then, by arm, wheels of the sleepers woken by turning too.
    wheels: [Wheel; 1 + ARMS],
    /// Length of the arm of every wheel.
    arms: [f64; 1 + ARMS],
    /// Distance moved for each radian turned, in the last motion.
    course: f64,
    pub work: Vec<u32>,
    /// Refinements waiting for themselves, or for others they need, to arrive.
    waiting: Vec<u32>,
    /// Tests so far.
    pub tests: u64,
}

impl Front {
    /// Creates an empty set without answers. `size` is the object's size, object units.
    pub fn new(count: usize, size: f64) -> Self {
        // Keeps the tick a normal number.
        let tick = if size > 1e-290 { size * 1e-6 } else { 1.0 };
        Self {
            state: vec![0; count],
            next: vec![0; count],
            wheels: std::array::from_fn(|_| Wheel::new(tick)),
            arms: std::array::from_fn(|wheel| {
                if wheel == 0 { 0.0 } else { size.max(tick) * 2_f64.powi(LONGEST + 1 - wheel as i32) }
            }),
            course: size,
            work: Vec::new(),
            waiting: Vec::new(),
            tests: 0,
        }
    }

    /// Moves the set to the refinements asked for now. `changed` is called with each change, in an order which keeps the
    /// set closed. If it returns `false`, the update stops, all answers are forgotten, and the set is closed but not
    /// complete. Returns whether the update was completed.
    pub fn update<R: Refinements + ?Sized, C: Criterion<R::Bounds> + ?Sized>(
        &mut self,
        of: &R,
        criterion: &C,
        motion: Motion,
        mut changed: impl FnMut(&mut [u8], u32, bool) -> bool,
    ) -> bool {
        self.wake(of, motion);
        while let Some(r) = self.work.pop() {
            let state = self.state[r as usize];
            if state & ASLEEP != 0 {
                continue;
            }
            if R::PARTIAL && !of.available(r) {
                of.miss(r, false);
                self.wait(r);
                continue;
            }
            if state & AT_FRONT == 0 && !self.is_due(of, r) {
                continue;
            }
            let asked = state & ASKED != 0;
            self.tests += 1;
            self.state[r as usize] |= AT_FRONT;
            let answer = criterion.test(&of.bounds(r));
            if R::PARTIAL && answer.refine && !asked && !may_come(of, &self.state, r) {
                self.wait(r);
                continue;
            }
            if answer.refine != asked {
                self.state[r as usize] ^= ASKED;
                if !changed(&mut self.state, r, answer.refine) {
                    self.forget();
                    return false;
                }
            }
            self.sleep(r, answer);
            if answer.refine == asked {
                continue;
            }
            // The rim has moved. Refinements on one side leave the front, refinements on the other may have come to it.
            let Self { state, work, .. } = self;
            let mut leave = |other: u32| state[other as usize] &= !AT_FRONT;
            if asked {
                of.children(r).for_each(&mut leave);
                work.extend(of.parents(r).filter(|&parent| state[parent as usize] & ASLEEP == 0));
            } else {
                of.parents(r).for_each(&mut leave);
                work.extend(of.children(r).filter(|&child| state[child as usize] & ASLEEP == 0));
            }
        }
        true
    }

    /// Whether a refinement is on the rim or the fringe.
    #[inline]
    pub fn is_due<R: Refinements + ?Sized>(&self, of: &R, r: u32) -> bool {
        if self.state[r as usize] & ASKED != 0 {
            !of.children(r).any(|child| self.state[child as usize] & ASKED != 0)
        } else if R::PARTIAL && !of.available(r) {
            of.miss(r, false);
            false
        } else {
            of.parents(r).all(|parent| self.state[parent as usize] & ASKED != 0)
        }
    }

    /// Puts a refinement to sleep until others arrive.
    fn wait(&mut self, r: u32) {
        self.state[r as usize] |= ASLEEP;
        self.waiting.push(r);
    }

    /// Wakes what waits for others to arrive.
    #[cfg(all(feature = "stream", feature = "io"))]
    pub fn arrived(&mut self) {
        for r in self.waiting.drain(..) {
            self.state[r as usize] &= !ASLEEP;
            self.work.push(r);
        }
    }

    /// Forgets all answers and front flags, but not the set.
    pub fn forget(&mut self) {
        self.wheels.iter_mut().for_each(Wheel::clear);
        self.waiting.clear();
        self.state.iter_mut().for_each(|s| *s &= !(ASLEEP | AT_FRONT));
        self.work.clear();
    }

    /// Returns the rim and the fringe, with duplicates and with others. Check each with [`Front::is_due`].
    pub fn candidates<R: Refinements + ?Sized>(&mut self, of: &R) -> &[u32] {
        self.forget();
        self.wake(of, Motion::Other);
        &self.work
    }

    #[inline]
    fn sleep(&mut self, r: u32, answer: Answer) {
        self.state[r as usize] |= ASLEEP;
        let Answer { moved, turned, .. } = answer;
        if turned == f64::INFINITY {
            if moved != f64::INFINITY {
                self.wheels[0].put(r, caution(moved), &mut self.next);
            }
            return;
        }
        // The arm nearest to the course. Exponents approximate logarithms well enough.
        let ratio = moved.max(f64::MIN_POSITIVE) / turned;
        let arm = self.course.max(ratio * (1.0 / KEPT)).min(ratio * KEPT);
        let exponent = |x: f64| (x.to_bits() >> 52) as i32;
        let halvings = exponent(self.arms[1]) - exponent(arm);
        let wheel = halvings.clamp(0, ARMS as i32 - 1) as usize + 1;
        // The odometer may advance by `slack` in moving and at the same time in turning.
        let turned = turned * self.arms[wheel];
        let slack = if moved < f64::INFINITY { moved * turned / (moved + turned) } else { turned };
        self.wheels[wheel].put(r, caution(slack), &mut self.next);
    }

    fn wake<R: Refinements + ?Sized>(&mut self, of: &R, motion: Motion) {
        let runs: [f64; 1 + ARMS] = match motion {
            Motion::Moved { distance, angle } if distance.is_finite() && angle.is_finite() => {
                self.course = distance / angle.max(f64::MIN_POSITIVE);
                self.arms.map(|arm| distance.max(angle * arm))
            }
            _ => [f64::NAN; 1 + ARMS],
        };
        let Self { state, next, work, waiting, wheels, .. } = self;
        if wheels.iter().zip(runs).all(|(wheel, run)| wheel.can_run(run)) {
            let mut wake = |r: u32| {
                state[r as usize] &= !ASLEEP;
                work.push(r);
            };
            for (wheel, run) in wheels.iter_mut().zip(runs) {
                wheel.advance(run, next, &mut wake);
            }
            work.sort_unstable_by(|a, b| b.cmp(a));
            return;
        }
        // No answer holds.
        wheels.iter_mut().for_each(Wheel::clear);
        waiting.clear();
        state.iter_mut().for_each(|s| *s &= !ASLEEP);
        work.extend(of.roots());
        for r in 0..state.len() as u32 {
            if state[r as usize] & ASKED != 0 {
                work.push(r);
                work.extend(of.children(r).filter(|&child| state[child as usize] & ASKED == 0));
            }
        }
    }
}

impl Front {
    /// Bytes of the arrays.
    pub fn memory(&self) -> usize {
        self.state.len()
            + size_of_val(&self.next[..])
            + size_of_val(&self.waiting[..])
            + self.wheels.iter().map(Wheel::memory).sum::<usize>()
    }
}
