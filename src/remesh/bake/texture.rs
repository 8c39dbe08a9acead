//! Texels: a view to read, and what was filled.

use crate::error::MeshError;
use crate::wavelet::{Atlas, DomainPoint};

/// A texture to read: RGBA, 8 bits a channel, row by row from the top. A view, checked once.
///
/// As in glTF: coordinates `(0, 0)` are the upper left corner of the first texel, `v` runs down, texel `[x, y]` has its
/// centre at `((x + 0.5) / width, (y + 0.5) / height)`, and the texture repeats.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Texture<'a> {
    width: u32,
    height: u32,
    texels: &'a [[u8; 4]],
}

impl<'a> Texture<'a> {
    /// Makes a view of `width * height` texels.
    ///
    /// # Errors
    /// Another number of texels, or none.
    pub fn new(width: u32, height: u32, texels: &'a [[u8; 4]]) -> Result<Self, MeshError> {
        let expected = (width as usize).saturating_mul(height as usize).max(1);
        if texels.len() != expected {
            return Err(MeshError::LengthMismatch {
                what: "texels".to_owned(),
                found: texels.len(),
                expected,
            });
        }
        Ok(Self { width, height, texels })
    }

    /// Returns the number of texels in each direction.
    pub fn size(&self) -> [u32; 2] {
        [self.width, self.height]
    }

    /// Returns the texels, row by row.
    pub fn texels(&self) -> &'a [[u8; 4]] {
        self.texels
    }

    /// Returns the value at texture coordinates, 0 to 255 a channel: bilinear between the four nearest texels, as stored
    /// (colours are not made linear first). Coordinates which are not finite count as 0.
    pub fn at(&self, uv: [f64; 2]) -> [f64; 4] {
        let size = [self.width, self.height];
        let ([mut low, mut high], mut share) = ([[0usize; 2]; 2], [0.0; 2]);
        for i in 0..2 {
            let count = f64::from(size[i]);
            let wrapped = if uv[i].is_finite() { uv[i] - uv[i].floor() } else { 0.0 };
            let at = wrapped * count - 0.5;
            share[i] = at - at.floor();
            let wrap = |texel: f64| texel.rem_euclid(count) as usize % size[i] as usize;
            (low[i], high[i]) = (wrap(at.floor()), wrap(at.floor() + 1.0));
        }
        let texel = |x: usize, y: usize| self.texels[y * self.width as usize + x].map(f64::from);
        let corners = [(low[0], low[1]), (high[0], low[1]), (low[0], high[1]), (high[0], high[1])];
        let [a, b, c, d] = corners.map(|(x, y)| texel(x, y));
        std::array::from_fn(|k| {
            let above = (1.0 - share[0]) * a[k] + share[0] * b[k];
            let below = (1.0 - share[0]) * c[k] + share[0] * d[k];
            (1.0 - share[1]) * above + share[1] * below
        })
    }
}

/// A texture that was filled: RGBA, 8 bits a channel, row by row from the top.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct BakedTexture {
    /// Texels along a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Texels, row by row; `[T]::as_flattened` gives the bytes.
    pub texels: Vec<[u8; 4]>,
    /// Share of the texels with a value, 0 to 1: those of charts and their gutters.
    pub filled: f64,
}

impl BakedTexture {
    /// Fills the texture of an atlas; texels without a value are `background`.
    pub(super) fn fill(
        atlas: &Atlas,
        background: [u8; 4],
        value: impl Fn(&DomainPoint) -> Option<[u8; 4]> + Sync,
    ) -> Self {
        let texels: Vec<Option<[u8; 4]>> = atlas.fill(|place| Some(value(place)));
        let filled = texels.iter().flatten().count() as f64 / texels.len().max(1) as f64;
        let texels = texels.into_iter().map(|texel| texel.unwrap_or(background)).collect();
        Self { width: atlas.resolution(), height: atlas.resolution(), texels, filled }
    }

    /// Returns a view to read from; `None` without texels.
    pub fn view(&self) -> Option<Texture<'_>> {
        Texture::new(self.width, self.height, &self.texels).ok()
    }
}

/// Rounds a channel from 0 to 255.
pub(super) fn byte(value: f64) -> u8 {
    // The cast holds back what is out of range, and turns NaN into 0.
    value.round() as u8
}
