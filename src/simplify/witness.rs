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
    /// The largest squared distance of what was committed, and of what was measured last.
    largest: f32,
    measured: f32,
    /// Where the witnesses of the patch measured last would go: witness and triangle.
    moves: Vec<[u32; 2]>,
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
            measured: 0.0,
            moves: Vec::new(),
        }
    }

    /// The largest distance of a witness of the patch from the patch that merging `pair` at `x` would make, inner
    /// units. [`commit`](Self::commit) then hands them over.
    pub fn measure(&mut self, surface: &Surface, pair: Pair, x: Vec3) -> f32 {
        let Pair { lost, kept } = pair;
        let moves = surface.at(kept) != x;
        self.fan.clear();
        self.fan_len = 0;
        self.moves.clear();
        for corner in surface.star(lost) {
            let [a, b] = corner.others;
            if a != kept && b != kept {
                self.push(corner.triangle, surface.at(a) - x, surface.at(b) - x);
            }
        }
        if moves || self.fan.is_empty() {
            for corner in surface.star(kept) {
                let [a, b] = corner.others;
                if a != lost && b != lost {
                    self.push(corner.triangle, surface.at(a) - x, surface.at(b) - x);
                }
            }
        }
        let mut worst: f32 = 0.0;
        for corner in surface.star(lost) {
            worst = worst.max(self.hand_over(self.head[corner.triangle as usize], x));
        }
        worst = worst.max(self.hand_over_new(lost, x));
        if moves {
            for corner in surface.star(kept).filter(|corner| !corner.others.contains(&lost)) {
                worst = worst.max(self.hand_over(self.head[corner.triangle as usize], x));
            }
            worst = worst.max(self.hand_over_new(kept, x));
        }
        self.measured = worst;
        worst.sqrt()
    }

    fn hand_over_new(&mut self, point: u32, x: Vec3) -> f32 {
        if self.merged[point as usize] {
            return 0.0;
        }
        let (distance, triangle) = self.nearest(self.positions[point as usize] - x);
        self.moves.push([point, triangle]);
        distance
    }

    /// Finds a place for every witness of a chain; the largest squared distance.
    fn hand_over(&mut self, head: u32, x: Vec3) -> f32 {
        let mut worst: f32 = 0.0;
        let mut witness = head;
        while witness != NONE {
            let (distance, triangle) = self.nearest(self.positions[witness as usize] - x);
            self.moves.push([witness, triangle]);
            worst = worst.max(distance);
            witness = self.next[witness as usize];
        }
        worst
    }

    /// Adds a triangle to the new patch.
    #[inline]
    fn push(&mut self, triangle: u32, a: Vec3, b: Vec3) {
        let lane = self.fan_len % 4;
        if lane == 0 {
            self.fan.push(EMPTY);
        }
        self.fan_len += 1;
        let Some(sectors) = self.fan.last_mut() else { return };
        let normal = a.cross(b);
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

    /// Does what the last [`measure`](Self::measure) found: call after the surface changed.
    pub fn commit(&mut self, surface: &Surface, pair: Pair, dead: &[u32], changed: &[u32], moves: bool) {
        for &t in dead.iter().chain(changed) {
            self.head[t as usize] = NONE;
        }
        if moves {
            for corner in surface.star(pair.kept) {
                self.head[corner.triangle as usize] = NONE;
            }
            self.merged[pair.kept as usize] = true;
        }
        self.merged[pair.lost as usize] = true;
        self.largest = self.largest.max(self.measured);
        for &[witness, triangle] in &self.moves {
            if triangle != NONE {
                self.next[witness as usize] = self.head[triangle as usize];
                self.head[triangle as usize] = witness;
            }
        }
    }
}

#[inline]
fn distance_squared_to_segment(p: Vec3, a: Vec3, b: Vec3) -> f32 {
    let ab = b - a;
    let length = ab.length_squared();
    let t = if length > 0.0 { ((p - a).dot(ab) / length).clamp(0.0, 1.0) } else { 0.0 };
    p.distance_squared(a + t * ab)
}
