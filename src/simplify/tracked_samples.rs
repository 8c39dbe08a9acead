//! How far the input lies from the level of detail: every input point keeps a place on the current surface.
//!
//! ```text
//!          w2                   w2          A point that was merged away is a tracked sample. It hangs on the triangle
//!        /  | \               / . \         of the current surface that it lies over. When a collapse replaces a
//!      w3 --u-- v    ->     w3  o  v        patch, the tracked samples on the patch (and the lost point, o) are handed
//!        \  | /               \ . /         to the nearest new triangle, and the distance to it is taken.
//!          w1                   w1
//! ```
//!
//! The nearest triangle of the patch is at least as far as the nearest of the whole surface, so the largest distance is
//! an upper bound for the distance of every input point from the level, and a tight one. A simplification from n
//! points to m hands over about `3 n ln(n / m)` tracked samples in all.

use glam::{Vec3, Vec4};

use crate::mesh::NONE;

use super::angles::Angles;
use super::lanes::Lanes;
use super::metric::Pair;
use super::patch::{Facet, Patch};
use super::sectors::Sectors;
use super::surface::WorkingSurface;

/// Which triangle each merged point lies over.
#[derive(Debug, Clone, Default)]
pub(super) struct TrackedSamples {
    /// The input's points, then middles of triangles between curves.
    points: Vec<TrackedSample>,
    /// First tracked sample on each triangle.
    head: Vec<u32>,
    /// Whether each point is a tracked sample yet.
    merged: Vec<bool>,
    fan: Vec<Group>,
    /// Where to look in a fan of more than [`FEW_SECTORS`].
    angles: Angles,
    facets: [Vec<Facet>; 2],
    /// How many sectors of such a fan may still be asked that lie elsewhere.
    budget: usize,
    /// The largest squared distance so far.
    largest: f32,
    heads: Vec<u32>,
    /// Where the tracked samples of a part that vanishes would go: tracked sample, squared distance and triangle.
    handed: Vec<(u32, f32, u32)>,
    /// Squared distance of each tracked sample when it was placed last; empty unless asked to remember.
    placed: Vec<f32>,
    /// Area per input point.
    share: f32,
}

/// An input point, and the next one on the same triangle: side by side, since chains run all over memory.
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
    /// Up to four facets.
    #[inline]
    fn new(facets: &[Facet]) -> Self {
        // Lanes without a facet repeat the last one: no harm in finding it twice.
        let facet = |i: usize| &facets[i.min(facets.len() - 1)];
        let [a, b] = [Lanes::gather(|i| facet(i).a), Lanes::gather(|i| facet(i).b)];
        Self {
            sectors: Sectors::new(a, b, Lanes::gather(|i| facet(i).after)),
            triangle: std::array::from_fn(|i| facet(i).triangle),
        }
    }

    /// The nearer of `best` and the least of `distances`.
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

/// Fans of up to so many groups of four triangles are asked as a whole.
const FEW_SECTORS: usize = 16;
/// In larger ones so many groups around the direction of a tracked sample are asked.
const NEAR_SECTORS: usize = 4;
/// So many points on a triangle are asked which is nearest to a place.
const MOST_ON: usize = 32;
/// An ear leaves its tracked samples to at most this many triangles around the kept point.
const EAR_TRIANGLES: usize = 64;

impl TrackedSamples {
    /// No point is a tracked sample yet. To `remember` distances is needed for [`added`](Self::added).
    pub fn new(surface: &WorkingSurface, remember: bool) -> Self {
        let points = surface.point_count();
        let mut samples: Vec<TrackedSample> =
            (0..points as u32).map(|p| TrackedSample { position: surface.at(p), next: NONE }).collect();
        let mut head = vec![NONE; surface.triangle_count()];
        if !surface.curves().is_empty() || surface.is_small() {
            // Between curves there is no point to tell how far a triangle's middle comes to lie: it is one itself.
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
            angles: Angles::default(),
            facets: Default::default(),
            budget: 0,
            largest: 0.0,
            heads: Vec::new(),
            handed: Vec::new(),
            share: area(surface) / surface.live_points().max(1) as f32,
        }
    }

    /// The largest squared distance so far.
    pub fn largest(&self) -> f32 {
        self.largest
    }

    /// Takes down a distance found by other means.
    pub fn note(&mut self, distance: f32) {
        self.largest = self.largest.max(distance * distance);
    }

    /// The nearest to a place of the first points of the input that hang on a triangle.
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

    /// Area per input point.
    pub fn share(&self) -> f32 {
        self.share
    }

    /// The largest distance of a tracked sample of the patch from the patch that merging `pair` at `x` would make, inner
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
        for point in self.newcomers(surface, pair, x) {
            worst = worst.max(self.nearest(self.points[point as usize].position - x).0);
        }
        worst.sqrt()
    }

    /// How much the integral of squared distance over the input would grow: every tracked sample of the patch stands for an
    /// equal share of the area.
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
        for point in self.newcomers(surface, pair, x) {
            sum += self.nearest_with_sides(self.points[point as usize].position - x).0;
        }
        sum * self.share
    }

    /// Hands every tracked sample of the patch to the triangle of the new patch that it lies over, just before the collapse
    /// is done; the largest distance, inner units.
    pub fn hand_over(&mut self, surface: &WorkingSurface, patch: &Patch, pair: Pair, x: Vec3) -> f32 {
        self.spread(surface, patch, pair, x);
        // The chains are cut off first: what is handed over goes onto triangles of the same patch.
        let heads = self.heads(surface, pair, x);
        self.clear_heads(surface, pair, x);
        let mut worst: f32 = 0.0;
        for &head in &heads {
            let mut at = head;
            while at != NONE {
                let next = self.points[at as usize].next;
                worst = worst.max(self.place(at, x));
                at = next;
            }
        }
        self.heads = heads;
        for point in self.newcomers(surface, pair, x) {
            self.merged[point as usize] = true;
            worst = worst.max(self.place(point, x));
        }
        self.largest = self.largest.max(worst);
        worst.sqrt()
    }

    /// The largest distance to what is left, inner units, of the tracked samples on a part of `points` that vanishes, and of
    /// those points: `nearest` gives the squared distance of a position and the triangle that has it.
    pub fn measure_vanishing(
        &mut self,
        surface: &WorkingSurface,
        points: &[u32],
        mut nearest: impl FnMut(Vec3) -> (f32, u32),
    ) -> f32 {
        let mut handed = std::mem::take(&mut self.handed);
        handed.clear();
        let mut worst: f32 = 0.0;
        let mut hand = |samples: &Self, sample: u32| {
            let (distance, triangle) = nearest(samples.points[sample as usize].position);
            worst = worst.max(distance);
            handed.push((sample, distance, triangle));
        };
        for &point in points {
            if !self.merged[point as usize] {
                hand(self, point);
            }
            // Each triangle once, from its first corner.
            for corner in surface.star(point).filter(|corner| corner.slot == 0) {
                let mut at = self.head[corner.triangle as usize];
                while at != NONE {
                    hand(self, at);
                    at = self.points[at as usize].next;
                }
            }
        }
        self.handed = handed;
        worst.sqrt()
    }

    /// Hands over what was measured last, just before the part vanishes; the largest distance, inner units.
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

    /// Tracked sample, squared distance and triangle of what was measured last.
    pub fn handed(&self) -> &[(u32, f32, u32)] {
        &self.handed
    }

    /// The new patch as sectors.
    fn spread(&mut self, surface: &WorkingSurface, patch: &Patch, pair: Pair, x: Vec3) {
        self.fan.clear();
        if patch.facets().len() > 4 * FEW_SECTORS {
            return self.spread_many(patch);
        }
        self.fan.extend(patch.facets().chunks(4).map(Group::new));
        if patch.facets().is_empty() {
            // Nothing of the patch survives (an ear): its tracked samples go to what lies around the kept point, near in the
            // list of its star, where triangles lie side by side that did so in the input.
            let ear = surface.star_triangles(pair.lost).next();
            let at = surface.star_triangles(pair.kept).position(|triangle| Some(triangle) == ear);
            let from = at.unwrap_or(0).saturating_sub(EAR_TRIANGLES / 2);
            let near = surface.star(pair.kept).skip(from).take(EAR_TRIANGLES);
            let around = near.filter(|corner| !corner.others.contains(&pair.lost));
            self.fan.extend(around.map(|corner| Group::new(&[Facet::around(surface, corner, x)])));
        }
    }

    /// Very many triangles, in the order of their angle.
    #[cold]
    fn spread_many(&mut self, patch: &Patch) {
        let [facets, scratch] = &mut self.facets;
        facets.clear();
        facets.extend_from_slice(patch.facets());
        self.angles.sort(facets, scratch);
        self.fan.extend(facets.chunks(4).map(Group::new));
        self.budget = 64 * self.fan.len();
    }

    /// The first tracked sample of every triangle of the patch that has one.
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

    /// The merged points that are not tracked samples yet.
    fn newcomers(&self, surface: &WorkingSurface, pair: Pair, x: Vec3) -> impl Iterator<Item = u32> + use<> {
        let is_new = |point: u32| (!self.merged[point as usize]).then_some(point);
        let kept = if surface.at(pair.kept) == x { None } else { is_new(pair.kept) };
        is_new(pair.lost).into_iter().chain(kept)
    }

    /// Puts a tracked sample on the triangle it lies over; its squared distance.
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

    /// Squared distance to a nearby triangle of the new patch, and which. The triangle that the point lies over is
    /// mostly the nearest; on a ridge the point may lie over no triangle but a distant one, and the sides are nearer.
    /// They are asked where it matters: where the distance would be the largest so far.
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

    /// The same with the triangles' sides asked in any case: exact for the new patch.
    fn nearest_with_sides(&mut self, point: Vec3) -> (f32, u32) {
        if self.fan.len() > FEW_SECTORS {
            return self.nearest_of_many(point);
        }
        self.nearest_of(0..self.fan.len(), point)
    }

    /// Squared distance to the nearest triangle of some groups, and which.
    fn nearest_of(&self, groups: std::ops::Range<usize>, point: Vec3) -> (f32, u32) {
        let p = Lanes::splat(point);
        let mut best = (f32::INFINITY, NONE);
        for group in &self.fan[groups] {
            let Group { sectors, .. } = group;
            best = group.least(sectors.heights(&p).min(sectors.sides(&p)), best);
        }
        // Where nothing is left but the merged point itself.
        if best.1 == NONE { (point.length_squared(), NONE) } else { best }
    }

    /// Among very many triangles those near the point's direction are asked. The others only where the distance would be
    /// the largest so far, and only for as many points as keeps the whole in proportion to the triangles.
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

/// Area of a surface, inner units.
fn area(surface: &WorkingSurface) -> f32 {
    let triangles = (0..surface.triangle_count() as u32).filter_map(|t| surface.triangle(t));
    let double = triangles.map(|t| {
        let [p, q, r] = t.map(|v| surface.at(v));
        f64::from((q - p).cross(r - p).length())
    });
    (0.5 * double.sum::<f64>()) as f32
}
