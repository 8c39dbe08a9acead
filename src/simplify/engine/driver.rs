//! The driver: candidates by cost, oracles, collapses, and updates after each collapse.
//!
//! ```text
//! for each batch (one in linear order)
//!     tell the metric
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

use std::ops::ControlFlow;

use crate::geometry::parallel;
use crate::mesh::{Mesh, NONE, Tolerances, Topology, border_twins, rounding};
use crate::sequence::{CollapseSequence, StopReason};
use crate::simplify::errors::Errors;
use crate::simplify::metric::{Batch, ErrorMetric, MetricEvent};
use crate::simplify::options::{self, ErrorMeasure, Independence, Limits, Order, Progress};
use crate::simplify::oracle::Oracle;
use crate::simplify::parts::Parts;
use crate::simplify::parts::pairs::Partners;
use crate::simplify::permissive::{Giving, Permissive, Schedule};
use crate::simplify::placement::Placement;
use crate::simplify::simplifier::{Placements, Settings};
use crate::simplify::surface::WorkingSurface;
use crate::simplify::surface::patch::Patch;

use super::candidates::{Best, NO_BEST};
use super::filling::Filling;
use super::hubs::Hubs;
use super::queue::ClassQueue;
use super::recorder::Recorder;
use super::vanish::Vanishing;
use super::watch::Watch;

/// Maximum number of searches for new pairs without an edge, made when the queue is empty.
const LOOKS: usize = 8;
/// Steps between two calls of the progress callback.
const PROGRESS_STEPS: usize = 4096;

/// States of a point, as bits.
pub(super) mod state {
    /// Its candidate may be out of date.
    pub const STALE: u8 = 1;
    /// Every candidate was refused; woken by a change next to it.
    pub const ASLEEP: u8 = 2;
    /// Merged away.
    pub const GONE: u8 = 4;
    /// Not to be merged again in this batch.
    pub const TOUCHED: u8 = 8;
    /// A candidate was refused by the guard, whose limit grows as triangles go.
    pub const GUARDED: u8 = 16;
    /// A hub around which not every point was woken.
    pub const PENDING: u8 = 32;
    /// Among the next points to serve; looks at all its pairs then.
    pub const WOKEN: u8 = 64;
}

/// Input of the engine besides the metric.
pub(in crate::simplify) struct Plan<'a> {
    pub oracles: &'a mut [Box<dyn Oracle>],
    pub placements: Option<&'a Placements>,
    pub limits: Limits,
    pub settings: &'a Settings,
    /// Triangle counts at which seams, material borders and the topology begin to give.
    pub schedule: Schedule,
}

pub(in crate::simplify) struct Engine<'a, M> {
    pub(super) metric: &'a mut M,
    pub(super) placement: Placement,
    placements: Option<&'a Placements>,
    pub(super) order: Order,
    pub(super) independence: Independence,
    pub(super) oracles: &'a mut [Box<dyn Oracle>],
    /// Indices of oracles notified of changes.
    pub(super) watchers: Vec<usize>,
    pub(super) limits: Limits,
    pub(super) surface: WorkingSurface,
    /// Separate parts; `None` unless there are several and parts can vanish or be joined.
    pub(super) parts: Option<Box<Parts>>,
    pub(super) vanishing: Vanishing,
    pub(super) partners: Partners,
    /// Whether the candidates of a point are exactly its neighbours.
    pub(super) looks_at_all: bool,
    pub(super) recorder: Recorder,
    pub(super) queue: ClassQueue,
    /// Per step its rank: its class of cost, raised to the highest rank among the steps it depends on.
    pub(super) ranks: Vec<u32>,
    /// Per point the highest rank of a step which changed a triangle of the point.
    pub(super) touched: Vec<u32>,
    /// Whether ranks may descend.
    pub(super) tiled: bool,
    /// Ranks of steps before the last kind gave are below this.
    pub(super) first_rank: u32,
    pub(super) permissive: Permissive,
    pub(super) schedule: Schedule,
    /// Number of triangles at which the next kind gives; 0 where no kind gives by itself.
    pub(super) gives_at: usize,
    /// Whether rules keeping the topology are still asked. `breaks_topology`: whether such a rule refuses the last
    /// candidate.
    pub(super) keeps_topology: bool,
    pub(super) breaks_topology: bool,
    /// Per step the features given up, `gives` bits; empty while nothing may give.
    pub(super) given: Vec<u8>,
    /// Number of vertices in use at the start.
    pub(super) input_vertices: usize,
    pub(super) best: Vec<Best>,
    pub(super) state: Vec<u8>,
    /// Per point the partner whose cost was verified; empty unless costs are verified.
    pub(super) verified: Vec<u32>,
    pub(super) refusals: Vec<u64>,
    /// Number of candidates refused for exceeding the requested error.
    pub(super) too_far: u64,
    pub(super) errors: Errors,
    pub(super) watch: Watch,
    pub(super) hubs: Hubs,
    pub(super) patch: Patch,
    pub(super) dead: Vec<u32>,
    pub(super) ring: Vec<u32>,
    pub(super) options: Vec<Best>,
    pub(super) costs: Vec<f32>,
}

impl<'a, M: ErrorMetric> Engine<'a, M> {
    pub fn new(mesh: &Mesh, metric: &'a mut M, plan: Plan<'a>) -> Self {
        let Plan { oracles, placements, limits, settings, schedule } = plan;
        let &Settings { placement, order, measure, permissive, join_distance, guard, parts, .. } = settings;
        let independence = settings.independence;
        let (topology, mut surface) = Self::welded(mesh, &settings.tolerances);
        surface.moves_wedges = placements.is_some() || !placement.keeps_vertices();
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
            placements,
            order,
            independence,
            refusals: vec![0; oracles.len()],
            oracles,
            watchers,
            limits,
            input_vertices: recorder.live_vertices(),
            looks_at_all: order == Order::Linear
                && placements.is_none()
                && placement == Placement::Endpoint
                && partners.is_empty(),
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
        // In linear order batches begin anew where features give, and stay one.
        if let Some(choose) = self.placements.filter(|_| index == 0 || self.order == Order::Batched) {
            self.placement = choose(info);
            self.surface.moves_wedges = !self.placement.keeps_vertices();
        }
        self.metric.update(&self.surface, MetricEvent::Begin(info));
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
        // Band in which the target was reached, and in which the batch was full: other tiles have steps of equal cost.
        let mut last_band = None;
        let mut full_band = None;
        let mut filling = Filling::new(self.surface.live_triangles());
        let fills = self.order == Order::Batched && self.independence == Independence::Matching;
        while let Some(point) = self.next_point() {
            if last_band.is_some_and(|band| band != self.queue.bands()) {
                return Some(StopReason::Target);
            }
            if full_band.is_some_and(|band| band != self.queue.bands()) {
                break;
            }
            if fills && filling.is_full(self.surface.live_triangles(), self.queue.rank()) {
                if !self.queue.is_tiled() {
                    break;
                }
                full_band = full_band.or(Some(self.queue.bands()));
            }
            if let Some(part) = (point as usize).checked_sub(self.state.len()) {
                if !self.serve_part(part as u32) {
                    continue;
                }
            } else if !self.serve_point(point) {
                continue;
            }
            if last_band.is_none() && self.is_done() {
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
}
