//! Removes a part of the surface as a whole, in a single step.
//!
//! ```text
//!     when one is due       its loss by size?    dearer: put back
//!                           by distance?         dearer: put back
//!                           a rule, the error?   refused: it stays for good
//!     in one step           all its vertices are taken for one of its nearest kin: all its triangles are degenerate
//!                           its tracked samples go to the nearest triangles that are left
//!     joining               in a second step a corner of the heir moves to the part's far end
//! ```
//!
//! Refuses collapses which would leave a rag of a card (`Engine::makes_rag`): half a leaf is worse than none, since a
//! remaining leaf can grow. A pebble is simplified down to a tetrahedron.

use glam::Vec3;

use crate::geometry::triangle::distance_squared_single;
use crate::mesh::NONE;
use crate::simplify::metric::{ErrorMetric, Loss, Pair, VanishingLoss};
use crate::simplify::options::Order;
use crate::simplify::oracle::Collapse;
use crate::simplify::parts::Parts;
use crate::simplify::surface::WorkingSurface;

use super::candidates::Candidate;
use super::driver::{Engine, state};

/// Maximum number of triangles of a remnant.
const REMNANT: u32 = 10;
/// Share of its area below which a part facing a single direction is a rag.
const KEPT_AREA: f32 = 0.6;
/// A part of more triangles waits as if it had this number.
const LARGE: usize = 64;
/// Number of points of other parts among which kin is searched.
const KIN: usize = 16;
/// Number of points of other parts around which the nearest triangle is searched.
const AROUND: usize = 6;
/// Cost per integral of squared distance where no point is kept: a triangle counts at each of its corners with twice
/// its area.
const SUMMED_RATE: f32 = 6.0;

/// State for vanishing parts, besides the parts.
#[derive(Default)]
pub(super) struct Vanishing {
    /// Whether parts vanish at all.
    pub is_on: bool,
    /// Whether everything else is done: then parts go whose loss does not compare with the metric's costs.
    pub is_last: bool,
    /// Maximum distance an heir reaches to the place of a vanishing part, inner units; 0: does not reach.
    join_distance: f32,
    /// Number of collapses refused for making rags.
    pub rags: u64,
    /// Number of collapses refused for leaving nothing of a part, whatever the topology.
    pub whole: u64,
    /// Least rank of further steps.
    pub floor: u32,
    /// All points a part ever had; `points`: the live points among them.
    all: Vec<u32>,
    points: Vec<u32>,
    found: Vec<(f32, u32)>,
    tried: Vec<u32>,
    takers: Vec<u32>,
    corners: Vec<[u32; 3]>,
}

impl Vanishing {
    pub fn new(is_on: bool, join_distance: f32) -> Self {
        Self { is_on, join_distance, ..Self::default() }
    }
}

impl<M: ErrorMetric> Engine<'_, M> {
    /// Puts every part allowed to vanish into the queue. Returns whether there is any.
    pub(super) fn queue_parts(&mut self) -> bool {
        if !self.vanishing.is_on {
            return false;
        }
        let Some(parts) = self.parts.take() else { return false };
        let first = self.state.len() as u32;
        let mut any = false;
        for part in 0..parts.count() as u32 {
            if parts.root(part) == part
                && parts.live(part) > 0
                && parts.may_vanish(part)
                && let Some(cost) = self.loss_cost(&parts, part, parts.least_loss(part))
            {
                self.queue.insert(first + part, cost);
                any = true;
            }
        }
        self.parts = Some(parts);
        any
    }

    /// Returns the queue cost of a loss, per pair of triangles, as collapses remove triangles in pairs; `None` where
    /// the loss does not compare with the metric's costs.
    fn loss_cost(&self, parts: &Parts, part: u32, loss: f32) -> Option<f32> {
        let point = parts.first_point(part);
        let triangles = parts.live(part) as usize;
        let pair = Pair { lost: point, kept: point };
        let cost = match self.metric.cost_of(&self.surface, pair, Loss::Deviation) {
            Some(_) if self.is_symmetric() => SUMMED_RATE * loss,
            Some(rate) => rate * loss,
            None => {
                // Triangles over the same points count once.
                let [sheets, live] =
                    [self.surface.live_sheets(), self.surface.live_triangles()].map(|count| count.max(1));
                let (triangles, mean_area) = (triangles * sheets / live, parts.area() / sheets as f32);
                let area = parts.shape(part).area;
                let part = Loss::Part(VanishingLoss { integral: loss, area, triangles, mean_area });
                let cost = self.metric.cost_of(&self.surface, pair, part);
                cost.or(self.vanishing.is_last.then_some(loss))?
            }
        };
        let pairs = 0.5 * triangles.clamp(1, LARGE) as f32;
        let cost = cost / pairs;
        Some(if cost >= 0.0 { cost } else { f32::MAX })
    }

    /// Lets a part vanish, unless it turns out dearer or must stay. Returns whether it vanished.
    pub(super) fn serve_part(&mut self, part: u32) -> bool {
        let Some(mut parts) = self.parts.take() else { return false };
        let mut scratch = std::mem::take(&mut self.vanishing);
        self.vanishing.is_last = scratch.is_last;
        let done = self.try_vanish(part, &mut parts, &mut scratch);
        self.vanishing = scratch;
        if done && parts.left() == 1 {
            // The last part is simplified as far as possible.
            self.wake_all();
        }
        self.parts = Some(parts);
        done
    }

    fn try_vanish(&mut self, part: u32, parts: &mut Parts, scratch: &mut Vanishing) -> bool {
        if parts.root(part) != part || parts.live(part) == 0 || !parts.may_vanish(part) {
            return false;
        }
        // Search the distance only if the size alone does not defer the part.
        let mut loss = parts.least_loss(part);
        for by_distance in [false, true] {
            if by_distance {
                let centre = parts.shape(part).centre;
                parts.nearest(centre, part, (KIN, f32::MAX), &mut scratch.found);
                let nearest = scratch.found.first().map_or(0.0, |found| found.0);
                loss = parts.loss(part, nearest);
            }
            let Some(cost) = self.loss_cost(parts, part, loss) else { return false };
            if !self.queue.is_due(cost) {
                self.queue.insert(self.state.len() as u32 + part, cost);
                return false;
            }
        }
        scratch.all.clear();
        parts.points(part, &mut scratch.all);
        scratch.points.clear();
        let there = |&p: &u32| self.state[p as usize] & state::GONE == 0 && self.surface.valence(p) > 0;
        scratch.points.extend(scratch.all.iter().copied().filter(there));
        if scratch.points.iter().any(|&p| self.state[p as usize] & state::TOUCHED != 0) {
            // Touched by this batch: waits for the next.
            return false;
        }
        let mut allowed = true;
        for (oracle, count) in self.oracles.iter().zip(&mut self.refusals) {
            if !oracle.allows_vanishing(&self.surface, &scratch.points) {
                *count += 1;
                allowed = false;
                break;
            }
        }
        if !allowed || scratch.found.is_empty() {
            self.let_stay(part, parts, &scratch.points);
            return false;
        }
        // All touched by this batch: the part waits for the next.
        let Some(into) = self.heir(part, parts, scratch) else { return false };
        // The surface before the part goes explains its error: a large part may have to wait.
        let guard = self.watch.limit(self.surface.live_sheets());
        // A part that has to wait is asked about again and again: one sample beyond the guard is answer enough.
        let enough = if self.limits.error == f32::INFINITY { guard } else { f32::INFINITY };
        let Vanishing { points, found, tried, .. } = &mut *scratch;
        let surface = &self.surface;
        let error = self.errors.measure_vanishing(surface, points, into, enough, |position| {
            parts.nearest(position, part, (AROUND, f32::MAX), found);
            nearest_triangle(surface, parts, found, tried, position)
        });
        if self.surface.frame().object_length(error.largest()) > self.limits.error {
            self.too_far += 1;
            self.let_stay(part, parts, &scratch.points);
            return false;
        }
        if error.surface > guard {
            // Waits until there are fewer triangles.
            self.watch.refuse(guard);
            for &point in &scratch.points {
                self.state[point as usize] |= state::GUARDED;
            }
            return false;
        }
        let reached = self.reach(into, scratch);
        self.commit_vanishing(part, parts, scratch, [into, reached.unwrap_or(NONE)], loss);
        if let Some(point) = reached {
            let pair = Pair { lost: into, kept: point };
            self.breaks_topology = false;
            self.commit(Candidate { pair, x: self.surface.at(point), object: None });
            parts.absorb(into, point);
            let both = parts.of(point);
            if let Some(cost) = self.loss_cost(parts, both, parts.least_loss(both)) {
                self.queue.insert(self.state.len() as u32 + both, cost);
            }
        }
        true
    }

    /// Returns the point of a vanishing part to which its heir's point `into` moves, so the heir covers the part's
    /// place: the farthest point within the join distance. `None` unless every rule allows the move, the heir's area
    /// grows, and the error stays within the requested error. Leaves the move's patch in `self.patch`.
    fn reach(&mut self, into: u32, scratch: &Vanishing) -> Option<u32> {
        // Two steps on the same point would not be independent.
        if scratch.join_distance <= 0.0 || self.order == Order::Batched {
            return None;
        }
        let from = self.surface.at(into);
        let near = scratch.points.iter().map(|&point| (from.distance(self.surface.at(point)), point));
        let near = near.filter(|&(distance, _)| distance <= scratch.join_distance && distance > 0.0);
        let (_, point) = near.max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)))?;
        let (pair, x) = (Pair { lost: into, kept: point }, self.surface.at(point));
        self.patch.gather(&self.surface, pair, x);
        let collapse = Collapse { pair, position: x.into(), patch: &self.patch };
        let gains: f32 = self.patch.facets().iter().map(|f| f.after.length() - f.before.length()).sum();
        if gains <= 0.0 || !self.oracles.iter().all(|oracle| oracle.allows(&self.surface, &collapse)) {
            return None;
        }
        let error = self.errors.measure_reaching(&self.surface, &self.patch, pair, x, &scratch.points);
        (self.surface.frame().object_length(error.largest()) <= self.limits.error).then_some(point)
    }

    /// Returns the point replacing a part's vertices: of its nearest kin, else of the nearest part.
    fn heir(&self, part: u32, parts: &mut Parts, scratch: &Vanishing) -> Option<u32> {
        let mut heir = None;
        for &(_, point) in &scratch.found {
            let point = parts.current(point);
            let state = self.state[point as usize];
            if state & (state::GONE | state::TOUCHED) != 0 || self.surface.valence(point) == 0 {
                continue;
            }
            if parts.are_kin(part, parts.of(point)) {
                return Some(point);
            }
            heir = heir.or(Some(point));
        }
        heir
    }

    /// Keeps a refused part for good, and lets it be simplified as far as possible.
    fn let_stay(&mut self, part: u32, parts: &mut Parts, points: &[u32]) {
        parts.keep(part);
        for &point in points {
            self.wake(point);
        }
    }

    /// Wakes every sleeping point.
    fn wake_all(&mut self) {
        for point in 0..self.state.len() as u32 {
            self.wake(point);
        }
    }

    /// Removes the part whose error was measured last. Replaces its vertices by the point `heir`, or by the part's own
    /// point `stays`, to which the heir then reaches.
    fn commit_vanishing(
        &mut self,
        part: u32,
        parts: &mut Parts,
        scratch: &mut Vanishing,
        [heir, stays]: [u32; 2],
        loss: f32,
    ) {
        let Vanishing { all, points, takers, corners, .. } = scratch;
        takers.clear();
        takers.extend(self.errors.takers());
        let error = self.errors.vanish(&self.surface, points, heir);
        self.watch.reached(error.surface);
        if self.may_give_up() {
            // Nothing gives.
            self.given.push(0);
        }
        let error = [error.surface, error.curve].map(|error| self.surface.frame().object_length(error));
        let goes = |point: &u32| *point != stays;
        if stays == NONE {
            let corner = self.surface.star(heir).next();
            let vertex = corner.map(|c| self.surface.corner_vertices(c.triangle)[c.slot as usize]);
            let vertex = vertex.unwrap_or(self.surface.point_vertex(heir));
            self.recorder.vanish(&self.surface, points.iter().copied(), vertex);
        } else {
            let vertex = self.recorder.leave_one(&self.surface, stays);
            self.recorder.vanish(&self.surface, points.iter().copied().filter(|p| goes(p)), vertex);
        }
        self.surface.vanish(points, &mut self.dead);
        self.tell(None);
        self.recorder.finish_step(error, &self.dead, self.surface.live_triangles());
        // Rank: after the steps which changed the part, its heir and the triangles taking over its tracked samples, and
        // before the next steps changing them.
        self.tiled |= self.queue.is_tiled();
        let mut rank = (self.first_rank + self.queue.rank()).max(self.vanishing.floor).max(scratch.floor);
        if self.tiled {
            corners.clear();
            let real = takers.iter().filter(|&&t| t != NONE);
            corners.extend(real.filter_map(|&t| self.surface.triangle(t)));
            let around = || points.iter().chain(corners.as_flattened()).chain([&heir]);
            rank = around().map(|&point| self.touched[point as usize]).fold(rank, u32::max);
            for &point in around() {
                self.touched[point as usize] = rank;
            }
        }
        self.ranks.push(rank);
        for &point in points.iter().filter(|p| goes(p)) {
            self.state[point as usize] = state::GONE;
            self.queue.remove(point);
        }
        if self.order == Order::Batched {
            self.state[heir as usize] |= state::TOUCHED;
        }
        all.retain(goes);
        parts.vanish(part, all, heir, if stays == NONE { loss } else { 0.0 });
    }

    /// Whether a collapse whose patch is in `self.patch` would leave nothing of its connected piece.
    pub(super) fn takes_all(&self, pair: Pair) -> bool {
        let opposite = self.patch.opposite();
        let goes = |point: u32, dying: usize| self.surface.valence(point) == dying;
        let dying_at = |third: u32| opposite.iter().filter(|&&other| other == third).count();
        !opposite.is_empty()
            && goes(pair.lost, opposite.len())
            && goes(pair.kept, opposite.len())
            && opposite.iter().all(|&third| goes(third, dying_at(third)))
    }

    /// Whether a collapse whose patch is in `self.patch` would leave too little of a card allowed to vanish instead.
    pub(super) fn makes_rag(&self, pair: Pair) -> bool {
        let Some(parts) = self.parts.as_deref().filter(|_| self.vanishing.is_on) else { return false };
        if self.limits.error.is_finite() || self.patch.opposite().is_empty() {
            return false;
        }
        let part = parts.of(pair.kept);
        let live = parts.live(part);
        let is_card = parts.shape(part).is_flat() && !parts.is_joined(part);
        if live > REMNANT || !is_card || !parts.may_vanish(part) {
            return false;
        }
        // The part's present triangles, found by walking over neighbours.
        let mut found = [NONE; REMNANT as usize];
        let mut points = [NONE; 3 * REMNANT as usize];
        let (mut triangles, mut known, mut next) = (0, 1, 0);
        points[0] = pair.kept;
        let mut area = 0.0;
        while next < known {
            for corner in self.surface.star(points[next]) {
                if triangles == found.len() || found[..triangles].contains(&corner.triangle) {
                    continue;
                }
                found[triangles] = corner.triangle;
                triangles += 1;
                let [p, q, r] = [points[next], corner.others[0], corner.others[1]];
                let dies = [p, q, r].contains(&pair.lost) && [p, q, r].contains(&pair.kept);
                if !dies {
                    area += double_area(&self.surface, [p, q, r]);
                }
                for other in corner.others {
                    if known < points.len() && !points[..known].contains(&other) {
                        points[known] = other;
                        known += 1;
                    }
                }
            }
            next += 1;
        }
        for facet in self.patch.facets() {
            area += facet.after.length() - facet.before.length();
        }
        0.5 * area < KEPT_AREA * parts.shape(part).area
    }
}

fn double_area(surface: &WorkingSurface, corners: [u32; 3]) -> f32 {
    let [p, q, r] = corners.map(|v| surface.at(v));
    (q - p).cross(r - p).length()
}

/// Returns the squared distance from a position to the triangles around the images of the found points, and the nearest
/// triangle. `tried` is scratch.
fn nearest_triangle(
    surface: &WorkingSurface,
    parts: &mut Parts,
    found: &[(f32, u32)],
    tried: &mut Vec<u32>,
    position: Vec3,
) -> (f32, u32) {
    let mut best = (f32::INFINITY, NONE);
    tried.clear();
    for &(_, point) in found {
        let point = parts.current(point);
        if tried.contains(&point) {
            continue;
        }
        tried.push(point);
        for corner in surface.star(point) {
            let [a, b] = corner.others.map(|p| surface.at(p));
            let distance = distance_squared_single([surface.at(point), a, b], position);
            if (distance, corner.triangle) < best {
                best = (distance, corner.triangle);
            }
        }
    }
    if best.0 == f32::INFINITY { (found.first().map_or(0.0, |f| f.0), NONE) } else { best }
}
