//! Where one looks from: poses, the hands that move them, and paths.
//!
//! | file | idea |
//! |---|---|
//! | `mod.rs` | [`Pose`], [`Lens`], [`Tolerances`]: what a picture is taken with |
//! | `orbit.rs` | [`Orbit`]: around what one looks at |
//! | `fly.rs` | [`Fly`]: wherever one likes |
//! | `path.rs` | [`Path`]: poses frame by frame, as text, recorded and replayed |

mod fly;
mod orbit;
mod path;

pub use fly::Fly;
pub use orbit::Orbit;
pub use path::{Path, PathError, PathFrame};

use glam::DVec3;
use multires::view::{ErrorKind, View, ViewError, look_at};

use crate::renderer::{Look, Shading};

/// An eye and what it looks at, world units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// The eye.
    pub eye: [f64; 3],
    /// What is in the middle of the picture.
    pub target: [f64; 3],
    /// What is up on it.
    pub up: [f64; 3],
}

/// How much a picture shows, and in how many pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lens {
    /// Vertical field of view, radians.
    pub field_of_view: f64,
    /// Pixels across and down.
    pub size: [u32; 2],
}

impl Lens {
    /// The field of view in the narrower direction, radians: what all of a scene must fit into.
    pub fn narrow(&self) -> f64 {
        let [width, height] = self.size.map(f64::from);
        let high = (self.field_of_view * 0.5).tan();
        2.0 * (high * (width / height.max(1.0)).min(1.0)).atan()
    }
}

/// How large errors may be on the screen.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Tolerances {
    /// Anywhere, pixels; default 1.
    pub anywhere: f32,
    /// For what may be on the silhouette, pixels; default as anywhere.
    pub silhouette: Option<f32>,
    /// Which error; default geometric.
    pub error: ErrorKind,
}

impl Default for Tolerances {
    fn default() -> Self {
        Self { anywhere: 1.0, silhouette: None, error: ErrorKind::Geometric }
    }
}

impl Tolerances {
    /// With this tolerance, pixels.
    #[must_use]
    pub fn with_anywhere(mut self, pixels: f32) -> Self {
        self.anywhere = pixels;
        self
    }

    /// With this tolerance for the silhouette, pixels.
    #[must_use]
    pub fn with_silhouette(mut self, pixels: Option<f32>) -> Self {
        self.silhouette = pixels;
        self
    }

    /// With this error.
    #[must_use]
    pub fn with_error(mut self, error: ErrorKind) -> Self {
        self.error = error;
        self
    }

    fn on(&self, view: View) -> View {
        let view = view.with_tolerance_px(self.anywhere).with_error(self.error);
        match self.silhouette {
            Some(pixels) => view.with_silhouette_px(pixels),
            None => view,
        }
    }
}

impl Pose {
    /// Unit vectors to the right, up and ahead.
    pub fn axes(&self) -> [[f64; 3]; 3] {
        let [eye, target, up] = [self.eye, self.target, self.up].map(DVec3::from_array);
        let ahead = (target - eye).try_normalize().unwrap_or(DVec3::NEG_Z);
        let right = ahead.cross(up).try_normalize().unwrap_or_else(|| ahead.any_orthonormal_vector());
        [right, right.cross(ahead), ahead].map(|axis| axis.to_array())
    }

    /// What the library is told.
    ///
    /// # Errors
    /// A pose that is not finite, or a picture without pixels.
    pub fn view(&self, lens: &Lens, tolerances: &Tolerances) -> Result<View, ViewError> {
        let [eye, target, up] = [self.eye, self.target, self.up].map(|p| p.map(|x| x as f32));
        let view = View::perspective(look_at(eye, target, up), lens.field_of_view as f32, lens.size)?;
        Ok(tolerances.on(view))
    }

    /// What the renderer is told. `size` is the length over which the scene extends.
    pub fn look(&self, lens: &Lens, size: f64) -> Look {
        Look {
            eye: self.eye,
            axes: self.axes(),
            field_of_view: lens.field_of_view,
            near: (size * 1e-4).max(f64::MIN_POSITIVE),
            tolerance: 1.0,
            shading: Shading::Material,
            flat: false,
            background: [[250, 250, 252], [226, 229, 234]],
        }
    }

    /// Whether all of it is finite.
    pub fn is_finite(&self) -> bool {
        [self.eye, self.target, self.up].as_flattened().iter().all(|x| x.is_finite())
    }
}
