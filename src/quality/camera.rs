//! Where a picture is taken from: a pinhole camera, placed by hand or so that a mesh fills the picture.

use glam::DVec3;

use crate::mesh::Mesh;

use super::QualityError;

/// Room left around a framed mesh: share of the picture's half side.
const MARGIN: f64 = 0.08;

/// A pinhole camera. Right-handed: with `up` along y, looking along -z, x is to the right.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Camera {
    /// Where it is, object units.
    pub eye: [f64; 3],
    /// What is in the middle of the picture; not where the eye is.
    pub target: [f64; 3],
    /// What is up in the picture; default y. Along the line of sight another axis stands in.
    pub up: [f64; 3],
    /// Angle that the picture's shorter side spans, radians, more than 0 and less than pi; default 0.5 (29 degrees).
    pub field_of_view: f64,
}

impl Camera {
    /// A camera at `eye` that looks at `target`.
    pub fn new(eye: [f64; 3], target: [f64; 3]) -> Self {
        Self { eye, target, up: [0.0, 1.0, 0.0], field_of_view: 0.5 }
    }

    /// A camera that looks along `direction` (of any length) and is so far away that the mesh just fills a square
    /// picture. A mesh without triangles, or a direction of no length, gets a view along -z. O(n).
    pub fn framing(mesh: &Mesh, direction: [f64; 3]) -> Self {
        let [low, high] =
            mesh.bounds().unwrap_or([[-1.0; 3], [1.0; 3]]).map(|p| DVec3::from_array(p.map(f64::from)));
        let target = low + (high - low) * 0.5;
        let forward = DVec3::from_array(direction).try_normalize().unwrap_or(DVec3::NEG_Z);
        let mut camera = Self::new((target - forward).to_array(), target.to_array());
        let axes = axes(forward, DVec3::Y);
        let slope = (camera.field_of_view * 0.5).tan() * (1.0 - MARGIN);
        let distance = mesh
            .indices()
            .iter()
            .map(|&v| {
                let p = DVec3::from_array(mesh.positions()[v as usize].map(f64::from)) - target;
                p.dot(axes[0]).abs().max(p.dot(axes[1]).abs()) / slope - p.dot(axes[2])
            })
            .fold(0.0, f64::max);
        let distance = if distance > 0.0 { distance } else { 1.0 };
        camera.eye = (target - forward * distance).to_array();
        camera
    }

    /// With another direction up.
    #[must_use]
    pub fn with_up(mut self, up: [f64; 3]) -> Self {
        self.up = up;
        self
    }

    /// With another angle across the shorter side, radians. The eye stays where it is.
    #[must_use]
    pub fn with_field_of_view(mut self, field_of_view: f64) -> Self {
        self.field_of_view = field_of_view;
        self
    }

    pub(super) fn view(&self, width: usize, height: usize) -> Result<View, QualityError> {
        let refuse = |what, why| Err(QualityError::Camera { what, why });
        for (what, v) in [("eye", self.eye), ("target", self.target), ("up", self.up)] {
            if !v.iter().all(|x| x.abs() < 1e100) {
                return refuse(what, "it is not finite");
            }
        }
        if !(self.field_of_view > 0.0 && self.field_of_view < std::f64::consts::PI) {
            return refuse("field of view", "it is not between 0 and pi");
        }
        let eye = DVec3::from_array(self.eye);
        let Some(forward) = (DVec3::from_array(self.target) - eye).try_normalize() else {
            return refuse("target", "it is where the eye is");
        };
        let axes = axes(forward, DVec3::from_array(self.up).normalize_or(DVec3::Y));
        let pixels_per_slope = width.min(height) as f64 * 0.5 / (self.field_of_view * 0.5).tan();
        Ok(View { eye, axes, middle: [width as f64 * 0.5, height as f64 * 0.5], pixels_per_slope })
    }
}

/// A camera and a picture's size, ready for use.
#[derive(Debug, Clone, Copy)]
pub(super) struct View {
    pub eye: DVec3,
    /// Right, up, forward.
    pub axes: [DVec3; 3],
    middle: [f64; 2],
    pixels_per_slope: f64,
}

impl View {
    /// Unit direction through a point of the picture, in pixels from the top left.
    pub fn direction(&self, x: f64, y: f64) -> DVec3 {
        let (right, up) =
            ((x - self.middle[0]) / self.pixels_per_slope, (self.middle[1] - y) / self.pixels_per_slope);
        (self.axes[2] + self.axes[0] * right + self.axes[1] * up).normalize()
    }

    /// Where a point is in the picture, in pixels from the top left; `None` behind the eye.
    pub fn project(&self, point: DVec3) -> Option<[f64; 2]> {
        let p = point - self.eye;
        let depth = p.dot(self.axes[2]);
        (depth > 0.0).then(|| {
            let scale = self.pixels_per_slope / depth;
            [self.middle[0] + p.dot(self.axes[0]) * scale, self.middle[1] - p.dot(self.axes[1]) * scale]
        })
    }
}

/// Right, up and forward of a view, orthonormal.
fn axes(forward: DVec3, up: DVec3) -> [DVec3; 3] {
    let right = forward.cross(up);
    let right = if right.length() > 1e-6 { right.normalize() } else { forward.any_orthonormal_vector() };
    [right, right.cross(forward), forward]
}
