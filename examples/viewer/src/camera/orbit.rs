//! A camera that goes around what it looks at.

use glam::DVec3;

use super::Pose;

/// Steepest angle up or down, radians: short of the poles, where left and right change places.
const STEEPEST: f64 = 1.55;

/// Around a target, at a distance, by two angles about an axis that is up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Orbit {
    /// What is looked at, world units.
    pub target: [f64; 3],
    /// How far away it is; above 0.
    pub distance: f64,
    /// Angle around the axis that is up, radians; 0 is along +z (or -y where z is up).
    pub around: f64,
    /// Angle above the horizon, radians.
    pub above: f64,
    /// What is up: y, or z where set.
    pub z_up: bool,
}

impl Orbit {
    /// Around a ball, so that all of it is seen in a picture that is no higher than wide.
    pub fn framing(centre: [f64; 3], radius: f64, field_of_view: f64, z_up: bool) -> Self {
        let distance = (radius / (field_of_view * 0.5).sin()).max(1e-12);
        Self { target: centre, distance, around: 0.6, above: 0.35, z_up }
    }

    fn turned(&self, v: DVec3) -> DVec3 {
        if self.z_up { DVec3::new(v.x, -v.z, v.y) } else { v }
    }

    /// From the target to the eye, unit length.
    fn outwards(&self) -> DVec3 {
        let (sin, cos) = self.around.sin_cos();
        let (high, flat) = self.above.sin_cos();
        self.turned(DVec3::new(sin * flat, high, cos * flat))
    }

    /// Where that is.
    pub fn pose(&self) -> Pose {
        let target = DVec3::from_array(self.target);
        Pose {
            eye: (target + self.outwards() * self.distance).to_array(),
            target: self.target,
            up: self.turned(DVec3::Y).to_array(),
        }
    }

    /// The orbit that has this pose: the same target and eye, as far from the poles as it must be.
    pub fn of(pose: &Pose, z_up: bool) -> Self {
        let target = DVec3::from_array(pose.target);
        let out = DVec3::from_array(pose.eye) - target;
        let distance = out.length().max(1e-12);
        let out = out / distance;
        let v = if z_up { DVec3::new(out.x, out.z, -out.y) } else { out };
        Self {
            target: pose.target,
            distance,
            around: v.x.atan2(v.z),
            above: v.y.clamp(-1.0, 1.0).asin().clamp(-STEEPEST, STEEPEST),
            z_up,
        }
    }

    /// Turns by angles, radians.
    pub fn turn(&mut self, around: f64, above: f64) {
        self.around = (self.around + around) % std::f64::consts::TAU;
        self.above = (self.above + above).clamp(-STEEPEST, STEEPEST);
    }

    /// Comes nearer by a factor above 1, or goes away. Not beyond a millionth and a million times `size`.
    pub fn zoom(&mut self, factor: f64, size: f64) {
        let size = if size > 0.0 { size } else { 1.0 };
        if factor > 0.0 && factor.is_finite() {
            self.distance = (self.distance / factor).clamp(size * 1e-6, size * 1e6);
        }
    }

    /// Moves the target along the picture, in shares of its height (right, up).
    pub fn pan(&mut self, right: f64, up: f64, field_of_view: f64) {
        let [x, y, _] = self.pose().axes().map(DVec3::from_array);
        let high = 2.0 * self.distance * (field_of_view * 0.5).tan();
        self.target = (DVec3::from_array(self.target) + (x * right + y * up) * high).to_array();
    }
}
