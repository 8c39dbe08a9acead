//! The driver: candidates by cost, oracles, collapses, and what they make stale.
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
//! A stale point keeps its old place. Where costs only grow, as with accumulated quadrics, that place is a lower bound
//! and the order is exactly the greedy one; for memoryless metrics a cost that fell is noticed late.

mod around;
mod finish;
mod vanish;

use std::ops::ControlFlow;

use glam::Vec3;

use crate::mesh::{Mesh, NONE, Topology};

use super::candidates::{Best, Candidate, Judge, NO_BEST, blend_weight};
use super::classify::kind;
use super::errors::Errors;
use super::metric::{Batch, ErrorMetric, Pair};
use super::options::{self, ErrorMeasure, Limits, Order, Progress};
use super::oracle::{Collapse, Oracle};
use super::pairs::Partners;
use super::parts::Parts;
use super::patch::Patch;
use super::placement::Placement;
use super::queue::ClassQueue;
use super::recorder::Recorder;
use super::report::StopReason;
use super::sequence::CollapseSequence;
use super::simplifier::Settings;
use super::surface::Surface;
use vanish::Vanishing;

/// How much a measured deviation weighs against an estimated one. Found by trial: the more, the better the mean (2: by
/// 15 %, 4: by 22 %, 8: by 24 % at a tenth of the triangles), the worse the maximum, and the slower.
const VERIFIED_WEIGHT: f32 = 4.0;
/// Costs within this factor of the estimate are taken for it.
const VERIFIED_SLACK: f32 = 1.2;

/// Up to so many candidates of a point are priced together.
const FEW: usize = 16;
/// How often pairs without an edge are looked for anew where nothing else is left.
const LOOKS: usize = 8;
/// Steps between two calls of the progress callback.
const PROGRESS_STEPS: usize = 4096;

/// What became of a candidate.
enum Attempt {
    Done,
    Refused,
    /// It costs more than it seemed to, and should wait for that.
    Later(f32),
}

/// What a point waits for.
mod state {
    /// Its candidate may be out of date.
    pub const STALE: u8 = 1;
    /// Every candidate was refused; woken by a change next to it.
    pub const ASLEEP: u8 = 2;
    /// Merged away.
    pub const GONE: u8 = 4;
    /// Part of a neighbourhood that this batch changed.
    pub const TOUCHED: u8 = 8;
}

/// What the engine is asked to do, besides the metric.
pub(super) struct Plan<'a> {
    pub oracles: &'a mut [Box<dyn Oracle>],
    pub limits: Limits,
    pub settings: &'a Settings,
}

pub(super) struct Engine<'a, M> {
    metric: &'a mut M,
    placement: Placement,
    order: Order,
    oracles: &'a mut [Box<dyn Oracle>],
    /// Those that are told of changes.
    watchers: Vec<usize>,
    limits: Limits,
    surface: Surface,
    /// Separate parts, where there are several and they matter.
    parts: Option<Box<Parts>>,
    vanishing: Vanishing,
    partners: Partners,
    /// Whether the candidates of a point are all its neighbours and no others.
    looks_at_all: bool,
    recorder: Recorder,
    queue: ClassQueue,
    /// Per step its class of cost, no less than those of the steps it needs.
    ranks: Vec<u32>,
    /// Per point the highest rank of a step that changed a triangle of it.
    touched: Vec<u32>,
    /// Whether ranks may descend.
    tiled: bool,
    /// Vertices in use at the start.
    input_vertices: usize,
    best: Vec<Best>,
    state: Vec<u8>,
    /// The partner for which each point's cost was verified; empty unless costs are.
    verified: Vec<u32>,
    refusals: Vec<u64>,
    /// Candidates refused because they would exceed the error asked for.
    too_far: u64,
    errors: Errors,
    patch: Patch,
    dead: Vec<u32>,
    ring: Vec<u32>,
    options: Vec<Best>,
    costs: Vec<f32>,
}

impl<'a, M: ErrorMetric> Engine<'a, M> {
    pub fn new(mesh: &Mesh, metric: &'a mut M, plan: Plan<'a>) -> Self {
        let Plan { oracles, limits, settings } = plan;
        let &Settings { placement, order, measure, join_distance, parts, .. } = settings;
        let topology = Topology::new(mesh);
        let surface = Surface::new(mesh, &topology);
        let recorder = Recorder::new(mesh, &topology, &surface);
        let points = surface.point_count();
        let watches = |(i, oracle): (usize, &mut Box<dyn Oracle>)| oracle.begin(&surface).then_some(i);
        let watchers = oracles.iter_mut().enumerate().filter_map(watches).collect();
        let join_distance = (f64::from(join_distance) * surface.frame().scale()) as f32;
        let vanishing = Vanishing::new(parts == options::Parts::Vanish, join_distance);
        let matter = vanishing.is_on || join_distance > 0.0;
        let mut parts = if matter { Parts::new(&surface).map(Box::new) } else { None };
        // Where parts vanish, joining is what one does to another that vanishes.
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
            // With a size asked for, a band is finished before the target is looked at: so it is a narrow one.
            queue: ClassQueue::new(waiting, if limits.is_sized() { 16 } else { 32 }),
            ranks: Vec::new(),
            touched: vec![0; points],
            tiled: false,
            best: vec![NO_BEST; points],
            state: vec![0; points],
            verified: if measure == ErrorMeasure::Verified { vec![NONE; points] } else { Vec::new() },
            too_far: 0,
            errors: Errors::new(&surface, measure),
            patch: Patch::default(),
            dead: Vec::new(),
            ring: Vec::new(),
            options: Vec::new(),
            costs: Vec::new(),
            surface,
        }
    }

    pub fn run(
        mut self,
        mesh: &Mesh,
        progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> CollapseSequence {
        let mut batch = 0;
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
                None if self.order == Order::Linear => {
                    stop = self.run_rest(progress).unwrap_or(stop);
                    self.recorder.finish_batch();
                    break;
                }
                None => {
                    let done = self.recorder.finish_batch();
                    if !done && self.vanishing.is_last {
                        break;
                    }
                    // Of metrics whose costs parts do not compare with, parts go when nothing else does.
                    self.vanishing.is_last = !done;
                }
            }
            batch += 1;
        }
        if stop == StopReason::NothingLegal && self.too_far > 0 {
            stop = StopReason::Error;
        }
        self.finish(mesh, stop)
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
        self.queue.restart();
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

    /// Goes on in linear order where nothing waits any more: with pairs that have come near since, and then with parts that
    /// had to wait for everything else.
    fn run_rest(&mut self, progress: &mut dyn FnMut(Progress) -> ControlFlow<()>) -> Option<StopReason> {
        let mut parts = self.parts.take()?;
        // What is done now comes after everything before.
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

    /// The cheapest candidate of every point.
    fn all_candidates(&self) -> Vec<Best> {
        let of = |point: usize| {
            if self.state[point] & state::GONE != 0 { NO_BEST } else { self.candidate(point as u32) }
        };
        #[cfg(feature = "parallel")]
        {
            use rayon::prelude::*;
            (0..self.best.len()).into_par_iter().with_min_len(1024).map(of).collect()
        }
        #[cfg(not(feature = "parallel"))]
        {
            (0..self.best.len()).map(of).collect()
        }
    }

    /// Serves the queue until it is empty (`None`) or there is a reason to stop.
    fn run_batch(&mut self, progress: &mut dyn FnMut(Progress) -> ControlFlow<()>) -> Option<StopReason> {
        let mut next_call = self.recorder.steps() + PROGRESS_STEPS;
        // The band in which the target was reached.
        let mut last_band = None;
        while let Some(point) = self.queue.pop() {
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
                // Other tiles have steps of the same worth.
                if !self.queue.is_tiled() {
                    return Some(StopReason::Target);
                }
                last_band = Some(self.queue.bands());
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

    /// Does the cheapest legal collapse of a point whose turn it is, if it is still its turn. Whether it did one.
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
        }
        self.try_collapse(point)
    }

    fn refresh(&mut self, point: u32) {
        self.state[point as usize] &= !state::STALE;
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

    /// The cheapest candidate of a point, whether legal or not; of equal ones that of the lowest number.
    fn candidate(&self, point: u32) -> Best {
        // Costs are not negative, so they compare like their bits: one number for both, and no branch on which is less.
        let key = |option: Best| u64::from(option.cost.to_bits()) << 32 | u64::from(option.other);
        let mut least = key(NO_BEST);
        self.for_candidates(point, |option| least = least.min(key(option)));
        Best { cost: f32::from_bits((least >> 32) as u32), other: least as u32 }
    }

    /// Calls `visit` with every candidate of a point. They are priced together, which metrics make use of.
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

    /// Calls `visit` with every point that a point may be merged with.
    #[inline]
    fn for_others(&self, point: u32, mut visit: impl FnMut(u32)) {
        let symmetric = self.is_symmetric();
        self.surface.for_neighbours(point, |other| {
            if !(symmetric && other < point) && self.state[other as usize] & state::TOUCHED == 0 {
                visit(other);
            }
        });
        // Not every point is a partner of its partners: those are looked at from either side.
        self.partners.for_each(&self.surface, self.parts.as_deref(), point, |other| {
            if self.state[other as usize] & state::TOUCHED == 0 {
                visit(other);
            }
        });
    }

    /// Collapses the point's candidate, or the next one that is legal. Whether anything was done.
    fn try_collapse(&mut self, point: u32) -> bool {
        let first = self.best[point as usize];
        match self.attempt(point, first) {
            Attempt::Done => return true,
            Attempt::Later(cost) => {
                self.postpone(point, Best { cost, other: first.other });
                return false;
            }
            Attempt::Refused => {}
        }
        let mut options = std::mem::take(&mut self.options);
        options.clear();
        self.for_candidates(point, |option| options.push(option));
        options.sort_unstable_by(|a, b| a.cost.total_cmp(&b.cost).then(a.other.cmp(&b.other)));
        options.dedup_by_key(|option| option.other);
        let mut done = false;
        let mut later = NO_BEST;
        for &option in options.iter().filter(|option| option.other != first.other) {
            if self.queue.is_due(option.cost) {
                match self.attempt(point, option) {
                    Attempt::Done => done = true,
                    Attempt::Later(cost) => later = Best { cost, other: option.other },
                    Attempt::Refused => continue,
                }
                break;
            } else if self.legal(point, option.other).is_some() {
                later = option;
                break;
            }
        }
        self.options = options;
        if !done {
            self.postpone(point, later);
        }
        done
    }

    /// Lets a point wait for a dearer candidate, or sleep where it has none.
    fn postpone(&mut self, point: u32, later: Best) {
        self.best[point as usize] = later;
        if later.other == NONE {
            self.state[point as usize] |= state::ASLEEP;
        } else {
            self.queue.insert(point, later.cost);
        }
    }

    /// The pair and position of a candidate where every oracle allows it; its patch is then in `self.patch`.
    #[inline]
    fn legal(&mut self, point: u32, other: u32) -> Option<Candidate> {
        let (pair, x) = self.judge().place(point, other);
        let (x, object) = self.judge().snap(pair, x);
        self.patch.gather(&self.surface, pair, x);
        let collapse = Collapse { pair, position: x.into(), patch: &self.patch };
        let is_joined = self.parts.as_deref().is_some_and(|parts| parts.has_joined(pair));
        for (oracle, count) in self.oracles.iter().zip(&mut self.refusals) {
            let is_asked = !(is_joined && oracle.keeps_topology());
            if is_asked && !oracle.allows(&self.surface, &collapse) {
                *count += 1;
                return None;
            }
        }
        if self.makes_rag(pair) {
            self.vanishing.rags += 1;
            return None;
        }
        Some(Candidate { pair, x, object })
    }

    /// Does a candidate's collapse, unless a rule refuses it or it turns out dearer than it seemed.
    fn attempt(&mut self, point: u32, best: Best) -> Attempt {
        let Some(candidate) = self.legal(point, best.other) else { return Attempt::Refused };
        let Candidate { pair, x, .. } = candidate;
        if let Some(true_cost) = self.verify(point, best.other, pair, x) {
            if true_cost > VERIFIED_SLACK * best.cost && !self.queue.is_due(true_cost) {
                return Attempt::Later(true_cost);
            }
        }
        if self.limits.error.is_finite() {
            let error = self.errors.measure(&self.surface, &self.patch, pair, x);
            if self.surface.frame().object_length(error) > self.limits.error {
                self.too_far += 1;
                return Attempt::Refused;
            }
        }
        self.commit(candidate);
        Attempt::Done
    }

    /// What a collapse costs by what it does to the input; `None` where that is not asked for, or the cost at hand is
    /// that already.
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

    /// Tells the rules that want to know of a step that was done.
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
        let error = self.errors.hand_over(&self.surface, &self.patch, pair, x);
        self.metric.collapsing(&self.surface, pair, x.into());
        self.recorder.substitute(&self.surface, pair, object.map(|object| (object, share)));
        self.metric.substituting(&self.surface, self.recorder.last(x.into()));
        let shifts_features =
            self.surface.kind(pair.lost) & !self.surface.kind(pair.kept) & kind::FEATURE != 0;
        self.surface.collapse(pair.lost, pair.kept, x, &mut self.dead);
        let recorder = &self.recorder;
        self.surface.replace_vertices(pair.kept, |v| recorder.image(v, mark));
        if shifts_features || self.patch.thirds().is_empty() {
            self.surface.reclassify_around(pair.kept);
        }
        self.metric.collapsed(&self.surface, pair);
        self.tell(Some(pair.kept));
        let error = self.surface.frame().object_length(error);
        self.recorder.finish_step(error, &self.dead, self.surface.live_triangles());
        // Ranks matter from the first tile on; without tiles they ascend by themselves.
        self.tiled |= self.queue.is_tiled();
        let rank = if self.tiled {
            let needed = self.touched[pair.lost as usize].max(self.touched[pair.kept as usize]);
            self.queue.rank().max(needed).max(self.vanishing.floor)
        } else {
            self.queue.rank()
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
