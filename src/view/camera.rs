//! A camera with tolerances: eye, frustum and pixels, read from plain matrices.

use glam::{DMat3, DMat4, DVec3, DVec4};

use super::matrix::{columns, uniform_scale};

/// Error from creating a [`View`], or a view of an object.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ViewError {
    /// A matrix holds an infinity or NaN.
    #[error("the {which} matrix has entries that are not finite")]
    NotFinite {
        /// Name of the matrix.
        which: &'static str,
    },
    /// A matrix cannot be inverted.
    #[error("the {which} matrix cannot be inverted")]
    Singular {
        /// Name of the matrix.
        which: &'static str,
    },
    /// The field of view is not between 0 and 180 degrees.
    #[error("the field of view is {radians} radians, which is not between 0 and pi")]
    FieldOfView {
        /// The given field of view, radians.
        radians: f32,
    },
    /// The viewport has no pixels.
    #[error("the viewport of {width} x {height} has no pixels")]
    Viewport {
        /// Width, pixels.
        width: u32,
        /// Height, pixels.
        height: u32,
    },
    /// The last row of an object's matrix is not 0 0 0 1.
    #[error("the {which} matrix is no affine map")]
    NotAffine {
        /// Name of the matrix.
        which: &'static str,
    },
    /// A camera's matrix shears, or scales directions differently.
    #[error("the {which} matrix is not a rotation, translation and uniform scale")]
    NotUniform {
        /// Name of the matrix.
        which: &'static str,
    },
}

/// A ball refined fully inside the frustum, at any distance: the region of interest of Berkey and Song (section 3.4),
/// centred at the eye in their paper.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Focus {
    /// Centre, world units.
    pub centre: [f32; 3],
    /// Radius, world units.
    pub radius: f32,
}

/// The error in [`Bounds`](super::Bounds) used by a view.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum ErrorKind {
    /// Distance from the drawn surface to the original: keeps the shape on the screen. Measured.
    #[default]
    Geometric,
    /// Distance from each point of the surface to the place where it is drawn: keeps textures in place too. An upper
    /// bound; several times as many triangles.
    Parametric,
}

/// A camera: the eye, the frustum, and the tolerances on the screen.
///
/// Matrices are column-major (`m[column][row]`) and multiply column vectors. Only the product of view and projection
/// matters, so a perspective eye may look along any axis. Pixels are measured at the middle of the picture; off-centre
/// pixels of wide perspective pictures span less.
///
/// ```
/// use multires::view::View;
/// let world_to_eye = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, -5.0, 1.0]];
/// let view = View::perspective(world_to_eye, 60_f32.to_radians(), [1920, 1080])?
///     .with_tolerance_px(1.0)
///     .with_silhouette_px(0.5);
/// assert_eq!(view.eye(), Some([0.0, 0.0, 5.0]));
/// # Ok::<(), multires::view::ViewError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct View {
    /// The eye; of an orthographic view, the direction of view.
    pub(super) eye: Eye,
    /// Half-spaces containing the frustum: unit normals pointing inward, and offsets. World space.
    pub(super) planes: [DVec4; 5],
    pub(super) plane_count: usize,
    pub(super) tolerance: f64,
    pub(super) silhouette: f64,
    pub(super) error: ErrorKind,
    pub(super) frustum: bool,
    pub(super) back_faces: bool,
    pub(super) focus: Option<Focus>,
}

/// Origin of the rays, and pixels per unit of length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Eye {
    /// Rays from a point. `pixels` per unit at distance 1.
    At { eye: DVec3, forward: DVec3, pixels: f64 },
    /// Rays along a direction. `pixels` per unit at any distance.
    Along { forward: DVec3, pixels: f64 },
}

impl View {
    /// Creates a perspective camera from the matrix from world to eye, the vertical field of view in radians, and the
    /// viewport in pixels. The eye looks along its -z axis, as in OpenGL, Vulkan and wgpu programs.
    ///
    /// # Errors
    /// The matrix is not finite, or is not a rotation, translation and uniform scale; the field of view is not between 0
    /// and pi; the viewport has no pixels.
    pub fn perspective(
        world_to_eye: [[f32; 4]; 4],
        field_of_view: f32,
        viewport: [u32; 2],
    ) -> Result<Self, ViewError> {
        if !(field_of_view > 0.0 && field_of_view < std::f32::consts::PI) {
            return Err(ViewError::FieldOfView { radians: field_of_view });
        }
        let high = 1.0 / (f64::from(field_of_view) * 0.5).tan();
        let wide = high * f64::from(viewport[1]) / f64::from(viewport[0].max(1));
        let projection = DMat4::from_cols(
            DVec4::X * wide,
            DVec4::Y * high,
            DVec4::new(0.0, 0.0, 0.0, -1.0),
            DVec4::new(0.0, 0.0, 1.0, 0.0),
        );
        Self::new(world_to_eye, projection, viewport)
    }

    /// Creates any camera from the matrices from world to eye and from eye to clip space, and the viewport in pixels.
    ///
    /// The projection may be perspective or orthographic, off-centre, mirrored, with any range of depth, reversed, or
    /// infinite. Only the sides of the pyramid (or box) are read, not near and far. An orthographic view is taken to look
    /// along -z.
    ///
    /// # Errors
    /// A matrix is not finite; the view is not a rotation, translation and uniform scale; the projection has no eye and
    /// no direction; the viewport has no pixels.
    pub fn from_projection(
        world_to_eye: [[f32; 4]; 4],
        eye_to_clip: [[f32; 4]; 4],
        viewport: [u32; 2],
    ) -> Result<Self, ViewError> {
        let projection = columns(eye_to_clip).ok_or(ViewError::NotFinite { which: "projection" })?;
        Self::new(world_to_eye, projection, viewport)
    }

    fn new(world_to_eye: [[f32; 4]; 4], projection: DMat4, viewport: [u32; 2]) -> Result<Self, ViewError> {
        let [width, height] = viewport;
        if width == 0 || height == 0 {
            return Err(ViewError::Viewport { width, height });
        }
        let view = columns(world_to_eye).ok_or(ViewError::NotFinite { which: "view" })?;
        let mut scale = uniform_scale(&view).ok_or(ViewError::NotUniform { which: "view" })?;
        if (scale - 1.0).abs() < 1e-4 {
            // A rotation in single precision. Its scale must not change from frame to frame.
            scale = 1.0;
        }
        let to_world = view.inverse();

        // Depth is `w`. If `w` does not depend on the point, there is no eye, only a direction. Values read from the
        // projection alone stay exactly equal while the camera moves.
        let singular = ViewError::Singular { which: "projection" };
        let [x, y, w] = [projection.row(0), projection.row(1), projection.row(3)];
        let [across, down] = [f64::from(width) * 0.5, f64::from(height) * 0.5];
        let perspective = w.truncate().length_squared() > 0.0;
        let eye = if perspective {
            // The eye is the point with x = y = w = 0.
            let rows = DMat3::from_cols(x.truncate(), y.truncate(), w.truncate()).transpose();
            let determinant = rows.determinant();
            if !(determinant.is_finite() && determinant != 0.0) {
                return Err(singular);
            }
            let eye = rows.inverse() * -DVec3::new(x.w, y.w, w.w);
            let ahead = w.truncate().normalize();
            // At distance 1 straight ahead, `w` is the length of its row.
            let beside =
                |row: DVec4| row.truncate().reject_from_normalized(ahead).length() / w.truncate().length();
            Eye::At {
                eye: to_world.transform_point3(eye),
                forward: to_world.transform_vector3(ahead).normalize(),
                pixels: (beside(x) * across).max(beside(y) * down),
            }
        } else {
            let Some(axis) = x.truncate().cross(y.truncate()).try_normalize() else { return Err(singular) };
            if w.w <= 0.0 {
                return Err(singular);
            }
            // Depth may run either way. The eye is taken to look along -z.
            let ahead = if axis.z > 0.0 { -axis } else { axis };
            let pixels = (x.truncate().length() * across).max(y.truncate().length() * down) / w.w;
            Eye::Along { forward: to_world.transform_vector3(ahead).normalize(), pixels: pixels * scale }
        };
        let clip = projection * view;
        let [x, y, w] = [clip.row(0), clip.row(1), clip.row(3)];
        let front = perspective.then_some(w);
        let mut planes = [DVec4::ZERO; 5];
        let mut plane_count = 0;
        for plane in [w + x, w - x, w + y, w - y].into_iter().chain(front) {
            let length = plane.truncate().length();
            if length > 0.0 {
                planes[plane_count] = plane / length;
                plane_count += 1;
            }
        }
        let sound = match eye {
            Eye::At { eye, pixels, .. } => eye.is_finite() && pixels.is_finite() && pixels > 0.0,
            Eye::Along { pixels, .. } => pixels.is_finite() && pixels > 0.0,
        };
        if !sound || planes.iter().any(|p| !p.is_finite()) {
            return Err(singular);
        }
        Ok(Self {
            eye,
            planes,
            plane_count,
            tolerance: 1.0,
            silhouette: f64::INFINITY,
            error: ErrorKind::Geometric,
            frustum: true,
            back_faces: true,
            focus: None,
        })
    }

    /// Sets the tolerance: the largest error on the screen, pixels; default 1. At 0 or less, or NaN, every error is too
    /// large.
    #[must_use]
    pub fn with_tolerance_px(mut self, pixels: f32) -> Self {
        self.tolerance = f64::from(pixels).max(0.0);
        self
    }

    /// Sets the tolerance of parts possibly on the silhouette, pixels; default: no separate tolerance. Silhouettes use
    /// the smaller of both tolerances.
    #[must_use]
    pub fn with_silhouette_px(mut self, pixels: f32) -> Self {
        self.silhouette = f64::from(pixels).max(0.0);
        self
    }

    /// Sets the kind of error; default [`ErrorKind::Geometric`].
    #[must_use]
    pub fn with_error(mut self, kind: ErrorKind) -> Self {
        self.error = kind;
        self
    }

    /// Sets whether parts outside the picture are left coarse; default true.
    #[must_use]
    pub fn with_frustum(mut self, on: bool) -> Self {
        self.frustum = on;
        self
    }

    /// Sets whether parts facing away are left coarse; default true. Turn it off for meshes drawn from both sides.
    #[must_use]
    pub fn with_back_faces_culled(mut self, on: bool) -> Self {
        self.back_faces = on;
        self
    }

    /// Sets a ball refined fully inside the frustum.
    #[must_use]
    pub fn with_focus(mut self, focus: Option<Focus>) -> Self {
        self.focus = focus;
        self
    }

    /// Refines fully all parts inside the frustum and within `radius` (world units) of the eye, facing either way, and
    /// nothing else: the test of Berkey and Song (section 3.4). Tolerances then have no effect. An orthographic view has
    /// no eye, and refines nothing.
    #[must_use]
    pub fn with_radius_test(self, radius: f32) -> Self {
        let focus = self.eye().map(|centre| Focus { centre, radius: radius.max(0.0) });
        self.with_tolerance_px(f32::INFINITY)
            .with_silhouette_px(f32::INFINITY)
            .with_back_faces_culled(false)
            .with_frustum(true)
            .with_focus(focus)
    }

    /// Returns the eye, world units; `None` for an orthographic view.
    pub fn eye(&self) -> Option<[f32; 3]> {
        match self.eye {
            Eye::At { eye, .. } => Some(eye.as_vec3().to_array()),
            Eye::Along { .. } => None,
        }
    }

    /// Returns the direction straight ahead, unit length.
    pub fn forward(&self) -> [f32; 3] {
        match self.eye {
            Eye::At { forward, .. } | Eye::Along { forward, .. } => forward.as_vec3().to_array(),
        }
    }

    /// Returns the tolerance, pixels.
    pub fn tolerance_px(&self) -> f32 {
        self.tolerance as f32
    }

    /// Returns the pixels covered by an error of 1 world unit at `distance` (world units), at the middle of the picture.
    pub fn pixels_per_unit(&self, distance: f32) -> f32 {
        match self.eye {
            Eye::At { pixels, .. } => (pixels / f64::from(distance)) as f32,
            Eye::Along { pixels, .. } => pixels as f32,
        }
    }
}
