//! Sums over the triangles around every point, kept up to date: what makes memoryless quadratic costs cheap.
//!
//! ```text
//!   cost of merging u and v at x  =  sum over triangles around either of  (m . (x - p))^2
//!                                 =  (x-u)' A_u (x-u)  +  (x-v)' A_v (x-v)  -  the same for the triangles on uv
//! ```
//!
//! where `m` is a triangle's normal, of a length that says how much it counts. The plane of a triangle around `u` runs
//! through `u`, so relative to `u` the sum is the matrix `A_u = sum mm'` alone. A candidate then costs two matrices and
//! the triangles on its edge instead of a walk around both points; in return every collapse sums up the stars of the
//! points around it anew. Nothing drifts: sums are never updated by differences.

use glam::{DVec3, Vec3};

use super::Pair;
use super::region::at;
use super::solve::Symmetric;
use crate::simplify::surface::WorkingSurface;

/// How much the plane of a triangle counts, as a length for its normal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Weight {
    /// `m . (x - p)` is six times the volume between `x` and the triangle.
    Volume,
    /// Its square is the squared distance times twice the area.
    Area,
    /// It is the distance.
    One,
}

impl Weight {
    /// The normal `m`, from one as long as twice the area; 0 for a triangle without area.
    #[inline]
    fn apply(self, cross: DVec3) -> DVec3 {
        let length = match self {
            Self::Volume => return cross,
            Self::Area => cross.length().sqrt(),
            Self::One => cross.length(),
        };
        if length > f64::from(f32::MIN_POSITIVE) { cross / length } else { DVec3::ZERO }
    }
}

/// What the triangles around a point sum up to, relative to it.
#[derive(Debug, Clone, Copy, Default)]
struct Star {
    /// Sum of squared distances to planes.
    planes: Symmetric,
    /// Sum of the normals.
    normals: DVec3,
}

/// The sums of a candidate's region as a function of `x` relative to the lost point:
/// `planes = x'hx - 2 c'x + constant`, and `normals . x - offset` (six times the signed volume swept).
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Sum {
    pub h: Symmetric,
    pub c: DVec3,
    pub constant: f64,
    pub normals: DVec3,
    pub offset: f64,
}

impl Sum {
    /// The sum of squared distances at `x`; not negative.
    #[inline]
    pub fn at(&self, x: DVec3) -> f64 {
        (x.dot(self.h.times(x)) - 2.0 * self.c.dot(x) + self.constant).max(0.0)
    }
}

/// The sums around every point.
#[derive(Debug, Clone)]
pub(super) struct StarSums {
    /// `m` of every triangle. Single precision: its direction is as sure as the corners are.
    normals: Vec<Vec3>,
    stars: Vec<Star>,
    weight: Weight,
    /// Weight of the planes upright on feature edges and creases, each like a triangle of the edge's square; 0: none.
    upright: f64,
}

impl StarSums {
    pub fn new(weight: Weight, upright: f64) -> Self {
        Self { normals: Vec::new(), stars: Vec::new(), weight, upright }
    }

    /// Sums up every star. O(n).
    pub fn build(&mut self, surface: &WorkingSurface) {
        let normal = |t: u32| {
            let points = surface.triangle(t).map(|points| points.map(|p| at(surface, p)));
            points.map_or(Vec3::ZERO, |[p, q, r]| self.weight.apply((q - p).cross(r - p)).as_vec3())
        };
        let (triangles, points) = (0..surface.triangle_count() as u32, 0..surface.point_count() as u32);
        #[cfg(feature = "parallel")]
        {
            use rayon::prelude::*;
            self.normals = triangles.into_par_iter().with_min_len(4096).map(normal).collect();
            self.stars = points.into_par_iter().with_min_len(4096).map(|p| self.sum(surface, p)).collect();
        }
        #[cfg(not(feature = "parallel"))]
        {
            self.normals = triangles.map(normal).collect();
            self.stars = points.map(|p| self.sum(surface, p)).collect();
        }
    }

    /// Sums up anew what a collapse into `kept` changed: its own star and those of its neighbours.
    pub fn update(&mut self, surface: &WorkingSurface, kept: u32) {
        let p = at(surface, kept);
        for corner in surface.star(kept) {
            let [a, b] = corner.others.map(|o| at(surface, o) - p);
            self.normals[corner.triangle as usize] = self.weight.apply(a.cross(b)).as_vec3();
        }
        self.stars[kept as usize] = self.sum(surface, kept);
        surface.for_neighbours(kept, |n| self.stars[n as usize] = self.sum(surface, n));
    }

    #[inline]
    fn sum(&self, surface: &WorkingSurface, point: u32) -> Star {
        let mut star = Star::default();
        for triangle in surface.star_triangles(point) {
            let normal = self.normals[triangle as usize].as_dvec3();
            star.planes.add_outer(normal);
            star.normals += normal;
        }
        if self.upright > 0.0 && surface.is_on_curve(point) {
            for corner in surface.star(point) {
                for other in corner.others {
                    if surface.is_curve_edge(point, other) {
                        star.planes.add(&self.upright(surface, point, other, corner.triangle));
                    }
                }
            }
        }
        star
    }

    /// The sum of the squared lengths of the normals around a point (and of planes upright there).
    #[inline]
    pub fn squares(&self, point: u32) -> f64 {
        self.stars[point as usize].planes.trace()
    }

    /// The plane through an edge, upright on one of its triangles.
    fn upright(&self, surface: &WorkingSurface, point: u32, other: u32, triangle: u32) -> Symmetric {
        let edge = at(surface, other) - at(surface, point);
        let normal = self.normals[triangle as usize].as_dvec3();
        let mut planes = Symmetric::ZERO;
        planes.add_outer(self.weight.apply(edge.cross(normal).normalize_or_zero() * edge.length_squared()));
        planes.scaled(self.upright)
    }

    /// The sums of a candidate's region.
    #[inline]
    pub fn region(&self, surface: &WorkingSurface, pair: Pair) -> Sum {
        let (lost, kept) = (&self.stars[pair.lost as usize], &self.stars[pair.kept as usize]);
        let edge = at(surface, pair.kept) - at(surface, pair.lost);
        let mut h = lost.planes;
        h.add(&kept.planes);
        let mut normals = lost.normals + kept.normals;
        surface.for_shared_triangles(pair.lost, pair.kept, |triangle| {
            let normal = self.normals[triangle as usize].as_dvec3();
            h.subtract_outer(normal);
            normals -= normal;
        });
        if self.upright > 0.0 && surface.is_curve_edge(pair.lost, pair.kept) {
            surface.for_shared_triangles(pair.lost, pair.kept, |triangle| {
                h.add(&self.upright(surface, pair.lost, pair.kept, triangle).scaled(-1.0));
            });
        }
        // The planes of the triangles on the edge hold both ends: they add nothing to the terms in `edge`.
        let c = kept.planes.times(edge);
        Sum { h, c, constant: edge.dot(c), normals, offset: kept.normals.dot(edge) }
    }
}
