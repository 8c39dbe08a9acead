//! Pixels in rows from the top, and pictures side by side. No file format: any image library takes the bytes.

/// A picture: sRGB bytes, row by row from the top left.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Picture {
    width: usize,
    height: usize,
    rgb: Vec<[u8; 3]>,
}

/// What lies between and under pictures of different size.
const MOUNT: [u8; 3] = [255; 3];

impl Picture {
    /// A picture from its rows; `rgb` has `width * height` pixels.
    pub(super) fn new(width: usize, height: usize, rgb: Vec<[u8; 3]>) -> Self {
        Self { width, height, rgb }
    }

    /// Pixels in a row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Number of rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// All pixels, row by row from the top left.
    pub fn pixels(&self) -> &[[u8; 3]] {
        &self.rgb
    }

    /// The bytes red, green, blue of every pixel, row by row from the top left: `3 * width * height` of them.
    pub fn rgb_bytes(&self) -> &[u8] {
        self.rgb.as_flattened()
    }

    /// The same bytes, for keeps.
    pub fn to_rgb_bytes(&self) -> Vec<u8> {
        self.rgb_bytes().to_vec()
    }

    /// Pictures in a row from left to right, tops aligned, the lower ones padded with white at their foot. Of no
    /// pictures, an empty one.
    pub fn beside(pictures: &[Picture]) -> Picture {
        let width = pictures.iter().map(|p| p.width).sum();
        let height = pictures.iter().map(|p| p.height).max().unwrap_or(0);
        let mut rgb = Vec::with_capacity(width * height);
        for row in 0..height {
            for picture in pictures {
                let start = row * picture.width;
                match picture.rgb.get(start..start + picture.width) {
                    Some(pixels) if row < picture.height => rgb.extend_from_slice(pixels),
                    _ => rgb.extend(std::iter::repeat_n(MOUNT, picture.width)),
                }
            }
        }
        Picture { width, height, rgb }
    }
}
