//! Levels of detail side by side in one picture, each with its triangles' edges and a caption.

use std::error::Error;

use multires::mesh::Mesh;
use multires::quality::{Camera, Colours, Picture, RenderOptions, Shading, render};

use super::canvas::Canvas;
use super::lettering;

/// Pixels that a level is rendered in, and that are left around what is seen of it.
const SIZE: usize = 308;
const MARGIN: usize = 16;
/// Least width of a level's cell, for its caption, and height of the caption's strip.
const CAPTION: [usize; 2] = [205, 34];
const PAPER: [u8; 3] = [247, 247, 247];
const INK: [u8; 3] = [52, 58, 68];

/// All levels from the same camera, which frames the whole mesh, in one row or two. Levels are captions and meshes,
/// fine to coarse.
pub fn levels(mesh: &Mesh, levels: &[(String, Mesh)]) -> Result<Canvas, Box<dyn Error>> {
    let camera = Camera::framing(mesh, [-0.55, -0.42, -1.0]);
    let colours = match mesh.materials() {
        [] => Colours::Uniform([150, 172, 200]),
        _ => Colours::Materials,
    };
    let options = RenderOptions::default()
        .with_size(SIZE, SIZE)
        .with_shading(Shading::Flat)
        .with_colours(colours)
        .with_background(PAPER, PAPER)
        .with_occlusion_rays(0)
        .with_edges(1.0);
    let pictures: Result<Vec<_>, _> =
        levels.iter().map(|(_, level)| render(level, &camera, &options)).collect();
    let pictures = pictures?;

    // What no level reaches into is cut off, the same for all.
    let [low, high] = seen(&pictures);
    let [width, height] = [high[0] - low[0] + 2 * MARGIN, high[1] - low[1] + 2 * MARGIN];
    let cell = [width.max(CAPTION[0]), height + CAPTION[1]];
    let columns = if levels.len() > 5 { levels.len().div_ceil(2) } else { levels.len().max(1) };
    let rows = levels.len().div_ceil(columns).max(1);
    let size = [columns * cell[0], rows * cell[1] + MARGIN].map(|n| n as u32);
    let mut sheet = Canvas::new(size[0], size[1], PAPER);
    for (number, ((caption, _), picture)) in levels.iter().zip(&pictures).enumerate() {
        let corner = [number % columns * cell[0], number / columns * cell[1]];
        let left = corner[0] + (cell[0] + low[0] - high[0]) / 2;
        for y in low[1]..high[1] {
            for x in low[0]..high[0] {
                let pixel = picture.pixels()[y * SIZE + x];
                sheet.put((left + x - low[0]) as u32, (corner[1] + MARGIN + y - low[1]) as u32, pixel);
            }
        }
        let middle = [corner[0] + cell[0] / 2, corner[1] + height + CAPTION[1] / 2].map(|n| n as f32);
        lettering::write(&mut sheet, caption, middle, INK);
    }
    Ok(sheet)
}

/// The box, from and to, outside of which all pictures are blank; the whole if they all are.
fn seen(pictures: &[Picture]) -> [[usize; 2]; 2] {
    let (mut low, mut high) = ([SIZE; 2], [0; 2]);
    for picture in pictures {
        for (i, _) in picture.pixels().iter().enumerate().filter(|&(_, &pixel)| pixel != PAPER) {
            let at = [i % SIZE, i / SIZE];
            low = [low[0].min(at[0]), low[1].min(at[1])];
            high = [high[0].max(at[0] + 1), high[1].max(at[1] + 1)];
        }
    }
    if low[0] < high[0] { [low, high] } else { [[0; 2], [SIZE; 2]] }
}
