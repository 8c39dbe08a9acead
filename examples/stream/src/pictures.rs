//! Pictures of what a client draws: ray-cast on the CPU, with a caption each, as PNG files.

use std::path::Path;

use multires::mesh::Mesh;
use multires::quality::{Colours, Picture, RenderOptions, Shading, render};

use crate::AnyError;
use crate::camera::Pose;
use crate::canvas::Canvas;
use crate::lettering;

const PAPER: [u8; 3] = [247, 247, 247];
const INK: [u8; 3] = [52, 58, 68];
/// Rows of a caption, and pixels between pictures.
const CAPTION: usize = 30;
const GAP: usize = 6;
/// Bits kept of each colour.
const BITS: u32 = 6;

/// Draws a mesh as a camera sees it: flat triangles with edges `edges` pixels wide, or a smooth surface if `edges` is 0.
///
/// # Errors
/// The picture has no pixels, or the pose is not finite.
pub fn draw(mesh: &Mesh, pose: &Pose, size: [usize; 2], edges: f32) -> Result<Picture, AnyError> {
    let colours =
        if mesh.materials().is_empty() { Colours::Uniform([150, 172, 200]) } else { Colours::Materials };
    let options = RenderOptions::default()
        .with_size(size[0], size[1])
        .with_shading(if edges > 0.0 { Shading::Flat } else { Shading::Smooth })
        .with_background(PAPER, PAPER)
        .with_occlusion_rays(0)
        .with_colours(colours)
        .with_edges(edges);
    Ok(render(mesh, &pose.camera(), &options)?)
}

/// Writes pictures with captions, `columns` in a row, as one PNG file.
///
/// # Errors
/// The file cannot be written.
pub fn write(file: &Path, pictures: &[(Picture, String)], columns: usize) -> Result<(), AnyError> {
    let columns = columns.clamp(1, pictures.len().max(1));
    let width = pictures.iter().map(|(picture, _)| picture.width()).max().unwrap_or(1);
    let height = pictures.iter().map(|(picture, _)| picture.height()).max().unwrap_or(1) + CAPTION;
    let rows = pictures.len().div_ceil(columns).max(1);
    let size = [columns * (width + GAP) - GAP, rows * (height + GAP) - GAP].map(|side| side as u32);
    let mut canvas = Canvas::new(size[0], size[1], PAPER);
    for (number, (picture, caption)) in pictures.iter().enumerate() {
        let corner = [number % columns * (width + GAP), number / columns * (height + GAP)];
        for (at, &pixel) in picture.pixels().iter().enumerate() {
            let [x, y] = [at % picture.width(), at / picture.width()];
            canvas.put((corner[0] + x) as u32, (corner[1] + y) as u32, pixel);
        }
        let middle = [corner[0] + width / 2, corner[1] + height - CAPTION / 2].map(|at| at as f32);
        lettering::write(&mut canvas, caption, middle, INK);
    }
    std::fs::write(file, canvas.png(BITS)?).map_err(|error| format!("{}: {error}", file.display()))?;
    Ok(())
}
