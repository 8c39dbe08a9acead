//! Sums over the triangles around every point, kept up to date: they make memoryless quadratic costs cheap.
//!
//! ```text
//!   cost of merging u and v at x  =  sum over triangles around either of  (m . (x - p))^2
//!                                 =  (x-u)' A_u (x-u)  +  (x-v)' A_v (x-v)  -  the same for the triangles on uv
//! ```
//!
//! where `m` is a triangle's normal, with a length chosen by [`Weight`]. The plane of a triangle around `u` runs through
//! `u`, so relative to `u` the sum is the matrix `A_u = sum mm'` alone. A candidate then takes two matrices and the
//! triangles on its edge instead of a walk around both points. In return every collapse recomputes the stars of the
//! points around it. Sums are never updated by differences, so nothing drifts.

use glam::{DVec3, Vec3};

use crate::geometry::parallel;
use crate::simplify::surface::WorkingSurface;

use super::region::at;
use super::solve::Symmetric;
use super::{MetricEvent, Pair};

/// Weight of the plane of a triangle, as a length of its normal `m`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Weight {
    /// `m . (x - p)` is six times the volume between `x` and the triangle.
    Volume,
    /// `(m . (x - p))^2` is the squared distance times twice the area.
    Area,
    /// `m . (x - p)` is the distance.
    One,
}

impl Weight {
    /// Returns the normal `m` for a normal as long as twice the area; 0 for a triangle without area.
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

/// Sums over the triangles around a point, relative to the point.
#[derive(Debug, Clone, Copy, Default)]
struct Star {
    /// Sum of squared distances to planes.
    planes: Symmetric,
    /// Sum of the normals.
    normals: DVec3,
}

/// Sums over a candidate's region as a function of `x` relative to the lost point: `planes = x'hx - 2 c'x + constant`,
/// and `normals . x - offset` (6 times the signed volume swept).
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Sum {
    pub h: Symmetric,
    pub c: DVec3,
    pub constant: f64,
    pub normals: DVec3,
    pub offset: f64,
}

impl Sum {
    /// Returns the sum of squared distances at `x`; not negative.
    #[inline]
    pub fn at(&self, x: DVec3) -> f64 {
        (x.dot(self.h.times(x)) - 2.0 * self.c.dot(x) + self.constant).max(0.0)
    }
}

/// The sums around every point.
#[derive(Debug, Clone)]
pub(super) struct StarSums {
    /// `m` of every triangle. Single precision, like the corners.
    normals: Vec<Vec3>,
    stars: Vec<Star>,
    weight: Weight,
    /// Weight of the planes upright on feature edges and creases; 0: none. With weight 1 such a plane counts like a
    /// triangle whose doubled area is the edge's squared length.
    upright: f64,
}

impl StarSums {
    pub fn new(weight: Weight, upright: f64) -> Self {
        Self { normals: Vec::new(), stars: Vec::new(), weight, upright }
    }

    /// Keeps the sums up to date: builds them at the start of a batch, and sums anew around a merged point.
    pub fn follow(&mut self, surface: &WorkingSurface, event: MetricEvent<'_>) {
        match event {
            MetricEvent::Begin(_) => self.build(surface),
            MetricEvent::Collapsing { .. } => {}
            MetricEvent::Collapsed { pair } => self.update(surface, pair.kept),
        }
    }

    /// Sums up every star. O(n).
    fn build(&mut self, surface: &WorkingSurface) {
        let normal = |t: usize| {
            let points = surface.triangle(t as u32).map(|points| points.map(|p| at(surface, p)));
            points.map_or(Vec3::ZERO, |[p, q, r]| self.weight.apply((q - p).cross(r - p)).as_vec3())
        };
        self.normals = parallel::map(surface.triangle_count(), 4096, normal);
        self.stars = parallel::map(surface.point_count(), 4096, |p| self.sum(surface, p as u32));
    }

    /// Recomputes the sums changed by a collapse into `kept`: the stars of `kept` and of its neighbours.
    fn update(&mut self, surface: &WorkingSurface, kept: u32) {
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

    /// Sum of the squared lengths of the normals around a point (and of planes upright there).
    #[inline]
    pub fn squares(&self, point: u32) -> f64 {
        self.stars[point as usize].planes.trace()
    }

    /// Returns the plane through an edge, upright on a triangle of the edge.
    fn upright(&self, surface: &WorkingSurface, point: u32, other: u32, triangle: u32) -> Symmetric {
        let edge = at(surface, other) - at(surface, point);
        let normal = self.normals[triangle as usize].as_dvec3();
        let mut planes = Symmetric::ZERO;
        planes.add_outer(self.weight.apply(edge.cross(normal).normalize_or_zero() * edge.length_squared()));
        planes.scaled(self.upright)
    }

    /// Returns the sums of a candidate's region.
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
        // The planes of the triangles on the edge contain both ends: they add nothing to the terms in `edge`.
        let c = kept.planes.times(edge);
        Sum { h, c, constant: edge.dot(c), normals, offset: kept.normals.dot(edge) }
    }
}
