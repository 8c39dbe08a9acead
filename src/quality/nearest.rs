//! Points on a surface: evenly spread samples, and the point nearest to a query point.
//!
//! ```text
//!     original  --o------o-----o--      sample, find what the level has nearest to it, and compare
//!                 |      |     |        whatever both carry: normals, texture coordinates, colours, labels
//!     level     --x------x-----x--
//! ```

use glam::DVec3;

use crate::geometry::{
    bvh::Bvh,
    triangle::{angle_at, weights_at},
};

use super::{DistanceOptions, QualityError, surface::Surface};

/// A point of a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct SurfacePoint {
    /// Triangle of the mesh containing the point.
    pub triangle: u32,
    /// Barycentric weights of the triangle's corners, 0 to 1, sum 1.
    pub weights: [f64; 3],
    /// Position, object units.
    pub position: [f64; 3],
    /// Distance from the query point, object units; 0 for samples.
    pub distance: f64,
}

impl Surface<'_> {
    /// Samples the surface: each sample stands for an equal area. O(samples + n).
    ///
    /// # Errors
    /// `samples` is not in 1 to 2^32 - 1.
    ///
    /// ```
    /// use multires::{mesh::shapes, quality::{DistanceOptions, Surface}};
    /// let cube = shapes::cube();
    /// let samples = Surface::new(&cube)?.samples(&DistanceOptions::default().with_samples(600))?;
    /// let top = samples.iter().filter(|sample| sample.position[1] == 1.0).count();
    /// assert!((98..=102).contains(&top), "a sixth of the area: {top}");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn samples(&self, options: &DistanceOptions) -> Result<Vec<SurfacePoint>, QualityError> {
        options.check()?;
        let triangle_of = self.bvh().triangle_of();
        let chunks = self.on_faces(options, Vec::new, |points, slot, weights, point| {
            points.push(SurfacePoint {
                triangle: triangle_of[slot as usize],
                weights,
                position: point.to_array(),
                distance: 0.0,
            });
        });
        Ok(chunks.concat())
    }

    /// Calls `visit` for every point, in order, with the point's index and the nearest point of the surface. The slice
    /// holds the nearest point once for every triangle touching it (two on an edge, more at a corner), the nearest
    /// triangle first. Points that are not finite are skipped. O(log n) expected for each point.
    ///
    /// ```
    /// use multires::{mesh::shapes, quality::Surface};
    /// let cube = shapes::cube();
    /// let mut around = [0, 0];
    /// Surface::new(&cube)?.nearest(&[[0.5, 3.0, 0.25], [3.0; 3]], |point, places| {
    ///     assert!((places[0].distance - [2.0, 12f64.sqrt()][point]).abs() < 1e-12);
    ///     around[point] = places.len();
    /// });
    /// assert!(around[0] == 1 && around[1] >= 3, "inside a face, and at a corner");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn nearest(&self, points: &[[f64; 3]], mut visit: impl FnMut(usize, &[SurfacePoint])) {
        let bvh = self.bvh();
        let mut walker = bvh.walker();
        let (mut slots, mut places) = (Vec::new(), Vec::new());
        for (number, point) in points.iter().enumerate() {
            let point = DVec3::from_array(*point);
            if !point.is_finite() {
                continue;
            }
            let nearest = walker.closest(point);
            slots.clear();
            slots.push(nearest.slot);
            let reach = 2.0 * bvh.touch();
            if angle_at(&bvh.corners(nearest.slot), nearest.point, reach) < std::f64::consts::TAU {
                walker.touching(nearest.point, |slot| {
                    if slot != nearest.slot {
                        slots.push(slot);
                    }
                });
            }
            places.clear();
            let distance = nearest.distance_squared.sqrt();
            places.extend(slots.iter().map(|&slot| place(bvh, slot, nearest.point, distance)));
            visit(number, &places);
        }
    }
}

fn place(bvh: &Bvh, slot: u32, point: DVec3, distance: f64) -> SurfacePoint {
    SurfacePoint {
        triangle: bvh.triangle_of()[slot as usize],
        weights: weights_at(&bvh.corners(slot), point),
        position: point.to_array(),
        distance,
    }
}
