//! A camera that goes wherever one likes.

use glam::DVec3;

use super::{Orbit, Pose};

/// An eye with a direction, and a speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fly {
    /// The eye, world units.
    pub eye: [f64; 3],
    /// World units a second; above 0.
    pub speed: f64,
    /// How far ahead what is looked at lies, where that is asked for.
    pub reach: f64,
    /// Angles as those of an [`Orbit`], whose target is straight ahead.
    around: f64,
    above: f64,
    z_up: bool,
}

impl Fly {
    /// Starts from a pose, at a speed.
    pub fn of(pose: &Pose, speed: f64, z_up: bool) -> Self {
        let orbit = Orbit::of(pose, z_up);
        let Orbit { around, above, distance, .. } = orbit;
        Self { eye: pose.eye, speed, reach: distance, around, above, z_up }
    }

    /// Where that is.
    pub fn pose(&self) -> Pose {
        let orbit = Orbit {
            target: [0.0; 3],
            distance: self.reach,
            around: self.around,
            above: self.above,
            z_up: self.z_up,
        };
        let seen = orbit.pose();
        let eye = DVec3::from_array(self.eye);
        Pose { eye: self.eye, target: (eye - DVec3::from_array(seen.eye)).to_array(), up: seen.up }
    }

    /// Turns by angles, radians.
    pub fn turn(&mut self, around: f64, above: f64) {
        let pose = self.pose();
        let mut orbit = Orbit::of(&pose, self.z_up);
        orbit.turn(around, above);
        (self.around, self.above) = (orbit.around, orbit.above);
    }

    /// Goes right, up and ahead, -1 to 1 each, for so many seconds.
    pub fn go(&mut self, way: [f64; 3], seconds: f64) {
        let [right, _, ahead] = self.pose().axes().map(DVec3::from_array);
        let up = DVec3::from_array(self.pose().up);
        let way = right * way[0] + up * way[1] + ahead * way[2];
        self.eye =
            (DVec3::from_array(self.eye) + way.clamp_length_max(1.0) * self.speed * seconds).to_array();
    }
}
