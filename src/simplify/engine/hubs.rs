//! Points with very many triangles (hubs): looked at in proportion to the changes around them.
//!
//! A change next to a point makes its candidate stale or wakes it. Looking at a hub of valence v again takes v steps: v^2
//! in all where a fan is removed triangle by triangle. So a hub, and the points around it, are looked at again after a
//! share of its triangles has changed. Points still to look at when the queue is empty are woken then.

use glam::Vec3;

use crate::simplify::metric::{ErrorMetric, Pair};
use crate::simplify::oracle::{Collapse, Reads};
use crate::simplify::surface::HUB;

use super::candidates::Best;
use super::driver::{Engine, state};

/// A hub is looked at again after valence / SHARE changes.
const SHARE: usize = 16;

/// Changes around hubs since they were last looked at.
pub(super) struct Hubs {
    changes: Vec<u32>,
    /// Per point, merges into the hub since the points around it were last looked at.
    around: Vec<u32>,
    /// Hubs around which some point still sleeps despite a change.
    pending: Vec<u32>,
    /// The pending hubs are woken below this number of triangles: fewer than at the last time.
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

    /// Counts a change next to a hub. Returns whether the hub is due to be looked at; if not, remembers the hub.
    pub(super) fn is_time_for_hub(&mut self, hub: u32) -> bool {
        let changes = &mut self.hubs.changes[hub as usize];
        *changes = changes.saturating_add(1);
        let due = *changes as usize >= self.surface.valence(hub) / SHARE;
        if !due {
            self.remember(hub);
        }
        due
    }

    /// Counts a merge into a hub. Returns whether all points around the hub are due to be looked at; if not, remembers
    /// the hub.
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

    /// Whether all candidates of a point may be looked at now: always, except for a hub looked at recently.
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

    /// Thins out the sorted candidates of a hub to at most [`HUB`]: the cheapest half of this number, and as many spread
    /// over the rest. Asking about all then takes time in proportion to the hub's triangles.
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

    /// Wakes points asleep only because of hubs or of a guard limit grown since. Returns whether any point was woken.
    pub(super) fn wake_rest(&mut self) -> bool {
        let mut any = false;
        for hub in self.surface.walk_hubs() {
            self.remember(hub);
        }
        let triangles = self.surface.live_triangles();
        // Visits everything around the hubs each time: wait until a share of the triangles is gone since.
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

    /// Whether the guard refuses some remaining collapse.
    pub(super) fn guards_any(&self) -> bool {
        let guarded = |state: &u8| state & state::GUARDED != 0 && state & state::GONE == 0;
        self.state.iter().any(guarded)
    }
}
