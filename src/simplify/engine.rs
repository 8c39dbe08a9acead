//! The driver: candidates by cost, oracles, collapses, and updates after each collapse.
//!
//! ```text
//! for each batch (one in linear order)
//!     metric.begin
//!     for every point: its cheapest candidate -> queue
//!     while a target is missed, take the next point
//!         stale?            look for its cheapest again, put it back where that belongs
//!         refused?          the cheapest that every oracle allows, now or put back; none: asleep until woken
//!         collapse          measure the deviation, record, merge
//!         around it         a cheaper way opened? moved up. Costs changed? marked stale. Asleep? woken
//! ```
//!
//! A stale point keeps its old place in the queue. Where costs only grow, as with accumulated quadrics, its place is a
//! lower bound and the order is exactly the greedy order; memoryless metrics notice a falling cost late.

mod around;
mod finish;
mod give;
mod hubs;
mod vanish;
mod watch;

use std::ops::ControlFlow;

use glam::Vec3;
use vanish::Vanishing;

use crate::geometry::parallel;
use crate::mesh::{Mesh, NONE, Tolerances, Topology, border_twins, rounding};
use crate::sequence::{CollapseSequence, StopReason};

use super::candidates::{Best, Candidate, Judge, NO_BEST, blend_weight};
use super::classify::kind;
use super::errors::Errors;
use super::metric::{Batch, ErrorMetric, Pair};
use super::options::{self, ErrorMeasure, Limits, Order, Progress};
use super::oracle::{Collapse, Oracle};
use super::pairs::Partners;
use super::parts::Parts;
use super::patch::Patch;
use super::permissive::{Giving, Permissive, Schedule, gives};
use super::placement::Placement;
use super::queue::ClassQueue;
use super::recorder::Recorder;
use super::simplifier::Settings;
use super::surface::WorkingSurface;

pub(super) use hubs::HUB;
use hubs::Hubs;
use watch::Watch;

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
/// Maximum number of searches for new pairs without an edge, made when the queue is empty.
const LOOKS: usize = 8;
/// Steps between two calls of the progress callback.
const PROGRESS_STEPS: usize = 4096;

/// Outcome of a candidate.
enum Attempt {
    Done,
    Refused,
    /// Costs more than estimated, and should wait for this cost.
    Later(f32),
    /// Deferred until this cost is due, by a rule with a surcharge.
    Dear(f32),
}

/// States of a point, as bits.
mod state {
    /// Its candidate may be out of date.
    pub const STALE: u8 = 1;
    /// Every candidate was refused; woken by a change next to it.
    pub const ASLEEP: u8 = 2;
    /// Merged away.
    pub const GONE: u8 = 4;
    /// In a neighbourhood changed by this batch.
    pub const TOUCHED: u8 = 8;
    /// A candidate was refused by the guard, whose limit grows as triangles go.
    pub const GUARDED: u8 = 16;
    /// A hub around which not every point was woken.
    pub const PENDING: u8 = 32;
    /// Among the next points to serve; looks at all its pairs then.
    pub const WOKEN: u8 = 64;
}

/// A candidate allowed by the rules, and the factor on its cost.
struct Legal {
    candidate: Candidate,
    surcharge: f32,
}

/// Input of the engine besides the metric.
pub(super) struct Plan<'a> {
    pub oracles: &'a mut [Box<dyn Oracle>],
    pub limits: Limits,
    pub settings: &'a Settings,
    /// Triangle counts at which seams, material borders and the topology begin to give.
    pub schedule: Schedule,
}

pub(super) struct Engine<'a, M> {
    metric: &'a mut M,
    placement: Placement,
    order: Order,
    oracles: &'a mut [Box<dyn Oracle>],
    /// Indices of oracles notified of changes.
    watchers: Vec<usize>,
    limits: Limits,
    surface: WorkingSurface,
    /// Separate parts; `None` unless there are several and parts can vanish or be joined.
    parts: Option<Box<Parts>>,
    vanishing: Vanishing,
    partners: Partners,
    /// Whether the candidates of a point are exactly its neighbours.
    looks_at_all: bool,
    recorder: Recorder,
    queue: ClassQueue,
    /// Per step its rank: its class of cost, raised to the highest rank among the steps it depends on.
    ranks: Vec<u32>,
    /// Per point the highest rank of a step which changed a triangle of the point.
    touched: Vec<u32>,
    /// Whether ranks may descend.
    tiled: bool,
    /// Ranks of steps before the last kind gave are below this.
    first_rank: u32,
    permissive: Permissive,
    schedule: Schedule,
    /// Number of triangles at which the next kind gives; 0 where no kind gives by itself.
    gives_at: usize,
    /// Whether rules keeping the topology are still asked. `breaks_topology`: whether such a rule refuses the last
    /// candidate.
    keeps_topology: bool,
    breaks_topology: bool,
    /// Per step the features given up, `gives` bits; empty while nothing may give.
    given: Vec<u8>,
    /// Number of vertices in use at the start.
    input_vertices: usize,
    best: Vec<Best>,
    state: Vec<u8>,
    /// Per point the partner whose cost was verified; empty unless costs are verified.
    verified: Vec<u32>,
    refusals: Vec<u64>,
    /// Number of candidates refused for exceeding the requested error.
    too_far: u64,
    errors: Errors,
    watch: Watch,
    hubs: Hubs,
    patch: Patch,
    dead: Vec<u32>,
    ring: Vec<u32>,
    options: Vec<Best>,
    costs: Vec<f32>,
}

impl<'a, M: ErrorMetric> Engine<'a, M> {
    pub fn new(mesh: &Mesh, metric: &'a mut M, plan: Plan<'a>) -> Self {
        let Plan { oracles, limits, settings, schedule } = plan;
        let &Settings { placement, order, measure, permissive, join_distance, guard, parts, .. } = settings;
        let (topology, mut surface) = Self::welded(mesh, &settings.tolerances);
        surface.moves_wedges = !placement.keeps_vertices();
        let recorder = Recorder::new(mesh, &topology, &surface);
        let points = surface.point_count();
        let watches = |(i, oracle): (usize, &mut Box<dyn Oracle>)| oracle.begin(&surface).then_some(i);
        let watchers = oracles.iter_mut().enumerate().filter_map(watches).collect();
        let join_distance = (f64::from(join_distance) * surface.frame().scale()) as f32;
        let vanishing = Vanishing::new(parts == options::Parts::Vanish, join_distance);
        let matter = vanishing.is_on || join_distance > 0.0;
        let mut parts = if matter { Parts::new(&surface).map(Box::new) } else { None };
        // Where parts vanish, an heir joins the part when it vanishes: no pairs are needed.
        let pairs = if vanishing.is_on { 0.0 } else { join_distance };
        let partners = Partners::new(&surface, parts.as_deref_mut(), pairs);
        let waiting = points + parts.as_ref().map_or(0, |parts| parts.count());
        Self {
            metric,
            placement,
            order,
            refusals: vec![0; oracles.len()],
            oracles,
            watchers,
            limits,
            input_vertices: recorder.live_vertices(),
            looks_at_all: order == Order::Linear && placement == Placement::Endpoint && partners.is_empty(),
            partners,
            parts,
            vanishing,
            recorder,
            // With a size requested, a band is finished before the target is checked: use narrow bands.
            queue: ClassQueue::new(waiting, if limits.is_sized() { 16 } else { 32 }),
            ranks: Vec::new(),
            touched: vec![0; points],
            tiled: false,
            first_rank: 0,
            permissive,
            schedule,
            gives_at: 0,
            keeps_topology: true,
            breaks_topology: false,
            given: Vec::new(),
            best: vec![NO_BEST; points],
            state: vec![0; points],
            verified: if measure == ErrorMeasure::Verified { vec![NONE; points] } else { Vec::new() },
            too_far: 0,
            errors: Errors::new(&surface, measure),
            watch: Watch::new(&surface, guard, measure),
            hubs: Hubs::new(points),
            patch: Patch::default(),
            dead: Vec::new(),
            ring: Vec::new(),
            options: Vec::new(),
            costs: Vec::new(),
            surface,
        }
    }

    /// Builds points, wedges and their surface; closes cracks no wider than the tolerance.
    fn welded(mesh: &Mesh, tolerances: &Tolerances) -> (Topology, WorkingSurface) {
        let topology = Topology::with(mesh, tolerances);
        let surface = WorkingSurface::new(mesh, &topology);
        let is_open = |point: u32| surface.is_border(point) && !surface.is_locked(point);
        if !(0..surface.point_count() as u32).any(is_open) {
            return (topology, surface);
        }
        let twin = border_twins(mesh, &topology, is_open, rounding(mesh, tolerances.position));
        if twin.iter().zip(0..).all(|(&to, point)| to == point) {
            return (topology, surface);
        }
        let topology = topology.with_twins(mesh, tolerances, &twin);
        let surface = WorkingSurface::new(mesh, &topology);
        (topology, surface)
    }

    /// Returns the sequence. `Err(schedule)`: seams, material borders or the topology must give earlier, or a target is
    /// missed; start over with `schedule`.
    pub fn run(
        mut self,
        mesh: &Mesh,
        progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<CollapseSequence, Schedule> {
        let mut batch = 0;
        self.gives_at = self.next_to_give().map_or(0, |(_, at)| at);
        let mut stop = StopReason::NothingLegal;
        loop {
            if self.is_done() {
                stop = StopReason::Target;
                break;
            }
            self.begin_batch(batch);
            match self.run_batch(progress) {
                Some(reason) => {
                    stop = reason;
                    self.recorder.finish_batch();
                    break;
                }
                None if self.gives_now() => {
                    // In linear order all following steps belong to this batch.
                    if self.order == Order::Batched {
                        self.recorder.finish_batch();
                    }
                    self.give();
                }
                None if self.order == Order::Linear => {
                    if let Some(reason) = self.run_rest(progress) {
                        stop = reason;
                        self.recorder.finish_batch();
                        break;
                    }
                    if let Some(schedule) = self.should_start_over() {
                        return Err(schedule);
                    }
                    if !self.give() {
                        self.recorder.finish_batch();
                        break;
                    }
                }
                None => {
                    // For metrics whose costs do not compare with a part's loss, parts go when nothing else does.
                    if self.recorder.finish_batch() {
                        self.vanishing.is_last = false;
                    } else if !self.vanishing.is_last && self.parts.is_some() {
                        self.vanishing.is_last = true;
                    } else if let Some(schedule) = self.should_start_over() {
                        return Err(schedule);
                    } else if !self.give() {
                        break;
                    }
                }
            }
            batch += 1;
        }
        if stop == StopReason::NothingLegal && self.too_far > 0 {
            stop = StopReason::Error;
        } else if stop == StopReason::NothingLegal && self.guards_any() {
            stop = StopReason::Guard;
        }
        Ok(self.finish(mesh, stop))
    }

    fn is_done(&self) -> bool {
        self.limits.reached(self.surface.live_triangles(), self.recorder.live_vertices())
    }

    fn begin_batch(&mut self, index: usize) {
        let info = Batch {
            index,
            triangles: self.surface.live_triangles(),
            input_triangles: self.surface.triangle_count(),
            verified: !self.verified.is_empty(),
        };
        self.metric.begin(&self.surface, info);
        if index == 0 && self.permissive == Permissive::On && self.surface.has_seams() {
            // Release seams only now: the metric's sums already contain their weight.
            self.release(Giving::Seams);
        }
        self.queue.restart();
        self.verified.fill(NONE);
        self.touched.fill(0);
        for state in &mut self.state {
            *state &= state::GONE;
        }
        let best = self.all_candidates();
        for (point, best) in best.iter().enumerate() {
            if best.other != NONE {
                self.queue.insert(point as u32, best.cost);
            }
        }
        self.best = best;
        self.queue_parts();
    }

    /// Continues in linear order when the queue is empty: first with pairs which have come near since, then with parts
    /// which had to wait for everything else.
    fn run_rest(&mut self, progress: &mut dyn FnMut(Progress) -> ControlFlow<()>) -> Option<StopReason> {
        let mut parts = self.parts.take()?;
        // Steps from here on come after all earlier steps.
        self.vanishing.floor = self.ranks.iter().copied().max().unwrap_or(0);
        for _ in 0..if self.partners.is_empty() { 0 } else { LOOKS } {
            let steps = self.recorder.steps();
            self.partners.look_all(&self.surface, &mut parts);
            self.parts = Some(parts);
            self.queue.restart();
            self.queue_parts();
            for point in 0..self.state.len() as u32 {
                if self.state[point as usize] & state::GONE == 0 {
                    self.state[point as usize] = state::STALE;
                    self.queue.insert(point, 0.0);
                }
            }
            let stop = self.run_batch(progress);
            if stop.is_some() {
                return stop;
            }
            parts = self.parts.take()?;
            if self.recorder.steps() == steps {
                break;
            }
        }
        self.parts = Some(parts);
        self.vanishing.is_last = true;
        self.queue.restart();
        self.queue_parts();
        self.run_batch(progress)
    }

    /// Returns the cheapest candidate of every point.
    fn all_candidates(&self) -> Vec<Best> {
        let of = |point: usize| {
            if self.state[point] & state::GONE != 0 { NO_BEST } else { self.candidate(point as u32) }
        };
        parallel::map(self.best.len(), 1024, of)
    }

    /// Serves the queue until it is empty (`None`) or there is a reason to stop.
    fn run_batch(&mut self, progress: &mut dyn FnMut(Progress) -> ControlFlow<()>) -> Option<StopReason> {
        let mut next_call = self.recorder.steps() + PROGRESS_STEPS;
        // Band in which the target was reached.
        let mut last_band = None;
        while let Some(point) = self.next_point() {
            if last_band.is_some_and(|band| band != self.queue.bands()) {
                return Some(StopReason::Target);
            }
            if let Some(part) = (point as usize).checked_sub(self.state.len()) {
                if !self.serve_part(part as u32) {
                    continue;
                }
            } else if !self.serve_point(point) {
                continue;
            }
            if last_band.is_none() && self.is_done() {
                // Other tiles have steps of equal cost.
                if !self.queue.is_tiled() {
                    return Some(StopReason::Target);
                }
                last_band = Some(self.queue.bands());
            }
            if last_band.is_none() && self.gives_now() {
                return None;
            }
            if self.recorder.steps() >= next_call {
                next_call += PROGRESS_STEPS;
                let now = Progress {
                    steps: self.recorder.steps(),
                    triangles: self.surface.live_triangles(),
                    input_triangles: self.surface.triangle_count(),
                    target_triangles: self.limits.triangles,
                };
                if progress(now).is_break() {
                    return Some(StopReason::Cancelled);
                }
            }
        }
        last_band.map(|_| StopReason::Target)
    }

    /// Returns the next point to serve. When the queue is empty, points left asleep temporarily are woken.
    fn next_point(&mut self) -> Option<u32> {
        let next = match self.queue.pop() {
            None if self.wake_rest() => self.queue.pop(),
            next => next,
        };
        // Parts are numbered after the points.
        if let Some(state) = next.and_then(|point| self.state.get_mut(point as usize)) {
            *state &= !state::ASLEEP;
        }
        next
    }

    /// Does the cheapest legal collapse of a point, unless the point must wait. Returns whether a collapse was done.
    #[inline]
    fn serve_point(&mut self, point: u32) -> bool {
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

    fn refresh(&mut self, point: u32) {
        self.state[point as usize] &= !(state::STALE | state::WOKEN);
        self.best[point as usize] = self.candidate(point);
        if let Some(verified) = self.verified.get_mut(point as usize) {
            *verified = NONE;
        }
    }

    /// Whether this placement looks at each pair once, from its lower point, rather than in both directions.
    fn is_symmetric(&self) -> bool {
        self.placement != Placement::Endpoint
    }

    fn judge(&self) -> Judge<'_, M> {
        Judge { metric: self.metric, surface: &self.surface, placement: self.placement }
    }

    /// Returns the cheapest candidate of a point, legal or not; among equal costs the lowest number.
    fn candidate(&self, point: u32) -> Best {
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
    fn for_candidates(&self, point: u32, mut visit: impl FnMut(Best)) {
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
        self.surface.for_neighbours(point, |other| {
            if !(symmetric && other < point) && self.state[other as usize] & state::TOUCHED == 0 {
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
    fn legal(&mut self, point: u32, other: u32) -> Option<Legal> {
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
        if let Some(true_cost) = self.verify(point, best.other, pair, x) {
            if true_cost > VERIFIED_SLACK * best.cost && !self.queue.is_due(true_cost) {
                return Attempt::Later(true_cost);
            }
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
    fn guard_limit(&self) -> f32 {
        self.watch.limit(self.surface.live_sheets() - self.patch.opposite().len())
    }

    /// Whether a collapse may raise the error beyond `limit`: distances from the patch grow by at most the way the
    /// points move.
    #[inline]
    fn may_exceed(&self, limit: f32, pair: Pair, x: Vec3) -> bool {
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
        let rate = self.metric.cost_per_deviation(&self.surface, pair)?;
        let added = self.errors.added(&self.surface, &self.patch, pair, x)?;
        Some((VERIFIED_WEIGHT * rate * added).max(0.0))
    }

    /// Notifies the watching rules of a step.
    fn tell(&mut self, kept: Option<u32>) {
        for &watcher in &self.watchers {
            self.oracles[watcher].changed(&self.surface, kept, &self.dead);
        }
    }

    /// Does a collapse whose patch is in `self.patch`.
    fn commit(&mut self, candidate: Candidate) {
        let Candidate { pair, x, object } = candidate;
        let share = blend_weight(self.surface.at(pair.lost), self.surface.at(pair.kept), x);
        let mark = self.recorder.mark();
        if self.may_give_up() {
            let topology = if self.breaks_topology { gives::TOPOLOGY } else { 0 };
            self.given.push(self.surface.gives_up(pair, object.is_none()) | topology);
        }
        let error = self.errors.hand_over(&self.surface, &self.patch, pair, x);
        self.watch.reached(error.surface);
        self.metric.collapsing(&self.surface, pair, x.into());
        self.recorder.substitute(&self.surface, pair, object.map(|object| (object, share)));
        self.metric.substituting(&self.surface, self.recorder.last(x.into()));
        for new in self.recorder.last(x.into()).new_vertices {
            self.surface.add_vertex(new.from, new.weight);
        }
        let shifts_features =
            self.surface.kind(pair.lost) & !self.surface.kind(pair.kept) & kind::FEATURE != 0;
        self.surface.collapse(pair.lost, pair.kept, x, &mut self.dead);
        let recorder = &self.recorder;
        self.surface.replace_vertices(pair.kept, |v| recorder.image(v, mark));
        if shifts_features || self.breaks_topology || self.patch.opposite().is_empty() {
            self.surface.reclassify_around(pair.kept);
        }
        self.metric.collapsed(&self.surface, pair);
        self.tell(Some(pair.kept));
        let error = [error.surface, error.curve].map(|error| self.surface.frame().object_length(error));
        self.recorder.finish_step(error, &self.dead, self.surface.live_triangles());
        // Ranks matter from the first tile on; without tiles they ascend by themselves.
        self.tiled |= self.queue.is_tiled();
        let rank = if self.tiled {
            let needed = self.touched[pair.lost as usize].max(self.touched[pair.kept as usize]);
            (self.first_rank + self.queue.rank()).max(needed).max(self.vanishing.floor)
        } else {
            self.first_rank + self.queue.rank()
        };
        self.ranks.push(rank);
        self.state[pair.lost as usize] = state::GONE;
        self.queue.remove(pair.lost);
        if let Some(parts) = &mut self.parts {
            parts.merge(pair.lost, pair.kept, self.dead.len());
            if !self.partners.is_empty() && self.surface.valence(pair.kept) > 0 {
                self.partners.look(&self.surface, parts, pair.kept, Some(pair.lost));
            }
        }
        self.update_around(pair, rank);
    }
}

/// Returns the cost of a candidate deferred by a rule. Never 0, so it comes after all candidates of cost 0.
fn dearer(cost: f32, surcharge: f32) -> f32 {
    if surcharge > 1.0 { (cost.max(LEAST_COST) * surcharge).min(f32::MAX) } else { cost }
}
