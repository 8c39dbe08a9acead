//! A single texture for all levels: every base face is a chart, two right triangles to a square cell, cells on shelves.
//!
//! ```text
//!      +---------------+   size of the cell
//!      |   __________  |   between the long sides a gutter from each, and so around them; distances are those of
//!      | .  \        | |   squares (the larger of both directions), as bilinear filters reach
//!      | |\   \  two | |
//!      | |  \   \    | |
//!      | |one \   \  | |   right angles at corners of texels, at the corner of the base face that is opposite to its
//!      | |______\   \| |   longest side; charts turn the way of their faces
//!      |               |
//!      +---------------+   size = 4 gutters + length of a leg
//! ```
//!
//! Coordinates are affine on each base face. So the midpoint of an edge has the mean coordinates of its ends, wavelets
//! have no coefficient for coordinates, and a texture fits every set of wavelets as it fits the full resolution.

use glam::DVec3;

use crate::geometry::parallel;
use crate::mesh::NONE;
use crate::wavelet::{WaveletError, WaveletMesh};

use super::DomainPoint;
use super::sampler::SurfacePoint;

/// Maximum number of texels along a side.
const MOST_TEXELS: u32 = 1 << 16;

/// Sizes of charts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum ChartSize {
    /// Equal sizes.
    #[default]
    Equal,
    /// By the area of the full resolution over each base face; at least a single texel.
    Area,
}

/// Options of [`Atlas::new`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct AtlasOptions {
    /// Texels along each side of the texture, up to 65536. If it is `2^k`, coordinates are exact down to level `24 - k`.
    pub resolution: u32,
    /// Texels around each chart which hold its colours too: 1 is enough for bilinear filtering, `2^k` for mipmaps down to
    /// level `k`.
    pub gutter: u32,
    /// Sizes of charts.
    pub size: ChartSize,
}

impl Default for AtlasOptions {
    /// 2048 texels, gutters of 2, equal charts.
    fn default() -> Self {
        Self { resolution: 2048, gutter: 2, size: ChartSize::Equal }
    }
}

impl AtlasOptions {
    /// Sets the number of texels along each side of the texture.
    #[must_use]
    pub fn with_resolution(mut self, texels: u32) -> Self {
        self.resolution = texels;
        self
    }

    /// Sets the number of texels around each chart.
    #[must_use]
    pub fn with_gutter(mut self, texels: u32) -> Self {
        self.gutter = texels;
        self
    }

    /// Sets the sizes of charts.
    #[must_use]
    pub fn with_size(mut self, size: ChartSize) -> Self {
        self.size = size;
        self
    }
}

/// A square of the texture with two charts, texels. The second may be missing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Cell {
    corner: [u32; 2],
    size: u32,
    faces: [u32; 2],
}

/// A row of cells of descending size.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Shelf {
    rows: std::ops::Range<u32>,
    cells: std::ops::Range<usize>,
}

/// Every base face of a mesh as a chart of a square texture. Base faces keep their numbers, so the atlas fits every mesh
/// with the same base. About 16 bytes a base face.
///
/// Texel `[x, y]` has its centre at `((x + 0.5) / resolution, (y + 0.5) / resolution)`. The first row of a texture is
/// `y = 0`.
///
/// ```
/// use multires::mesh::shapes;
/// use multires::wavelet::{Atlas, AtlasOptions, WaveletBuilder, WaveletOptions};
///
/// let mut builder = WaveletBuilder::new(&shapes::icosphere(0))?;
/// for _ in 0..4 {
///     builder.subdivide(|midpoint| midpoint.middle)?;
/// }
/// let mesh = builder.build(&WaveletOptions::default())?;
/// let atlas = Atlas::new(&mesh, &AtlasOptions::default().with_resolution(256))?;
/// let texels: Vec<[u8; 4]> = atlas.bake(&mesh, |point| {
///     let [x, y, z] = point.normal.map(|n| (127.5 * (n + 1.0)) as u8);
///     [x, y, z, 255]
/// })?;
/// assert_eq!(texels.as_flattened().len(), 256 * 256 * 4);
/// let mesh = mesh.with_atlas(&atlas)?;
/// assert_eq!(mesh.vertices().attribute("uv").map(|uv| uv.width()), Some(2));
/// # Ok::<(), multires::wavelet::WaveletError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Atlas {
    resolution: u32,
    gutter: u32,
    shelves: Vec<Shelf>,
    cells: Vec<Cell>,
    /// Per base face its place: twice its cell, plus 1 for the second chart.
    place_of: Vec<u32>,
    /// Per base face the corner at the right angle.
    first: Vec<u8>,
}

impl Atlas {
    /// Packs the base faces of a mesh. O(n + base faces x log).
    ///
    /// # Errors
    /// The texture has no room for all charts, with gutters, at a single texel a leg; or it is too large.
    pub fn new(mesh: &WaveletMesh, options: &AtlasOptions) -> Result<Self, WaveletError> {
        let AtlasOptions { resolution, gutter, size } = *options;
        if resolution > MOST_TEXELS {
            let (count, limit) = (resolution as usize, MOST_TEXELS as usize);
            return Err(WaveletError::TooMany { what: "texels along a side", count, limit });
        }
        let of = mesh.subdivision();
        let count = of.base_face_count();
        let sizes = match size {
            ChartSize::Equal => vec![1.0; count],
            ChartSize::Area => relative_sizes(mesh),
        };
        let mut order: Vec<u32> = (0..count as u32).collect();
        // Ties in the order of faces.
        order.sort_by(|&a, &b| sizes[b as usize].total_cmp(&sizes[a as usize]));
        // Size of each cell: the size of its larger chart, which comes first.
        let larger: Vec<f64> = order.chunks(2).map(|faces| sizes[faces[0] as usize]).collect();
        let margin = 4 * u64::from(gutter);
        let cells =
            |longest: u64| larger.iter().map(move |size| ((size * longest as f64) as u64).max(1) + margin);
        let fits = |longest: u64| height(cells(longest), resolution) <= u64::from(resolution);
        if !fits(1) {
            let columns = (larger.len() as f64).sqrt().ceil() as u64;
            let needed = columns * (1 + margin);
            return Err(WaveletError::AtlasTooSmall { charts: count, gutter, resolution, needed });
        }
        let (mut least, mut most) = (1, u64::from(resolution) + 1);
        while most - least > 1 {
            let middle = least + (most - least) / 2;
            if fits(middle) {
                least = middle;
            } else {
                most = middle;
            }
        }
        let mut atlas = Self {
            resolution,
            gutter,
            shelves: Vec::new(),
            cells: Vec::new(),
            place_of: vec![NONE; count],
            first: (0..count as u32).map(|face| right_corner(mesh, face)).collect(),
        };
        let mut next = [0, 0];
        for (faces, size) in order.chunks(2).zip(cells(least)) {
            let size = size as u32;
            if atlas.shelves.is_empty() || next[0] + size > resolution {
                next = [0, atlas.shelves.last().map_or(0, |shelf| shelf.rows.end)];
                let end = atlas.cells.len();
                atlas.shelves.push(Shelf { rows: next[1]..next[1] + size, cells: end..end });
            }
            for (at, &face) in faces.iter().enumerate() {
                atlas.place_of[face as usize] = (2 * atlas.cells.len() + at) as u32;
            }
            let faces = [faces[0], faces.get(1).copied().unwrap_or(NONE)];
            atlas.cells.push(Cell { corner: next, size, faces });
            next[0] += size;
            if let Some(shelf) = atlas.shelves.last_mut() {
                shelf.cells.end += 1;
            }
        }
        Ok(atlas)
    }

    /// Returns the number of charts: base faces.
    pub fn len(&self) -> usize {
        self.place_of.len()
    }

    /// Whether there are no charts.
    pub fn is_empty(&self) -> bool {
        self.place_of.is_empty()
    }

    /// Returns the number of texels along each side of the texture.
    pub fn resolution(&self) -> u32 {
        self.resolution
    }

    /// Returns the number of texels around each chart which hold its colours too.
    pub fn gutter(&self) -> u32 {
        self.gutter
    }

    /// Returns the share of the texture's area inside charts, 0 to 1.
    pub fn coverage(&self) -> f64 {
        let charts = self.cells.iter().map(|cell| {
            let charts = if cell.faces[1] == NONE { 0.5 } else { 1.0 };
            charts * f64::from(self.leg(cell)).powi(2)
        });
        charts.sum::<f64>() / f64::from(self.resolution).powi(2).max(1.0)
    }

    fn leg(&self, cell: &Cell) -> u32 {
        cell.size - 4 * self.gutter
    }

    /// Returns the texture coordinates of a base face's corners; `None` out of range.
    pub fn chart(&self, base_face: u32) -> Option<[[f32; 2]; 3]> {
        let scale = f64::from(self.resolution);
        let corners = self.texels(base_face)?;
        Some(corners.map(|corner| corner.map(|x| (f64::from(x) / scale) as f32)))
    }

    /// Returns the texture coordinates of a point of the base; `None` out of range.
    pub fn uv(&self, point: &DomainPoint) -> Option<[f64; 2]> {
        let corners = self.texels(point.base_face)?.map(|corner| corner.map(f64::from));
        let weights = point.barycentric;
        Some(std::array::from_fn(|i| {
            (0..3).map(|k| weights[k] * corners[k][i]).sum::<f64>() / f64::from(self.resolution)
        }))
    }

    /// Returns the corners of a chart in the order of the face, texels.
    fn texels(&self, base_face: u32) -> Option<[[u32; 2]; 3]> {
        let place = *self.place_of.get(base_face as usize)?;
        let cell = &self.cells[place as usize / 2];
        let leg = self.leg(cell);
        let [x, y] = cell.corner;
        let corners = if place % 2 == 0 {
            let [x, y] = [x + self.gutter, y + self.gutter];
            [[x, y], [x + leg, y], [x, y + leg]]
        } else {
            let [x, y] = [x + cell.size - self.gutter, y + cell.size - self.gutter];
            [[x, y], [x - leg, y], [x, y - leg]]
        };
        let first = usize::from(self.first[base_face as usize]);
        Some([0, 1, 2].map(|k| corners[(k + 3 - first) % 3]))
    }

    /// Fills a texture, row by row. Each texel of a chart or its gutter gets the value of `colour` at the point of the
    /// full resolution at its centre, or at the nearest point of the chart. Texels outside charts and gutters are
    /// `T::default()`.
    ///
    /// Deterministic if `colour` is. O(texels x levels).
    ///
    /// # Errors
    /// The mesh has other base faces than this atlas.
    pub fn bake<T: Copy + Default + Send>(
        &self,
        mesh: &WaveletMesh,
        colour: impl Fn(&SurfacePoint) -> T + Sync,
    ) -> Result<Vec<T>, WaveletError> {
        self.check(mesh)?;
        let sampler = mesh.sampler();
        Ok(self.fill(|point| sampler.at(point).map(|point| colour(&point))))
    }

    /// Fills a texture, row by row. Each texel of a chart or its gutter gets `value` at the place on the base at its
    /// centre, or at the nearest place of the chart. Texels outside charts and gutters, and texels where `value` is
    /// `None`, are `T::default()`.
    ///
    /// Deterministic if `value` is. O(texels).
    pub fn fill<T: Copy + Default + Send>(&self, value: impl Fn(&DomainPoint) -> Option<T> + Sync) -> Vec<T> {
        let width = self.resolution as usize;
        let mut texels = vec![T::default(); width * width];
        let fill = |(y, row): (usize, &mut [T])| {
            let y = y as u32;
            let shelf = self.shelves.partition_point(|shelf| shelf.rows.end <= y);
            let cells = self.shelves.get(shelf).map_or(0..0, |shelf| shelf.cells.clone());
            for cell in self.cells[cells].iter().filter(|cell| y < cell.corner[1] + cell.size) {
                for x in 0..cell.size {
                    if let Some(value) = value(&self.nearest(cell, [x, y - cell.corner[1]])) {
                        row[(cell.corner[0] + x) as usize] = value;
                    }
                }
            }
        };
        if width > 0 {
            parallel::fill_chunks(&mut texels, width, fill);
        }
        texels
    }

    /// Returns the point of a cell's charts nearest to the centre of a texel. Uses the chart on the texel's side of the
    /// diagonal, so charts and gutters are complete.
    fn nearest(&self, cell: &Cell, [x, y]: [u32; 2]) -> DomainPoint {
        let is_second = x + y + 1 > cell.size && cell.faces[1] != NONE;
        let [x, y] = if is_second { [cell.size - 1 - x, cell.size - 1 - y] } else { [x, y] };
        let leg = f64::from(self.leg(cell));
        let [mut u, mut v] = [x, y].map(|x| f64::from(x) + 0.5 - f64::from(self.gutter));
        let beyond = u + v - leg;
        if beyond > 0.0 {
            (u, v) = (u - 0.5 * beyond, v - 0.5 * beyond);
        }
        (u, v) = (u.clamp(0.0, leg), v.clamp(0.0, leg));
        let [u, v] = [u / leg, v / leg];
        let weights = [1.0 - u - v, u, v];
        let face = cell.faces[usize::from(is_second)];
        let first = usize::from(self.first[face as usize]);
        DomainPoint::new(face, [0, 1, 2].map(|k| weights[(k + 3 - first) % 3]))
    }

    /// Fails unless the mesh has as many base faces as the atlas.
    pub(crate) fn check(&self, mesh: &WaveletMesh) -> Result<(), WaveletError> {
        let (found, expected) = (self.len(), mesh.subdivision().base_face_count());
        if found == expected { Ok(()) } else { Err(WaveletError::Length { what: "charts", found, expected }) }
    }
}

/// Returns the height of the shelves filled by cells of descending size; `width + 1` where a cell or the height exceeds
/// the width.
fn height(cells: impl Iterator<Item = u64>, width: u32) -> u64 {
    let width = u64::from(width);
    let (mut height, mut x) = (0, width + 1);
    for size in cells {
        if x + size > width {
            (x, height) = (0, height + size);
        }
        x += size;
        if size > width || height > width {
            return width + 1;
        }
    }
    height
}

/// Returns the square root of the area over each base face, relative to the largest.
fn relative_sizes(mesh: &WaveletMesh) -> Vec<f64> {
    let of = mesh.subdivision();
    let mut area = vec![0.0; of.face_count()];
    for face in (0..of.face_count() as u32).rev() {
        area[face as usize] = if of.is_split(face) {
            (0..4).map(|child| area[of.child(face, child) as usize]).sum()
        } else {
            let [a, b, c] = places(mesh, of.corners(face));
            0.5 * (b - a).cross(c - a).length()
        };
    }
    area.truncate(of.base_face_count());
    let most = area.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    area.iter().map(|area| (area / most).sqrt()).collect()
}

/// Returns the corner opposite to the longest side of a base face.
fn right_corner(mesh: &WaveletMesh, base_face: u32) -> u8 {
    let places = places(mesh, mesh.subdivision().corners(base_face));
    let opposite = [0, 1, 2].map(|k| places[(k + 1) % 3].distance_squared(places[(k + 2) % 3]));
    (1..3).fold(0, |longest, k| if opposite[k] > opposite[longest] { k } else { longest }) as u8
}

fn places(mesh: &WaveletMesh, vertices: [u32; 3]) -> [DVec3; 3] {
    vertices.map(|vertex| DVec3::from_array(mesh.vertices().positions()[vertex as usize].map(f64::from)))
}
