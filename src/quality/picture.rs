//! Pictures: pixels in rows from the top, and pictures side by side. No file format: any image library takes the bytes.

/// A picture: sRGB bytes, row by row from the top left.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Picture {
    width: usize,
    height: usize,
    rgb: Vec<[u8; 3]>,
}

/// Fill colour below pictures of smaller height.
const MOUNT: [u8; 3] = [255; 3];

impl Picture {
    /// Creates a picture from its rows; `rgb` has `width * height` pixels.
    pub(super) fn new(width: usize, height: usize, rgb: Vec<[u8; 3]>) -> Self {
        Self { width, height, rgb }
    }

    /// Returns the number of pixels in a row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Returns the number of rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Returns all pixels, row by row from the top left.
    pub fn pixels(&self) -> &[[u8; 3]] {
        &self.rgb
    }

    /// Returns the bytes red, green, blue of every pixel, row by row from the top left: `3 * width * height` bytes.
    pub fn rgb_bytes(&self) -> &[u8] {
        self.rgb.as_flattened()
    }

    /// Copies [`rgb_bytes`](Self::rgb_bytes) to a vector.
    pub fn to_rgb_bytes(&self) -> Vec<u8> {
        self.rgb_bytes().to_vec()
    }

    /// Places pictures in a row from left to right, tops aligned; shorter pictures are padded with white at the bottom.
    /// Without pictures, the result is an empty picture.
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
