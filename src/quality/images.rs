//! Image difference of two meshes: pictures of both from all sides, compared pixel by pixel.
//!
//! ```text
//!               o  o  o            the first mesh is framed once: 42 views around it, one scale for all;
//!            o    ___    o         both meshes are seen through the same frames
//!            o   (   )   o
//!            o    ---    o         per view:  L1, L2   over the pixels that show either mesh
//!               o  o  o                       silhouette   pixels that show one mesh and not the other
//! ```
//!
//! Source: Southern, "Quality control tools for interactive rendering of 3D triangle meshes", sections 2.5.5 and 4.2.2
//! (K_L1, K_L2, K_sil), after Lindstrom and Turk, "Image-driven simplification", ACM TOG 19(3), 2000.
//!
//! Rules for every pixel, independent of the mesh:
//!
//! - **Views** are orthographic. All pixels are squares of equal side, so a silhouette's area is a number of pixels at
//!   any depth. A ray goes through the middle of each pixel.
//! - **Grey** is linear in the cosine of the angle between normal `n` and light `l`: `grey = 32 + 223 (1 + n.l) / 2`.
//!   The light moves with the view: from the left, above and in front, `(-1, 2, 2) / 3` as right, up and towards the
//!   eye. Even a normal facing away from the light has grey 32. Only the background is 0.
//! - **Normals** come from the surface: the mesh's own normals may be part of the error. The normal at a point is the
//!   mean over its triangles weighted by area, with vertices at equal positions welded. Triangles more than 60 degrees
//!   apart are not averaged: creases stay sharp, and removing triangles from a flat part makes no difference. Either
//!   side of a triangle is lit as the visible side.
//!
//! A pixel is computed by sums, products, quotients and square roots only. Sums over pixels are integers. So the bytes
//! are equal on every machine and for any number of threads.

use glam::DVec3;

use crate::geometry::{
    boxes,
    bvh::{Bvh, Walker},
    parallel::map_chunks,
};
use crate::mesh::Mesh;

use super::{Picture, QualityError, camera::axes, normals::smooth_normals, sight::Sight};

/// Number of views for which the vertices of a subdivided icosahedron are used.
const ICOSAHEDRAL: usize = 42;
/// Most pixels of all views, 1 byte each.
const MAX_PIXELS: usize = 1 << 30;
/// Half the picture's side in radii of the ball around the first mesh: margin for parts of the second mesh outside it.
const ROOM: f64 = 1.0625;
/// Cosine of the largest angle between triangles without a crease: 60 degrees.
const CREASE: f32 = 0.5;
/// Direction to the light: right, up, towards the eye.
const LIGHT: [f64; 3] = [-1.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0];
/// Grey level facing away from the light, and levels added facing it.
const GREY: [f32; 2] = [32.0, 223.0];
/// Rows of a unit of work.
const BAND: usize = 16;
/// Factor applied to differences to make them visible in [`ReferenceImages::compare_view`].
const STRONGER: u8 = 4;

/// Number and resolution of the views of [`image_difference`].
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct ImageOptions {
    /// Views around the mesh, at least 1; default 42. 42 views are the vertices of an icosahedron and the middles of
    /// its edges. Any other number lies along a spiral from pole to pole, in equal shares of the sphere's area.
    pub views: usize,
    /// Pixels on each side of a picture, at least 1; default 512. At most 2^30 pixels in all views.
    pub size: usize,
}

impl Default for ImageOptions {
    fn default() -> Self {
        Self { views: ICOSAHEDRAL, size: 512 }
    }
}

impl ImageOptions {
    /// Sets the number of views.
    #[must_use]
    pub fn with_views(mut self, views: usize) -> Self {
        self.views = views;
        self
    }

    /// Sets the pixels on each side of a picture.
    #[must_use]
    pub fn with_size(mut self, size: usize) -> Self {
        self.size = size;
        self
    }
}

/// Image difference of two meshes.
///
/// Grey values are in levels 0 to 255. A level is the smallest step of a usual display, so a mean below 1 cannot be
/// displayed on average. Every number is 0 for meshes with equal pictures. The measures depend on [`size`](Self::size)
/// (a silhouette's pixels grow with it): compare only results of equal size.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct ImageDifference {
    /// K_L1, grey levels: mean difference over the pixels showing either mesh; mean over the views.
    pub l1: f64,
    /// K_L2, grey levels: root of the mean square difference over the pixels showing either mesh; mean over the views.
    pub l2: f64,
    /// K_sil, pixels a view: pixels showing exactly one mesh; mean over the views.
    pub silhouette: f64,
    /// Pixels showing exactly one mesh, as a share of the pixels showing the first mesh, over all views: unlike
    /// `silhouette` it does not grow with the size. 0 if no pixel shows the first mesh.
    pub silhouette_share: f64,
    /// The largest L1 of any view, grey levels.
    pub l1_max: f64,
    /// First view with `l1_max` (its direction: [`ReferenceImages::direction`]).
    pub l1_max_view: usize,
    /// The largest L2 of any view, grey levels.
    pub l2_max: f64,
    /// First view with `l2_max`.
    pub l2_max_view: usize,
    /// The largest silhouette difference of any view, pixels.
    pub silhouette_max: u64,
    /// First view with `silhouette_max`.
    pub silhouette_max_view: usize,
    /// Views compared.
    pub views: usize,
    /// Pixels on each side of a picture.
    pub size: usize,
    /// Pixels showing the first mesh, over all views.
    pub pixels_first: u64,
    /// Pixels showing the second mesh, over all views.
    pub pixels_second: u64,
}

/// Pictures of a mesh from all sides, made once to compare many meshes with; 1 byte a pixel.
///
/// ```
/// use multires::{mesh::shapes, quality::{ImageOptions, ReferenceImages}};
/// let images = ReferenceImages::new(&shapes::icosphere(4), &ImageOptions::default().with_size(64))?;
/// let [fine, coarse] = [3, 1].map(|levels| images.difference(&shapes::icosphere(levels)));
/// let (fine, coarse) = (fine?, coarse?);
/// assert!(fine.l1 < coarse.l1 && fine.silhouette < coarse.silhouette);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct ReferenceImages {
    frame: Frame,
    /// Grey values, row by row from the top left, view by view.
    grey: Vec<u8>,
}

impl ReferenceImages {
    /// Frames a mesh and takes its pictures. O(views * size^2 * log n), 1 byte a pixel.
    ///
    /// # Errors
    /// A mesh has no surface; there is no view or no pixel, or more than 2^30 pixels in all.
    pub fn new(mesh: &Mesh, options: &ImageOptions) -> Result<Self, QualityError> {
        let &ImageOptions { views, size } = options;
        let pixels = size.checked_mul(size).and_then(|n| n.checked_mul(views)).unwrap_or(usize::MAX);
        if !(1..=MAX_PIXELS).contains(&pixels) {
            return Err(QualityError::ImagePixels { views, size, limit: MAX_PIXELS });
        }
        let surface = surface(mesh, "first")?;
        let frame = Frame::around(&surface, views, size);
        let model = Model::new(mesh, &surface, &frame);
        let bands = map_chunks(frame.bands(), 1, |band| {
            let mut grey = Vec::with_capacity(size * BAND);
            model.draw(&frame, band.start, |_, value| grey.push(value));
            grey
        });
        Ok(Self { frame, grey: bands.concat() })
    }

    /// Compares another mesh through the frames of this mesh. Parts of it outside the frames are not seen. O(views *
    /// size^2 * log n).
    ///
    /// # Errors
    /// The other mesh has no surface.
    pub fn difference(&self, other: &Mesh) -> Result<ImageDifference, QualityError> {
        let surface = surface(other, "second")?;
        let model = Model::new(other, &surface, &self.frame);
        let bands = map_chunks(self.frame.bands(), 1, |band| {
            let mut sums = Sums::default();
            model.draw(&self.frame, band.start, |pixel, value| sums.add(self.grey[pixel], value));
            sums
        });
        Ok(self.summary(&bands))
    }

    /// Returns the number of views.
    pub fn views(&self) -> usize {
        self.frame.views.len()
    }

    /// Returns the unit direction from the mesh to the eye of a view; `None` beyond the last view.
    pub fn direction(&self, view: usize) -> Option<[f64; 3]> {
        self.frame.views.get(view).map(|axes| (-axes[2]).to_array())
    }

    /// Returns the picture of a view; `None` beyond the last view.
    pub fn picture(&self, view: usize) -> Option<Picture> {
        let area = self.frame.size * self.frame.size;
        (view < self.views()).then(|| self.frame.picture(&self.grey[view * area..(view + 1) * area]))
    }

    /// Draws for inspection, side by side: a view of the mesh, of another mesh, and their difference times 4.
    ///
    /// # Errors
    /// The other mesh has no surface; `view` is out of range.
    pub fn compare_view(&self, other: &Mesh, view: usize) -> Result<Picture, QualityError> {
        let views = self.views();
        let first = self.picture(view).ok_or(QualityError::View { view, views })?;
        let surface = surface(other, "second")?;
        let model = Model::new(other, &surface, &self.frame);
        let bands = self.frame.bands() / views;
        let mut grey = Vec::with_capacity(first.pixels().len());
        for band in view * bands..(view + 1) * bands {
            model.draw(&self.frame, band, |_, value| grey.push(value));
        }
        let difference: Vec<u8> = first
            .pixels()
            .iter()
            .zip(&grey)
            .map(|(a, &b)| a[0].abs_diff(b).saturating_mul(STRONGER))
            .collect();
        Ok(Picture::beside(&[first, self.frame.picture(&grey), self.frame.picture(&difference)]))
    }

    fn summary(&self, bands: &[Sums]) -> ImageDifference {
        let views = self.views();
        let mut result = ImageDifference {
            l1: 0.0,
            l2: 0.0,
            silhouette: 0.0,
            silhouette_share: 0.0,
            l1_max: 0.0,
            l1_max_view: 0,
            l2_max: 0.0,
            l2_max_view: 0,
            silhouette_max: 0,
            silhouette_max_view: 0,
            views,
            size: self.frame.size,
            pixels_first: 0,
            pixels_second: 0,
        };
        let mut silhouette = 0;
        for (view, bands) in bands.chunks(bands.len() / views).enumerate() {
            let sums = bands.iter().copied().fold(Sums::default(), Sums::join);
            // A flat mesh seen edge on covers no pixel, and neither does its difference.
            let either = sums.either.max(1) as f64;
            let (l1, l2) = (sums.difference as f64 / either, (sums.square as f64 / either).sqrt());
            if l1 > result.l1_max {
                (result.l1_max, result.l1_max_view) = (l1, view);
            }
            if l2 > result.l2_max {
                (result.l2_max, result.l2_max_view) = (l2, view);
            }
            if sums.one > result.silhouette_max {
                (result.silhouette_max, result.silhouette_max_view) = (sums.one, view);
            }
            result.l1 += l1 / views as f64;
            result.l2 += l2 / views as f64;
            result.pixels_first += sums.first;
            result.pixels_second += sums.second;
            silhouette += sums.one;
        }
        result.silhouette = silhouette as f64 / views as f64;
        result.silhouette_share = silhouette as f64 / result.pixels_first.max(1) as f64;
        if result.pixels_first == 0 {
            result.silhouette_share = 0.0;
        }
        result
    }
}

/// Compares pictures of two meshes over views from all sides, framing the first mesh.
///
/// Symmetric if both meshes fill the same frame: the ball about the middle of the box around the surface. To compare
/// many meshes with a single mesh, use [`ReferenceImages`]: from the second comparison on it costs half.
///
/// O(views * size^2 * log n), 1 byte a pixel; the bytes are equal for any number of threads and on every machine.
///
/// # Errors
/// A mesh has no surface; there is no view or no pixel, or more than 2^30 pixels in all.
///
/// ```
/// use multires::quality::{ImageOptions, image_difference};
/// use multires::mesh::shapes;
///
/// let options = ImageOptions::default().with_views(4).with_size(64);
/// let [near, far] = [3, 1].map(|level| image_difference(&shapes::icosphere(4), &shapes::icosphere(level), &options));
/// assert!(near?.l2 < far?.l2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn image_difference(a: &Mesh, b: &Mesh, options: &ImageOptions) -> Result<ImageDifference, QualityError> {
    ReferenceImages::new(a, options)?.difference(b)
}

fn surface(mesh: &Mesh, which: &'static str) -> Result<Bvh, QualityError> {
    Bvh::new(mesh.positions(), mesh.triangles())
        .ok_or(QualityError::NoSurface { which, triangles: mesh.triangles().len() })
}

/// Integer sums over pixels: the order of addition does not matter.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    difference: u64,
    square: u64,
    first: u64,
    second: u64,
    either: u64,
    one: u64,
}

impl Sums {
    fn add(&mut self, a: u8, b: u8) {
        let difference = u64::from(a.abs_diff(b));
        self.difference += difference;
        self.square += difference * difference;
        self.first += u64::from(a != 0);
        self.second += u64::from(b != 0);
        self.either += u64::from(a != 0 || b != 0);
        self.one += u64::from((a != 0) != (b != 0));
    }

    fn join(self, other: Self) -> Self {
        Self {
            difference: self.difference + other.difference,
            square: self.square + other.square,
            first: self.first + other.first,
            second: self.second + other.second,
            either: self.either + other.either,
            one: self.one + other.one,
        }
    }
}

/// The views, and the pixels they share.
#[derive(Debug, Clone)]
struct Frame {
    centre: DVec3,
    /// Side of a pixel, object units.
    pixel: f64,
    /// Pixels on each side.
    size: usize,
    /// Right, up and forward of every view.
    views: Vec<[DVec3; 3]>,
}

impl Frame {
    fn around(surface: &Bvh, views: usize, size: usize) -> Self {
        let corners = || (0..surface.len() as u32).flat_map(|slot| surface.corners(slot));
        let [low, high] = boxes::around(corners());
        let centre = low + (high - low) * 0.5;
        let pixel = radius(surface, centre) * 2.0 * ROOM / size as f64;
        let views = directions(views).into_iter().map(|from| axes(-from, DVec3::Y)).collect();
        Self { centre, pixel, size, views }
    }

    /// Returns the number of units of work in all views; a band lies in a single view.
    fn bands(&self) -> usize {
        self.views.len() * self.size.div_ceil(BAND)
    }

    fn picture(&self, grey: &[u8]) -> Picture {
        Picture::new(self.size, self.size, grey.iter().map(|&value| [value; 3]).collect())
    }
}

/// Returns the largest distance of the surface from a point.
fn radius(surface: &Bvh, centre: DVec3) -> f64 {
    let corners = (0..surface.len() as u32).flat_map(|slot| surface.corners(slot));
    corners.map(|p| p.distance_squared(centre)).fold(0.0, f64::max).sqrt()
}

/// A mesh to draw.
struct Model<'a> {
    sight: Sight<'a>,
    /// Distance before the frame's centre at which rays start, object units: outside the surface.
    back: f64,
}

impl<'a> Model<'a> {
    fn new(mesh: &Mesh, surface: &'a Bvh, frame: &Frame) -> Self {
        let back = radius(surface, frame.centre) * 1.125;
        Self { sight: Sight { bvh: surface, normals: smooth_normals(mesh, CREASE) }, back }
    }

    /// Passes the grey value of every pixel of a band to `put`, with the pixel's index among all views.
    fn draw(&self, frame: &Frame, band: usize, mut put: impl FnMut(usize, u8)) {
        let size = frame.size;
        let bands = size.div_ceil(BAND);
        let (view, first) = (band / bands, band % bands * BAND);
        let [right, up, forward] = frame.views[view];
        let light = (right * LIGHT[0] + up * LIGHT[1] - forward * LIGHT[2]).as_vec3();
        let mut walker = self.sight.bvh.walker();
        let along = |at: usize| (at as f64 + 0.5 - size as f64 * 0.5) * frame.pixel;
        let start = frame.centre - forward * self.back;
        for y in first..(first + BAND).min(size) {
            let row = start - up * along(y);
            for x in 0..size {
                let value = self.grey(&mut walker, row + right * along(x), forward, light);
                put((view * size + y) * size + x, value);
            }
        }
    }

    fn grey(&self, walker: &mut Walker<'_>, origin: DVec3, forward: DVec3, light: glam::Vec3) -> u8 {
        self.sight.look(walker, origin, forward).map_or(0, |seen| {
            let lit = 0.5 + 0.5 * seen.normal.dot(light);
            (GREY[0] + GREY[1] * lit + 0.5).clamp(GREY[0], 255.0) as u8
        })
    }
}

/// Returns unit vectors spread evenly over the sphere.
fn directions(count: usize) -> Vec<DVec3> {
    if count == ICOSAHEDRAL { icosahedron_and_middles() } else { spiral(count) }
}

/// Returns the 12 vertices of an icosahedron and the middles of its 30 edges: the vertices after 1 subdivision.
fn icosahedron_and_middles() -> Vec<DVec3> {
    let golden = 0.5 + 0.5 * 5f64.sqrt();
    let mut corners = Vec::with_capacity(ICOSAHEDRAL);
    for [a, b] in [[1.0, golden], [1.0, -golden], [-1.0, golden], [-1.0, -golden]] {
        corners.extend([DVec3::new(0.0, a, b), DVec3::new(b, 0.0, a), DVec3::new(a, b, 0.0)]);
    }
    let mut all = corners.clone();
    for (i, &a) in corners.iter().enumerate() {
        // An edge joins vertices less than a right angle apart.
        all.extend(corners[i + 1..].iter().filter(|b| a.dot(**b) > 0.0).map(|&b| a + b));
    }
    all.into_iter().map(DVec3::normalize).collect()
}

/// Returns directions from pole to pole in steps of equal area, turning by the golden angle at each step (Swinbank and
/// Purser, "Fibonacci grids", QJRMS 132, 2006).
fn spiral(count: usize) -> Vec<DVec3> {
    // Cosine and sine of the golden angle: rotating by multiplication gives equal bits on every machine.
    const STEP: [f64; 2] = [-0.737_368_878_078_319_9, 0.675_490_294_261_523_6];
    let [mut x, mut z] = [1.0, 0.0];
    let mut directions = Vec::with_capacity(count);
    for i in 0..count {
        let y = 1.0 - (2 * i + 1) as f64 / count as f64;
        let ring = (1.0 - y * y).sqrt();
        directions.push(DVec3::new(ring * x, y, ring * z).normalize());
        [x, z] = [x * STEP[0] - z * STEP[1], x * STEP[1] + z * STEP[0]];
        let length = (x * x + z * z).sqrt();
        [x, z] = [x / length, z / length];
    }
    directions
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_are_spread_evenly() {
        for count in [1, 2, 3, 12, 41, ICOSAHEDRAL, 43, 500] {
            let all = directions(count);
            assert_eq!(all.len(), count);
            assert!(all.iter().all(|d| (d.length() - 1.0).abs() < 1e-12));
            // As dense discs of equal area on the sphere have radii of 2 / sqrt(count).
            for (i, a) in all.iter().enumerate() {
                let nearest = all.iter().enumerate().filter(|&(j, _)| j != i).map(|(_, b)| a.distance(*b));
                let nearest = nearest.fold(f64::INFINITY, f64::min);
                assert!(nearest * (count as f64).sqrt() > 2.5, "{count}: {i} has another at {nearest}");
            }
        }
        // Centred on both poles and all axes: no side is looked at more than another.
        let sum: DVec3 = directions(ICOSAHEDRAL).into_iter().sum();
        assert!(sum.length() < 1e-12, "{sum}");
        assert!(spiral(500).into_iter().sum::<DVec3>().length() < 1.0);
    }
}
