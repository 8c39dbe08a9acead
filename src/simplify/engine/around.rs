//! Updates after a collapse: candidates around it become stale, cheaper or awake.

use crate::mesh::NONE;
use crate::simplify::metric::{Dependence, ErrorMetric, Pair};
use crate::simplify::options::{Independence, Order};
use crate::simplify::surface::HUB;

use super::candidates::{Best, NO_BEST};
use super::driver::{Engine, state};

impl<M: ErrorMetric> Engine<'_, M> {
    /// Updates the candidates around a merged point, or marks them stale.
    pub(super) fn update_around(&mut self, pair: Pair, rank: u32) {
        let mut ring = std::mem::take(&mut self.ring);
        ring.clear();
        let is_hub = self.is_hub(pair.kept);
        // Around an unmoved hub, only the lost point's star has changed.
        let is_part = is_hub
            && self.order == Order::Linear
            && self.patch.facets().len() == self.patch.facets_of_lost().len()
            && !self.is_time_around_hub(pair.kept);
        if is_part {
            ring.extend(self.patch.facets_of_lost().iter().flat_map(|facet| facet.others));
            ring.extend(self.patch.opposite());
        } else {
            self.surface.for_neighbours(pair.kept, |n| ring.push(n));
        }
        if self.tiled {
            self.touched[pair.kept as usize] = rank;
            for &n in &ring {
                self.touched[n as usize] = self.touched[n as usize].max(rank);
            }
        }
        if self.order == Order::Batched {
            self.state[pair.kept as usize] |= state::TOUCHED;
        }
        if self.order == Order::Batched && self.independence == Independence::Ring {
            ring.iter().for_each(|&n| self.state[n as usize] |= state::TOUCHED);
        } else {
            let dependence = self.metric.properties().dependence;
            let memoryless = dependence == Dependence::Triangles;
            // Edges between points of the ring go out of the batch.
            let has_domains = self.order == Order::Batched && self.independence == Independence::Domain;
            let kept_counts = dependence == Dependence::Both || self.is_symmetric();
            if !self.verified.is_empty() {
                ring.iter().for_each(|&n| self.verified[n as usize] = NONE);
                self.verified[pair.kept as usize] = NONE;
            }
            for &n in &ring {
                let other = self.best[n as usize].other;
                let stale =
                    memoryless | has_domains | (other == pair.lost) | (kept_counts & (other == pair.kept));
                let asleep = self.state[n as usize] & state::ASLEEP != 0;
                if (stale | asleep) && self.is_hub(n) && !self.is_time_for_hub(n) {
                    continue;
                }
                self.state[n as usize] |= state::STALE * u8::from(stale);
                if asleep {
                    self.wake(n);
                }
            }
            if self.order == Order::Batched {
                self.best[pair.kept as usize] = NO_BEST;
                self.queue.remove(pair.kept);
                self.ring = ring;
                return;
            }
            if is_part {
                // The hub's own candidates are looked at later; candidates of others into the hub are looked at now.
                let mut others = std::mem::take(&mut self.dead);
                others.clear();
                others.extend(self.patch.facets_of_lost().iter().map(|facet| facet.others[1]));
                self.offer_to(pair.kept, &others);
                self.dead = others;
                ring.clear();
                self.partners.for_each(&self.surface, self.parts.as_deref(), pair.kept, |n| ring.push(n));
                self.offer(pair.kept, &ring);
                self.ring = ring;
                return;
            }
            let was_asleep = self.state[pair.kept as usize] & (state::ASLEEP | state::WOKEN) != 0;
            self.state[pair.kept as usize] &= !(state::ASLEEP | state::WOKEN);
            if memoryless {
                // All its pairs are offered below.
                self.state[pair.kept as usize] &= !state::STALE;
                self.best[pair.kept as usize] = NO_BEST;
                self.queue.remove(pair.kept);
                self.offer(pair.kept, &ring);
            } else {
                self.state[pair.kept as usize] |= state::STALE;
                // Costs of existing pairs only grew; pairs with new neighbours are new.
                ring.clear();
                let others = self.patch.facets_of_lost().iter().map(|facet| facet.others[1]);
                ring.extend(others.filter(|&n| !self.patch.has_third(n)));
                self.offer(pair.kept, &ring);
            }
            ring.clear();
            self.partners.for_each(&self.surface, self.parts.as_deref(), pair.kept, |n| ring.push(n));
            self.offer(pair.kept, &ring);
            if was_asleep && !memoryless {
                self.refresh(pair.kept);
            }
            match self.best[pair.kept as usize] {
                Best { other: NONE, .. } => self.queue.remove(pair.kept),
                Best { cost, .. } => self.queue.insert(pair.kept, cost),
            }
        }
        self.ring = ring;
    }

    /// Serves a point and all around it after the others that are due.
    ///
    /// Where all costs are alike, points are served in the order of their numbers, which is often an order along the mesh:
    /// each would be merged into the next, with all samples that were handed to it before.
    pub(super) fn put_behind(&mut self, point: u32) {
        let Self { surface, queue, .. } = self;
        queue.put_behind(point);
        if surface.valence(point) <= HUB {
            surface.for_neighbours(point, |n| queue.put_behind(n));
        }
    }

    /// Looks at the pairs of a point with others, in both directions, and moves a point up where its pair is its
    /// cheapest.
    fn offer(&mut self, point: u32, others: &[u32]) {
        if self.is_symmetric() {
            for &other in others {
                let (low, high) = (point.min(other), point.max(other));
                self.offer_one(low, high, self.judge().cost(low, high));
            }
            return;
        }
        let mut costs = std::mem::take(&mut self.costs);
        costs.clear();
        costs.resize(others.len(), 0.0);
        self.judge().costs(point, others, &mut costs);
        for (&other, &cost) in others.iter().zip(&costs) {
            self.offer_one(point, other, cost);
            self.offer_one(other, point, self.judge().cost(other, point));
        }
        self.costs = costs;
    }

    /// Looks at the pairs of others with a hub, in the direction into the hub.
    fn offer_to(&mut self, hub: u32, others: &[u32]) {
        for &other in others.iter().filter(|&&other| other != hub) {
            let (low, high) =
                if self.is_symmetric() { (other.min(hub), other.max(hub)) } else { (other, hub) };
            if low != hub {
                self.offer_one(low, high, self.judge().cost(low, high));
            }
        }
    }

    #[inline]
    fn offer_one(&mut self, point: u32, other: u32, cost: f32) {
        let best = &mut self.best[point as usize];
        if self.state[point as usize] & state::WOKEN != 0 {
            return;
        }
        if cost < best.cost || best.other == NONE {
            *best = Best { cost, other };
            self.queue.insert(point, cost);
        }
    }
}
