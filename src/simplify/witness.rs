//! How far the input lies from the level of detail: every input point keeps a place on the current surface.
//!
//! ```text
//!          w2                   w2          A point that was merged away is a witness. It hangs on the triangle
//!        /  | \               / . \         of the current surface that it lies over. When a collapse replaces a
//!      w3 --u-- v    ->     w3  o  v        patch, the witnesses on the patch (and the lost point, o) are handed
//!        \  | /               \ . /         to the nearest new triangle, and the distance to it is taken.
//!          w1                   w1
//! ```
//!
//! The nearest triangle of the patch is at least as far as the nearest of the whole surface, so the largest distance is
//! an upper bound for the distance of every input point from the level, and a tight one. A simplification from n
//! points to m hands over about `3 n ln(n / m)` witnesses in all.

use glam::{Vec3, Vec4};

use crate::mesh::NONE;

use super::metric::Pair;
use super::patch::{Facet, Patch};
use super::surface::Surface;

/// Which triangle each merged point lies over.
#[derive(Debug, Clone, Default)]
pub(super) struct Witnesses {
    positions: Vec<Vec3>,
    /// First witness on each triangle, and the next one on the same.
    head: Vec<u32>,
    next: Vec<u32>,
    /// Whether each point is a witness yet.
    merged: Vec<bool>,
    fan: Vec<Sectors>,
    fan_len: usize,
    /// The largest squared distance so far.
    largest: f32,
    heads: Vec<u32>,
}

/// Four triangles of the new patch side by side, relative to the merged point's position (their first corner). A
/// point `p` lies between a triangle's sides along a and b where its products with the two inner side normals are not
/// negative, and over the triangle where `p . side_ab + reach` is not either. Its squared distance is then
/// `(p . normal)^2 * inverse_area`.
#[derive(Debug, Clone, Copy)]
struct Sectors {
    normal: [Vec4; 3],
    side_a: [Vec4; 3],
    side_b: [Vec4; 3],
    side_ab: [Vec4; 3],
    reach: Vec4,
    inverse_area: Vec4,
    a: [Vec3; 4],
    b: [Vec3; 4],
    triangle: [u32; 4],
}

/// Lanes that no point lies over.
const EMPTY: Sectors = Sectors {
    normal: [Vec4::ZERO; 3],
    side_a: [Vec4::ZERO; 3],
    side_b: [Vec4::ZERO; 3],
    side_ab: [Vec4::ZERO; 3],
    reach: Vec4::NEG_ONE,
    inverse_area: Vec4::ZERO,
    a: [Vec3::ZERO; 4],
    b: [Vec3::ZERO; 4],
    triangle: [NONE; 4],
};

impl Witnesses {
    pub fn new(surface: &Surface) -> Self {
        let points = surface.point_count();
        Self {
            positions: (0..points as u32).map(|p| surface.at(p)).collect(),
            head: vec![NONE; surface.triangle_count()],
            next: vec![NONE; points],
            merged: vec![false; points],
            fan: Vec::new(),
            fan_len: 0,
            largest: 0.0,
            heads: Vec::new(),
        }
    }

    /// The largest distance of a witness of the patch from the patch that merging `pair` at `x` would make, inner
    /// units.
    pub fn measure(&mut self, surface: &Surface, patch: &Patch, pair: Pair, x: Vec3) -> f32 {
        self.spread(surface, patch, pair, x);
        let mut worst: f32 = 0.0;
        self.for_heads(surface, pair, x, |witnesses, mut at| {
            while at != NONE {
                worst = worst.max(witnesses.nearest(witnesses.positions[at as usize] - x).0);
                at = witnesses.next[at as usize];
            }
        });
        for point in self.newcomers(surface, pair, x) {
            worst = worst.max(self.nearest(self.positions[point as usize] - x).0);
        }
        worst.sqrt()
    }

    /// Hands every witness of the patch to the triangle of the new patch that it lies over, just before the collapse
    /// is done; the largest distance, inner units.
    pub fn hand_over(&mut self, surface: &Surface, patch: &Patch, pair: Pair, x: Vec3) -> f32 {
        self.spread(surface, patch, pair, x);
        // The chains are cut off first: what is handed over goes onto triangles of the same patch.
        let mut heads = std::mem::take(&mut self.heads);
        heads.clear();
        self.for_heads(surface, pair, x, |_, head| heads.push(head));
        self.clear_heads(surface, pair, x);
        let mut worst: f32 = 0.0;
        for &head in &heads {
            let mut at = head;
            while at != NONE {
                let next = self.next[at as usize];
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

    /// The new patch as sectors.
    fn spread(&mut self, surface: &Surface, patch: &Patch, pair: Pair, x: Vec3) {
        self.fan.clear();
        self.fan_len = 0;
        patch.facets().iter().for_each(|facet| self.push(facet));
        if patch.facets().is_empty() {
            // Nothing of the patch survives (an ear): its witnesses go to what lies around the kept point.
            for corner in surface.star(pair.kept).filter(|corner| !corner.others.contains(&pair.lost)) {
                self.push(&Facet::around(surface, corner, x));
            }
        }
    }

    /// Calls `visit` with the first witness of every triangle of the patch.
    #[inline]
    fn for_heads(&self, surface: &Surface, pair: Pair, x: Vec3, mut visit: impl FnMut(&Self, u32)) {
        for corner in surface.star(pair.lost) {
            visit(self, self.head[corner.triangle as usize]);
        }
        if surface.at(pair.kept) != x {
            for corner in surface.star(pair.kept).filter(|corner| !corner.others.contains(&pair.lost)) {
                visit(self, self.head[corner.triangle as usize]);
            }
        }
    }

    fn clear_heads(&mut self, surface: &Surface, pair: Pair, x: Vec3) {
        for corner in surface.star(pair.lost) {
            self.head[corner.triangle as usize] = NONE;
        }
        if surface.at(pair.kept) != x {
            for corner in surface.star(pair.kept) {
                self.head[corner.triangle as usize] = NONE;
            }
        }
    }

    /// The merged points that are not witnesses yet.
    fn newcomers(&self, surface: &Surface, pair: Pair, x: Vec3) -> impl Iterator<Item = u32> + use<> {
        let is_new = |point: u32| (!self.merged[point as usize]).then_some(point);
        let kept = if surface.at(pair.kept) == x { None } else { is_new(pair.kept) };
        is_new(pair.lost).into_iter().chain(kept)
    }

    /// Puts a witness on the triangle it lies over; its squared distance.
    #[inline]
    fn place(&mut self, witness: u32, x: Vec3) -> f32 {
        let (distance, triangle) = self.nearest(self.positions[witness as usize] - x);
        if triangle != NONE {
            self.next[witness as usize] = self.head[triangle as usize];
            self.head[triangle as usize] = witness;
        }
        distance
    }

    /// Adds a triangle to the new patch.
    #[inline]
    fn push(&mut self, facet: &Facet) {
        let &Facet { triangle, a, b, after: normal, .. } = facet;
        let lane = self.fan_len % 4;
        if lane == 0 {
            self.fan.push(EMPTY);
        }
        self.fan_len += 1;
        let Some(sectors) = self.fan.last_mut() else { return };
        let area = normal.length_squared();
        sectors.a[lane] = a;
        sectors.b[lane] = b;
        sectors.triangle[lane] = triangle;
        if area <= f32::MIN_POSITIVE {
            return;
        }
        // Lengths do not matter for the sides' signs.
        let (side_a, side_b, side_ab) = (normal.cross(a), b.cross(normal), normal.cross(b - a));
        for i in 0..3 {
            sectors.normal[i][lane] = normal[i];
            sectors.side_a[i][lane] = side_a[i];
            sectors.side_b[i][lane] = side_b[i];
            sectors.side_ab[i][lane] = side_ab[i];
        }
        sectors.reach[lane] = -a.dot(side_ab);
        sectors.inverse_area[lane] = 1.0 / area;
    }

    /// Squared distance to a nearby triangle of the new patch, and which. The triangle that the point lies over is
    /// mostly the nearest; on a ridge the point may lie over no triangle but a distant one, and the sides are nearer.
    /// They are asked where it matters: where the distance would be the largest so far.
    #[inline]
    fn nearest(&self, p: Vec3) -> (f32, u32) {
        let mut best = (f32::INFINITY, NONE);
        let p4 = [Vec4::splat(p.x), Vec4::splat(p.y), Vec4::splat(p.z)];
        let dot = |v: &[Vec4; 3]| p4[0] * v[0] + p4[1] * v[1] + p4[2] * v[2];
        for sectors in &self.fan {
            let between = dot(&sectors.side_a).min(dot(&sectors.side_b)).cmpge(Vec4::ZERO);
            let inside = (dot(&sectors.side_ab) + sectors.reach).cmpge(Vec4::ZERO);
            let height = dot(&sectors.normal);
            let distance = height * height * sectors.inverse_area;
            let distance = Vec4::select(between & inside, distance, Vec4::INFINITY);
            let least = distance.min_element();
            if least < best.0 {
                let lane = distance.cmpeq(Vec4::splat(least)).bitmask().trailing_zeros();
                best = (least, sectors.triangle[lane as usize & 3]);
            }
        }
        if best.0 <= self.largest { best } else { self.nearest_with_sides(best, p) }
    }

    fn nearest_with_sides(&self, found: (f32, u32), p: Vec3) -> (f32, u32) {
        let first = self.fan.first().map_or(NONE, |sectors| sectors.triangle[0]);
        let mut best = if found.1 == NONE { (p.length_squared(), first) } else { found };
        for i in 0..self.fan_len {
            let (sectors, lane) = (&self.fan[i / 4], i % 4);
            let (a, b) = (sectors.a[lane], sectors.b[lane]);
            for (from, to) in [(Vec3::ZERO, a), (Vec3::ZERO, b), (a, b)] {
                let distance = distance_squared_to_segment(p, from, to);
                if distance < best.0 {
                    best = (distance, sectors.triangle[lane]);
                }
            }
        }
        best
    }
}

#[inline]
fn distance_squared_to_segment(p: Vec3, a: Vec3, b: Vec3) -> f32 {
    let ab = b - a;
    let length = ab.length_squared();
    let t = if length > 0.0 { ((p - a).dot(ab) / length).clamp(0.0, 1.0) } else { 0.0 };
    p.distance_squared(a + t * ab)
}
