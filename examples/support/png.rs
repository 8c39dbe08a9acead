//! Small PNG files.

use std::error::Error;
use std::fs::File;
use std::io::BufWriter;
use std::path::Path;

use image::RgbImage;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};

/// Writes a picture as a small PNG: the fewer bits of each colour, 4 to 8, the less room it takes. 6 are not seen to be fewer
/// than 8. Flat colours pack best unfiltered.
pub fn save(mut picture: RgbImage, bits: u32, path: &Path) -> Result<(), Box<dyn Error>> {
    let bits = bits.clamp(4, 8);
    picture
        .iter_mut()
        .for_each(|value| *value = (*value & !(255_u16 >> bits) as u8) | (u16::from(*value) >> bits) as u8);
    let file = BufWriter::new(File::create(path)?);
    let encoder = PngEncoder::new_with_quality(file, CompressionType::Best, FilterType::NoFilter);
    Ok(picture.write_with_encoder(encoder)?)
}
