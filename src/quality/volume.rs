//! Volume and area of a mesh, and how far its triangles are from equilateral.
//!
//! Source: Southern, "Quality control tools for interactive rendering of 3D triangle meshes", sections 2.5 and 4.2
//! (K_vol, K_sliver, and K_Tri of Frey and Borouchaki 1997). Volume is defined only for closed, consistently oriented
//! surfaces; for others there is no number.

use glam::DVec3;

use crate::mesh::Mesh;

/// Returns the enclosed volume in cubic object units, negative if the triangles face inward: [`Mesh::volume`].
///
/// `None` without triangles, or unless each edge between two positions is traversed equally often in both directions.
/// Otherwise the surface is open or inconsistently oriented, and the sum would depend on the origin. Vertices at the
/// same position count as a single vertex. Separate bodies add up; a cavity whose surface faces into it is subtracted.
/// O(n log n).
///
/// ```
/// use multires::{mesh::Mesh, quality::volume};
/// let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// let tetrahedron = Mesh::new(corners, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])?;
/// assert_eq!(volume(&tetrahedron), Some(1.0 / 6.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn volume(mesh: &Mesh) -> Option<f64> {
    mesh.volume()
}

/// Returns the volume of a level divided by the original's: K_vol as normalised by Southern (section 4.2.1). 1 if no
/// volume is lost; a level may also gain.
///
/// `None` if either mesh is open or inconsistently oriented ([`volume()`]), or the original's volume is 0. O(n log n).
///
/// ```
/// use multires::{mesh::shapes, quality::volume_ratio};
/// let ratio = volume_ratio(&shapes::icosphere(4), &shapes::icosphere(2));
/// assert!(ratio.is_some_and(|k| 0.9 < k && k < 1.0));
/// ```
pub fn volume_ratio(original: &Mesh, level: &Mesh) -> Option<f64> {
    let ratio = volume(level)? / volume(original)?;
    ratio.is_finite().then_some(ratio)
}

/// Returns the area of all triangles in square object units. O(n).
///
/// ```
/// use multires::{mesh::shapes, quality::area};
///
/// assert!((area(&shapes::icosphere(5)) / (4.0 * std::f64::consts::PI) - 1.0).abs() < 0.01);
/// ```
pub fn area(mesh: &Mesh) -> f64 {
    let position = |v: u32| DVec3::from_array(mesh.positions()[v as usize].map(f64::from));
    let twice = mesh.triangles().iter().map(|t| {
        let [a, b, c] = t.map(position);
        (b - a).cross(c - a).length()
    });
    twice.sum::<f64>() * 0.5
}

/// Shape measures of a mesh's triangles: how far they are from equilateral.
///
/// ```
/// use multires::{mesh::shapes, quality::ShapeReport};
///
/// let report = ShapeReport::new(&shapes::icosphere(0));
/// assert_eq!((report.triangles, report.degenerate), (20, 0));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct ShapeReport {
    /// Triangles measured: triangles with an area.
    pub triangles: usize,
    /// Triangles left out: triangles without an area.
    pub degenerate: usize,
    /// Mean of (sum of the edges) / (3 * shortest edge), Southern's K_sliver: 1 for equilateral triangles, above 2 is
    /// poor. Like all measures, 0 if no triangle has an area.
    pub sliver_mean: f64,
    /// Largest (sum of the edges) / (3 * shortest edge).
    pub sliver_max: f64,
    /// Mean of Q_f = (6 / sqrt(3)) * area / (half the perimeter * longest edge), Frey and Borouchaki's aspect ratio:
    /// 1 for equilateral triangles, 0 for flat ones. Southern's K_Tri (section 2.5.2).
    pub aspect_mean: f64,
    /// Smallest Q_f ([`aspect_mean`](Self::aspect_mean)).
    pub aspect_min: f64,
    /// Mean of 4 sqrt(3) * area / (sum of squared edges): 1 for equilateral triangles, 0 for collapsed ones. Unlike the
    /// sliver ratio it also detects caps (an angle near 180 degrees).
    pub compactness_mean: f64,
    /// Smallest 4 sqrt(3) * area / (sum of squared edges).
    pub compactness_min: f64,
    /// Smallest angle of any triangle, radians.
    pub angle_min: f64,
    /// Largest angle of any triangle, radians.
    pub angle_max: f64,
}

impl ShapeReport {
    /// Measures every triangle. O(n).
    pub fn new(mesh: &Mesh) -> Self {
        let position = |v: u32| DVec3::from_array(mesh.positions()[v as usize].map(f64::from));
        let mut report = Self {
            triangles: 0,
            degenerate: 0,
            sliver_mean: 0.0,
            sliver_max: 0.0,
            aspect_mean: 0.0,
            aspect_min: f64::INFINITY,
            compactness_mean: 0.0,
            compactness_min: f64::INFINITY,
            angle_min: f64::INFINITY,
            angle_max: 0.0,
        };
        for triangle in mesh.triangles() {
            let [a, b, c] = triangle.map(position);
            let normal = (b - a).cross(c - a);
            if normal == DVec3::ZERO {
                report.degenerate += 1;
                continue;
            }
            let edges = [b - a, c - b, a - c];
            let lengths = edges.map(DVec3::length);
            let shortest = lengths[0].min(lengths[1]).min(lengths[2]);
            let perimeter = lengths.iter().sum::<f64>();
            let sliver = perimeter / (3.0 * shortest);
            let longest = lengths[0].max(lengths[1]).max(lengths[2]);
            // The normal is twice the area long, and the perimeter two halves.
            let aspect = 6.0 / 3f64.sqrt() * normal.length() / (perimeter * longest);
            let squares: f64 = edges.iter().map(|e| e.length_squared()).sum();
            let compactness = 2.0 * 3f64.sqrt() * normal.length() / squares;
            report.triangles += 1;
            report.sliver_mean += sliver;
            report.sliver_max = report.sliver_max.max(sliver);
            report.aspect_mean += aspect;
            report.aspect_min = report.aspect_min.min(aspect);
            report.compactness_mean += compactness;
            report.compactness_min = report.compactness_min.min(compactness);
            for (out, back) in [(edges[0], -edges[2]), (edges[1], -edges[0]), (edges[2], -edges[1])] {
                let angle = normal.length().atan2(out.dot(back));
                report.angle_min = report.angle_min.min(angle);
                report.angle_max = report.angle_max.max(angle);
            }
        }
        if report.triangles == 0 {
            return Self { aspect_min: 0.0, compactness_min: 0.0, angle_min: 0.0, ..report };
        }
        // A sum of `count` equal numbers may round to more than `count` times the number.
        let count = report.triangles as f64;
        report.sliver_mean = (report.sliver_mean / count).min(report.sliver_max);
        report.aspect_mean = (report.aspect_mean / count).max(report.aspect_min);
        report.compactness_mean = (report.compactness_mean / count).max(report.compactness_min);
        report
    }
}
