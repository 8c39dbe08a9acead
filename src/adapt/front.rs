//! Which refinements a view asks for, kept up to date by looking only at those whose answer may have changed.
//!
//! ```text
//!              o          asked for: all that it needs is asked for too
//!            /   \
//!          o       o      the rim: asked for, with nothing asked for above it     -> may go
//!         / \     / \
//!        .   .   .   .    the fringe: not asked for, but all that it needs is     -> may come
//! ```
//!
//! An answer comes with a slack: how far the eye may move and turn before it can change. Until the odometer has run that
//! far nobody asks again. Since tests are monotone in nested bounds, looking at rim and fringe finds all there is; and since
//! an answer depends on the view alone, so does the set, whatever it was before.

use crate::view::{Answer, Criterion, Motion};

use super::refinements::Refinements;
use super::wheel::Wheel;

/// Asked for by the view.
pub(super) const ASKED: u8 = 1;
/// Its last answer still holds.
const ASLEEP: u8 = 2;
/// In the mesh: asked for, or needed by what is.
pub(super) const DONE: u8 = 4;

/// Shrinks slacks by more than what sums of floats lose.
const CAUTION: f64 = 1.0 - 1e-9;

#[derive(Debug, Clone)]
pub(super) struct Front {
    /// Flags of every refinement.
    pub state: Vec<u8>,
    next: Vec<u32>,
    /// Those that only moving wakes, and those that turning wakes too.
    moved: Wheel,
    moved_or_turned: Wheel,
    /// Length that a turn of one radian counts for.
    arm: f64,
    pub work: Vec<u32>,
    /// Answers asked for so far.
    pub tests: u64,
}

impl Front {
    /// Nothing asked for, nothing known. `size` is the object's, object units.
    pub fn new(count: usize, size: f64) -> Self {
        let tick = if size > 0.0 { size * 1e-6 } else { 1.0 };
        Self {
            state: vec![0; count],
            next: vec![0; count],
            moved: Wheel::new(tick),
            moved_or_turned: Wheel::new(tick),
            arm: size,
            work: Vec::new(),
            tests: 0,
        }
    }

    /// Moves the set to what is asked for now. `changed` is told every change in an order in which each step is closed, and
    /// may say no to go on: then the set is closed, but no more than that, and no answer is known.
    pub fn update<R: Refinements + ?Sized, C: Criterion + ?Sized>(
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
            if !self.is_due(of, r) {
                continue;
            }
            let asked = state & ASKED != 0;
            self.tests += 1;
            let answer = criterion.needs(of.bounds(r));
            if answer.refine != asked {
                self.state[r as usize] ^= ASKED;
                if !changed(&mut self.state, r, answer.refine) {
                    self.forget();
                    return false;
                }
            }
            self.sleep(r, answer);
            // Those for whom the rim has moved.
            if answer.refine && !asked {
                for child in of.children(r) {
                    if self.state[child as usize] & ASLEEP == 0 {
                        self.work.push(child);
                    }
                }
            } else if asked && !answer.refine {
                for parent in of.parents(r) {
                    if self.state[parent as usize] & ASLEEP == 0 {
                        self.work.push(parent);
                    }
                }
            }
        }
        true
    }

    /// Whether it is on the rim or the fringe.
    #[inline]
    pub fn is_due<R: Refinements + ?Sized>(&self, of: &R, r: u32) -> bool {
        if self.state[r as usize] & ASKED != 0 {
            !of.children(r).any(|child| self.state[child as usize] & ASKED != 0)
        } else {
            of.parents(r).all(|parent| self.state[parent as usize] & ASKED != 0)
        }
    }

    /// Forgets all answers, not what they led to.
    pub fn forget(&mut self) {
        self.moved.clear();
        self.moved_or_turned.clear();
        self.state.iter_mut().for_each(|s| *s &= !ASLEEP);
        self.work.clear();
    }

    /// Hands out the rim and the fringe, some of it twice, and more; check with [`Front::is_due`].
    pub fn candidates<R: Refinements + ?Sized>(&mut self, of: &R) -> &[u32] {
        self.forget();
        self.wake(of, Motion::Other);
        &self.work
    }

    fn sleep(&mut self, r: u32, answer: Answer) {
        self.state[r as usize] |= ASLEEP;
        if answer.turned == f64::INFINITY {
            if answer.moved < f64::INFINITY {
                self.moved.put(r, answer.moved * CAUTION, &mut self.next);
            }
        } else {
            let slack = answer.moved.min(answer.turned * self.arm);
            self.moved_or_turned.put(r, slack * CAUTION, &mut self.next);
        }
    }

    fn wake<R: Refinements + ?Sized>(&mut self, of: &R, motion: Motion) {
        let Self { state, next, work, .. } = self;
        match motion {
            Motion::Moved { distance, angle } if distance.is_finite() && angle.is_finite() => {
                let mut wake = |r: u32| {
                    state[r as usize] &= !ASLEEP;
                    work.push(r);
                };
                self.moved.advance(distance, next, &mut wake);
                self.moved_or_turned.advance(distance + angle * self.arm, next, &mut wake);
            }
            _ => {
                self.moved.clear();
                self.moved_or_turned.clear();
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
    }

    /// Bytes of its arrays.
    pub fn memory(&self) -> usize {
        self.state.len() + size_of_val(&self.next[..]) + self.moved.memory() + self.moved_or_turned.memory()
    }
}
