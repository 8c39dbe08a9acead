//! Sums over the triangles around every point, kept up to date: what makes memoryless quadratic costs cheap.
//!
//! ```text
//!   cost of merging u and v at x  =  sum over triangles around either of  w (n . (x - p))^2
//!                                 =  (x-u)' A_u (x-u)  +  (x-v)' A_v (x-v)  -  the same for the triangles on uv
//! ```
//!
//! The plane of a triangle around `u` runs through `u`, so relative to `u` the sum is the matrix `A_u = sum w nn'` alone.
//! A candidate then costs two matrices and the triangles on its edge instead of a walk around both points; in return
//! every collapse sums up the stars of the points around it anew. Nothing drifts: sums are never updated by differences.

use glam::DVec3;

use super::Pair;
use super::region::at;
use super::solve::Symmetric;
use crate::simplify::surface::{Corner, Surface, kind};

/// How much a triangle's plane counts, given the square of twice its area: as the factor of `cross cross'`.
pub(super) type Weight = fn(f64) -> f64;

/// The squared volume between a point and the triangle (times 36).
pub(super) fn by_area_squared(_: f64) -> f64 {
    1.0
}

/// The squared distance times twice the area.
pub(super) fn by_area(cross_squared: f64) -> f64 {
    if cross_squared > f64::MIN_POSITIVE { 1.0 / cross_squared.sqrt() } else { 0.0 }
}

/// The squared distance.
pub(super) fn equally(cross_squared: f64) -> f64 {
    if cross_squared > f64::MIN_POSITIVE { 1.0 / cross_squared } else { 0.0 }
}

/// What the triangles around a point sum up to, relative to it.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Star {
    /// Sum of weighted squared distances to planes.
    pub planes: Symmetric,
    /// Sum of the normals, each as long as twice the area.
    pub normals: DVec3,
}

/// The sums of a candidate's region as a function of `x` relative to the lost point:
/// `planes = x'hx - 2 c'x + constant`, `volume = normals . x - offset` (six times the signed volume swept).
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Sum {
    pub h: Symmetric,
    pub c: DVec3,
    pub constant: f64,
    pub normals: DVec3,
    pub offset: f64,
}

impl Sum {
    /// The weighted sum of squared distances at `x`; not negative.
    #[inline]
    pub fn at(&self, x: DVec3) -> f64 {
        (x.dot(self.h.times(x)) - 2.0 * self.c.dot(x) + self.constant).max(0.0)
    }
}

/// The sums around every point.
#[derive(Debug, Clone)]
pub(super) struct Stars {
    stars: Vec<Star>,
    weight: Weight,
    /// Weight of the planes upright on feature edges; 0: none.
    upright: f64,
}

impl Stars {
    pub fn new(weight: Weight, upright: f64) -> Self {
        Self { stars: Vec::new(), weight, upright }
    }

    /// Sums up every star. O(n).
    pub fn build(&mut self, surface: &Surface) {
        let points = 0..surface.point_count() as u32;
        #[cfg(feature = "parallel")]
        {
            use rayon::prelude::*;
            self.stars = points.into_par_iter().with_min_len(1024).map(|p| self.sum(surface, p)).collect();
        }
        #[cfg(not(feature = "parallel"))]
        {
            self.stars = points.map(|p| self.sum(surface, p)).collect();
        }
    }

    /// Sums up anew what a collapse into `kept` changed: its own star and those of its neighbours.
    pub fn update(&mut self, surface: &Surface, kept: u32) {
        self.stars[kept as usize] = self.sum(surface, kept);
        surface.for_neighbours(kept, |n| self.stars[n as usize] = self.sum(surface, n));
    }

    fn sum(&self, surface: &Surface, point: u32) -> Star {
        let mut star = Star::default();
        let origin = at(surface, point);
        let uprights = self.upright > 0.0 && surface.kind(point) & kind::FEATURE != 0;
        for corner in surface.star(point) {
            let [a, b] = corner.others.map(|o| at(surface, o) - origin);
            let normal = a.cross(b);
            star.planes.add_outer(normal, (self.weight)(normal.length_squared()));
            star.normals += normal;
            if uprights {
                for (other, edge) in corner.others.into_iter().zip([a, b]) {
                    self.add_upright(surface, point, other, edge, normal, 1.0, &mut star.planes);
                }
            }
        }
        star
    }

    /// Adds the plane through an edge, upright on one of its triangles, where the edge is a feature.
    #[allow(clippy::too_many_arguments)]
    fn add_upright(
        &self,
        surface: &Surface,
        point: u32,
        other: u32,
        edge: DVec3,
        normal: DVec3,
        sign: f64,
        planes: &mut Symmetric,
    ) {
        if surface.kind(other) & kind::FEATURE != 0
            && surface.edge_kind(point, other).is_some_and(|k| k & kind::FEATURE != 0)
        {
            // The product is as long as the edge times twice the area: weighted as a triangle of the edge's square.
            let upright = edge.cross(normal).normalize_or_zero() * edge.length_squared();
            planes.add_outer(upright, sign * self.upright * (self.weight)(upright.length_squared()));
        }
    }

    /// The sums of a candidate's region.
    #[inline]
    pub fn region(&self, surface: &Surface, pair: Pair) -> Sum {
        let (lost, kept) = (&self.stars[pair.lost as usize], &self.stars[pair.kept as usize]);
        let origin = at(surface, pair.lost);
        let edge = at(surface, pair.kept) - origin;
        let mut h = lost.planes;
        h.add(&kept.planes);
        let mut normals = lost.normals + kept.normals;
        let features = surface.kind(pair.lost) & surface.kind(pair.kept) & kind::FEATURE != 0;
        let mut remove = |corner: Corner, third: u32, side: f64| {
            let normal = edge.cross(at(surface, third) - origin) * side;
            h.add_outer(normal, -(self.weight)(normal.length_squared()));
            normals -= normal;
            if features && self.upright > 0.0 {
                let _ = corner;
                self.add_upright(surface, pair.lost, pair.kept, edge, normal, -1.0, &mut h);
            }
        };
        for corner in surface.star(pair.lost) {
            let [a, b] = corner.others;
            if a == pair.kept {
                remove(corner, b, 1.0);
            } else if b == pair.kept {
                remove(corner, a, -1.0);
            }
        }
        // The planes of the triangles on the edge hold both ends: they add nothing to the terms in `edge`.
        let c = kept.planes.times(edge);
        Sum { h, c, constant: edge.dot(c), normals, offset: kept.normals.dot(edge) }
    }
}
