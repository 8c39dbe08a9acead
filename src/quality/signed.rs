//! Signed distances to a closed surface, positive outside.
//!
//! ```text
//!       n1 \   p             nearest to p is an edge or a corner: neither n1 nor n2 alone need tell the side,
//!     -------\·              but the sum of all normals there does, each weighted by the angle that its
//!      inside |--> n2        triangle fills around the nearest point
//! ```
//!
//! Source: Baerentzen and Aanaes, "Signed distance computation using the angle weighted pseudonormal", TVCG 11(3),
//! 2005. Normals are summed over the triangles containing the nearest point. Triangles are found by position, so
//! duplicate vertices, T-junctions and edges with any number of triangles need no special case.

use glam::DVec3;

use crate::geometry::{
    bvh::{Bvh, Walker},
    parallel::map_chunks,
    triangle::{angle_at, unit_normal},
};
use crate::mesh::{Mesh, Topology};

use super::{
    DistanceOptions, QualityError,
    closed::check_closed,
    surface::{CHUNK, Surface, finite},
};

/// Signed distance from a surface to a closed surface, object units, positive outside.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct SignedOneSided {
    /// Mean signed distance over the area: positive if the surface lies mostly outside the other.
    pub mean: f64,
    /// Largest distance found outside the other surface; 0 if no sample is outside.
    pub outside: f64,
    /// Largest depth found inside the other surface; 0 if no sample is inside.
    pub inside: f64,
    /// Point of the largest signed distance.
    pub outside_at: [f64; 3],
    /// Point of the smallest signed distance.
    pub inside_at: [f64; 3],
    /// Share of the area inside the other surface, 0 to 1. Points on the other surface count as outside.
    pub inside_share: f64,
}

/// Signed distance of two closed surfaces in both directions.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct SignedDistance {
    /// From the first to the second: positive if the first lies outside the second.
    pub forward: SignedOneSided,
    /// From the second to the first: positive if the second lies outside the first.
    pub backward: SignedOneSided,
}

/// Measures how far two closed surfaces lie outside and inside each other. Samples as [`distance`](super::distance())
/// does.
///
/// Outside is the side from which triangles appear counter-clockwise: a mesh turned inside out gives opposite signs. If
/// bodies overlap or intersect themselves, the surface nearest to the point decides. Sheets without thickness have no
/// inside. O((n + samples) log n).
///
/// # Errors
/// A mesh has no surface, is open or is inconsistently oriented (as for [`volume()`](super::volume())); `samples` is
/// not in 1 to 2^32 - 1.
///
/// ```
/// use multires::{mesh::shapes, quality::{DistanceOptions, signed_distance}};
/// // A coarser sphere with its vertices on the same sphere lies inside.
/// let (fine, coarse) = (shapes::icosphere(4), shapes::icosphere(2));
/// let apart = signed_distance(&coarse, &fine, &DistanceOptions::default().with_samples(1000))?;
/// assert!(apart.forward.mean < 0.0 && apart.backward.mean > 0.0);
/// # Ok::<(), multires::quality::QualityError>(())
/// ```
pub fn signed_distance(
    a: &Mesh,
    b: &Mesh,
    options: &DistanceOptions,
) -> Result<SignedDistance, QualityError> {
    options.check()?;
    let (first, second) = (Surface::named(a, "first")?, Surface::named(b, "second")?);
    let (inner, outer) = (first.solid("first")?, second.solid("second")?);
    Ok(SignedDistance {
        forward: one_sided(&first, &second, outer, options),
        backward: one_sided(&second, &first, inner, options),
    })
}

/// Measures the signed distance of every vertex of a mesh from the closed surface of another, object units, positive
/// outside. O((n + m) log m).
///
/// # Errors
/// The second mesh has no surface, is open or is inconsistently oriented. The first mesh needs no surface.
pub fn vertex_signed_distances(from: &Mesh, to: &Mesh) -> Result<Vec<f64>, QualityError> {
    Surface::named(to, "second")?.signed(from.positions(), "second")
}

impl Surface<'_> {
    /// Measures how far this surface lies outside and inside a closed surface: the forward half of [`signed_distance`].
    /// This surface may be open.
    ///
    /// # Errors
    /// `other` is open or inconsistently oriented; `samples` is not in 1 to 2^32 - 1.
    pub fn signed_distance_to(
        &self,
        other: &Surface<'_>,
        options: &DistanceOptions,
    ) -> Result<SignedOneSided, QualityError> {
        options.check()?;
        Ok(one_sided(self, other, other.solid("second")?, options))
    }

    /// Returns the signed distance of every point from the surface, object units, positive outside. Points that are not
    /// finite are infinitely far outside. O(log n) expected for each point.
    ///
    /// # Errors
    /// The surface is open or inconsistently oriented.
    pub fn point_signed_distances(&self, points: &[[f32; 3]]) -> Result<Vec<f64>, QualityError> {
        self.signed(points, "given")
    }

    fn signed(&self, points: &[[f32; 3]], which: &'static str) -> Result<Vec<f64>, QualityError> {
        let solid = self.solid(which)?;
        let chunks = map_chunks(points.len(), CHUNK, |range| {
            let mut walker = self.bvh().walker();
            let distance = |p: &[f32; 3]| {
                finite(p).map_or(f64::INFINITY, |point| solid.distance(self.bvh(), &mut walker, point))
            };
            points[range].iter().map(distance).collect::<Vec<_>>()
        });
        Ok(chunks.concat())
    }
}

/// Orientation data to tell inside from outside.
#[derive(Debug)]
pub(super) struct Solid {
    /// For each slot, the coincident triangles facing as the slot's triangle, minus the triangles facing the other way.
    /// Empty if no triangles coincide.
    facing: Vec<f64>,
}

impl Solid {
    /// Prepares a surface. Fails if the surface is open or inconsistently oriented. O(n log n).
    pub(super) fn new(mesh: &Mesh, bvh: &Bvh) -> Result<Self, QualityError> {
        check_closed(mesh, "given")?;
        // Coincident triangles facing the same way leave the surface closed. Opposite triangles cancel: they are no
        // surface.
        let topology = Topology::new(mesh);
        let mut named: Vec<([u32; 3], u32, bool)> = mesh
            .triangles()
            .iter()
            .enumerate()
            .map(|(t, corners)| {
                let points = corners.map(|v| topology.point_of()[v as usize]);
                let mut sorted = points;
                sorted.sort_unstable();
                let lowest = points.iter().position(|&p| p == sorted[0]).unwrap_or(0);
                (sorted, t as u32, points[(lowest + 1) % 3] == sorted[1])
            })
            .collect();
        named.sort_unstable();
        if named.windows(2).all(|pair| pair[0].0 != pair[1].0) {
            return Ok(Self { facing: Vec::new() });
        }
        let mut net = vec![1.0; mesh.triangles().len()];
        for same in named.chunk_by(|a, b| a.0 == b.0) {
            let upward: f64 = same.iter().map(|&(_, _, up)| if up { 1.0 } else { -1.0 }).sum();
            for &(_, triangle, up) in same {
                net[triangle as usize] = if up { upward } else { -upward };
            }
        }
        Ok(Self { facing: bvh.triangle_of().iter().map(|&t| net[t as usize]).collect() })
    }

    /// Returns the signed distance of a point.
    fn distance(&self, bvh: &Bvh, walker: &mut Walker<'_>, point: DVec3) -> f64 {
        let nearest = walker.closest(point);
        let distance = nearest.distance_squared.sqrt();
        let snap = 2.0 * bvh.touch();
        let weighted = |slot: u32| {
            let corners = bvh.corners(slot);
            let facing = self.facing.get(slot as usize).copied().unwrap_or(1.0);
            let angle = angle_at(&corners, nearest.point, snap);
            (unit_normal(&corners) * (facing * angle), angle)
        };
        let (mut sum, angle) = weighted(nearest.slot);
        // Inside a triangle its own normal decides.
        if angle < std::f64::consts::TAU {
            sum = DVec3::ZERO;
            walker.touching(nearest.point, |slot| sum += weighted(slot).0);
        }
        if (point - nearest.point).dot(sum) < 0.0 { -distance } else { distance }
    }
}

/// Sums over a chunk of samples.
#[derive(Clone, Copy)]
struct Partial {
    count: usize,
    inside_count: usize,
    sum: f64,
    high: (f64, DVec3),
    low: (f64, DVec3),
}

impl Partial {
    const NONE: Self = Self {
        count: 0,
        inside_count: 0,
        sum: 0.0,
        high: (f64::NEG_INFINITY, DVec3::ZERO),
        low: (f64::INFINITY, DVec3::ZERO),
    };

    fn add(&mut self, distance: f64, point: DVec3) {
        self.count += 1;
        self.inside_count += usize::from(distance < 0.0);
        self.sum += distance;
        if distance > self.high.0 {
            self.high = (distance, point);
        }
        if distance < self.low.0 {
            self.low = (distance, point);
        }
    }

    fn join(self, other: Self) -> Self {
        Self {
            count: self.count + other.count,
            inside_count: self.inside_count + other.inside_count,
            sum: self.sum + other.sum,
            high: if other.high.0 > self.high.0 { other.high } else { self.high },
            low: if other.low.0 < self.low.0 { other.low } else { self.low },
        }
    }
}

fn one_sided(
    from: &Surface<'_>,
    to: &Surface<'_>,
    solid: &Solid,
    options: &DistanceOptions,
) -> SignedOneSided {
    let start = || (to.bvh().walker(), Partial::NONE);
    let joined = |sums: Vec<(Walker<'_>, Partial)>| {
        sums.into_iter().map(|(_, partial)| partial).fold(Partial::NONE, Partial::join)
    };
    let faces = joined(from.on_faces(options, start, |(walker, partial), _, _, point| {
        partial.add(solid.distance(to.bvh(), walker, point), point);
    }));
    let corners = joined(from.on_corners(start, |(walker, partial), _, point| {
        partial.add(solid.distance(to.bvh(), walker, point), point);
    }));
    let edges = joined(from.on_edges(options, start, |(walker, partial), point| {
        partial.add(solid.distance(to.bvh(), walker, point), point);
    }));
    let all = faces.join(corners).join(edges);
    let count = faces.count.max(1) as f64;
    SignedOneSided {
        mean: faces.sum / count,
        outside: all.high.0.max(0.0),
        inside: (-all.low.0).max(0.0),
        outside_at: all.high.1.to_array(),
        inside_at: all.low.1.to_array(),
        inside_share: faces.inside_count as f64 / count,
    }
}
