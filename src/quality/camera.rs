//! A pinhole camera, placed by hand or framing a mesh.

use glam::DVec3;

use crate::mesh::Mesh;

use super::QualityError;

/// Margin around a framed mesh, as a share of the picture's half side.
const MARGIN: f64 = 0.08;

/// A pinhole camera. Right-handed: with `up` along y, looking along -z, x is to the right.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Camera {
    /// Position of the eye, object units.
    pub eye: [f64; 3],
    /// Point shown in the middle of the picture, object units; must differ from `eye`.
    pub target: [f64; 3],
    /// Direction shown upward in the picture; default y. If it is parallel to the line of sight, another axis replaces
    /// it.
    pub up: [f64; 3],
    /// Angle spanned by the picture's shorter side, radians, more than 0 and less than pi; default 0.5 (29 degrees).
    pub field_of_view: f64,
}

impl Camera {
    /// Creates a camera at `eye`, looking at `target`.
    pub fn new(eye: [f64; 3], target: [f64; 3]) -> Self {
        Self { eye, target, up: [0.0, 1.0, 0.0], field_of_view: 0.5 }
    }

    /// Creates a camera looking along `direction` (of any length) from where the mesh just fills a square picture. For
    /// a mesh without triangles it frames a box of side 2 about the origin. A direction of length 0 means -z. O(n).
    pub fn framing(mesh: &Mesh, direction: [f64; 3]) -> Self {
        let forward = DVec3::from_array(direction).try_normalize().unwrap_or(DVec3::NEG_Z);
        let axes = axes(forward, DVec3::Y);
        let mut camera = Self::new([0.0; 3], forward.to_array());
        let slope = (camera.field_of_view * 0.5).tan() * (1.0 - MARGIN);

        // A point at x to the right and depth z is inside the left and right planes of a camera at cx, cz where
        //     x - cx <= slope (z - cz)   and   cx - x <= slope (z - cz);
        // the tightest of each over all points gives the largest cz and its cx, and likewise for up.
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let mut planes = [f64::NEG_INFINITY; 4];
        let mut include = |p: DVec3| {
            let p = DVec3::from_array(axes.map(|axis| p.dot(axis)));
            (low, high) = (low.min(p), high.max(p));
            for (plane, side) in planes.iter_mut().zip([p.x, -p.x, p.y, -p.y]) {
                *plane = plane.max(side - slope * p.z);
            }
        };
        for &v in mesh.indices() {
            include(DVec3::from_array(mesh.positions()[v as usize].map(f64::from)));
        }
        if mesh.indices().is_empty() {
            (0..8).for_each(|i| {
                include(DVec3::from_array([1, 2, 4].map(|bit| if i & bit == 0 { -1.0 } else { 1.0 })))
            });
        }
        let depth = |a: f64, b: f64| -(a + b) / (2.0 * slope);
        let size = (high - low).length();
        // Never at the mesh itself, even if the mesh is flat along the line of sight.
        let room = if size > 0.0 { 0.1 * size } else { 1.0 };
        let depth = depth(planes[0], planes[1]).min(depth(planes[2], planes[3])).min(low.z - room);
        let at = |z: f64| {
            axes[0] * ((planes[0] - planes[1]) * 0.5)
                + axes[1] * ((planes[2] - planes[3]) * 0.5)
                + forward * z
        };
        (camera.eye, camera.target) = (at(depth).to_array(), at((low.z + high.z) * 0.5).to_array());
        camera
    }

    /// Sets the up direction.
    #[must_use]
    pub fn with_up(mut self, up: [f64; 3]) -> Self {
        self.up = up;
        self
    }

    /// Sets the angle spanned by the shorter side, radians. The eye stays in place.
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

/// A camera and a picture's size, prepared for projecting.
#[derive(Debug, Clone, Copy)]
pub(super) struct View {
    pub eye: DVec3,
    /// Right, up, forward.
    pub axes: [DVec3; 3],
    middle: [f64; 2],
    pixels_per_slope: f64,
}

impl View {
    /// Returns the unit direction through a point of the picture, in pixels from the top left.
    pub fn direction(&self, x: f64, y: f64) -> DVec3 {
        let (right, up) =
            ((x - self.middle[0]) / self.pixels_per_slope, (self.middle[1] - y) / self.pixels_per_slope);
        (self.axes[2] + self.axes[0] * right + self.axes[1] * up).normalize()
    }

    /// Returns where a point appears in the picture, in pixels from the top left; `None` behind the eye.
    pub fn project(&self, point: DVec3) -> Option<[f64; 2]> {
        let p = point - self.eye;
        let depth = p.dot(self.axes[2]);
        (depth > 0.0).then(|| {
            let scale = self.pixels_per_slope / depth;
            [self.middle[0] + p.dot(self.axes[0]) * scale, self.middle[1] - p.dot(self.axes[1]) * scale]
        })
    }
}

/// Returns right, up and forward of a view, orthonormal.
pub(super) fn axes(forward: DVec3, up: DVec3) -> [DVec3; 3] {
    let right = forward.cross(up);
    let right = if right.length() > 1e-6 { right.normalize() } else { forward.any_orthonormal_vector() };
    [right, right.cross(forward), forward]
}
