//! Ray-cast pictures on the CPU: a ray a sample, soft studio lights, equal bytes on any number of cores.
//!
//! ```text
//!            rim  \                     key: white, from above the left shoulder
//!                  \  .---.             fill: faint and cool, from the right
//!     key  ------>  (      )  <- fill   rim: from behind, along outlines
//!                     '---'             sky and ground: all around, less where the surface shades itself
//!                    o eye
//! ```
//!
//! The lights move with the camera: every view of a mesh is lit alike, and views of different meshes are comparable.

use glam::{DVec3, Vec3};

use crate::geometry::{
    bvh::{Bvh, RayHit, Walker},
    hash,
    parallel::map_chunks,
};
use crate::mesh::Mesh;

use super::{Camera, Picture, QualityError, camera::View, normals::corner_normals, palette, sight::Sight};

/// Most pixels on a side.
const MAX_SIDE: usize = 1 << 14;
/// Colour of back faces: shows flipped triangles and open insides.
const BACK: [u8; 3] = [176, 120, 104];
/// Reach of ambient occlusion, as a share of the surface's size.
const OCCLUSION_REACH: f64 = 0.5;

/// Variation of normals over a triangle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Shading {
    /// The mesh's own normals if it has them; otherwise the mean of neighbouring triangles, split at creases.
    #[default]
    Smooth,
    /// A single normal for each triangle, to show the triangles.
    Flat,
}

/// Colour of the surface, sRGB.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Colours {
    /// A colour for each material id ([`palette::categorical`]); grey-blue without material ids.
    Materials,
    /// A single colour for all triangles.
    Uniform([u8; 3]),
    /// A colour per vertex, interpolated over triangles.
    PerVertex(Vec<[u8; 3]>),
    /// A colour per triangle.
    PerTriangle(Vec<[u8; 3]>),
}

/// Options of [`render`].
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct RenderOptions {
    /// Pixels in a row, 1 to 16,384; default 800.
    pub width: usize,
    /// Number of rows, 1 to 16,384; default 800.
    pub height: usize,
    /// Variation of normals over a triangle; default smooth.
    pub shading: Shading,
    /// Colour of the surface; default by material.
    pub colours: Colours,
    /// Width of triangle edges drawn over the surface, pixels; default 0, none. Edges fade where triangles are small.
    pub edges: f32,
    /// Colour of the background at the top and at the foot, sRGB; default near white to light grey.
    pub background: [[u8; 3]; 2],
    /// Casts 2 x 2 rays a pixel if set, else 1; default set.
    pub supersampling: bool,
    /// Occlusion rays a sample, 0 to 255, estimating the visible share of the sky; default 4. 0 is fastest, and looks
    /// flatter.
    pub occlusion_rays: u8,
}

impl Default for RenderOptions {
    fn default() -> Self {
        Self {
            width: 800,
            height: 800,
            shading: Shading::default(),
            colours: Colours::Materials,
            edges: 0.0,
            background: [[250, 250, 252], [226, 229, 234]],
            supersampling: true,
            occlusion_rays: 4,
        }
    }
}

impl RenderOptions {
    /// Sets width and height in pixels.
    #[must_use]
    pub fn with_size(mut self, width: usize, height: usize) -> Self {
        (self.width, self.height) = (width, height);
        self
    }

    /// Sets the shading.
    #[must_use]
    pub fn with_shading(mut self, shading: Shading) -> Self {
        self.shading = shading;
        self
    }

    /// Sets the colours.
    #[must_use]
    pub fn with_colours(mut self, colours: Colours) -> Self {
        self.colours = colours;
        self
    }

    /// Draws triangle edges of this width in pixels.
    #[must_use]
    pub fn with_edges(mut self, width: f32) -> Self {
        self.edges = width;
        self
    }

    /// Sets the background's colours at the top and at the foot.
    #[must_use]
    pub fn with_background(mut self, top: [u8; 3], foot: [u8; 3]) -> Self {
        self.background = [top, foot];
        self
    }

    /// Sets 2 x 2 rays a pixel, or 1.
    #[must_use]
    pub fn with_supersampling(mut self, on: bool) -> Self {
        self.supersampling = on;
        self
    }

    /// Sets the number of occlusion rays a sample.
    #[must_use]
    pub fn with_occlusion_rays(mut self, rays: u8) -> Self {
        self.occlusion_rays = rays;
        self
    }
}

/// Draws a mesh. A mesh without a surface gives the background.
///
/// O(pixels * rays * log n); equal bytes for any number of threads.
///
/// # Errors
/// The picture has no pixels or is too large; the camera does not define a view; the number of colours differs from the
/// number of vertices or triangles.
///
/// ```
/// use multires::quality::{Camera, RenderOptions, render};
/// use multires::mesh::shapes;
///
/// let mesh = shapes::rock(500, 1);
/// let picture = render(&mesh, &Camera::framing(&mesh, [1.0, 0.5, 1.0]), &RenderOptions::default().with_size(32, 24))?;
/// assert_eq!(picture.rgb_bytes().len(), 3 * 32 * 24);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn render(mesh: &Mesh, camera: &Camera, options: &RenderOptions) -> Result<Picture, QualityError> {
    let (width, height) = (options.width, options.height);
    if !(1..=MAX_SIDE).contains(&width) || !(1..=MAX_SIDE).contains(&height) {
        return Err(QualityError::PictureSize { width, height, limit: MAX_SIDE });
    }
    let (what, found, expected) = match &options.colours {
        Colours::PerVertex(colours) => ("vertices", colours.len(), mesh.positions().len()),
        Colours::PerTriangle(colours) => ("triangles", colours.len(), mesh.triangles().len()),
        _ => ("", 0, 0),
    };
    if found != expected {
        return Err(QualityError::ColourCount { what, found, expected });
    }
    let view = camera.view(width, height)?;
    let bvh = Bvh::new(mesh.positions(), mesh.triangles());
    let scene = bvh.as_ref().map(|bvh| Scene {
        mesh,
        sight: Sight {
            bvh,
            normals: match options.shading {
                Shading::Smooth => corner_normals(mesh),
                Shading::Flat => Vec::new(),
            },
        },
        view,
        options,
    });

    let offsets: &[[f64; 2]] = match options.supersampling {
        true => &[[0.25, 0.25], [0.75, 0.25], [0.25, 0.75], [0.75, 0.75]],
        false => &[[0.5, 0.5]],
    };
    let rows = map_chunks(height, 1, |rows| {
        let mut walker = bvh.as_ref().map(Bvh::walker);
        let y = rows.start;
        let backdrop = backdrop(options.background, (y as f32 + 0.5) / height as f32);
        let pixel = |x: usize| {
            let mut light = Vec3::ZERO;
            for (sample, offset) in offsets.iter().enumerate() {
                let at = [x as f64 + offset[0], y as f64 + offset[1]];
                let seen = match (&scene, &mut walker) {
                    (Some(scene), Some(walker)) => {
                        scene.trace(walker, at, (y * width + x) as u64, sample as u64)
                    }
                    _ => None,
                };
                light += seen.unwrap_or(backdrop);
            }
            to_srgb(light / offsets.len() as f32)
        };
        (0..width).map(pixel).collect::<Vec<_>>()
    });
    Ok(Picture::new(width, height, rows.concat()))
}

struct Scene<'a> {
    mesh: &'a Mesh,
    sight: Sight<'a>,
    view: View,
    options: &'a RenderOptions,
}

impl Scene<'_> {
    /// Returns the linear light along the ray through a point of the picture; `None` if the ray misses the mesh.
    fn trace(&self, walker: &mut Walker<'_>, at: [f64; 2], pixel: u64, sample: u64) -> Option<Vec3> {
        let direction = self.view.direction(at[0], at[1]);
        let seen = self.sight.look(walker, self.view.eye, direction)?;
        let base = if seen.front { self.colour(seen.triangle, seen.weights) } else { to_linear(BACK) };
        let point = self.view.eye + direction * seen.hit.t;
        let open = self.openness(walker, point, seen.facing, pixel, sample);
        let lit = self.light(base, seen.normal, direction.as_vec3(), open);
        let line = self.edge(&seen.hit, at);
        Some(lit.lerp(lit * 0.12, line))
    }

    fn colour(&self, triangle: usize, weights: [f32; 3]) -> Vec3 {
        match &self.options.colours {
            Colours::Materials => {
                to_linear(palette::categorical(self.mesh.materials().get(triangle).copied().unwrap_or(0)))
            }
            Colours::Uniform(colour) => to_linear(*colour),
            Colours::PerTriangle(colours) => to_linear(colours[triangle]),
            Colours::PerVertex(colours) => {
                let [a, b, c] = self.mesh.triangles()[triangle].map(|v| to_linear(colours[v as usize]));
                a * weights[0] + b * weights[1] + c * weights[2]
            }
        }
    }

    /// Returns the share of the sky seen from a point, 0 to 1.
    fn openness(&self, walker: &mut Walker<'_>, point: DVec3, normal: DVec3, pixel: u64, sample: u64) -> f32 {
        let rays = u64::from(self.options.occlusion_rays);
        if rays == 0 {
            return 1.0;
        }
        let reach = self.sight.bvh.size() * OCCLUSION_REACH;
        let from = point + normal * (self.sight.bvh.size() * 1e-5);
        let (side, across) = normal.any_orthonormal_pair();
        let start = [hash::unit(pixel, 0), hash::unit(pixel, 1)];
        let mut open = 0.0;
        for ray in sample * rays..(sample + 1) * rays {
            // Directions are even on the disc under the hemisphere, so cosine-weighted on it. They are also even over
            // all rays of a pixel (the plastic number's sequence, started anew for each pixel).
            let [across_disc, around] = [(0, 0.754_877_666_246_693), (1, 0.569_840_290_998_053)]
                .map(|(axis, step): (usize, f64)| (start[axis] + step * ray as f64).fract());
            let (radius, (sin, cos)) = (across_disc.sqrt(), (std::f64::consts::TAU * around).sin_cos());
            let up = (1.0 - across_disc).sqrt();
            let direction = side * (radius * cos) + across * (radius * sin) + normal * up;
            open +=
                walker.first_hit(from, direction, reach).map_or(1.0, |hit| (hit.t / reach).powi(2) as f32);
        }
        open / rays as f32
    }

    fn light(&self, base: Vec3, normal: Vec3, direction: Vec3, open: f32) -> Vec3 {
        let [right, up, forward] = self.view.axes.map(|axis| axis.as_vec3());
        let from = |x: f32, y: f32, z: f32| (right * x + up * y - forward * z).normalize();
        let (key, fill, rim) = (from(-0.55, 0.75, 0.65), from(0.9, 0.05, 0.55), from(0.35, 0.65, -0.75));
        // Wrapped a little around the shape, as from a large light source.
        let soft = |light: Vec3, wrap: f32| ((normal.dot(light) + wrap) / (1.0 + wrap)).max(0.0);
        let sky = 0.5 + 0.5 * normal.dot(up);
        let grazing = (1.0 + normal.dot(direction)).clamp(0.0, 1.0);
        let ambient = Vec3::new(0.13, 0.125, 0.12).lerp(Vec3::new(0.37, 0.40, 0.45), sky) * open;
        let direct = Vec3::new(1.0, 0.975, 0.94) * (1.12 * soft(key, 0.1).powf(1.3) * (0.45 + 0.55 * open))
            + Vec3::new(0.72, 0.84, 1.0) * (0.22 * soft(fill, 0.3) * (0.35 + 0.65 * open));
        let outline = Vec3::new(0.95, 0.98, 1.0) * (0.55 * soft(rim, 0.0) * grazing.powi(2) * open);
        let gloss = |light: Vec3, power: i32| {
            normal.dot((light - direction).normalize_or_zero()).max(0.0).powi(power)
        };
        let shine = (0.10 * gloss(key, 48) + 0.03 * gloss(fill, 24)) * open;
        base * (ambient + direct + outline * 0.6) + outline * 0.12 + Vec3::splat(shine)
    }

    /// Returns the coverage of a point of the picture by an edge line, 0 to 1.
    fn edge(&self, hit: &RayHit, at: [f64; 2]) -> f32 {
        // NaN counts as width 0.
        let width = f64::from(self.options.edges).max(0.0);
        if width == 0.0 {
            return 0.0;
        }
        let corners = self.sight.bvh.corners(hit.slot).map(|p| self.view.project(p));
        let [Some(a), Some(b), Some(c)] = corners else { return 0.0 };
        let size = ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])).abs().sqrt();
        let nearest =
            [(a, b), (b, c), (c, a)].into_iter().map(|(p, q)| from_line(at, p, q)).fold(f64::MAX, f64::min);
        let cover = (width * 0.5 + 0.5 - nearest).clamp(0.0, 1.0);
        let fade = (size / (8.0 * width)).clamp(0.0, 1.0);
        (cover * fade * 0.75) as f32
    }
}

/// Returns the distance of a point from a segment.
fn from_line(at: [f64; 2], p: [f64; 2], q: [f64; 2]) -> f64 {
    let (edge, offset) = ([q[0] - p[0], q[1] - p[1]], [at[0] - p[0], at[1] - p[1]]);
    let square = (edge[0] * edge[0] + edge[1] * edge[1]).max(f64::MIN_POSITIVE);
    let along = ((offset[0] * edge[0] + offset[1] * edge[1]) / square).clamp(0.0, 1.0);
    (offset[0] - edge[0] * along).hypot(offset[1] - edge[1] * along)
}

fn backdrop(colours: [[u8; 3]; 2], down: f32) -> Vec3 {
    to_linear(colours[0]).lerp(to_linear(colours[1]), down)
}

/// Converts an sRGB colour to linear light (IEC 61966-2-1).
fn to_linear(colour: [u8; 3]) -> Vec3 {
    Vec3::from_array(colour.map(|byte| {
        let x = f32::from(byte) / 255.0;
        if x <= 0.04045 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) }
    }))
}

fn to_srgb(light: Vec3) -> [u8; 3] {
    light.to_array().map(|x| {
        let x = x.clamp(0.0, 1.0);
        let x = if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 };
        (x * 255.0).round() as u8
    })
}
