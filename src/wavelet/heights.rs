//! Terrain from a grid of heights of any size.
//!
//! ```text
//!     samples   0   1   2   3   4   5   6       halved at samples, as evenly as they allow; where one half of a square is
//!     level 0   |-----------------------|       a single step and the other is not, a step is halved between its samples
//!     level 1   |-----------|-----------|
//!     level 2   |---|-------|---|-------|
//!     level 3       |---|---|   |---|---|
//! ```
//!
//! A grid of `2^k n + 1` samples a side is a subdivision already. For other sizes, faces are split to different depths, and
//! each side gets at most 1/8 more steps.

use std::cell::RefCell;

use crate::mesh::Mesh;

use super::{Face, WaveletBuilder, WaveletError, WaveletMesh, WaveletOptions};

/// Largest share of additional steps along a side.
const SPARE: f64 = 1.0 / 8.0;
/// Most levels.
const MOST_LEVELS: u32 = 20;

impl WaveletMesh {
    /// Makes a terrain over a grid of `size[0]` by `size[1]` heights, at least 2 by 2, in rows along x. Sample `(i, j)` lies at
    /// `[i * spacing[0], heights[i + j * size[0]], j * spacing[1]]`, object units. y is up, and the upper side is the outside.
    ///
    /// The full resolution goes through every sample. A side without `2^k n + 1` samples gets additional vertices half-way
    /// between two samples. O(n).
    ///
    /// ```
    /// use multires::lod::Level;
    /// use multires::wavelet::{WaveletMesh, WaveletOptions};
    ///
    /// let heights: Vec<f32> = (0..100 * 70).map(|i| ((i % 100) as f32 * 0.2).sin() + (i / 100) as f32 * 0.01).collect();
    /// let terrain = WaveletMesh::from_heights(&heights, [100, 70], [0.5, 0.5], &WaveletOptions::default())?;
    /// assert!(terrain.subdivision().depth() >= 3);
    /// assert!(terrain.subdivision().triangle_count() < 2 * 99 * 69 * 9 / 8);
    /// # Ok::<(), multires::wavelet::WaveletError>(())
    /// ```
    ///
    /// # Errors
    /// Fewer than 2 samples a side, not exactly `size[0] * size[1]` heights, a non-finite height or position, or more faces
    /// than can be numbered.
    pub fn from_heights(
        heights: &[f32],
        size: [usize; 2],
        spacing: [f32; 2],
        options: &WaveletOptions,
    ) -> Result<Self, WaveletError> {
        let expected = size[0].saturating_mul(size[1]);
        if let Some(at) = size.iter().position(|&side| side < 2) {
            return Err(WaveletError::Invalid { what: "fewer than 2 samples along side", at });
        }
        if heights.len() != expected {
            return Err(WaveletError::Length { what: "heights", found: heights.len(), expected });
        }
        let field = Field { heights, size, spacing };
        let steps = size.map(|side| side - 1);
        let levels = levels(steps);
        let [across, down] = steps.map(|steps| cuts(steps, levels));

        // The base: squares between cuts, two triangles each.
        let coords: Vec<[f64; 2]> =
            down.iter().flat_map(|&y| across.iter().map(move |&x| [x as f64, y as f64])).collect();
        let row = across.len() as u32;
        let mut triangles = Vec::new();
        for y in 0..down.len() as u32 - 1 {
            for x in 0..row - 1 {
                let corner = |dx: u32, dy: u32| (y + dy) * row + x + dx;
                let [a, b, c, d] = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
                triangles.extend([[a, c, b], [a, d, c]]);
            }
        }
        let places: Vec<[f32; 3]> = coords.iter().map(|&at| field.place(at)).collect();
        let mut builder = WaveletBuilder::new(&Mesh::new(places, triangles)?)?;
        let coords = RefCell::new(coords);
        for _ in 0..levels {
            let is_coarse = |face: &Face| {
                let corners = face.vertices.map(|v| coords.borrow()[v as usize]);
                extent(corners).iter().any(|&steps| steps > 1.0)
            };
            builder.subdivide_where(is_coarse, |midpoint| {
                let [a, b] = midpoint.ends.map(|end| coords.borrow()[end as usize]);
                let at = [0, 1].map(|axis| halfway(a[axis], b[axis]));
                // New vertices are numbered in the order of these calls.
                coords.borrow_mut().push(at);
                field.place(at)
            })?;
        }
        builder.build(options)
    }
}

struct Field<'a> {
    heights: &'a [f32],
    size: [usize; 2],
    spacing: [f32; 2],
}

impl Field<'_> {
    /// Returns the position of a grid point; between samples, the middle of the two samples beside it.
    fn place(&self, at: [f64; 2]) -> [f32; 3] {
        let [low, high] = [at.map(f64::floor), at.map(f64::ceil)].map(|at| at.map(|x| x as usize));
        let height = |x: usize, y: usize| f64::from(self.heights[x + y * self.size[0]]);
        // Along the diagonal which cuts the squares.
        let height = if low == high {
            self.heights[low[0] + low[1] * self.size[0]]
        } else {
            (0.5 * (height(low[0], low[1]) + height(high[0], high[1]))) as f32
        };
        [at[0] as f32 * self.spacing[0], height, at[1] as f32 * self.spacing[1]]
    }
}

/// Returns the most halvings for which neither side gets too many steps.
fn levels(steps: [usize; 2]) -> u32 {
    let fits = |levels: u32| {
        steps.iter().all(|&steps| {
            let piece = 1_usize << levels;
            let made = steps.div_ceil(piece) * piece;
            made as f64 <= steps as f64 * (1.0 + SPARE)
        })
    };
    (0..=MOST_LEVELS).rev().find(|&levels| fits(levels)).unwrap_or(0)
}

/// Returns the samples cutting a side into base edges of at most `2^levels` steps, as even as possible.
fn cuts(steps: usize, levels: u32) -> Vec<usize> {
    let pieces = steps.div_ceil(1 << levels);
    (0..=pieces).map(|piece| piece * steps / pieces).collect()
}

/// Returns the sample half-way between two grid points; their middle if no sample is between them.
fn halfway(a: f64, b: f64) -> f64 {
    let middle = 0.5 * (a + b);
    if (a - b).abs() > 1.0 { middle.floor() } else { middle }
}

fn extent([a, b, c]: [[f64; 2]; 3]) -> [f64; 2] {
    [0, 1].map(|axis| {
        let [a, b, c] = [a[axis], b[axis], c[axis]];
        a.max(b).max(c) - a.min(b).min(c)
    })
}
