//! What a refinement can change: where it lies, which way it faces, how far it moves the surface.

use glam::DVec3;

use super::region;

/// Bounds of one refinement and of all that need it: 28 bytes.
///
/// The sphere holds all of the input's surface that the refinement changes, the cone the normals of that surface.
/// Quantised cones are widened by what rounding may cost.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Bounds {
    /// Centre of the sphere, object units.
    pub centre: [f32; 3],
    /// Radius of the sphere, object units. `f32::MAX`: all of space, where no number is large enough.
    pub radius: f32,
    /// How far the drawn surface may be from the original where this refinement is left out, measured normal to it,
    /// object units.
    pub error: f32,
    /// How far a point of the original surface may be from where it is drawn, object units: an upper bound.
    pub parametric: f32,
    /// Axis of the cone in 127ths, and its half-angle in 255ths of a right angle; 255: normals of all directions.
    pub cone: [i8; 4],
}

impl Bounds {
    /// A sphere and errors, with normals of all directions.
    pub fn new(centre: [f32; 3], radius: f32, error: f32, parametric: f32) -> Self {
        Self { centre, radius, error, parametric, cone: region::ALL }
    }

    /// The same with normals within `half_angle` (radians) of `axis`. Where that is no direction, or the angle a right
    /// one or more, normals of all directions.
    #[must_use]
    pub fn with_cone(mut self, axis: [f64; 3], half_angle: f64) -> Self {
        let cone = region::pack(DVec3::from_array(axis), half_angle);
        self.cone = cone.filter(|cone| cone[3] != region::ANY).unwrap_or(region::ALL);
        self
    }

    /// The cone's axis (unit length) and half-angle in radians; `None` where it holds all directions.
    pub fn cone(&self) -> Option<([f64; 3], f64)> {
        region::unpack(self.cone).map(|(axis, angle)| (axis.to_array(), angle))
    }

    /// Whether these bounds hold `other`'s: sphere in sphere, cone in cone, no error larger.
    pub fn contains(&self, other: &Bounds) -> bool {
        region::sphere_holds((self.centre, self.radius), (other.centre, other.radius))
            && region::cone_holds(self.cone, other.cone)
            && other.error <= self.error
            && other.parametric <= self.parametric
    }
}
