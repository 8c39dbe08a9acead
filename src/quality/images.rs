//! How different two meshes look: pictures of both from all sides, compared pixel by pixel.
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
//! What a pixel shows, the same for every mesh:
//!
//! - **Views** are orthographic. A pixel is a square of the same side everywhere, so an area of the silhouette is a
//!   number of pixels, whatever its depth. One ray goes through the middle of every pixel.
//! - **Grey** is linear in the angle's cosine to one light that goes with the view: from the left, above and in front,
//!   `(-1, 2, 2) / 3` as right, up and towards the eye. `grey = 32 + 223 (1 + n.l) / 2`: no normal is so far from the
//!   light that it could turn unseen. The background is 0, which no surface is.
//! - **Normals** come from the surface, not from the mesh's own normals, which are part of what may be wrong: at every
//!   point the mean of its triangles by area, vertices at the same position welded. Triangles more than 60 degrees
//!   apart stay apart, so that creases stay sharp and taking triangles out of a flat part is no difference. Either side
//!   of a triangle is lit as the side seen.
//!
//! Only sums, products, quotients and square roots make a pixel, and only whole numbers are added up over pixels: the
//! same bytes on every machine and for any number of threads.

use glam::DVec3;

use crate::mesh::Mesh;

use super::{
    Picture, QualityError,
    bvh::{Bvh, Walker},
    camera::axes,
    map_chunks,
    normals::smooth_normals,
    sight::Sight,
};

/// Views that are the vertices of a subdivided icosahedron.
const ICOSAHEDRAL: usize = 42;
/// Most pixels of all views, one byte each.
const MAX_PIXELS: usize = 1 << 30;
/// Half the picture's side in radii of the ball around the first mesh: room for what stands out of it.
const ROOM: f64 = 1.0625;
/// Cosine of the angle between triangles beyond which there is a crease: 60 degrees.
const CREASE: f32 = 0.5;
/// Where the light is: right, up, towards the eye.
const LIGHT: [f64; 3] = [-1.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0];
/// Grey levels facing away from the light, and from there to facing it.
const GREY: [f32; 2] = [32.0, 223.0];
/// Rows of one unit of work.
const BAND: usize = 16;
/// Times that differences are made stronger to be seen in [`ReferenceImages::compare_view`].
const STRONGER: u8 = 4;

/// From how many sides, and how finely, to compare by [`image_difference`].
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct ImageOptions {
    /// Views around the mesh, at least 1; default 42. 42 are the vertices of an icosahedron and the middles of its
    /// edges; any other number lies along a spiral from pole to pole, by equal shares of the sphere's area.
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
    /// With this many views.
    #[must_use]
    pub fn with_views(mut self, views: usize) -> Self {
        self.views = views;
        self
    }

    /// With pictures of this many pixels on each side.
    #[must_use]
    pub fn with_size(mut self, size: usize) -> Self {
        self.size = size;
        self
    }
}

/// How different two meshes look.
///
/// Grey values are in levels of 0 to 255, because one level is the least step of a usual display: below 1 is nothing
/// that could be shown on average. Every number is 0 for meshes that look the same. The measures depend on
/// [`size`](Self::size) (a silhouette's pixels grow with it), so compare only figures of the same size.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct ImageDifference {
    /// K_L1, grey levels: mean difference over the pixels that show either mesh; mean over the views.
    pub l1: f64,
    /// K_L2, grey levels: root of the mean square difference over the same pixels; mean over the views.
    pub l2: f64,
    /// K_sil, pixels a view: those that show one mesh and not the other; mean over the views.
    pub silhouette: f64,
    /// The same in parts of the pixels that show the first mesh, over all views: what does not grow with the size. 0
    /// where no pixel shows the first mesh.
    pub silhouette_share: f64,
    /// The largest L1 of any view, grey levels.
    pub l1_max: f64,
    /// The first view that has it ([`ReferenceImages::direction`]).
    pub l1_max_view: usize,
    /// The largest L2 of any view, grey levels.
    pub l2_max: f64,
    /// The first view that has it.
    pub l2_max_view: usize,
    /// The largest silhouette difference of any view, pixels.
    pub silhouette_max: u64,
    /// The first view that has it.
    pub silhouette_max_view: usize,
    /// Views compared.
    pub views: usize,
    /// Pixels on each side of a picture.
    pub size: usize,
    /// Pixels that show the first mesh, over all views.
    pub pixels_first: u64,
    /// Pixels that show the second mesh, over all views.
    pub pixels_second: u64,
}

/// Pictures of a mesh from all sides, to compare many others with: made once, one byte a pixel.
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
    /// Row by row from the top left, view by view.
    grey: Vec<u8>,
}

impl ReferenceImages {
    /// Frames a mesh and takes its pictures. O(views * size^2 * log n), one byte a pixel.
    ///
    /// # Errors
    /// A mesh without a surface; no view or no pixel, or more than 2^30 pixels in all.
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

    /// How different another mesh looks through the same frames. What of it lies outside of them is not seen.
    /// O(views * size^2 * log n).
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

    /// How many views there are.
    pub fn views(&self) -> usize {
        self.frame.views.len()
    }

    /// The unit direction from which a view sees the mesh, pointing away from it; `None` beyond the last view.
    pub fn direction(&self, view: usize) -> Option<[f64; 3]> {
        self.frame.views.get(view).map(|axes| (-axes[2]).to_array())
    }

    /// The mesh as a view sees it; `None` beyond the last view.
    pub fn picture(&self, view: usize) -> Option<Picture> {
        let area = self.frame.size * self.frame.size;
        (view < self.views()).then(|| self.frame.picture(&self.grey[view * area..(view + 1) * area]))
    }

    /// A view to look at: the mesh, another one, and their difference four times as strong, side by side.
    ///
    /// # Errors
    /// The other mesh has no surface; there is no such view.
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
            // A flat mesh seen edge on is in no pixel, and so is its difference.
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

/// How different two meshes look, over views from all sides that frame the first one.
///
/// Symmetric as long as both fill the same frame: the ball about the middle of the box around the surface. Of several
/// comparisons with one mesh all but the first are at half price with [`ReferenceImages`].
///
/// O(views * size^2 * log n), one byte a pixel; the same bytes for any number of threads and on every machine.
///
/// # Errors
/// A mesh without a surface; no view or no pixel, or more than 2^30 pixels in all.
pub fn image_difference(a: &Mesh, b: &Mesh, options: &ImageOptions) -> Result<ImageDifference, QualityError> {
    ReferenceImages::new(a, options)?.difference(b)
}

fn surface(mesh: &Mesh, which: &'static str) -> Result<Bvh, QualityError> {
    Bvh::new(mesh).ok_or(QualityError::NoSurface { which, triangles: mesh.triangles().len() })
}

/// Whole numbers over some pixels, so that the order of adding up is no matter.
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

/// The views and what they frame.
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
        let (low, high) =
            corners().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(l, h), p| (l.min(p), h.max(p)));
        let centre = low + (high - low) * 0.5;
        let pixel = radius(surface, centre) * 2.0 * ROOM / size as f64;
        let views = directions(views).into_iter().map(|from| axes(-from, DVec3::Y)).collect();
        Self { centre, pixel, size, views }
    }

    /// Units of work in all views; a band lies in one view.
    fn bands(&self) -> usize {
        self.views.len() * self.size.div_ceil(BAND)
    }

    fn picture(&self, grey: &[u8]) -> Picture {
        Picture::new(self.size, self.size, grey.iter().map(|&value| [value; 3]).collect())
    }
}

/// Largest distance of the surface from a point.
fn radius(surface: &Bvh, centre: DVec3) -> f64 {
    let corners = (0..surface.len() as u32).flat_map(|slot| surface.corners(slot));
    corners.map(|p| p.distance_squared(centre)).fold(0.0, f64::max).sqrt()
}

/// A mesh that pictures are taken of.
struct Model<'a> {
    sight: Sight<'a>,
    /// How far in front of the frame's centre rays start, object units: before the surface.
    back: f64,
}

impl<'a> Model<'a> {
    fn new(mesh: &Mesh, surface: &'a Bvh, frame: &Frame) -> Self {
        let back = radius(surface, frame.centre) * 1.125;
        Self { sight: Sight { bvh: surface, normals: smooth_normals(mesh, CREASE) }, back }
    }

    /// Hands over the grey value of every pixel of a band, with the pixel's place among those of all views.
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

/// Unit vectors spread evenly over the sphere.
fn directions(count: usize) -> Vec<DVec3> {
    if count == ICOSAHEDRAL { icosahedron_and_middles() } else { spiral(count) }
}

/// The 12 vertices of an icosahedron and the middles of its 30 edges: the vertices after one subdivision.
fn icosahedron_and_middles() -> Vec<DVec3> {
    let golden = 0.5 + 0.5 * 5f64.sqrt();
    let mut corners = Vec::with_capacity(ICOSAHEDRAL);
    for [a, b] in [[1.0, golden], [1.0, -golden], [-1.0, golden], [-1.0, -golden]] {
        corners.extend([DVec3::new(0.0, a, b), DVec3::new(b, 0.0, a), DVec3::new(a, b, 0.0)]);
    }
    let mut all = corners.clone();
    for (i, &a) in corners.iter().enumerate() {
        // An edge joins those that are less than a right angle apart.
        all.extend(corners[i + 1..].iter().filter(|b| a.dot(**b) > 0.0).map(|&b| a + b));
    }
    all.into_iter().map(DVec3::normalize).collect()
}

/// Down from the pole in steps of equal area, by the golden angle from each to the next (Swinbank and Purser,
/// "Fibonacci grids", QJRMS 132, 2006).
fn spiral(count: usize) -> Vec<DVec3> {
    // Cosine and sine of the golden angle: turned by multiplication, which is the same everywhere.
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
