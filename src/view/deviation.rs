//! What a refinement can change where the error has a direction: bounds with a shape around the error vectors.

use glam::DVec3;

use super::camera::ErrorKind;
use super::error_shape::{ErrorShape, Shape};
use super::region;
use super::seen::{Extent, Place, SeenBounds};

/// Bounds of one refinement and of all that need it, by the vectors by which points of the surface are displaced where it is left
/// out: 32 bytes.
///
/// The shape is round about the axis of the cone, which is kept even where the cone holds all directions: so an error along the
/// normal counts for less where one looks along it, and displacements within the surface for less on silhouettes. How large
/// an error may look is half of what the shape spans across the line of sight, at the worst of all lines of sight to the sphere:
///
/// ```text
///     spheroid             sqrt(across^2 + max(0, along^2 - across^2) s^2)          s: sine of the angle to the axis
///     sphere and cones     max(across, along s)
/// ```
///
/// Source: Azuma et al. 2003 (View-dependent refinement of multiresolution meshes with subdivision connectivity), Eq. 4 and 5,
/// which take distance and angle at the centre alone; at the nearest point and the worst angle tests are nested.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct DeviationBounds {
    /// Centre of the sphere, object units.
    pub centre: [f32; 3],
    /// Radius of the sphere, object units. `f32::MAX`: all of space, where no number is large enough.
    pub radius: f32,
    /// Axis of the cone and of the shape in 127ths, and the cone's half-angle in 255ths of a right angle; 255: normals of all
    /// directions. Without an axis the shape is the ball that holds it.
    pub cone: [i8; 4],
    /// Which shape.
    pub shape: ErrorShape,
    /// Half-length along the axis, object units: of a spheroid, or the distance of the cones' tips.
    pub along: f32,
    /// Half-length across the axis, object units: of a spheroid, or the sphere's radius.
    pub across: f32,
}

impl DeviationBounds {
    /// A sphere without errors, with normals of all directions and no axis.
    pub fn new(centre: [f32; 3], radius: f32, shape: ErrorShape) -> Self {
        Self { centre, radius, cone: region::ALL, shape, along: 0.0, across: 0.0 }
    }

    /// The same with normals within `half_angle` (radians) of `axis`. Where the angle is a right one or more, normals of all
    /// directions, but about that axis; where the axis is no direction, about none. The shape of errors turns with it, so set it
    /// before them.
    #[must_use]
    pub fn with_cone(mut self, axis: [f64; 3], half_angle: f64) -> Self {
        self.cone = region::pack(DVec3::from_array(axis), half_angle).unwrap_or(region::ALL);
        self
    }

    /// The same with the smallest shape around these error vectors: [`ErrorShape::fit`] about the axis; without one, the
    /// smallest ball.
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

    /// The cone's axis (unit length) and half-angle in radians; `None` where it holds all directions.
    pub fn cone(&self) -> Option<([f64; 3], f64)> {
        region::unpack(self.cone).map(|(axis, angle)| (axis.to_array(), angle))
    }

    /// The axis of the shape (unit length), and of the cone; `None` where there is none.
    pub fn axis(&self) -> Option<[f64; 3]> {
        region::axis(self.cone).try_normalize().map(|axis| axis.to_array())
    }

    /// The length of the longest error, object units.
    pub fn largest_error(&self) -> f32 {
        self.along.max(self.across)
    }

    /// Whether these bounds hold `other`'s: sphere in sphere, cone in cone, shape in shape. Of spheroids in spheres with
    /// cones it says so only where they are in the sphere.
    pub fn contains(&self, other: &Self) -> bool {
        region::sphere_holds((self.centre, self.radius), (other.centre, other.radius))
            && region::cone_holds(self.cone, other.cone)
            && self.error().holds(&other.error())
    }

    /// Lets the shape grow, about its own axis and by little, until it holds `other`'s. Sphere and cone stay.
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
        // Without a slope it looks the same from everywhere.
        let sine = if slope > 0.0 { steepest(region::axis(self.cone), self.reach(), place) } else { 0.0 };
        Extent { size: shape.size(sine), least: shape.size(0.0), largest, slope }
    }
}

/// Largest sine of the angle between an axis and a line of sight to a sphere.
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
