//! Angles between the normals of two surfaces: at a point, and at the nearest point of the other surface.
//!
//! Distances miss this error: a surface folded like a paper fan may be close everywhere and shaded wrongly everywhere.

use glam::DVec3;

use crate::geometry::{
    bvh::{Bvh, Walker},
    triangle::{angle_at, unit_normal},
};
use crate::mesh::Mesh;

use super::{DistanceOptions, QualityError, sums::Sums, surface::Surface};

/// Angles over the area of a surface, degrees.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Angles {
    /// Mean angle.
    pub mean: f64,
    /// Root of the mean square angle.
    pub rms: f64,
    /// Largest angle found.
    pub max: f64,
    /// Point of the sampled surface with the largest angle, object units.
    pub max_at: [f64; 3],
}

/// Angles between the normals of a surface and the normals at the nearest points of another.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct OneSidedNormals {
    /// Between oriented normals, 0 to 180: for surfaces that agree on the outside.
    pub oriented: Angles,
    /// Between the triangles' planes, 0 to 90: for surfaces with different orientation, and for surfaces drawn from
    /// both sides.
    pub unoriented: Angles,
}

/// Angles between the normals of two surfaces in both directions, degrees.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct NormalDeviation {
    /// Samples on the first, nearest points on the second.
    pub forward: OneSidedNormals,
    /// Samples on the second, nearest points on the first.
    pub backward: OneSidedNormals,
}

/// Measures the angles between the normals of two surfaces.
///
/// Uses the normals of the triangles, not of the vertices: the shape, not its smoothing. Samples lie on faces, each
/// standing for an equal area. If the nearest point lies on an edge or a corner, the triangle with the smallest angle
/// there counts. O((n + samples) log n).
///
/// # Errors
/// A mesh has no surface; `samples` is not in 1 to 2^32 - 1.
///
/// ```
/// use multires::{mesh::Mesh, quality::{DistanceOptions, normal_deviation}};
/// let flat = Mesh::new([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], [[0, 1, 2]])?;
/// let steep = Mesh::new([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 1.0]], [[0, 2, 1]])?;
/// let turned = normal_deviation(&flat, &steep, &DistanceOptions::default().with_samples(100))?.forward;
/// assert!((turned.unoriented.mean - 45.0).abs() < 1e-6 && (turned.oriented.mean - 135.0).abs() < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn normal_deviation(
    a: &Mesh,
    b: &Mesh,
    options: &DistanceOptions,
) -> Result<NormalDeviation, QualityError> {
    options.check()?;
    let (first, second) = (Surface::named(a, "first")?, Surface::named(b, "second")?);
    Ok(NormalDeviation {
        forward: first.normal_deviation_to(&second, options)?,
        backward: second.normal_deviation_to(&first, options)?,
    })
}

impl Surface<'_> {
    /// Measures the angles from this surface's normals to another's: the forward half of [`normal_deviation`].
    ///
    /// # Errors
    /// `samples` is not in 1 to 2^32 - 1.
    pub fn normal_deviation_to(
        &self,
        other: &Surface<'_>,
        options: &DistanceOptions,
    ) -> Result<OneSidedNormals, QualityError> {
        options.check()?;
        let start = || (other.bvh().walker(), [Sums::NONE; 2]);
        let sums = self.on_faces(options, start, |(walker, sums), slot, _, point| {
            let normal = unit_normal(&self.bvh().corners(slot));
            let [oriented, unoriented] = turns(other.bvh(), walker, point, normal);
            sums[0].add(oriented, point);
            sums[1].add(unoriented, point);
        });
        let [oriented, unoriented] = [0, 1].map(|kind| {
            let joined = sums.iter().map(|(_, sums)| sums[kind]).fold(Sums::NONE, Sums::join);
            angles(joined, options.samples)
        });
        Ok(OneSidedNormals { oriented, unoriented })
    }
}

/// Returns the smallest oriented and unoriented angle, degrees, between a normal and the surface's normals at the point
/// nearest to `point`.
fn turns(bvh: &Bvh, walker: &mut Walker<'_>, point: DVec3, normal_there: DVec3) -> [f64; 2] {
    let nearest = walker.closest(point);
    let turn = |slot: u32| {
        let normal = unit_normal(&bvh.corners(slot));
        let (across, along) = (normal_there.cross(normal).length(), normal_there.dot(normal));
        [across.atan2(along).to_degrees(), across.atan2(along.abs()).to_degrees()]
    };
    let mut least = turn(nearest.slot);
    if angle_at(&bvh.corners(nearest.slot), nearest.point, 2.0 * bvh.touch()) < std::f64::consts::TAU {
        walker.touching(nearest.point, |slot| {
            let turn = turn(slot);
            least = [least[0].min(turn[0]), least[1].min(turn[1])];
        });
    }
    least
}

fn angles(sums: Sums<DVec3>, samples: usize) -> Angles {
    let (max, max_at) = sums.highest().unwrap_or_default();
    Angles { mean: sums.mean(samples), rms: sums.rms(samples), max, max_at: max_at.to_array() }
}
