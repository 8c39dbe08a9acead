//! A picture to draw into, and to encode as a PNG file.

/// Pixels row by row from the top.
pub struct Canvas {
    width: usize,
    pixels: Vec<[u8; 3]>,
}

impl Canvas {
    /// Makes a picture of a single colour.
    pub fn new(width: u32, height: u32, colour: [u8; 3]) -> Self {
        Self { width: width as usize, pixels: vec![colour; width as usize * height as usize] }
    }

    /// Returns the pixel at `x` from the left and `y` from the top, if it exists.
    pub fn at(&mut self, x: u32, y: u32) -> Option<&mut [u8; 3]> {
        let (x, y) = (x as usize, y as usize);
        (x < self.width).then(|| self.pixels.get_mut(y * self.width + x)).flatten()
    }

    /// Colours a pixel, if it exists.
    pub fn put(&mut self, x: u32, y: u32, colour: [u8; 3]) {
        if let Some(pixel) = self.at(x, y) {
            *pixel = colour;
        }
    }

    /// Encodes the picture as a PNG file. `bits` of each colour are kept, 4 to 8; fewer bits take less room, and 6 look
    /// like 8. Flat colours pack best unfiltered.
    ///
    /// # Errors
    /// The encoder fails: the picture is empty.
    pub fn png(&self, bits: u32) -> Result<Vec<u8>, png::EncodingError> {
        let bits = bits.clamp(4, 8);
        let coarse = |value: &u8| (value & !(255_u16 >> bits) as u8) | (u16::from(*value) >> bits) as u8;
        let values: Vec<u8> = self.pixels.as_flattened().iter().map(coarse).collect();
        let mut file = Vec::new();
        let height = self.pixels.len() / self.width.max(1);
        let mut encoder = png::Encoder::new(&mut file, self.width as u32, height as u32);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_compression(png::Compression::High);
        encoder.set_filter(png::Filter::NoFilter);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&values)?;
        writer.finish()?;
        Ok(file)
    }
}
