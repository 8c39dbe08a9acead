//! Distance from a level to the input: places on new triangles, measured against the input's triangles. Used next to
//! curves, on small meshes, and once few triangles are left.
//!
//! ```text
//!      .---.---.---.---.       A wall between two rims has no point of its own: all of them are on the rims. What lies
//!      |  /|  /|  /|  /|       between is told by the level's triangles only, whose diagonals cut through the round.
//!      '---'---'---'---'
//!
//!         ._________.          A large triangle that spans a hollow is far from the input, though every point of the
//!       _/ \_     _/ \_        input is near to some triangle.
//!             \_/
//! ```
//!
//! The nearest triangle of the input is found by walking. The walk starts at a point over the new triangle, or at its
//! corners, and moves to nearer neighbours. The distance found is never less than the true distance. The walk stops
//! once the distance is less than the known distance of the level.

use glam::Vec3;

use crate::geometry::{
    lanes::Lanes,
    sectors::{Sectors, least},
};
use crate::mesh::NONE;
use crate::simplify::metric::Pair;
use crate::simplify::surface::patch::{Facet, Patch};
use crate::simplify::surface::{HUB, WorkingSurface};

/// First places on a new triangle, as shares of its sides from the merged point: the middles of both sides, and the
/// centroid.
const FIRST_LOOKS: [[f32; 2]; 3] = [[0.5, 0.0], [0.0, 0.5], [1.0 / 3.0, 1.0 / 3.0]];
/// First places away from curves: the middle of the other side is measured on the triangle beyond.
const FEW_LOOKS: [[f32; 2]; 2] = [[0.5, 0.0], [1.0 / 3.0, 1.0 / 3.0]];
/// Further places, measured where a first place is far from the input.
const LOOKS: [[f32; 2]; 7] = [
    [0.25, 0.0],
    [0.75, 0.0],
    [0.0, 0.25],
    [0.0, 0.75],
    [1.0 / 6.0, 1.0 / 6.0],
    [2.0 / 3.0, 1.0 / 6.0],
    [1.0 / 6.0, 2.0 / 3.0],
];
/// Directions from a place to others in its triangle, along and across the sides.
const AROUND: [[f32; 2]; 6] = [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0], [1.0, -1.0], [-1.0, 1.0]];
/// Share of the known squared distance up to which a triangle is near the input.
const NEAR: f32 = 0.25;
/// Step at which the search for the farthest place ends, as a share of the triangle's sides.
const STEP: f32 = 0.03;
/// Most new triangles measured: with more, a hub moves.
const MOST_FACETS: usize = 64;

/// The triangles of the input around each of its points.
#[derive(Debug, Clone, Default)]
pub(crate) struct WayBack {
    positions: Vec<Vec3>,
    /// Start of each point's triangles; length points + 1.
    start: Vec<u32>,
    /// The two other corners of each triangle around each point.
    around: Vec<[u32; 2]>,
}

impl WayBack {
    /// Stores the triangles of a surface before any merge. O(n).
    pub fn new(surface: &WorkingSurface) -> Self {
        let points = surface.point_count();
        let mut result = Self {
            positions: Vec::with_capacity(points),
            start: Vec::with_capacity(points + 1),
            around: Vec::with_capacity(3 * surface.live_triangles()),
        };
        result.start.push(0);
        for point in 0..points as u32 {
            result.positions.push(surface.at(point));
            result.around.extend(surface.star(point).map(|corner| corner.others));
            result.start.push(result.around.len() as u32);
        }
        result
    }

    /// Returns the largest squared distance to the input from a place on the new triangles of a merge at `x`, or
    /// `known` where larger. Triangles with a corner off all curves are measured on small meshes and coarse levels
    /// only: elsewhere points of the input measure them. `on`: returns the input point nearest to a place, among points
    /// over a triangle.
    pub fn farthest(
        &self,
        surface: &WorkingSurface,
        patch: &Patch,
        pair: Pair,
        x: Vec3,
        known: f32,
        on: impl Fn(u32, Vec3) -> Option<u32>,
    ) -> f32 {
        let mut worst = known;
        let mut nearest = [NONE; 3];
        let is_coarse = surface.is_coarse();
        let is_between = |point: u32| surface.is_small() || surface.is_on_curve(point);
        let merged = is_between(pair.kept) || is_between(pair.lost);
        for facet in patch.facets().iter().take(MOST_FACETS) {
            let thorough = merged && facet.others.into_iter().all(is_between);
            if thorough || is_coarse {
                let look = |place: [f32; 2], enough: f32| {
                    let at = x + place[0] * facet.a + place[1] * facet.b;
                    let mut search = Search { back: self, at, best: f32::INFINITY, nearest, enough };
                    search.run(pair, facet, place, &on);
                    nearest = search.nearest;
                    if search.best.is_finite() { search.best } else { 0.0 }
                };
                worst = farthest_on_triangle(look, thorough, worst);
            }
        }
        worst
    }
}

/// Returns the largest result of `look` on a triangle, or `known` where larger. `look` takes a place and a squared
/// distance near enough to stop at.
fn farthest_on_triangle(mut look: impl FnMut([f32; 2], f32) -> f32, thorough: bool, known: f32) -> f32 {
    let mut farthest = (0.0, [0.0; 2]);
    let mut try_at = |place: [f32; 2], enough: f32, farthest: &mut (f32, [f32; 2])| {
        let found = look(place, enough);
        if found > farthest.0 {
            *farthest = (found, place);
        }
    };
    let (first, near) = if thorough { (&FIRST_LOOKS[..], NEAR * known) } else { (&FEW_LOOKS[..], known) };
    first.iter().for_each(|&place| try_at(place, near, &mut farthest));
    if farthest.0 > near {
        LOOKS.iter().for_each(|&place| try_at(place, known.max(farthest.0), &mut farthest));
    }
    // Between the measured places, around the farthest, where it exceeds `known`.
    let mut step = if farthest.0 > known { 0.125 } else { 0.0 };
    while step > STEP {
        let [a, b] = farthest.1;
        for [along_a, along_b] in AROUND {
            let place = [a + step * along_a, b + step * along_b];
            if place[0] >= 0.0 && place[1] >= 0.0 && place[0] + place[1] <= 1.0 {
                try_at(place, farthest.0, &mut farthest);
            }
        }
        step *= 0.5;
    }
    known.max(farthest.0)
}

/// The input's triangle nearest to a place, as far as known.
struct Search<'a> {
    back: &'a WayBack,
    at: Vec3,
    best: f32,
    /// Corners of the nearest triangle, beginning with the point it was found around.
    nearest: [u32; 3],
    enough: f32,
}

impl Search<'_> {
    /// Searches around the triangle nearest to the previous place, the nearest input point over the new triangle, and
    /// the corners; then around nearer neighbours while the distance falls.
    fn run(&mut self, pair: Pair, facet: &Facet, place: [f32; 2], on: impl Fn(u32, Vec3) -> Option<u32>) {
        if self.nearest[0] != NONE {
            self.look_around(self.nearest[0]);
        }
        if self.best > self.enough
            && let Some(point) = on(facet.triangle, self.at)
        {
            self.look_around(point);
        }
        let [a, b] = facet.others;
        for point in [pair.kept, if place[0] < place[1] { b } else { a }, pair.lost, a, b] {
            self.look_around(point);
        }
        let mut before = f32::INFINITY;
        while self.best < before && self.best > self.enough {
            before = self.best;
            self.nearest.into_iter().skip(1).for_each(|corner| self.look_around(corner));
        }
    }

    /// Searches the triangles around a point, unless the distance is near enough already.
    fn look_around(&mut self, point: u32) {
        let WayBack { positions, start, around } = self.back;
        let range = start[point as usize] as usize..start[point as usize + 1] as usize;
        if range.len() > HUB || self.best <= self.enough {
            return;
        }
        let origin = positions[point as usize];
        let p = Lanes::splat(self.at - origin);
        for four in around[range].chunks(4) {
            // Lanes without a triangle repeat the last triangle.
            let others = |i: usize| four[i.min(four.len() - 1)];
            let corner = |end: usize| Lanes::gather(|i| positions[others(i)[end] as usize] - origin);
            let [a, b] = [corner(0), corner(1)];
            let sectors = Sectors::new(a, b, a.cross(&b));
            let (distance, lane) = least(sectors.heights(&p).min(sectors.sides(&p)));
            if distance < self.best {
                let [b, c] = others(lane);
                (self.best, self.nearest) = (distance, [point, b, c]);
                if distance <= self.enough {
                    return;
                }
            }
        }
    }
}
