//! A camera path around a model: towards it, around it close by, and away again.
//!
//! ```text
//!     frame   0 ... 399   from 3 diagonals to 0.1 in even ratios, one and a half times around
//!           400 ... 499   a third of a turn at 0.1
//!           500 ... 599   back to 3, half a turn
//! ```
//!
//! Distances are to about the surface: the eye is 0.3 diagonals farther from the middle of the box. The picture has 1920 x
//! 1080 pixels and spans 60 degrees from top to foot.

use std::path::Path;

use glam::DVec3;
use multires::mesh::Mesh;
use multires::view::{View, ViewError};

/// Pixels across and down.
pub const VIEWPORT: [u32; 2] = [1920, 1080];
/// From top to foot, degrees.
pub const DEGREES: f64 = 60.0;
/// How far the surface is taken to be from the middle, diagonals.
const SURFACE: f64 = 0.3;
const FAR: f64 = 3.0;
const NEAR: f64 = 0.1;

/// Eye and target of one frame: first in diagonals about the middle of a box, then ([`Pose::about`]) in object units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    pub eye: DVec3,
    pub target: DVec3,
    pub up: DVec3,
}

/// The 600 frames. `up` is y, or z for models that stand on z = 0.
pub fn approach(up: DVec3) -> Vec<Pose> {
    (0..600).map(|frame| approach_at(frame, up)).collect()
}

fn approach_at(frame: u32, up: DVec3) -> Pose {
    let along = |first: u32, frames: f64| (f64::from(frame) - f64::from(first)) / frames;
    let (distance, turn) = match frame {
        ..400 => {
            let s = along(0, 399.0);
            (FAR * (NEAR / FAR).powf(s), 540.0 * s)
        }
        400..500 => (NEAR, 540.0 + 120.0 * along(399, 100.0)),
        _ => {
            let s = along(499, 100.0);
            (NEAR * (FAR / NEAR).powf(s), 660.0 + 180.0 * s)
        }
    };
    let (sine, cosine) = turn.to_radians().sin_cos();
    let (rise, ahead) = (20.0 + 10.0 * sine).to_radians().sin_cos();
    let [along, across] = [ahead * cosine, ahead * sine];
    let direction =
        if up == DVec3::Z { DVec3::new(along, across, rise) } else { DVec3::new(along, rise, across) };
    Pose { eye: direction * (SURFACE + distance), target: DVec3::ZERO, up }
}

/// A path from a file: seven numbers a line, the frame's number, eye and target in diagonals about the middle of the box. Lines
/// that start with `#`, and the line that names the columns, are skipped.
pub fn read(file: &Path, up: DVec3) -> Result<Vec<Pose>, String> {
    let text = std::fs::read_to_string(file).map_err(|error| format!("{}: {error}", file.display()))?;
    let mut poses = Vec::new();
    for (number, line) in text.lines().enumerate() {
        if line.trim().is_empty() || line.starts_with('#') || line.starts_with("frame") {
            continue;
        }
        let numbers: Result<Vec<f64>, _> = line.split(',').map(|field| field.trim().parse()).collect();
        match numbers.as_deref() {
            Ok([_, ex, ey, ez, tx, ty, tz]) if line.split(',').count() == 7 => {
                let (eye, target) = (DVec3::new(*ex, *ey, *ez), DVec3::new(*tx, *ty, *tz));
                poses.push(Pose { eye, target, up });
            }
            _ => {
                return Err(format!("{}:{}: want 7 numbers, found {line:?}", file.display(), number + 1));
            }
        }
    }
    if poses.is_empty() { Err(format!("{}: no frames", file.display())) } else { Ok(poses) }
}

impl Pose {
    /// The same about a mesh, in its units.
    pub fn about(&self, mesh: &Mesh) -> Self {
        let [low, high] =
            mesh.bounds().unwrap_or([[-1.0; 3], [1.0; 3]]).map(|p| DVec3::from_array(p.map(f64::from)));
        let (middle, size) = ((low + high) * 0.5, (high - low).length());
        Self { eye: middle + self.eye * size, target: middle + self.target * size, up: self.up }
    }

    /// Right, up and forward, orthonormal.
    pub fn axes(&self) -> [DVec3; 3] {
        let forward = (self.target - self.eye).try_normalize().unwrap_or(DVec3::NEG_Z);
        let right =
            forward.cross(self.up).try_normalize().unwrap_or_else(|| forward.any_orthonormal_vector());
        [right, right.cross(forward), forward]
    }

    /// A point as the eye has it: right, up, depth.
    pub fn to_eye(self, point: DVec3) -> DVec3 {
        DVec3::from_array(self.axes().map(|axis| (point - self.eye).dot(axis)))
    }

    /// Half of the picture's width and height at depth 1.
    pub fn slopes() -> [f64; 2] {
        let high = (DEGREES.to_radians() * 0.5).tan();
        [high * f64::from(VIEWPORT[0]) / f64::from(VIEWPORT[1]), high]
    }

    /// Whether a point is in the picture.
    pub fn sees(&self, point: DVec3) -> bool {
        let (p, [wide, high]) = (self.to_eye(point), Self::slopes());
        p.z > 0.0 && p.x.abs() <= p.z * wide && p.y.abs() <= p.z * high
    }

    /// The view of this frame, with a picture of that many pixels.
    pub fn view(&self, viewport: [u32; 2]) -> Result<View, ViewError> {
        let [right, up, forward] = self.axes();
        let rows = [right, up, -forward];
        let offset = rows.map(|row| -row.dot(self.eye) as f32);
        let column = |v: DVec3| rows.map(|row| row.dot(v) as f32);
        let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z].map(column);
        let matrix = [
            [x[0], x[1], x[2], 0.0],
            [y[0], y[1], y[2], 0.0],
            [z[0], z[1], z[2], 0.0],
            [offset[0], offset[1], offset[2], 1.0],
        ];
        View::perspective(matrix, DEGREES.to_radians() as f32, viewport)
    }
}
