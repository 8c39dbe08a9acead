//! Scripted cameras: towards a model, around it, close to a detail, and away again.
//!
//! ```text
//!     approach   0 ...  8 s   from 3 diagonals to 0.35 in even ratios, half a turn
//!                8 ... 16     a full turn
//!               16 ... 22     to the detail
//!               22 ... 25     stays
//!               25 ... 30     away to 1 diagonal
//!     detail     still, close to the detail
//! ```

use glam::DVec3;
use multires::quality::Camera;
use multires::view::{ObjectView, View, ViewError, look_at};

/// Pixels of the screen that views are refined for.
pub const VIEWPORT: [u32; 2] = [1_280, 720];
/// Angle from top to foot, radians.
const FIELD: f64 = std::f64::consts::FRAC_PI_3;
/// Distance from the middle of a model to its surface, diagonals.
const SURFACE: f64 = 0.3;
/// Distances of the eye from the surface, diagonals: at the start, on the orbit, and at the end.
const FAR: f64 = 3.0;
const ORBIT: f64 = 0.35;
const AWAY: f64 = 1.0;

/// An eye and its target, model units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// Place of the eye.
    pub eye: DVec3,
    /// Point in the middle of the picture.
    pub target: DVec3,
}

impl Pose {
    /// Returns the view on a screen of `viewport` pixels, refined to `pixels` of error.
    ///
    /// # Errors
    /// The pose is not finite, or the screen has no pixels.
    pub fn view(&self, viewport: [u32; 2], pixels: f32) -> Result<ObjectView, ViewError> {
        let camera =
            look_at(self.eye.as_vec3().to_array(), self.target.as_vec3().to_array(), [0.0, 1.0, 0.0]);
        Ok(View::perspective(camera, FIELD as f32, viewport)?.with_tolerance_px(pixels).of_world())
    }

    /// Returns the pose moved away from the target: `times` as far.
    pub fn back(&self, times: f64) -> Self {
        Self { eye: self.target + (self.eye - self.target) * times, target: self.target }
    }

    /// Returns the camera of a picture, wider than high.
    pub fn camera(&self) -> Camera {
        Camera::new(self.eye.to_array(), self.target.to_array()).with_field_of_view(FIELD)
    }

    /// Returns the pixels of a unit of length at the depth of `point`; `None` if the point lies outside a picture of `viewport`
    /// pixels.
    pub fn pixels_at(&self, point: DVec3, viewport: [u32; 2]) -> Option<f64> {
        let ahead = (self.target - self.eye).normalize();
        let right = ahead.cross(DVec3::Y).normalize();
        let [wide, high] = viewport.map(f64::from);
        let (p, slope) = (point - self.eye, (FIELD * 0.5).tan());
        let depth = p.dot(ahead);
        let [x, y] = [p.dot(right), p.dot(right.cross(ahead))].map(|at| at.abs() / (depth * slope));
        (depth > 0.0 && y <= 1.0 && x <= wide / high).then(|| 0.5 * high / (depth * slope))
    }
}

/// A model's box, and the detail that a camera comes close to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scene {
    middle: DVec3,
    diagonal: f64,
    detail: DVec3,
    /// Unit vector from the detail to an eye close to it.
    toward: DVec3,
    /// Distance of an eye close to the detail, diagonals.
    near: f64,
}

/// A detail of a model: a point in shares of the model's box, the direction to the eye, and the eye's distance in diagonals.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Detail {
    /// Point, 0 to 1 on each axis.
    pub at: [f64; 3],
    /// Direction from the point to the eye, of any length.
    pub from: [f64; 3],
    /// Distance of the eye, diagonals.
    pub near: f64,
}

impl Default for Detail {
    /// Returns the crystal of the model that the crate makes.
    fn default() -> Self {
        Self { at: [0.5, 0.66, 0.5], from: [0.5, 0.15, 1.0], near: 0.3 }
    }
}

impl Scene {
    /// Describes a model by its box.
    pub fn new([low, high]: [[f32; 3]; 2], detail: &Detail) -> Self {
        let [low, high] = [low, high].map(|p| DVec3::from_array(p.map(f64::from)));
        Self {
            middle: (low + high) * 0.5,
            diagonal: (high - low).length().max(f64::MIN_POSITIVE),
            detail: low + (high - low) * DVec3::from_array(detail.at),
            toward: DVec3::from_array(detail.from).try_normalize().unwrap_or(DVec3::Z),
            near: detail.near,
        }
    }

    /// Returns a pose on a circle around the middle, `distance` diagonals from the surface, `turn` (radians) from above the
    /// eye close to the detail.
    fn orbit(&self, distance: f64, turn: f64) -> Pose {
        let turn = self.toward.z.atan2(self.toward.x) + turn;
        let direction = DVec3::new(turn.cos(), 0.3, turn.sin()).normalize();
        Pose { eye: self.middle + direction * ((SURFACE + distance) * self.diagonal), target: self.middle }
    }

    /// Returns the pose close to the detail.
    fn close(&self) -> Pose {
        Pose { eye: self.detail + self.toward * (self.near * self.diagonal), target: self.detail }
    }
}

/// The course of a camera.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum)]
pub enum Script {
    /// Comes near, goes around, looks at a detail, and leaves.
    #[default]
    Approach,
    /// Looks at a detail, and stays.
    Detail,
}

impl Script {
    /// Returns the length of the script, seconds.
    pub fn seconds(self) -> f64 {
        match self {
            Self::Approach => 30.0,
            Self::Detail => 5.0,
        }
    }

    /// Returns the pose at a time, seconds.
    pub fn pose(self, scene: &Scene, time: f64) -> Pose {
        use std::f64::consts::{PI, TAU};
        if self == Self::Detail {
            return scene.close();
        }
        let share = |from: f64, to: f64| ((time - from) / (to - from)).clamp(0.0, 1.0);
        let between = |a: Pose, b: Pose, share: f64| {
            let smooth = share * share * (3.0 - 2.0 * share);
            Pose { eye: a.eye.lerp(b.eye, smooth), target: a.target.lerp(b.target, smooth) }
        };
        match time {
            ..8.0 => scene.orbit(FAR * (ORBIT / FAR).powf(share(0.0, 8.0)), PI + PI * share(0.0, 8.0)),
            8.0..16.0 => scene.orbit(ORBIT, TAU * share(8.0, 16.0)),
            16.0..25.0 => between(scene.orbit(ORBIT, 0.0), scene.close(), share(16.0, 22.0)),
            _ => between(scene.close(), scene.orbit(AWAY, 0.0), share(25.0, 30.0)),
        }
    }
}
