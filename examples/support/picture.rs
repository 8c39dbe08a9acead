//! Levels of detail side by side in one picture, each with its triangles' edges and a caption.

#[path = "lettering.rs"]
mod lettering;

use std::error::Error;

use image::{Rgb, RgbImage};
use multires::mesh::Mesh;
use multires::quality::{Camera, Colours, RenderOptions, Shading, render};

/// Pictures in a row.
const COLUMNS: usize = 5;
/// Pixels of one picture, and of the strip for its caption.
const SIZE: [usize; 2] = [300, 372];
const STRIP: usize = 40;
const PAPER: [u8; 3] = [247, 248, 250];
const INK: [u8; 3] = [52, 58, 68];

/// All levels from the same camera, which frames the whole mesh. Levels are captions and meshes, fine to coarse.
pub fn levels(mesh: &Mesh, levels: &[(String, Mesh)]) -> Result<RgbImage, Box<dyn Error>> {
    let camera = Camera::framing(mesh, [-0.55, -0.42, -1.0]);
    let [width, height] = SIZE;
    let colours =
        if mesh.materials().is_empty() { Colours::Uniform([150, 172, 200]) } else { Colours::Materials };
    let options = RenderOptions::default()
        .with_size(width, height)
        .with_shading(Shading::Flat)
        .with_colours(colours)
        .with_background(PAPER, PAPER)
        .with_occlusion_rays(4)
        .with_edges(1.0);

    let columns = levels.len().clamp(1, COLUMNS);
    let rows = levels.len().div_ceil(COLUMNS).max(1);
    let size = [columns * width, rows * (height + STRIP)].map(|n| n as u32);
    let mut sheet = RgbImage::from_pixel(size[0], size[1], Rgb(PAPER));
    for (number, (caption, level)) in levels.iter().enumerate() {
        let (left, top) = (number % COLUMNS * width, number / COLUMNS * (height + STRIP));
        let picture = render(level, &camera, &options)?;
        for (i, &pixel) in picture.pixels().iter().enumerate() {
            sheet.put_pixel((left + i % width) as u32, (top + i / width) as u32, Rgb(pixel));
        }
        let middle = [left as f32 + width as f32 * 0.5, (top + height + STRIP / 2) as f32];
        lettering::write(&mut sheet, caption, middle, INK);
    }
    Ok(sheet)
}
