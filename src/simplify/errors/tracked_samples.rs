//! Distance from the input to the level of detail: each input point is tracked on the current surface.
//!
//! ```text
//!          w2                   w2          A point that was merged away is a tracked sample. It hangs on the triangle
//!        /  | \               / . \         of the current surface that it lies over. When a collapse replaces a
//!      w3 --u-- v    ->     w3  o  v        patch, the tracked samples on the patch (and the lost point, o) are handed
//!        \  | /               \ . /         to the nearest new triangle, and the distance to it is taken.
//!          w1                   w1
//! ```
//!
//! The nearest triangle of the patch is at least as far as the nearest triangle of the whole surface. The largest
//! distance is therefore an upper bound, and a tight bound, for the distance of every input point from the level. A
//! simplification from n points to m hands over about `3 n ln(n / m)` tracked samples in all.

use glam::{Vec3, Vec4};

use crate::geometry::{lanes::Lanes, sectors::Sectors, triangle::distance_squared_single};
use crate::mesh::NONE;
use crate::simplify::metric::Pair;
use crate::simplify::surface::WorkingSurface;
use crate::simplify::surface::patch::{Facet, Patch};

use super::angles::Angles;
use super::left_alone::left_alone;

/// Tracks the triangle under each merged point.
#[derive(Debug, Clone, Default)]
pub(crate) struct TrackedSamples {
    /// The input's points, then middles of triangles: between curves, or all triangles on small meshes.
    points: Vec<TrackedSample>,
    /// First tracked sample on each triangle.
    head: Vec<u32>,
    /// True for each point already a tracked sample.
    merged: Vec<bool>,
    fan: Vec<Group>,
    /// Triangles beside the patch, where nothing of the patch survives and nothing is around the kept point either; their
    /// corners are relative to the merged point's position.
    beside: Vec<([Vec3; 3], u32)>,
    /// Points not tracked yet that the collapse takes off the surface.
    newcomers: Vec<u32>,
    /// Order by angle, to search a fan of more than [`FEW_SECTORS`] groups.
    angles: Angles,
    facets: [Vec<Facet>; 2],
    /// Groups of such a fan still allowed to be searched away from a sample's direction.
    budget: usize,
    /// The largest squared distance so far.
    largest: f32,
    heads: Vec<u32>,
    /// Targets of the tracked samples of a vanishing part: tracked sample, squared distance and triangle.
    handed: Vec<(u32, f32, u32)>,
    /// Squared distance of each tracked sample when last placed; empty unless remembered.
    placed: Vec<f32>,
    /// Area per input point, inner units.
    share: f32,
    /// Number of samples handed over by the last step.
    handed_over: usize,
}

/// The position of a sample, and the next sample on its triangle: side by side, since chains run all over memory.
#[derive(Debug, Clone, Copy)]
struct TrackedSample {
    position: Vec3,
    next: u32,
}

/// Up to four triangles of the new patch, relative to the merged point's position.
#[derive(Debug, Clone, Copy)]
struct Group {
    sectors: Sectors,
    triangle: [u32; 4],
}

impl Group {
    /// Builds a group of up to four facets.
    #[inline]
    fn new(facets: &[Facet]) -> Self {
        // Lanes without a facet repeat the last facet: finding it twice is harmless.
        let facet = |i: usize| &facets[i.min(facets.len() - 1)];
        let [a, b] = [Lanes::gather(|i| facet(i).a), Lanes::gather(|i| facet(i).b)];
        Self {
            sectors: Sectors::new(a, b, Lanes::gather(|i| facet(i).after)),
            triangle: std::array::from_fn(|i| facet(i).triangle),
        }
    }

    /// Returns the nearer of `best` and the least of `distances`.
    #[inline]
    fn least(&self, distances: Vec4, best: (f32, u32)) -> (f32, u32) {
        let least = distances.min_element();
        if least < best.0 {
            let lane = distances.cmpeq(Vec4::splat(least)).bitmask().trailing_zeros();
            (least, self.triangle[lane as usize & 3])
        } else {
            best
        }
    }
}

/// Fans of up to this many groups of four triangles are searched as a whole.
const FEW_SECTORS: usize = 16;
/// Number of groups searched around a sample's direction in larger fans.
const NEAR_SECTORS: usize = 4;
/// Most samples on a triangle compared when searching for the nearest to a place.
const MOST_ON: usize = 32;
/// An ear leaves its tracked samples to at most this many triangles around the kept point.
const EAR_TRIANGLES: usize = 64;

impl TrackedSamples {
    /// Creates the samples; no point is tracked yet. `remember`: keep distances, as needed by [`added`](Self::added).
    pub fn new(surface: &WorkingSurface, remember: bool) -> Self {
        let points = surface.point_count();
        let mut samples: Vec<TrackedSample> =
            (0..points as u32).map(|p| TrackedSample { position: surface.at(p), next: NONE }).collect();
        let mut head = vec![NONE; surface.triangle_count()];
        if !surface.curves().is_empty() || surface.is_small() {
            // Between curves no input point measures a triangle's middle, so the middle is a sample itself.
            for triangle in 0..surface.triangle_count() as u32 {
                let Some(corners) = surface.triangle(triangle) else { continue };
                if surface.is_small() || corners.iter().all(|&p| surface.is_on_curve(p)) {
                    let [p, q, r] = corners.map(|p| surface.at(p));
                    head[triangle as usize] = samples.len() as u32;
                    samples.push(TrackedSample { position: p + ((q - p) + (r - p)) / 3.0, next: NONE });
                }
            }
        }
        Self {
            placed: if remember { vec![0.0; samples.len()] } else { Vec::new() },
            points: samples,
            head,
            merged: vec![false; points],
            fan: Vec::new(),
            beside: Vec::new(),
            newcomers: Vec::new(),
            angles: Angles::default(),
            facets: Default::default(),
            budget: 0,
            largest: 0.0,
            heads: Vec::new(),
            handed: Vec::new(),
            share: area(surface) / surface.live_points().max(1) as f32,
            handed_over: 0,
        }
    }

    /// The largest squared distance so far.
    pub fn largest(&self) -> f32 {
        self.largest
    }

    /// Number of samples handed over by the last step.
    pub fn handed_over(&self) -> usize {
        self.handed_over
    }

    /// Records a distance found by other means, inner units.
    pub fn note(&mut self, distance: f32) {
        self.largest = self.largest.max(distance * distance);
    }

    /// Returns the input point nearest to a place among the first `MOST_ON` samples on a triangle.
    pub fn nearest_on(&self, triangle: u32, place: Vec3) -> Option<u32> {
        let (mut at, mut best, mut least) = (self.head[triangle as usize], None, f32::INFINITY);
        for _ in 0..MOST_ON {
            if at == NONE {
                break;
            }
            let sample = &self.points[at as usize];
            let distance = sample.position.distance_squared(place);
            if distance < least && (at as usize) < self.merged.len() {
                (best, least) = (Some(at), distance);
            }
            at = sample.next;
        }
        best
    }

    /// Area per input point, inner units.
    pub fn share(&self) -> f32 {
        self.share
    }

    /// Returns the largest distance from the patch's tracked samples to the patch made by merging `pair` at `x`, inner
    /// units.
    pub fn measure(&mut self, surface: &WorkingSurface, patch: &Patch, pair: Pair, x: Vec3) -> f32 {
        self.spread(surface, patch, pair, x);
        let mut worst: f32 = 0.0;
        let heads = self.heads(surface, pair, x);
        for &head in &heads {
            let mut at = head;
            while at != NONE {
                let sample = self.points[at as usize];
                worst = worst.max(self.nearest(sample.position - x).0);
                at = sample.next;
            }
        }
        self.heads = heads;
        for i in 0..self.newcomers.len() {
            worst = worst.max(self.nearest(self.points[self.newcomers[i] as usize].position - x).0);
        }
        worst.sqrt()
    }

    /// Returns the growth of the integral of squared distance over the input. Each tracked sample of the patch stands
    /// for an equal share of the area.
    pub fn added(&mut self, surface: &WorkingSurface, patch: &Patch, pair: Pair, x: Vec3) -> f32 {
        self.spread(surface, patch, pair, x);
        let mut sum: f32 = 0.0;
        let heads = self.heads(surface, pair, x);
        for &head in &heads {
            let mut at = head;
            while at != NONE {
                let sample = self.points[at as usize];
                sum += self.nearest_with_sides(sample.position - x).0 - self.placed[at as usize];
                at = sample.next;
            }
        }
        self.heads = heads;
        for i in 0..self.newcomers.len() {
            sum += self.nearest_with_sides(self.points[self.newcomers[i] as usize].position - x).0;
        }
        sum * self.share
    }

    /// Hands each tracked sample of the patch to the triangle of the new patch under it. Call just before the collapse.
    /// Returns the largest distance, inner units.
    pub fn hand_over(&mut self, surface: &WorkingSurface, patch: &Patch, pair: Pair, x: Vec3) -> f32 {
        self.spread(surface, patch, pair, x);
        // Chains are cut off first: samples are handed to triangles of the same patch.
        let heads = self.heads(surface, pair, x);
        self.clear_heads(surface, pair, x);
        let mut worst: f32 = 0.0;
        let mut count = 0;
        for &head in &heads {
            let mut at = head;
            while at != NONE {
                let next = self.points[at as usize].next;
                worst = worst.max(self.place(at, x));
                at = next;
                count += 1;
            }
        }
        self.heads = heads;
        self.handed_over = count;
        for i in 0..self.newcomers.len() {
            let point = self.newcomers[i];
            self.merged[point as usize] = true;
            worst = worst.max(self.place(point, x));
        }
        self.largest = self.largest.max(worst);
        worst.sqrt()
    }

    /// Returns the largest distance, inner units, from a vanishing part to the surface left: over its `points` and the
    /// tracked samples on it. `nearest` returns the squared distance of a position, and the nearest triangle. Stops at the first
    /// distance above `enough`.
    pub fn measure_vanishing(
        &mut self,
        surface: &WorkingSurface,
        points: &[u32],
        enough: f32,
        mut nearest: impl FnMut(Vec3) -> (f32, u32),
    ) -> f32 {
        let mut handed = std::mem::take(&mut self.handed);
        handed.clear();
        let mut worst: f32 = 0.0;
        let mut hand = |samples: &Self, sample: u32| {
            let (distance, triangle) = nearest(samples.points[sample as usize].position);
            worst = worst.max(distance);
            handed.push((sample, distance, triangle));
            worst.sqrt() > enough
        };
        'all: for &point in points {
            if !self.merged[point as usize] && hand(self, point) {
                break;
            }
            // Each triangle once, from its first corner.
            for corner in surface.star(point).filter(|corner| corner.slot == 0) {
                let mut at = self.head[corner.triangle as usize];
                while at != NONE {
                    if hand(self, at) {
                        break 'all;
                    }
                    at = self.points[at as usize].next;
                }
            }
        }
        self.handed = handed;
        worst.sqrt()
    }

    /// Hands over the samples measured last by [`measure_vanishing`](Self::measure_vanishing). Call just before the
    /// part vanishes. Returns the largest distance, inner units.
    pub fn vanish(&mut self, surface: &WorkingSurface, points: &[u32]) -> f32 {
        for &point in points {
            self.merged[point as usize] = true;
            for corner in surface.star(point) {
                self.head[corner.triangle as usize] = NONE;
            }
        }
        let mut worst: f32 = 0.0;
        for &(sample, distance, triangle) in &self.handed {
            worst = worst.max(distance);
            if let Some(placed) = self.placed.get_mut(sample as usize) {
                *placed = distance;
            }
            if triangle != NONE {
                self.points[sample as usize].next = self.head[triangle as usize];
                self.head[triangle as usize] = sample;
            }
        }
        self.largest = self.largest.max(worst);
        worst.sqrt()
    }

    /// Returns the largest distance from the patch measured last, inner units, of those samples of a vanishing part that the
    /// triangles of `pair.lost` take over.
    pub fn measure_handed(&mut self, surface: &WorkingSurface, pair: Pair, x: Vec3) -> f32 {
        let mut around = std::mem::take(&mut self.heads);
        around.clear();
        around.extend(surface.star_triangles(pair.lost));
        around.sort_unstable();
        let mut worst: f32 = 0.0;
        for i in 0..self.handed.len() {
            let (sample, _, triangle) = self.handed[i];
            if around.binary_search(&triangle).is_ok() {
                worst = worst.max(self.nearest(self.points[sample as usize].position - x).0);
            }
        }
        self.heads = around;
        worst.sqrt()
    }

    /// Tracked sample, squared distance and triangle of each sample measured last by
    /// [`measure_vanishing`](Self::measure_vanishing).
    pub fn handed(&self) -> &[(u32, f32, u32)] {
        &self.handed
    }

    /// Stores the new patch as sectors.
    fn spread(&mut self, surface: &WorkingSurface, patch: &Patch, pair: Pair, x: Vec3) {
        self.fan.clear();
        self.beside.clear();
        self.find_newcomers(surface, patch, pair, x);
        if patch.facets().len() > 4 * FEW_SECTORS {
            return self.spread_many(patch);
        }
        self.fan.extend(patch.facets().chunks(4).map(Group::new));
        if patch.facets().is_empty() {
            // Nothing of the patch survives (an ear): its tracked samples go to triangles around the kept point, near
            // the ear in its star's list. Triangles adjacent in the list were adjacent in the input.
            let ear = surface.star_triangles(pair.lost).next().unwrap_or(NONE);
            let near = surface.star_near(pair.kept, ear, EAR_TRIANGLES);
            let around = near.filter(|corner| !corner.others.contains(&pair.lost));
            self.fan.extend(around.map(|corner| Group::new(&[Facet::around(surface, corner, x)])));
            if self.fan.is_empty() {
                self.spread_beside(surface, patch, pair, x);
            }
        }
    }

    /// Stores triangles around the third corners of the removed triangles, which hung by these corners alone.
    #[cold]
    fn spread_beside(&mut self, surface: &WorkingSurface, patch: &Patch, pair: Pair, x: Vec3) {
        for &third in patch.opposite() {
            let ear = surface.star_triangles(pair.lost).next().unwrap_or(NONE);
            let near = surface.star_near(third, ear, EAR_TRIANGLES);
            for corner in near.filter(|corner| !corner.others.contains(&pair.lost)) {
                let [p, q] = corner.others.map(|p| surface.at(p) - x);
                self.beside.push(([surface.at(third) - x, p, q], corner.triangle));
            }
        }
    }

    /// Stores very many triangles, in the order of their angle.
    #[cold]
    fn spread_many(&mut self, patch: &Patch) {
        let [facets, scratch] = &mut self.facets;
        facets.clear();
        facets.extend_from_slice(patch.facets());
        self.angles.sort(facets, scratch);
        self.fan.extend(facets.chunks(4).map(Group::new));
        self.budget = 64 * self.fan.len();
    }

    /// Returns the first tracked sample of each triangle of the patch with any.
    #[inline]
    fn heads(&mut self, surface: &WorkingSurface, pair: Pair, x: Vec3) -> Vec<u32> {
        let mut heads = std::mem::take(&mut self.heads);
        heads.clear();
        let mut add = |triangle: u32| {
            let head = self.head[triangle as usize];
            if head != NONE {
                heads.push(head);
            }
        };
        surface.star_triangles(pair.lost).for_each(&mut add);
        if surface.at(pair.kept) != x {
            for corner in surface.star(pair.kept).filter(|corner| !corner.others.contains(&pair.lost)) {
                add(corner.triangle);
            }
        }
        heads
    }

    fn clear_heads(&mut self, surface: &WorkingSurface, pair: Pair, x: Vec3) {
        for corner in surface.star(pair.lost) {
            self.head[corner.triangle as usize] = NONE;
        }
        if surface.at(pair.kept) != x {
            for corner in surface.star(pair.kept) {
                self.head[corner.triangle as usize] = NONE;
            }
        }
    }

    /// Collects the points not tracked yet that are no longer on the surface: merged, or left alone.
    fn find_newcomers(&mut self, surface: &WorkingSurface, patch: &Patch, pair: Pair, x: Vec3) {
        let Self { newcomers, merged, .. } = self;
        let is_new = |point: &u32| !merged[*point as usize];
        let moved = (surface.at(pair.kept) != x).then_some(pair.kept);
        newcomers.clear();
        newcomers.extend([pair.lost].into_iter().chain(moved).filter(is_new));
        let count = newcomers.len();
        newcomers.extend(left_alone(surface, patch, pair).filter(is_new));
        if newcomers.len() > count {
            // Each once: a sample counts once, and has one place in a chain.
            newcomers.sort_unstable();
            newcomers.dedup();
        }
    }

    /// Puts a tracked sample on the triangle under it; returns its squared distance.
    #[inline]
    fn place(&mut self, sample: u32, x: Vec3) -> f32 {
        let (distance, triangle) = self.nearest(self.points[sample as usize].position - x);
        if let Some(placed) = self.placed.get_mut(sample as usize) {
            *placed = distance;
        }
        if triangle != NONE {
            self.points[sample as usize].next = self.head[triangle as usize];
            self.head[triangle as usize] = sample;
        }
        distance
    }

    /// Returns the squared distance to a nearby triangle of the new patch, and the triangle. The triangle under the
    /// point is mostly the nearest. On a ridge the point may lie over a distant triangle only, and the triangles' sides
    /// are nearer. Sides are tested only where the distance would be the largest so far.
    #[inline]
    fn nearest(&mut self, point: Vec3) -> (f32, u32) {
        if self.fan.len() > FEW_SECTORS {
            return self.nearest_of_many(point);
        }
        let p = Lanes::splat(point);
        let mut best = (f32::INFINITY, NONE);
        for group in &self.fan {
            best = group.least(group.sectors.heights(&p), best);
        }
        if best.0 <= self.largest { best } else { self.nearest_of(0..self.fan.len(), point) }
    }

    /// Returns the squared distance to the nearest triangle of the new patch, and the triangle. Always tests the
    /// triangles' sides. Exact for fans of up to [`FEW_SECTORS`] groups.
    fn nearest_with_sides(&mut self, point: Vec3) -> (f32, u32) {
        if self.fan.len() > FEW_SECTORS {
            return self.nearest_of_many(point);
        }
        self.nearest_of(0..self.fan.len(), point)
    }

    /// Returns the squared distance to the nearest triangle of some groups, and the triangle.
    fn nearest_of(&self, groups: std::ops::Range<usize>, point: Vec3) -> (f32, u32) {
        let p = Lanes::splat(point);
        let mut best = (f32::INFINITY, NONE);
        for group in &self.fan[groups] {
            let Group { sectors, .. } = group;
            best = group.least(sectors.heights(&p).min(sectors.sides(&p)), best);
        }
        if best.1 == NONE { self.nearest_beside(point) } else { best }
    }

    /// Returns the squared distance to the nearest triangle beside the patch, and the triangle. If there is none either, only
    /// the merged point itself is left.
    #[cold]
    fn nearest_beside(&self, point: Vec3) -> (f32, u32) {
        let distances = self.beside.iter().map(|&(corners, t)| (distance_squared_single(corners, point), t));
        distances.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((point.length_squared(), NONE))
    }

    /// Searches very many triangles: first the groups near the point's direction. All groups are searched only where
    /// the distance would be the largest so far, within a budget in proportion to the number of triangles.
    #[cold]
    fn nearest_of_many(&mut self, point: Vec3) -> (f32, u32) {
        let count = self.fan.len();
        let from = (self.angles.place(point) / 4 + count - NEAR_SECTORS / 2) % count;
        let to = (from + NEAR_SECTORS).min(count);
        let mut best = self.nearest_of(from..to, point);
        let others = self.nearest_of(0..NEAR_SECTORS.saturating_sub(to - from), point);
        if others.1 != NONE && others.0 < best.0 {
            best = others;
        }
        if best.0 > self.largest && self.budget >= count {
            self.budget -= count;
            best = self.nearest_of(0..count, point);
        }
        best
    }
}

/// Returns the area of a surface, inner units.
fn area(surface: &WorkingSurface) -> f32 {
    let triangles = (0..surface.triangle_count() as u32).filter_map(|t| surface.triangle(t));
    let double = triangles.map(|t| {
        let [p, q, r] = t.map(|v| surface.at(v));
        f64::from((q - p).cross(r - p).length())
    });
    (0.5 * double.sum::<f64>()) as f32
}
