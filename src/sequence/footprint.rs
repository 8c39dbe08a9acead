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

use crate::geometry::{
    lanes::Lanes,
    lists::prefix_sum,
    parallel,
    sectors::{Sectors, least},
    sets::Sets,
    triangle::{nearest_weights, weights_below},
};
use crate::mesh::{Mesh, NONE, Topology};

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
    parallel::map(mesh.triangles().len(), 1024, one)
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
    let mut parts = Sets::new(topology.point_count());
    for corners in mesh.triangles() {
        let [a, b, c] = corners.map(|v| point_of[v as usize]);
        parts.join(a, b);
        parts.join(b, c);
    }
    point_of.iter().map(|&point| parts.find(point)).collect()
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
        prefix_sum(&mut start);
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
        if best.1 != NONE
            && let Some((weights, height)) = weights_below(&ends(best.1), point)
            && height < CLOSE
        {
            return placed(best.1, weights);
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
            triangle => placed(triangle, nearest_weights(&ends(triangle), point).0),
        }
    }
}
