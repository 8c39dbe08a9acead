//! Points with very many triangles: looked at in proportion to what changes around them.
//!
//! A change next to a point makes its candidate stale or wakes it, and to look at a hub of valence v again takes v steps:
//! v^2 in all where a fan is taken away triangle by triangle. So a hub, and what lies around it, is looked at again after
//! a share of its triangles has changed; what is still to be looked at when the queue is empty is woken then.

use glam::Vec3;

use super::super::candidates::Best;
use super::super::metric::{ErrorMetric, Pair};
use super::super::oracle::{Collapse, Reads};
use super::{Engine, state};

/// Points of more triangles are hubs.
pub(in super::super) const HUB: usize = 64;
/// A hub is looked at again when this share of its triangles has changed.
const SHARE: usize = 16;

/// What changed around hubs since they were looked at.
pub(super) struct Hubs {
    changes: Vec<u32>,
    /// The same since what lies around them was looked at.
    around: Vec<u32>,
    /// Hubs around which something still sleeps that a change would have woken.
    pending: Vec<u32>,
    /// Triangles below which the pending are woken: fewer than when they were last.
    woken_below: usize,
}

impl Hubs {
    pub fn new(points: usize) -> Self {
        // At first everything is new.
        Self {
            changes: vec![u32::MAX; points],
            around: vec![0; points],
            pending: Vec::new(),
            woken_below: usize::MAX,
        }
    }
}

impl<M: ErrorMetric> Engine<'_, M> {
    #[inline]
    pub(super) fn is_hub(&self, point: u32) -> bool {
        self.surface.valence(point) > HUB
    }

    /// Counts a change next to a hub. Whether it is time to look at it again; where not, the hub is remembered.
    pub(super) fn is_time_for_hub(&mut self, hub: u32) -> bool {
        let changes = &mut self.hubs.changes[hub as usize];
        *changes = changes.saturating_add(1);
        let due = *changes as usize >= self.surface.valence(hub) / SHARE;
        if !due {
            self.remember(hub);
        }
        due
    }

    /// Counts a merge into a hub. Whether it is time to look at all that lies around it; where not, it is remembered.
    pub(super) fn is_time_around_hub(&mut self, hub: u32) -> bool {
        let changes = &mut self.hubs.changes[hub as usize];
        *changes = changes.saturating_add(1);
        let around = &mut self.hubs.around[hub as usize];
        *around += 1;
        let due = *around as usize >= self.surface.valence(hub) / SHARE;
        if due {
            *around = 0;
        } else {
            self.remember(hub);
        }
        due
    }

    fn remember(&mut self, hub: u32) {
        let state = &mut self.state[hub as usize];
        if *state & state::PENDING == 0 {
            *state |= state::PENDING;
            self.hubs.pending.push(hub);
        }
    }

    /// Whether all candidates of a point may be looked at: always, unless it is a hub that was looked at a short while
    /// ago.
    pub(super) fn may_look_around(&mut self, point: u32) -> bool {
        if !self.is_hub(point) {
            return true;
        }
        let changes = &mut self.hubs.changes[point as usize];
        if (*changes as usize) < self.surface.valence(point) / SHARE {
            self.remember(point);
            return false;
        }
        *changes = 0;
        true
    }

    /// Leaves so many candidates of a hub, sorted by cost, that to ask about all takes steps in proportion to its triangles:
    /// half of them the cheapest, half of them spread over the others.
    pub(super) fn thin_out(options: &mut Vec<Best>) {
        if options.len() > HUB {
            let (cheapest, stride) = (HUB / 2, options.len().div_ceil(HUB / 2));
            let mut index = 0;
            options.retain(|_| {
                index += 1;
                index <= cheapest || index % stride == 0
            });
        }
    }

    /// Whether a rule refuses a candidate by its pair, or by some facets of its patch.
    #[cold]
    pub(super) fn is_refused_early(&mut self, pair: Pair, x: Vec3) -> bool {
        self.patch.sample(&self.surface, pair, x, HUB);
        let collapse = Collapse { pair, position: x.into(), patch: &self.patch };
        let is_joined = self.parts.as_deref().is_some_and(|parts| parts.has_joined(pair));
        for (oracle, count) in self.oracles.iter().zip(&mut self.refusals) {
            let is_early = oracle.reads() != Reads::Patch
                && oracle.surcharge().is_none()
                && !((is_joined || !self.keeps_topology) && oracle.keeps_topology());
            if is_early && !oracle.allows(&self.surface, &collapse) {
                *count += 1;
                return true;
            }
        }
        false
    }

    /// Wakes what sleeps only because of hubs or of a limit that has grown since. Whether there was anything.
    pub(super) fn wake_rest(&mut self) -> bool {
        let mut any = false;
        let triangles = self.surface.live_triangles();
        // Each time costs steps for all around the hubs: so it is done when a share of the triangles is gone since.
        let is_time = triangles < self.hubs.woken_below;
        let mut pending = if is_time { std::mem::take(&mut self.hubs.pending) } else { Vec::new() };
        if !pending.is_empty() {
            self.hubs.woken_below = triangles - triangles / (4 * SHARE);
        }
        let mut ring = std::mem::take(&mut self.ring);
        for hub in pending.drain(..) {
            self.state[hub as usize] &= !state::PENDING;
            if self.state[hub as usize] & state::GONE != 0 {
                continue;
            }
            self.hubs.changes[hub as usize] = u32::MAX;
            any |= self.wake(hub);
            ring.clear();
            self.surface.for_neighbours(hub, |n| ring.push(n));
            for &n in &ring {
                any |= self.wake(n);
            }
        }
        self.ring = ring;
        if is_time {
            self.hubs.pending = pending;
        }
        if self.watch.has_grown(self.surface.live_sheets()) {
            any |= self.queue_parts();
            for point in 0..self.state.len() as u32 {
                if self.state[point as usize] & state::GUARDED != 0 {
                    self.state[point as usize] &= !state::GUARDED;
                    any |= self.wake(point);
                }
            }
        }
        any
    }

    /// Puts a sleeping point into the queue.
    pub(super) fn wake(&mut self, point: u32) -> bool {
        let state = &mut self.state[point as usize];
        let sleeps = *state & state::ASLEEP != 0 && *state & (state::GONE | state::TOUCHED) == 0;
        if sleeps {
            *state = *state & !state::ASLEEP | state::STALE | state::WOKEN;
            self.queue.insert(point, 0.0);
        }
        sleeps
    }

    /// Whether some collapse left is refused by the guard.
    pub(super) fn guards_any(&self) -> bool {
        let guarded = |state: &u8| state & state::GUARDED != 0 && state & state::GONE == 0;
        self.state.iter().any(guarded)
    }
}
