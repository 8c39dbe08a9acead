//! Maps the input to a level: the middle of every input triangle to the nearest place on the level in its own chart.
//!
//! ```text
//!     input triangle -> the vertices that stand for its corners -> the level's triangles around these
//!                    -> the nearest one -> those around its corners -> ... until none is nearer
//! ```
//!
//! Vertices are wedges, so triangles around them are in the same chart; where a seam has moved, the search does not
//! cross it. The search is local: it deliberately misses a much nearer place across the mesh.

use glam::{DVec3, Vec3};

use crate::mesh::{Mesh, NONE, Topology};

use super::lanes::Lanes;
use super::sectors::{Sectors, least};

/// Rounds of searching around the nearest triangle so far.
const ROUNDS: usize = 4;
/// A squared height over a triangle, relative to its squared length, below which no other triangle can be much nearer.
const CLOSE: f64 = 0.01;
/// Maximum number of triangles looked at around a vertex, for hubs.
const MOST: usize = 64;

/// A place on a level.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    /// Triangle of the level; `NONE` where the input's part is gone from the level.
    pub triangle: u32,
    /// Weights of the triangle's corners; they sum to 1.
    pub weights: [f32; 3],
}

/// Returns the place of the middle of every triangle of the mesh. `number`: per mesh vertex the level's vertex standing
/// for it, or `NONE`. O(input) for levels without hubs.
pub(super) fn places(mesh: &Mesh, level: &Mesh, number: &[u32]) -> Vec<Place> {
    let stars = LevelStars::new(level);
    let one = |t: usize| {
        let corners = mesh.triangles()[t];
        let middle = middle(mesh, corners);
        stars.place(middle, corners.map(|v| number[v as usize]))
    };
    let count = mesh.triangles().len();
    #[cfg(feature = "parallel")]
    {
        use rayon::prelude::*;
        (0..count).into_par_iter().with_min_len(1024).map(one).collect()
    }
    #[cfg(not(feature = "parallel"))]
    {
        (0..count).map(one).collect()
    }
}

/// Removes the places of triangles whose part differs from the level's part there: vanished parts, replaced by another
/// part. `origin`: per triangle of the level, the mesh's triangle it is the image of.
pub(super) fn keep_parts_apart(mesh: &Mesh, origin: &[u32], places: &mut [Place]) {
    let part = parts(mesh);
    let part_of = |t: u32| part[mesh.triangles()[t as usize][0] as usize];
    for (t, place) in places.iter_mut().enumerate().filter(|(_, place)| place.triangle != NONE) {
        if part_of(t as u32) != part_of(origin[place.triangle as usize]) {
            place.triangle = NONE;
        }
    }
}

/// Returns the part of every vertex: points joined by triangles. O(n).
pub(super) fn parts(mesh: &Mesh) -> Vec<u32> {
    let topology = Topology::new(mesh);
    let point_of = topology.point_of();
    let mut parent: Vec<u32> = (0..topology.point_count() as u32).collect();
    fn root(parent: &mut [u32], mut i: u32) -> u32 {
        while parent[i as usize] != i {
            parent[i as usize] = parent[parent[i as usize] as usize];
            i = parent[i as usize];
        }
        i
    }
    for corners in mesh.triangles() {
        let [a, b, c] = corners.map(|v| point_of[v as usize]);
        for (from, to) in [(a, b), (b, c)] {
            let (from, to) = (root(&mut parent, from), root(&mut parent, to));
            parent[from.max(to) as usize] = from.min(to);
        }
    }
    point_of.iter().map(|&point| root(&mut parent, point)).collect()
}

pub(super) fn at(mesh: &Mesh, vertex: u32) -> DVec3 {
    DVec3::from_array(mesh.positions()[vertex as usize].map(f64::from))
}

/// Returns the middle of a triangle.
fn middle(mesh: &Mesh, [a, b, c]: [u32; 3]) -> DVec3 {
    (at(mesh, a) + at(mesh, b) + at(mesh, c)) / 3.0
}

/// Triangles around every vertex of a level.
struct LevelStars<'a> {
    level: &'a Mesh,
    /// Origin and scale of `positions`: moved to 0 and scaled to a diagonal of 1, so single precision suffices.
    centre: DVec3,
    scale: f64,
    positions: Vec<Vec3>,
    start: Vec<u32>,
    /// Each triangle around a vertex, and its two other corners.
    around: Vec<(u32, [u32; 2])>,
}

impl<'a> LevelStars<'a> {
    fn new(level: &'a Mesh) -> Self {
        let mut start = vec![0u32; level.positions().len() + 1];
        level.indices().iter().for_each(|&v| start[v as usize + 1] += 1);
        for v in 1..start.len() {
            start[v] += start[v - 1];
        }
        let mut next = start.clone();
        let mut around = vec![(0, [0; 2]); level.indices().len()];
        for (t, &[a, b, c]) in level.triangles().iter().enumerate() {
            for (v, others) in [(a, [b, c]), (b, [c, a]), (c, [a, b])] {
                around[next[v as usize] as usize] = (t as u32, others);
                next[v as usize] += 1;
            }
        }
        let [low, high] = level.bounds().unwrap_or_default().map(|p| DVec3::from_array(p.map(f64::from)));
        let centre = low.midpoint(high);
        let scale = 1.0 / (high - low).length().max(f64::MIN_POSITIVE);
        let inner = |v| ((at(level, v) - centre) * scale).as_vec3();
        let positions = (0..level.positions().len() as u32).map(inner).collect();
        Self { level, centre, scale, positions, start, around }
    }

    /// Returns the nearest triangle around a vertex, and its squared distance from an inner point, where less than
    /// `best`. Only triangles the point lies over count, or with `sides` all triangles.
    #[inline]
    fn nearest_around(&self, vertex: u32, point: Vec3, sides: bool, best: (f32, u32)) -> (f32, u32) {
        let at = |v: u32| self.positions[v as usize];
        let origin = at(vertex);
        let p = Lanes::splat(point - origin);
        let [first, last] = [vertex, vertex + 1].map(|v| self.start[v as usize] as usize);
        let mut best = best;
        for four in self.around[first..last.min(first + MOST)].chunks(4) {
            // Lanes without a triangle repeat the last triangle.
            let one = |i: usize| four[i.min(four.len() - 1)];
            let [a, b] = [0, 1].map(|end| Lanes::gather(|i| at(one(i).1[end]) - origin));
            let sectors = Sectors::new(a, b, a.cross(&b));
            let mut distances = sectors.heights(&p);
            if sides {
                distances = distances.min(sectors.sides(&p));
            }
            let (distance, lane) = least(distances);
            if distance < best.0 {
                best = (distance, one(lane).0);
            }
        }
        best
    }

    fn place(&self, point: DVec3, corners: [u32; 3]) -> Place {
        let ends = |triangle: u32| self.level.triangles()[triangle as usize].map(|v| at(self.level, v));
        let placed =
            |triangle: u32, weights: [f64; 3]| Place { triangle, weights: weights.map(|w| w as f32) };
        let inner = ((point - self.centre) * self.scale).as_vec3();
        // The point mostly lies close over a triangle here: no side need be tested.
        let mut best = (f32::INFINITY, NONE);
        for (i, &vertex) in corners.iter().enumerate() {
            if vertex != NONE && !corners[..i].contains(&vertex) {
                best = self.nearest_around(vertex, inner, false, best);
            }
        }
        if best.1 != NONE {
            if let Some((weights, height)) = inside(point, ends(best.1)) {
                if height < CLOSE {
                    return placed(best.1, weights);
                }
            }
        }
        let mut best = (f32::INFINITY, NONE);
        let mut seen = [NONE; 3 * (ROUNDS + 1)];
        let mut count = 0;
        let mut around = corners;
        for _ in 0..=ROUNDS {
            let before = best.1;
            for vertex in around {
                if vertex == NONE || seen[..count].contains(&vertex) {
                    continue;
                }
                seen[count] = vertex;
                count += 1;
                best = self.nearest_around(vertex, inner, true, best);
            }
            if best.1 == before {
                break;
            }
            around = self.level.triangles()[best.1 as usize];
        }
        match best.1 {
            NONE => placed(NONE, [0.0; 3]),
            triangle => placed(triangle, nearest(point, ends(triangle)).0),
        }
    }
}

/// Returns the weights of the point of a triangle below `p`, and the squared height of `p` over the squared length of
/// the triangle's longest side; `None` where `p` does not lie over the triangle.
#[inline]
fn inside(p: DVec3, [a, b, c]: [DVec3; 3]) -> Option<([f64; 3], f64)> {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let normal = ab.cross(ac);
    let square = normal.length_squared();
    let (v, w) = (ap.cross(ac).dot(normal), ab.cross(ap).dot(normal));
    if v < 0.0 || w < 0.0 || v + w > square || square <= 0.0 {
        return None;
    }
    let (v, w) = (v / square, w / square);
    let longest = ab.length_squared().max(ac.length_squared()).max((c - b).length_squared());
    Some(([1.0 - v - w, v, w], ap.dot(normal).powi(2) / (square * longest)))
}

/// Returns the weights of the point of a triangle nearest to `p`, and its squared distance.
fn nearest(p: DVec3, [a, b, c]: [DVec3; 3]) -> ([f64; 3], f64) {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let normal = ab.cross(ac);
    let square = normal.length_squared();
    let (v, w) = (ap.cross(ac).dot(normal) / square, ab.cross(ap).dot(normal) / square);
    if v >= 0.0 && w >= 0.0 && v + w <= 1.0 {
        return ([1.0 - v - w, v, w], ap.dot(normal).powi(2) / square);
    }
    let along = |from: DVec3, to: DVec3| {
        let edge = to - from;
        let share = ((p - from).dot(edge) / edge.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        (share, (from + edge * share).distance_squared(p))
    };
    let [(x, first), (y, second), (z, third)] = [along(a, b), along(b, c), along(c, a)];
    if first <= second && first <= third {
        ([1.0 - x, x, 0.0], first)
    } else if second <= third {
        ([0.0, 1.0 - y, y], second)
    } else {
        ([z, 0.0, 1.0 - z], third)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_point_is_no_farther_than_any_other() {
        let [a, b, c] = [DVec3::ZERO, DVec3::new(2.0, 0.0, 0.0), DVec3::new(0.5, 1.0, 0.0)];
        for i in 0..1000u32 {
            let random =
                |k: u32| f64::from(i.wrapping_mul(2_654_435_761).wrapping_add(k * 977) % 1000) / 200.0 - 2.0;
            let p = DVec3::new(random(1), random(2), random(3));
            let (w, distance) = nearest(p, [a, b, c]);
            let point = a * w[0] + b * w[1] + c * w[2];
            assert!((point.distance_squared(p) - distance).abs() < 1e-9 && w.iter().all(|w| *w >= 0.0));
            for j in 0..=10 {
                for k in 0..=10 - j {
                    let (v, u) = (f64::from(j) / 10.0, f64::from(k) / 10.0);
                    assert!((a + (b - a) * v + (c - a) * u).distance_squared(p) >= distance - 1e-9);
                }
            }
        }
    }
}
