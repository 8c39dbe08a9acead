//! Meshes side by side in one picture, each with a caption: levels of detail with their triangles' edges, or coloured triangles.

use std::error::Error;

use multires::mesh::Mesh;
use multires::quality::{Camera, Colours, Picture, RenderOptions, Shading, render};

use super::canvas::Canvas;
use super::lettering;

/// Pixels that are left around what is seen of a mesh.
const MARGIN: usize = 16;
/// Least width of a cell, for its caption, and height of the caption's strip.
const CAPTION: [usize; 2] = [205, 34];
const PAPER: [u8; 3] = [247, 247, 247];
const INK: [u8; 3] = [52, 58, 68];

/// A mesh to show.
pub struct Shown {
    pub caption: String,
    pub mesh: Mesh,
    /// A colour per triangle, or by material.
    pub colours: Option<Vec<[u8; 3]>>,
    /// Width of edges, pixels.
    pub edges: f32,
}

/// All meshes from the same camera, which frames `mesh` in this many pixels, in one row or two.
pub fn sheet(mesh: &Mesh, size: usize, shown: &[Shown]) -> Result<Canvas, Box<dyn Error>> {
    let camera = Camera::framing(mesh, [-0.55, -0.42, -1.0]);
    let options = RenderOptions::default()
        .with_size(size, size)
        .with_shading(Shading::Flat)
        .with_background(PAPER, PAPER)
        .with_occlusion_rays(0);
    let picture = |shown: &Shown| {
        let colours = match (&shown.colours, mesh.materials()) {
            (Some(colours), _) => Colours::PerTriangle(colours.clone()),
            (None, []) => Colours::Uniform([150, 172, 200]),
            _ => Colours::Materials,
        };
        render(&shown.mesh, &camera, &options.clone().with_edges(shown.edges).with_colours(colours))
    };
    let pictures: Result<Vec<_>, _> = shown.iter().map(picture).collect();
    let pictures = pictures?;

    // What no mesh reaches into is cut off, the same for all.
    let [low, high] = seen(&pictures, size);
    let [width, height] = [high[0] - low[0] + 2 * MARGIN, high[1] - low[1] + 2 * MARGIN];
    let cell = [width.max(CAPTION[0]), height + CAPTION[1]];
    let columns = if shown.len() > 5 { shown.len().div_ceil(2) } else { shown.len().max(1) };
    let rows = shown.len().div_ceil(columns).max(1);
    let whole = [columns * cell[0], rows * cell[1] + MARGIN].map(|n| n as u32);
    let mut sheet = Canvas::new(whole[0], whole[1], PAPER);
    for (number, (Shown { caption, .. }, picture)) in shown.iter().zip(&pictures).enumerate() {
        let corner = [number % columns * cell[0], number / columns * cell[1]];
        let left = corner[0] + (cell[0] + low[0] - high[0]) / 2;
        for y in low[1]..high[1] {
            for x in low[0]..high[0] {
                let pixel = picture.pixels()[y * size + x];
                sheet.put((left + x - low[0]) as u32, (corner[1] + MARGIN + y - low[1]) as u32, pixel);
            }
        }
        let middle = [corner[0] + cell[0] / 2, corner[1] + height + CAPTION[1] / 2].map(|n| n as f32);
        lettering::write(&mut sheet, caption, middle, INK);
    }
    Ok(sheet)
}

/// The box, from and to, outside of which all pictures are blank; the whole if they all are.
fn seen(pictures: &[Picture], size: usize) -> [[usize; 2]; 2] {
    let (mut low, mut high) = ([size; 2], [0; 2]);
    for picture in pictures {
        for (i, _) in picture.pixels().iter().enumerate().filter(|&(_, &pixel)| pixel != PAPER) {
            let at = [i % size, i / size];
            low = [low[0].min(at[0]), low[1].min(at[1])];
            high = [high[0].max(at[0] + 1), high[1].max(at[1] + 1)];
        }
    }
    if low[0] < high[0] { [low, high] } else { [[0; 2], [size; 2]] }
}
