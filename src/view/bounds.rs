//! Bounds of a refinement: a sphere, a cone of normals, and errors.

use glam::DVec3;

use super::region;

/// Bounds of a refinement and of all refinements needing it: 28 bytes.
///
/// The sphere contains the part of the input's surface changed by the refinement. The cone contains the normals of this
/// part. Quantised cones are widened by the rounding error.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[repr(C)]
pub struct Bounds {
    /// Centre of the sphere, object units.
    pub centre: [f32; 3],
    /// Radius of the sphere, object units. `f32::MAX` means all of space, if no number is large enough.
    pub radius: f32,
    /// Distance the drawn surface may have from the original, if this refinement is left out, measured along the normal,
    /// object units.
    pub error: f32,
    /// Upper bound of the distance from a point of the original surface to the place where it is drawn, object units.
    pub parametric: f32,
    /// Axis of the cone in 127ths, and half-angle in 255ths of a right angle. 255: normals of all directions.
    pub cone: [i8; 4],
}

impl Bounds {
    /// Creates bounds from a sphere and errors, with normals of all directions.
    pub fn new(centre: [f32; 3], radius: f32, error: f32, parametric: f32) -> Self {
        Self { centre, radius, error, parametric, cone: region::ALL }
    }

    /// Sets the cone: normals within `half_angle` (radians) of `axis`. If `axis` has no direction, or `half_angle` is a
    /// right angle or more, the cone contains all directions.
    #[must_use]
    pub fn with_cone(mut self, axis: [f64; 3], half_angle: f64) -> Self {
        let cone = region::pack(DVec3::from_array(axis), half_angle);
        self.cone = cone.filter(|cone| cone[3] != region::ANY).unwrap_or(region::ALL);
        self
    }

    /// Returns the cone's axis (unit length) and half-angle in radians; `None` if the cone contains all directions.
    pub fn cone(&self) -> Option<([f64; 3], f64)> {
        region::unpack(self.cone).map(|(axis, angle)| (axis.to_array(), angle))
    }

    /// Whether these bounds contain `other`: sphere in sphere, cone in cone, no error larger.
    pub fn contains(&self, other: &Bounds) -> bool {
        region::sphere_holds((self.centre, self.radius), (other.centre, other.radius))
            && region::cone_holds(self.cone, other.cone)
            && other.error <= self.error
            && other.parametric <= self.parametric
    }
}
