//! A mesh coloured by its vertices' distances from another: as a mesh, and as a picture with a scale.
//!
//! ```text
//!     +-----------+-----------+
//!     |   front   |   back    |      dark blue: 0;  yellow: the largest distance of a vertex
//!     +-----------+-----------+
//!     |   [||||||||||||||||]  |      scale: object units, and percent of the diagonal
//!     +-----------------------+
//! ```

use multires::mesh::{Attribute, Mesh, names};
use multires::quality::{self, Camera, Colours, Picture, QualityError, RenderOptions, palette};

use crate::canvas::Canvas;
use crate::lettering;
use crate::measure::number;
use crate::output::{Failure, percent};

/// Pixels on each side of a view, height of the scale's strip, and of the scale in it.
const VIEW: usize = 640;
const STRIP: u32 = 84;
const SCALE: [u32; 2] = [480, 16];
/// Where the scale begins under the views.
const TOP: u32 = 10;
const PAPER: [u8; 3] = [247, 247, 247];
const INK: [u8; 3] = [52, 58, 68];
/// Directions of view. The first is the direction of `Camera::framing` in the documentation's pictures.
const DIRECTIONS: [[f64; 3]; 2] = [[-0.55, -0.42, -1.0], [0.55, -0.42, 1.0]];
/// Name of the attribute holding the distances.
const DISTANCE: &str = "distance";

/// Distances and their colours, per vertex.
pub struct Painted {
    /// Largest distance of a vertex used by a triangle: the end of the scale, object units.
    pub most: f64,
    distances: Vec<f32>,
    colours: Vec<[u8; 3]>,
}

impl Painted {
    /// Colours `mesh` by its distance from `other`.
    ///
    /// # Errors
    /// The other mesh has no surface.
    pub fn new(mesh: &Mesh, other: &Mesh) -> Result<Self, QualityError> {
        let distances = quality::vertex_distances(mesh, other)?;
        let most = mesh.indices().iter().map(|&v| distances[v as usize]).fold(0.0, f64::max);
        // In parts of the scale, so no unit is too small or too large for single precision.
        let share = |d: f64| if most > 0.0 { (d / most) as f32 } else { 0.0 };
        let colours = distances.iter().map(|&d| palette::sequential(share(d))).collect();
        Ok(Self { most, distances: distances.iter().map(|&d| d as f32).collect(), colours })
    }

    /// Returns the mesh with these colours in place of its own.
    ///
    /// # Errors
    /// None known.
    pub fn mesh(&self, mesh: &Mesh) -> Result<Mesh, Failure> {
        let mut painted = Mesh::new(mesh.positions(), mesh.triangles()).map_err(Failure::input)?;
        painted = painted.with_origin(mesh.origin()).map_err(Failure::input)?;
        let colours: Vec<[f32; 3]> =
            self.colours.iter().map(|c| c.map(|byte| f32::from(byte) / 255.0)).collect();
        let distances: Vec<[f32; 1]> = self.distances.iter().map(|&d| [d]).collect();
        let own = mesh.attributes().iter().filter(|a| ![names::COLOR, DISTANCE].contains(&a.name())).cloned();
        let new = [Attribute::floats(names::COLOR, &colours), Attribute::floats(DISTANCE, &distances)];
        for attribute in own.chain(new) {
            painted = painted.with_attribute(attribute).map_err(Failure::input)?;
        }
        painted = painted.with_materials(mesh.materials()).map_err(Failure::input)?;
        Ok(painted.with_material_names(mesh.material_names()))
    }

    /// Returns two views of the mesh and a scale, as a PNG file.
    ///
    /// # Errors
    /// The renderer or the encoder fails.
    pub fn picture(&self, mesh: &Mesh) -> Result<Vec<u8>, Failure> {
        let options = RenderOptions::default()
            .with_size(VIEW, VIEW)
            .with_background(PAPER, PAPER)
            .with_colours(Colours::PerVertex(self.colours.clone()))
            .with_occlusion_rays(2);
        let views: Result<Vec<Picture>, QualityError> = DIRECTIONS
            .map(|direction| quality::render(mesh, &Camera::framing(mesh, direction), &options))
            .into_iter()
            .collect();
        let views = Picture::beside(&views.map_err(Failure::input)?);
        let (width, height) = (views.width() as u32, views.height() as u32);
        let mut sheet = Canvas::new(width, height + STRIP, PAPER);
        for (at, &colour) in (0..).zip(views.pixels()) {
            sheet.put(at % width, at / width, colour);
        }
        self.draw_scale(&mut sheet, [width, height + TOP], mesh.diagonal());
        sheet.png(8).map_err(Failure::input)
    }

    fn draw_scale(&self, sheet: &mut Canvas, [width, top]: [u32; 2], diagonal: f64) {
        let [length, thickness] = SCALE;
        let left = (width - length) / 2;
        for x in 0..length {
            let colour = palette::sequential(x as f32 / (length - 1) as f32);
            (0..thickness).for_each(|y| sheet.put(left + x, top + y, colour));
        }
        for share in [0.0, 0.5, 1.0] {
            let x = left as f32 + share as f32 * (length - 1) as f32;
            (0..5).for_each(|y| sheet.put(x as u32, top + thickness + y, INK));
            let distance = share * self.most;
            let of_diagonal = format!("{} %", number(percent(distance, diagonal).unwrap_or(0.0)));
            for (line, text) in [number(distance), of_diagonal].into_iter().enumerate() {
                let y = (top + thickness + 17) as f32 + 22.0 * line as f32;
                lettering::write(sheet, &text, [x, y], INK);
            }
        }
    }
}
