//! Tries the candidates of a point: the cheapest that every rule allows is collapsed.

use glam::Vec3;

use crate::mesh::NONE;
use crate::simplify::metric::{ErrorMetric, Loss, Pair};
use crate::simplify::options::{Independence, Order};
use crate::simplify::oracle::Collapse;
use crate::simplify::placement::Placement;

use super::candidates::{Best, Candidate, Judge, NO_BEST};
use super::driver::{Engine, state};

/// Weight of a measured deviation against an estimated cost. Found by trial: a larger weight improves the mean (2: by
/// 15 %, 4: by 22 %, 8: by 24 % at a tenth of the triangles), but worsens the maximum, and is slower.
const VERIFIED_WEIGHT: f32 = 4.0;

/// A verified cost up to this factor above the estimate is accepted.
const VERIFIED_SLACK: f32 = 1.2;

/// A waiting point looks again after a change next to it if its next candidate costs more than this factor times a
/// refused candidate. On flat faces with straight edges the ratio is unbounded, on scans small.
const LEAP: f32 = 1024.0;

/// A cost below all costs arising from rounding.
const LEAST_COST: f32 = 1e-30;

/// Maximum number of candidates of a point priced together.
const FEW: usize = 16;

/// Outcome of a candidate.
enum Attempt {
    Done,
    Refused,
    /// Costs more than estimated, and should wait for this cost.
    Later(f32),
    /// Deferred until this cost is due, by a rule with a surcharge.
    Dear(f32),
}

/// A candidate allowed by the rules, and the factor on its cost.
pub(super) struct Legal {
    pub(super) candidate: Candidate,
    surcharge: f32,
}

impl<M: ErrorMetric> Engine<'_, M> {
    /// Does the cheapest legal collapse of a point, unless the point must wait. Returns whether a collapse was done.
    #[inline]
    pub(super) fn serve_point(&mut self, point: u32) -> bool {
        if self.state[point as usize] & (state::GONE | state::TOUCHED) != 0 {
            return false;
        }
        // Its candidate may have been merged away as a partner without an edge, or be taken by this batch.
        let other = self.state.get(self.best[point as usize].other as usize);
        let taken = other.is_some_and(|other| other & (state::GONE | state::TOUCHED) != 0);
        if taken || self.state[point as usize] & state::STALE != 0 {
            self.refresh(point);
            let best = self.best[point as usize];
            if best.other == NONE {
                return false;
            }
            if !self.queue.is_due(best.cost) {
                self.queue.insert(point, best.cost);
                return false;
            }
        } else if self.has_grown_unseen(point) {
            return false;
        }
        self.try_collapse(point)
    }

    /// Whether a hub has grown since the candidate's cost was computed, so the candidate is no longer due. If so, puts
    /// the point back at its present cost.
    fn has_grown_unseen(&mut self, point: u32) -> bool {
        let other = self.best[point as usize].other;
        if other == NONE || !(self.is_hub(point) || self.is_hub(other)) {
            return false;
        }
        let cost = self.judge().cost(point, other);
        let has_grown = !self.queue.is_due(cost);
        if has_grown {
            self.best[point as usize].cost = cost;
            self.queue.insert(point, cost);
        }
        has_grown
    }

    pub(super) fn refresh(&mut self, point: u32) {
        self.state[point as usize] &= !(state::STALE | state::WOKEN);
        self.best[point as usize] = self.candidate(point);
        if let Some(verified) = self.verified.get_mut(point as usize) {
            *verified = NONE;
        }
    }

    /// Whether this placement looks at each pair once, from its lower point, rather than in both directions.
    pub(super) fn is_symmetric(&self) -> bool {
        self.placement != Placement::Endpoint
    }

    pub(super) fn judge(&self) -> Judge<'_, M> {
        Judge { metric: self.metric, surface: &self.surface, placement: self.placement }
    }

    /// Returns the cheapest candidate of a point, legal or not; among equal costs the lowest number.
    pub(super) fn candidate(&self, point: u32) -> Best {
        // Costs are not negative, so they compare like their bits: a single number for both, and no branch on the
        // lesser.
        let key = |option: Best| u64::from(option.cost.to_bits()) << 32 | u64::from(option.other);
        let mut least = key(NO_BEST);
        self.for_candidates(point, |option| least = least.min(key(option)));
        Best { cost: f32::from_bits((least >> 32) as u32), other: least as u32 }
    }

    /// Calls `visit` with every candidate of a point. Prices candidates together, for metrics computing several at
    /// once.
    #[inline]
    pub(super) fn for_candidates(&self, point: u32, mut visit: impl FnMut(Best)) {
        let mut others = [0; FEW];
        let mut count = 0;
        if self.looks_at_all {
            count = self.surface.few_neighbours(point, &mut others);
        } else {
            self.for_others(point, |other| {
                others[count % FEW] = other;
                count += 1;
            });
        }
        if let Some(others) = others.get(..count) {
            let mut costs = [0.0; FEW];
            let costs = &mut costs[..count];
            self.judge().costs(point, others, costs);
            others.iter().zip(costs).for_each(|(&other, &mut cost)| visit(Best { cost, other }));
        } else {
            self.for_others(point, |other| visit(Best { cost: self.judge().cost(point, other), other }));
        }
    }

    /// Calls `visit` with every point which `point` may be merged with.
    #[inline]
    fn for_others(&self, point: u32, mut visit: impl FnMut(u32)) {
        let symmetric = self.is_symmetric();
        let has_domains = self.order == Order::Batched && self.independence == Independence::Domain;
        self.surface.for_neighbours(point, |other| {
            if !(symmetric && other < point)
                && self.state[other as usize] & state::TOUCHED == 0
                && !(has_domains && self.is_in_domain(point, other))
            {
                visit(other);
            }
        });
        // Partners are not symmetric: visit them from either side.
        self.partners.for_each(&self.surface, self.parts.as_deref(), point, |other| {
            if self.state[other as usize] & state::TOUCHED == 0 {
                visit(other);
            }
        });
    }

    /// Whether an edge is an edge of a triangle changed by a collapse of this batch.
    fn is_in_domain(&self, point: u32, other: u32) -> bool {
        let mut is = false;
        self.surface.for_shared_triangles(point, other, |triangle| {
            let corners = self.surface.triangle(triangle).into_iter().flatten();
            is |= corners.into_iter().any(|corner| self.state[corner as usize] & state::TOUCHED != 0);
        });
        is
    }

    /// Collapses the point's candidate, or the next legal candidate. Returns whether a collapse was done.
    fn try_collapse(&mut self, point: u32) -> bool {
        let first = self.best[point as usize];
        let mut later = NO_BEST;
        let mut asleep = false;
        let mut least_refused = f32::INFINITY;
        match self.attempt(point, first) {
            Attempt::Done => return true,
            Attempt::Later(cost) => {
                self.postpone(point, Best { cost, other: first.other }, false);
                return false;
            }
            Attempt::Dear(cost) => {
                later = Best { cost, other: first.other };
                asleep = true;
            }
            Attempt::Refused => least_refused = first.cost,
        }
        if !self.may_look_around(point) {
            self.postpone(point, later, asleep);
            return false;
        }
        let mut options = std::mem::take(&mut self.options);
        options.clear();
        self.for_candidates(point, |option| options.push(option));
        options.sort_unstable_by(|a, b| a.cost.total_cmp(&b.cost).then(a.other.cmp(&b.other)));
        options.dedup_by_key(|option| option.other);
        if self.is_hub(point) {
            Self::thin_out(&mut options);
        }
        let mut done = false;
        for &Best { cost, other } in options.iter().filter(|option| option.other != first.other) {
            if cost >= later.cost {
                break;
            }
            let (cost, dear) = if self.queue.is_due(cost) {
                match self.attempt(point, Best { cost, other }) {
                    Attempt::Done => {
                        done = true;
                        break;
                    }
                    Attempt::Later(cost) => (cost, false),
                    Attempt::Dear(cost) => (cost, true),
                    Attempt::Refused => {
                        least_refused = least_refused.min(cost);
                        continue;
                    }
                }
            } else {
                match self.legal(point, other) {
                    Some(Legal { surcharge, .. }) => (dearer(cost, surcharge), surcharge > 1.0),
                    None => {
                        least_refused = least_refused.min(cost);
                        continue;
                    }
                }
            };
            if cost < later.cost {
                later = Best { cost, other };
                asleep = dear;
            }
            if !dear {
                break;
            }
        }
        self.options = options;
        if !done {
            // A candidate of cost 0 may become legal at any change, and should not wait until an expensive candidate is
            // due.
            asleep |= least_refused * LEAP < later.cost;
            self.postpone(point, later, asleep);
        }
        done
    }

    /// Lets a point wait for a dearer candidate, or sleep without any. `asleep`: a change next to the point wakes it
    /// even while it waits.
    fn postpone(&mut self, point: u32, later: Best, asleep: bool) {
        self.best[point as usize] = later;
        if asleep || later.other == NONE {
            self.state[point as usize] |= state::ASLEEP;
        }
        if later.other != NONE {
            self.queue.insert(point, later.cost);
        }
    }

    /// Returns pair, position and surcharge of a candidate, or `None` if an oracle forbids it. Leaves its patch in
    /// `self.patch`.
    #[inline]
    pub(super) fn legal(&mut self, point: u32, other: u32) -> Option<Legal> {
        let (pair, x) = self.judge().place(point, other);
        let (x, object) = self.judge().snap(pair, x);
        if self.is_hub(pair.lost) && self.is_refused_early(pair, x) {
            return None;
        }
        self.patch.gather(&self.surface, pair, x);
        let collapse = Collapse { pair, position: x.into(), patch: &self.patch };
        let mut surcharge = 1.0;
        let is_joined = self.parts.as_deref().is_some_and(|parts| parts.has_joined(pair));
        self.breaks_topology = false;
        for (oracle, count) in self.oracles.iter().zip(&mut self.refusals) {
            let is_free = oracle.keeps_topology() && (is_joined || !self.keeps_topology);
            if is_free && (is_joined || self.breaks_topology) || oracle.allows(&self.surface, &collapse) {
                continue;
            }
            if is_free {
                self.breaks_topology = true;
            } else {
                *count += 1;
                surcharge *= oracle.surcharge()?.max(1.0);
            }
        }
        if (is_joined || self.breaks_topology) && self.takes_all(pair) {
            self.vanishing.whole += 1;
            return None;
        }
        if self.makes_rag(pair) {
            self.vanishing.rags += 1;
            return None;
        }
        Some(Legal { candidate: Candidate { pair, x, object }, surcharge })
    }

    /// Does a candidate's collapse, unless a rule refuses it or it turns out dearer than estimated.
    fn attempt(&mut self, point: u32, best: Best) -> Attempt {
        let Some(Legal { candidate, surcharge }) = self.legal(point, best.other) else {
            return Attempt::Refused;
        };
        let Candidate { pair, x, .. } = candidate;
        if surcharge > 1.0 {
            let cost = dearer(self.judge().cost(point, best.other), surcharge);
            if !self.queue.is_due(cost) {
                return Attempt::Dear(cost);
            }
        }
        if let Some(true_cost) = self.verify(point, best.other, pair, x)
            && true_cost > VERIFIED_SLACK * best.cost
            && !self.queue.is_due(true_cost)
        {
            return Attempt::Later(true_cost);
        }
        let guard = self.guard_limit();
        if self.limits.error.is_finite() || self.may_exceed(guard, pair, x) {
            let error = self.errors.measure(&self.surface, &self.patch, pair, x);
            if self.surface.frame().object_length(error.largest()) > self.limits.error {
                self.too_far += 1;
                return Attempt::Refused;
            }
            if error.surface > guard {
                self.watch.refuse(guard);
                self.state[point as usize] |= state::GUARDED;
                return Attempt::Refused;
            }
        }
        self.commit(candidate);
        Attempt::Done
    }

    /// Returns the largest error allowed by the guard after the collapse whose patch is in `self.patch`, inner units.
    pub(super) fn guard_limit(&self) -> f32 {
        self.watch.limit(self.surface.live_sheets() - self.patch.opposite().len())
    }

    /// Whether a collapse may raise the error beyond `limit`: distances from the patch grow by at most the way the
    /// points move.
    #[inline]
    pub(super) fn may_exceed(&self, limit: f32, pair: Pair, x: Vec3) -> bool {
        let way = x.distance(self.surface.at(pair.lost)).max(x.distance(self.surface.at(pair.kept)));
        self.watch.largest + way > limit
    }

    /// Returns the cost of a collapse from its deviation from the input; `None` where costs are not verified, or the
    /// cost is verified already.
    fn verify(&mut self, point: u32, other: u32, pair: Pair, x: Vec3) -> Option<f32> {
        let known = self.verified.get_mut(point as usize)?;
        if *known == other {
            return None;
        }
        *known = other;
        let rate = self.metric.cost_of(&self.surface, pair, Loss::Deviation)?;
        let added = self.errors.added(&self.surface, &self.patch, pair, x)?;
        Some((VERIFIED_WEIGHT * rate * added).max(0.0))
    }
}

/// Returns the cost of a candidate deferred by a rule. Never 0, so it comes after all candidates of cost 0.
fn dearer(cost: f32, surcharge: f32) -> f32 {
    if surcharge > 1.0 { (cost.max(LEAST_COST) * surcharge).min(f32::MAX) } else { cost }
}
