//! What a refinement can change: where it lies, which way it faces, how far it moves the surface.

use std::f64::consts::FRAC_PI_2;
use std::sync::LazyLock;

use glam::DVec3;

/// Steps of the half-angle in its byte, and of an axis component.
const ANGLE_STEPS: f64 = 255.0;
const AXIS_STEPS: f64 = 127.0;
/// Radius of all of space.
const EVERYWHERE: f64 = 1e40;

/// Sine and cosine of every half-angle.
static ANGLES: LazyLock<[[f64; 2]; 256]> =
    LazyLock::new(|| std::array::from_fn(|step| (step as f64 * (FRAC_PI_2 / ANGLE_STEPS)).sin_cos().into()));

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
        Self { centre, radius, error, parametric, cone: [0, 0, 0, -1] }
    }

    /// The same with normals within `half_angle` (radians) of `axis`. Where that is no direction, or the angle a right
    /// one or more, normals of all directions.
    #[must_use]
    pub fn with_cone(mut self, axis: [f64; 3], half_angle: f64) -> Self {
        self.cone = pack(DVec3::from_array(axis), half_angle);
        self
    }

    /// The cone's axis (unit length) and half-angle in radians; `None` where it holds all directions.
    pub fn cone(&self) -> Option<([f64; 3], f64)> {
        self.unpacked().map(|(axis, angle)| (axis.to_array(), angle))
    }

    pub(super) fn unpacked(&self) -> Option<(DVec3, f64)> {
        let [x, y, z, angle] = self.cone;
        let angle = angle as u8;
        if angle == u8::MAX {
            return None;
        }
        let axis = DVec3::new(f64::from(x), f64::from(y), f64::from(z)).try_normalize()?;
        Some((axis, f64::from(angle) * (FRAC_PI_2 / ANGLE_STEPS)))
    }

    /// The radius, and more than any distance between single-precision points where that is all of space.
    #[inline]
    pub(super) fn reach(&self) -> f64 {
        if self.radius < f32::MAX { f64::from(self.radius) } else { EVERYWHERE }
    }

    /// The cone as tests take it: its axis at any length, and sine and cosine of its half-angle.
    #[inline]
    pub(super) fn facing(&self) -> Option<(DVec3, [f64; 2])> {
        let [x, y, z, angle] = self.cone;
        let angle = angle as u8;
        if angle == u8::MAX || (x | y | z) == 0 {
            return None;
        }
        Some((DVec3::new(f64::from(x), f64::from(y), f64::from(z)), ANGLES[usize::from(angle)]))
    }

    /// Whether these bounds hold `other`'s: sphere in sphere, cone in cone, no error larger.
    pub fn contains(&self, other: &Bounds) -> bool {
        let [a, b] = [self, other].map(|x| DVec3::from_array(x.centre.map(f64::from)));
        let sphere = self.radius == f32::MAX || a.distance(b) + other.reach() <= self.reach();
        let cone = match (self.unpacked(), other.unpacked()) {
            (None, _) => true,
            (Some(_), None) => false,
            (Some((a, wide)), Some((b, narrow))) => angle_between(a, b) + narrow <= wide + 1e-12,
        };
        sphere && cone && other.error <= self.error && other.parametric <= self.parametric
    }
}

/// Angle between two unit vectors, exact for small ones too.
pub(crate) fn angle_between(a: DVec3, b: DVec3) -> f64 {
    2.0 * (a - b).length().atan2((a + b).length())
}

/// Rounds an axis and widens the angle by as much as that turned it.
fn pack(axis: DVec3, half_angle: f64) -> [i8; 4] {
    let all = [0, 0, 0, -1];
    let Some(axis) = axis.try_normalize() else { return all };
    let rounded = axis.to_array().map(|x| (x * AXIS_STEPS).round() as i8);
    let Some(turned) = DVec3::from_array(rounded.map(f64::from)).try_normalize() else { return all };
    let wide = half_angle + angle_between(axis, turned);
    let steps = (wide * (ANGLE_STEPS / FRAC_PI_2)).ceil();
    if !(0.0..ANGLE_STEPS).contains(&steps) {
        return all;
    }
    let [x, y, z] = rounded;
    [x, y, z, steps as u8 as i8]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packing_only_widens() {
        let mut state = 1u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 33) as f64 / (1u64 << 31) as f64 * 2.0 - 1.0
        };
        for _ in 0..20_000 {
            let axis = DVec3::new(random(), random(), random());
            let angle = random().abs() * 1.6;
            let bounds = Bounds::new([0.0; 3], 1.0, 0.0, 0.0).with_cone(axis.to_array(), angle);
            if let Some((packed, wide)) = bounds.unpacked() {
                assert!(angle_between(packed, axis.normalize()) + angle <= wide + 1e-9);
                assert!(wide <= angle + 0.02);
            } else {
                assert!(angle > FRAC_PI_2 - 0.02);
            }
        }
    }
}
