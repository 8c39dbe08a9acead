//! Sleepers by how far the odometer may run until they must be looked at again.
//!
//! ```text
//!     level 0   | . | . | o | . |  ...  64 slots of 1 tick
//!     level 1   | . | o | . | . |  ...  64 slots of 8 ticks        whoever sleeps longer lies in a coarser slot and
//!     level 2   | o | . | o | . |  ...  64 slots of 64 ticks       wakes at most an eighth too early
//! ```
//!
//! Lists are linked through one array that the caller shares among wheels, so nothing allocates and each sleeper takes 4
//! bytes. Putting one in is O(1); advancing is O(slots passed + woken).

use crate::mesh::NONE;

const SLOTS: usize = 64;
const LEVELS: usize = 14;

#[derive(Debug, Clone)]
pub(super) struct Wheel {
    /// First sleeper of every slot.
    heads: Vec<u32>,
    /// Those that cannot sleep for a whole tick.
    soon: u32,
    /// Ticks run so far.
    now: f64,
    /// Object units a tick.
    tick: f64,
}

fn span(level: usize) -> f64 {
    (1_u64 << (3 * level)) as f64
}

impl Wheel {
    /// An empty wheel with ticks of this length.
    pub fn new(tick: f64) -> Self {
        Self { heads: vec![NONE; SLOTS * LEVELS], soon: NONE, now: 0.0, tick }
    }

    /// Forgets all sleepers.
    pub fn clear(&mut self) {
        self.heads.fill(NONE);
        self.soon = NONE;
        self.now = 0.0;
    }

    /// Bytes of its slots.
    pub fn memory(&self) -> usize {
        size_of_val(&self.heads[..])
    }

    /// Puts in a sleeper that must wake before the odometer has run `slack` further.
    pub fn put(&mut self, sleeper: u32, slack: f64, next: &mut [u32]) {
        let until = self.now + slack / self.tick;
        let mut list = &mut self.soon;
        for level in 0..LEVELS {
            let (first, last) = ((self.now / span(level)).floor(), (until / span(level)).floor());
            let ahead = last - first;
            if ahead < 1.0 {
                break;
            }
            if ahead < SLOTS as f64 || level == LEVELS - 1 {
                let slot = (first + ahead.min(SLOTS as f64 - 1.0)) % SLOTS as f64;
                list = &mut self.heads[level * SLOTS + slot as usize];
                break;
            }
        }
        next[sleeper as usize] = *list;
        *list = sleeper;
    }

    /// Runs the odometer on and hands every sleeper that may be due to `wake`.
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
        let until = self.now + distance / self.tick;
        for level in 0..LEVELS {
            let (first, last) = ((self.now / span(level)).floor(), (until / span(level)).floor());
            let passed = (last - first).min(SLOTS as f64);
            if passed < 1.0 {
                break;
            }
            for step in 1..=passed as usize {
                let slot = (first + step as f64) % SLOTS as f64;
                drain(&mut self.heads[level * SLOTS + slot as usize]);
            }
        }
        self.now = until;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Nobody sleeps too long, and nobody wakes at less than three quarters of a long sleep.
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
                    assert!(odometer - put > 0.75 * slack - 0.1, "{} of {slack}", odometer - put);
                }
                let slack = 10f64.powf(random() * 6.0 - 3.0);
                due[sleeper as usize] = (odometer, slack);
                wheel.put(sleeper, slack, &mut next);
            }
            assert!(due.iter().all(|&(put, slack)| odometer - put <= slack * (1.0 + 1e-9) + 1e-9));
        }
    }
}
