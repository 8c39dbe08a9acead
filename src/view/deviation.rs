//! Bounds with directional errors: a sphere, a cone of normals, and a shape around the error vectors.

use glam::DVec3;

use super::camera::ErrorKind;
use super::error_shape::{ErrorShape, Shape};
use super::region;
use super::seen::{Extent, Place, SeenBounds};

/// Bounds of a refinement and of all refinements needing it, with a shape around the displacements of surface points if
/// the refinement is left out: 32 bytes.
///
/// The shape is round about the axis of the cone. The axis is kept even if the cone contains all directions. So errors
/// along the normal count for less if seen along the normal, and displacements within the surface count for less on
/// silhouettes. An error's size is half the extent of the shape across the line of sight, maximal over all lines of sight
/// to the sphere:
///
/// ```text
///     spheroid             sqrt(across^2 + max(0, along^2 - across^2) s^2)          s: sine of the angle to the axis
///     sphere and cones     max(across, along s)
/// ```
///
/// Source: Azuma et al. 2003 (View-dependent refinement of multiresolution meshes with subdivision connectivity), Eq. 4
/// and 5, with distance and angle at the centre only. Here tests use the nearest point and the worst angle, and so are
/// nested.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct DeviationBounds {
    /// Centre of the sphere, object units.
    pub centre: [f32; 3],
    /// Radius of the sphere, object units. `f32::MAX` means all of space, if no number is large enough.
    pub radius: f32,
    /// Axis of the cone and of the shape in 127ths, and the cone's half-angle in 255ths of a right angle. 255: normals of
    /// all directions. Without an axis the shape is the ball containing it.
    pub cone: [i8; 4],
    /// Kind of the shape.
    pub shape: ErrorShape,
    /// Half-length along the axis, object units: semi-axis of a spheroid, or distance of the cones' tips from the centre.
    pub along: f32,
    /// Half-length across the axis, object units: semi-axis of a spheroid, or radius of the sphere with cones.
    pub across: f32,
}

impl DeviationBounds {
    /// Creates bounds from a sphere, without errors, with normals of all directions and no axis.
    pub fn new(centre: [f32; 3], radius: f32, shape: ErrorShape) -> Self {
        Self { centre, radius, cone: region::ALL, shape, along: 0.0, across: 0.0 }
    }

    /// Sets the cone: normals within `half_angle` (radians) of `axis`. If `half_angle` is a right angle or more, the cone
    /// contains all directions but keeps the axis. If `axis` has no direction, there is no axis. The shape turns with the
    /// axis, so call this before [`with_errors`](Self::with_errors).
    #[must_use]
    pub fn with_cone(mut self, axis: [f64; 3], half_angle: f64) -> Self {
        self.cone = region::pack(DVec3::from_array(axis), half_angle).unwrap_or(region::ALL);
        self
    }

    /// Sets the shape to a small shape around the error vectors, by [`ErrorShape::fit`] about the axis. Without an axis,
    /// to the smallest ball.
    #[must_use]
    pub fn with_errors(mut self, errors: impl Iterator<Item = [f64; 3]> + Clone) -> Self {
        let errors = errors.map(DVec3::from_array);
        let parts = self.axis().map(DVec3::from_array);
        [self.along, self.across] = match parts {
            Some(axis) => self.shape.fit(errors.map(|e| (e.dot(axis), e.cross(axis).length()))),
            None => {
                let [longest, _] = self.shape.fit(errors.map(|e| (e.length(), 0.0)));
                [longest, longest]
            }
        };
        self
    }

    /// Returns the cone's axis (unit length) and half-angle in radians; `None` if the cone contains all directions.
    pub fn cone(&self) -> Option<([f64; 3], f64)> {
        region::unpack(self.cone).map(|(axis, angle)| (axis.to_array(), angle))
    }

    /// Returns the axis of the shape and the cone (unit length); `None` if there is no axis.
    pub fn axis(&self) -> Option<[f64; 3]> {
        region::axis(self.cone).try_normalize().map(|axis| axis.to_array())
    }

    /// Returns the length of the longest error, object units.
    pub fn largest_error(&self) -> f32 {
        self.along.max(self.across)
    }

    /// Whether these bounds contain `other`: sphere in sphere, cone in cone, shape in shape. A spheroid counts as
    /// contained in a sphere with cones only if it lies in the sphere.
    pub fn contains(&self, other: &Self) -> bool {
        region::sphere_holds((self.centre, self.radius), (other.centre, other.radius))
            && region::cone_holds(self.cone, other.cone)
            && self.error().holds(&other.error())
    }

    /// Enlarges the shape about its own axis, by little, until it contains the shape of `other`. Sphere and cone stay.
    pub fn hold_errors_of(&mut self, other: &Self) {
        [self.along, self.across] = self.error().enlarged(&other.error());
    }

    #[inline]
    fn error(&self) -> Shape {
        Shape::new(self.shape, region::axis(self.cone), self.along, self.across)
    }
}

impl SeenBounds for DeviationBounds {
    #[inline]
    fn centre(&self) -> DVec3 {
        DVec3::from_array(self.centre.map(f64::from))
    }

    #[inline]
    fn reach(&self) -> f64 {
        region::reach(self.radius)
    }

    #[inline]
    fn facing(&self) -> Option<(DVec3, [f64; 2])> {
        region::facing(self.cone)
    }

    #[inline]
    fn extent(&self, _: ErrorKind, place: &Place) -> Extent {
        let shape = self.error();
        let (largest, slope) = (shape.largest(), shape.slope());
        // Without a slope the shape looks equal from everywhere.
        let sine = if slope > 0.0 { steepest(region::axis(self.cone), self.reach(), place) } else { 0.0 };
        Extent { size: shape.size(sine), least: shape.size(0.0), largest, slope }
    }
}

/// Returns the largest sine of the angle between an axis and a line of sight to a sphere.
#[inline]
fn steepest(axis: DVec3, reach: f64, place: &Place) -> f64 {
    if place.gap <= 0.0 {
        return 1.0;
    }
    let length = (axis.length_squared() * place.square).sqrt();
    let (cosine, sine) = (axis.dot(place.to).abs() / length, axis.cross(place.to).length() / length);
    let [half_sine, half_cosine] = place.half(reach);
    if cosine * half_cosine <= sine * half_sine {
        1.0
    } else {
        (sine * half_cosine + cosine * half_sine).min(1.0)
    }
}
