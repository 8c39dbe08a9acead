//! Pictures of a wavelet mesh as in Figs. 8, 11 and 13 of Azuma et al., and how different the adapted mesh looks from the full one.

use std::error::Error;
use std::sync::Arc;

use multires::lod::{Lod, LodOptions, Values, VertexBuffer};
use multires::mesh::Mesh;
use multires::quality::{Colours, RenderOptions, Shading, render};
use multires::wavelet::{Normals, WaveletLod, WaveletMesh};

use super::canvas::Canvas;
use super::flight::Pose;
use super::outside::{self, LEGEND, Shot, camera};
use super::painted::Painted;
use super::say::grouped;
use super::sheet::{Cell, SIZE, sheet};

/// Pixels of the pictures that are compared.
pub const COMPARED: [usize; 2] = [960, 540];
const PAPER: [u8; 3] = [255; 3];
const GREY: [u8; 3] = [176, 186, 200];

/// What is pictured: a mesh, what is painted on it, and how large errors may look inside and on the silhouette, pixels.
pub struct Plates<'a> {
    pub mesh: &'a Arc<WaveletMesh>,
    pub painted: &'a Painted,
    pub pixels: [f32; 2],
}

/// Compared pictures have one ray a pixel, so that each shows the mesh or does not.
fn options(size: [usize; 2]) -> RenderOptions {
    RenderOptions::default()
        .with_size(size[0], size[1])
        .with_background(PAPER, PAPER)
        .with_occlusion_rays(0)
        .with_supersampling(size == SIZE)
        .with_colours(Colours::Uniform(GREY))
}

impl Plates<'_> {
    /// An instance as a picture of that size asks for.
    fn adapted(
        &self,
        pose: &Pose,
        size: [usize; 2],
        pixels: [f32; 2],
    ) -> Result<WaveletLod<[f32; 3]>, Box<dyn Error>> {
        let values = Values::from(self.mesh.vertices().positions().to_vec()).with_blending();
        let mut lod = WaveletLod::new(
            self.mesh.clone(),
            values,
            &LodOptions::default().with_buffer(VertexBuffer::Whole),
        )?;
        let view = pose.view(size.map(|n| n as u32))?;
        lod.adapt(&[view.with_tolerance_px(pixels[0]).with_silhouette_px(pixels[1]).of_world()], 1.0 / 60.0);
        Ok(lod)
    }

    fn flat(&self, mesh: &Mesh, pose: &Pose, size: [usize; 2]) -> Result<Vec<[u8; 3]>, Box<dyn Error>> {
        let options = options(size).with_shading(Shading::Flat);
        Ok(render(mesh, &camera(pose), &options)?.pixels().to_vec())
    }

    fn textured(
        &self,
        shows: impl Fn(u32) -> bool,
        pose: &Pose,
        size: [usize; 2],
    ) -> Result<Vec<[u8; 3]>, Box<dyn Error>> {
        let [_, textured] = self.lit_and_textured(shows, pose, size)?;
        Ok(textured)
    }

    /// With the normals of the full resolution; in one colour, and in those painted on it.
    fn lit_and_textured(
        &self,
        shows: impl Fn(u32) -> bool,
        pose: &Pose,
        size: [usize; 2],
    ) -> Result<[Vec<[u8; 3]>; 2], Box<dyn Error>> {
        // As wide as between rays.
        let rays = size[1] * if size == SIZE { 2 } else { 1 };
        let pixel = Pose::slopes()[1] * 2.0 / rays as f64 * (pose.eye - pose.target).length();
        let (surface, colours) = self.painted.on(self.mesh, shows, pixel)?;
        let painted = options(size).with_colours(Colours::PerVertex(colours));
        let [lit, painted] =
            [options(size), painted].map(|options| render(&surface, &camera(pose), &options));
        Ok([lit?.pixels().to_vec(), painted?.pixels().to_vec()])
    }

    /// Full and adapted, each flat shaded and textured (Fig. 8).
    pub fn beside(&self, pose: &Pose) -> Result<Canvas, Box<dyn Error>> {
        let lod = self.adapted(pose, SIZE, self.pixels)?;
        let row = |name: &str, mesh: Mesh, textured| -> Result<Vec<Cell>, Box<dyn Error>> {
            let caption = format!("{name}, {} triangles", grouped(mesh.triangles().len()));
            let flat = Cell { pixels: self.flat(&mesh, pose, SIZE)?, caption };
            Ok(vec![flat, Cell { pixels: textured, caption: format!("{name}, textured") }])
        };
        let textured = [self.textured(|_| true, pose, SIZE)?, self.textured(|w| lod.shows(w), pose, SIZE)?];
        let [full, adapted] = textured;
        let rows =
            [row("full", self.mesh.finest(Normals::Kept), full)?, row("adapted", lod.to_mesh(), adapted)?];
        Ok(sheet(&rows, &[]))
    }

    /// Full, adapted, and adapted as seen from outside (Fig. 11).
    pub fn outside(&self, pose: &Pose) -> Result<Canvas, Box<dyn Error>> {
        let lod = self.adapted(pose, SIZE, self.pixels)?;
        let shot = |mesh: Mesh| Shot { mesh, pose: *pose };
        let [full, adapted] = [shot(self.mesh.finest(Normals::Kept)), shot(lod.to_mesh())];
        let cell = |name: &str, shot: &Shot, pixels| {
            let caption = match name {
                "from outside" => name.to_owned(),
                _ => format!("{name}, {} triangles", grouped(shot.mesh.triangles().len())),
            };
            Cell { pixels, caption }
        };
        let row = vec![
            cell("full", &full, outside::view(&full, 1.0)?),
            cell("adapted", &adapted, outside::view(&adapted, 1.0)?),
            cell("from outside", &adapted, outside::outside(&adapted)?),
        ];
        Ok(sheet(&[row], &LEGEND))
    }

    /// A coarse level, adapted and full, with edges and textured (Fig. 13).
    pub fn levels(&self, pose: &Pose) -> Result<Canvas, Box<dyn Error>> {
        let lod = self.adapted(pose, SIZE, self.pixels)?;
        let drawn: usize = (0..lod.groups()).map(|group| lod.triangles(group).len()).sum();
        let of = self.mesh.subdivision();
        let count = |level: usize| of.faces_of(level).len();
        let level = (0..of.depth()).rev().find(|&level| count(level) <= drawn / 4).unwrap_or(0);
        let coarse = of.wavelets_of(level).end;

        let edged = [
            ("coarse", self.mesh.at_level(level, Normals::Kept)),
            ("adapted", lod.to_mesh()),
            ("full", self.mesh.finest(Normals::Kept)),
        ];
        let textured = [
            self.textured(|wavelet| wavelet < coarse, pose, SIZE)?,
            self.textured(|wavelet| lod.shows(wavelet), pose, SIZE)?,
            self.textured(|_| true, pose, SIZE)?,
        ];
        let mut rows = [Vec::new(), Vec::new()];
        for ((name, mesh), pixels) in edged.into_iter().zip(textured) {
            let caption = format!("{name}, {} triangles", grouped(mesh.triangles().len()));
            let shot = Shot { mesh, pose: *pose };
            rows[0].push(Cell { pixels: outside::view(&shot, 1.0)?, caption });
            rows[1].push(Cell { pixels, caption: format!("{name}, textured") });
        }
        Ok(sheet(&rows, &[]))
    }

    /// How different the adapted mesh looks from another mesh that it stands for, lit, by errors inside and on the silhouette in pixels;
    /// with the triangles drawn.
    pub fn against(
        &self,
        original: &Mesh,
        pose: &Pose,
        pixels: &[[f32; 2]],
    ) -> Result<Vec<(f64, usize)>, Box<dyn Error>> {
        let shown = render(original, &camera(pose), &options(COMPARED))?;
        let one = |&pixels: &[f32; 2]| {
            let lod = self.adapted(pose, COMPARED, pixels)?;
            // Normals as they are, since those of the original are not filtered either.
            let (surface, _) = self.painted.on(self.mesh, |wavelet| lod.shows(wavelet), 0.0)?;
            let lit = render(&surface, &camera(pose), &options(COMPARED))?;
            let drawn = (0..lod.groups()).map(|group| lod.triangles(group).len()).sum();
            Ok((mean_difference(shown.pixels(), lit.pixels(), |shown| shown != [false; 2]), drawn))
        };
        pixels.iter().map(one).collect()
    }

    /// Another mesh, and the adapted mesh at two tolerances, with edges and textured (Fig. 13).
    pub fn tolerances(
        &self,
        original: &Mesh,
        pose: &Pose,
        pixels: [f32; 2],
    ) -> Result<Canvas, Box<dyn Error>> {
        let mut rows = [Vec::new(), Vec::new()];
        let mut add = |name: String, mesh: Mesh, textured| -> Result<(), Box<dyn Error>> {
            let caption = format!("{name}, {} triangles", grouped(mesh.triangles().len()));
            let shot = Shot { mesh, pose: *pose };
            rows[0].push(Cell { pixels: outside::view(&shot, 1.0)?, caption });
            rows[1].push(Cell { pixels: textured, caption: format!("{name}, textured") });
            Ok(())
        };
        // The original has no texture: beside it stands the full remesh's.
        add("original".to_owned(), original.clone(), self.textured(|_| true, pose, SIZE)?)?;
        for pixels in pixels {
            let lod = self.adapted(pose, SIZE, [pixels; 2])?;
            let textured = self.textured(|wavelet| lod.shows(wavelet), pose, SIZE)?;
            add(format!("{pixels} px"), lod.to_mesh(), textured)?;
        }
        Ok(sheet(&rows, &[]))
    }

    /// How different the adapted mesh looks from the full one, where errors may look that large inside and on silhouettes.
    pub fn differences(&self, pose: &Pose, pixels: &[[f32; 2]]) -> Result<Vec<Difference>, Box<dyn Error>> {
        let [lit, textured] = self.lit_and_textured(|_| true, pose, COMPARED)?;
        let flat = self.flat(&self.mesh.finest(Normals::Kept), pose, COMPARED)?;
        let one = |&pixels: &[f32; 2]| {
            let lod = self.adapted(pose, COMPARED, pixels)?;
            let [adapted_lit, adapted] = self.lit_and_textured(|w| lod.shows(w), pose, COMPARED)?;
            Ok(Difference {
                lit: mean_difference(&lit, &adapted_lit, |shown| shown != [false; 2]),
                textured: mean_difference(&textured, &adapted, |shown| shown != [false; 2]),
                inside: mean_difference(&textured, &adapted, |shown| shown == [true; 2]),
                flat: mean_difference(&flat, &self.flat(&lod.to_mesh(), pose, COMPARED)?, |shown| {
                    shown != [false; 2]
                }),
            })
        };
        pixels.iter().map(one).collect()
    }
}

/// In levels of 255, mean over channels and pixels, from the same eye.
pub struct Difference {
    /// In one colour, with the normals of the full resolution, over the pixels that show either (K_L1 of Southern, section 4.2.2).
    pub lit: f64,
    /// Textured too.
    pub textured: f64,
    /// The same over the pixels that show both.
    pub inside: f64,
    /// Flat shaded, over the pixels that show either.
    pub flat: f64,
}

fn mean_difference(a: &[[u8; 3]], b: &[[u8; 3]], counts: impl Fn([bool; 2]) -> bool) -> f64 {
    let (mut sum, mut count) = (0_u64, 0_u64);
    for (p, q) in a.iter().zip(b).filter(|(p, q)| counts([**p, **q].map(|pixel| pixel != PAPER))) {
        sum += (0..3).map(|k| u64::from(p[k].abs_diff(q[k]))).sum::<u64>();
        count += 3;
    }
    sum as f64 / count.max(1) as f64
}
