//! A timing wheel: sleepers sorted by the distance the odometer may run until their next test.
//!
//! ```text
//!     level 0   | . | . | o | . |  ...  64 slots of 1 tick
//!     level 1   | . | o | . | . |  ...  64 slots of 4 ticks        whoever sleeps longer lies in a coarser slot and
//!     level 2   | o | . | o | . |  ...  64 slots of 16 ticks       wakes at most a sixteenth too early
//! ```
//!
//! Slots are lists linked through a single array, shared by the caller among wheels. Nothing allocates, and each sleeper
//! takes 4 bytes. Putting in a sleeper is O(1). Advancing is O(levels + slots drained + woken).

use crate::mesh::NONE;

const SLOTS: u64 = 64;
const LEVELS: usize = 20;
/// Shift between the slot widths of levels: each level's slots are 4 times as wide as the slots of the previous level.
const WIDER: u32 = 2;
/// Maximum number of ticks of a sleep, and of an odometer.
const FOREVER: u64 = 1 << 61;

#[derive(Debug, Clone)]
pub(super) struct Wheel {
    /// First sleeper of every slot. Empty until the first sleeper is put in a slot.
    heads: Vec<u32>,
    /// Per level, a bit for each slot with sleepers.
    taken: [u64; LEVELS],
    /// Sleepers with less than a whole tick to sleep.
    soon: u32,
    /// Whole ticks run so far (`now`), and the fraction of a tick (`part`).
    now: u64,
    part: f64,
    /// Ticks per object unit.
    ticks: f64,
}

impl Wheel {
    /// Creates an empty wheel. `tick` is the length of a tick, object units.
    pub fn new(tick: f64) -> Self {
        Self { heads: Vec::new(), taken: [0; LEVELS], soon: NONE, now: 0, part: 0.0, ticks: 1.0 / tick }
    }

    /// Forgets all sleepers.
    pub fn clear(&mut self) {
        self.heads.fill(NONE);
        self.taken = [0; LEVELS];
        self.soon = NONE;
        self.now = 0;
        self.part = 0.0;
    }

    /// Whether the odometer can run by `distance` without overflow. If not, the wheel must be cleared.
    pub fn can_run(&self, distance: f64) -> bool {
        self.now < FOREVER && distance * self.ticks < FOREVER as f64
    }

    /// Bytes of the slots.
    pub fn memory(&self) -> usize {
        size_of_val(&self.heads[..])
    }

    /// Puts in a sleeper which must wake before the odometer has run `slack` further.
    #[inline]
    pub fn put(&mut self, sleeper: u32, slack: f64, next: &mut [u32]) {
        // The cast rounds down.
        let ahead = (self.part + slack * self.ticks).min(FOREVER as f64) as u64;
        let (now, until) = (self.now, self.now + ahead);
        let list = if ahead == 0 {
            &mut self.soon
        } else {
            // The finest level with slots reaching `ahead` ticks.
            let level = (ahead.ilog2() + 1).saturating_sub(SLOTS.ilog2()).div_ceil(WIDER) as usize;
            let level = level.min(LEVELS - 1);
            let shift = WIDER * level as u32;
            // Part of the current slot may be gone, so `until` may lie one slot beyond the wheel.
            let slot = (until >> shift).min((now >> shift) + SLOTS - 1) % SLOTS;
            if self.heads.is_empty() {
                self.heads = vec![NONE; SLOTS as usize * LEVELS];
            }
            self.taken[level] |= 1 << slot;
            &mut self.heads[level * SLOTS as usize + slot as usize]
        };
        next[sleeper as usize] = *list;
        *list = sleeper;
    }

    /// Runs the odometer by `distance`, and calls `wake` with every sleeper which may be due.
    pub fn advance(&mut self, distance: f64, next: &[u32], mut wake: impl FnMut(u32)) {
        if distance <= 0.0 {
            return;
        }
        let mut drain = |list: &mut u32| {
            let mut sleeper = std::mem::replace(list, NONE);
            while sleeper != NONE {
                let following = next[sleeper as usize];
                wake(sleeper);
                sleeper = following;
            }
        };
        drain(&mut self.soon);
        let run = self.part + distance * self.ticks;
        let (now, until) = (self.now, self.now + run.min(FOREVER as f64) as u64);
        self.part = run.fract();
        self.now = until;
        for level in 0..LEVELS {
            let (first, last) = (now >> (WIDER * level as u32), until >> (WIDER * level as u32));
            let passed = (last - first).min(SLOTS);
            if passed == 0 {
                break;
            }
            // Slots `first + 1` to `first + passed`, around the wheel.
            let mask = (u64::MAX >> (SLOTS - passed)).rotate_left(((first + 1) % SLOTS) as u32);
            let mut due = self.taken[level] & mask;
            self.taken[level] &= !mask;
            while due != 0 {
                drain(&mut self.heads[level * SLOTS as usize + due.trailing_zeros() as usize]);
                due &= due - 1;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sleepers wake in time, and not before 7/8 of a long sleep.
    #[test]
    fn sleepers_wake_in_time() {
        let mut state = 3u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as f64 / (1u64 << 31) as f64
        };
        let count = 4000;
        let (mut wheel, mut next) = (Wheel::new(0.01), vec![NONE; count]);
        let mut due = vec![(0.0, f64::INFINITY); count];
        let mut odometer = 0.0;
        for sleeper in 0..count as u32 {
            let slack = 10f64.powf(random() * 8.0 - 3.0);
            due[sleeper as usize] = (odometer, slack);
            wheel.put(sleeper, slack, &mut next);
        }
        for _ in 0..3000 {
            let step = 10f64.powf(random() * 4.0 - 3.0);
            odometer += step;
            let mut woken = Vec::new();
            wheel.advance(step, &next, |sleeper| woken.push(sleeper));
            for &sleeper in &woken {
                let (put, slack) = due[sleeper as usize];
                if slack > 1.0 && odometer - put < slack {
                    assert!(odometer - put > 0.875 * slack - 0.1, "{} of {slack}", odometer - put);
                }
                let slack = 10f64.powf(random() * 6.0 - 3.0);
                due[sleeper as usize] = (odometer, slack);
                wheel.put(sleeper, slack, &mut next);
            }
            assert!(due.iter().all(|&(put, slack)| odometer - put <= slack * (1.0 + 1e-9) + 1e-9));
        }
    }
}
