//! The sphere of Azuma et al. (section 4): an octahedron subdivided five times, 8,192 faces, and how many of them a view asks for.

use std::error::Error;
use std::io::Write;
use std::sync::Arc;

use glam::DVec3;
use multires::lod::{Lod, LodOptions, Triangulation, Values, VertexBuffer};
use multires::mesh::Mesh;
use multires::wavelet::{ErrorBound, WaveletBuilder, WaveletError, WaveletLod, WaveletMesh, WaveletOptions};

use super::canvas::Canvas;
use super::flight::Pose;
use super::painted::{self, Painted};
use super::plates::Plates;
use super::sheet::SIZE;

/// What errors are forgiven inside and on the silhouette, pixels (Fig. 11).
pub const PIXELS: [f32; 2] = [3.5, 0.5];
/// Triangles that the paper has left there.
const THEIRS: usize = 732;
const LEVELS: usize = 5;
/// From so many radii the sphere fills the picture from top to foot.
const FILLING: f64 = 2.0;

/// Midpoints go out to radius 1.
pub fn build(options: &WaveletOptions) -> Result<WaveletMesh, WaveletError> {
    let positions = [[1., 0., 0.], [-1., 0., 0.], [0., 1., 0.], [0., -1., 0.], [0., 0., 1.], [0., 0., -1.]];
    let triangles = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    let octahedron = Mesh::new(positions, triangles)?;
    let mut builder = WaveletBuilder::new(&octahedron)?;
    for _ in 0..LEVELS {
        builder.subdivide(|midpoint| {
            let length = midpoint.middle.iter().map(|x| x * x).sum::<f32>().sqrt();
            midpoint.middle.map(|x| x / length)
        })?;
    }
    builder.build(options)
}

fn pose(distance: f64) -> Pose {
    let eye = DVec3::new(0.45, 0.35, 0.9).normalize() * distance;
    Pose { eye, target: DVec3::ZERO, up: DVec3::Y }
}

/// How many triangles are drawn from where, and a picture from where it is as many as in the paper.
pub fn distances(says: &mut impl Write) -> Result<Canvas, Box<dyn Error>> {
    let ways = [
        (Triangulation::Exact, ErrorBound::Conservative),
        (Triangulation::Exact, ErrorBound::WithoutSiblings),
        (Triangulation::Minimal, ErrorBound::Conservative),
        (Triangulation::Minimal, ErrorBound::WithoutSiblings),
    ];
    let mut lods = Vec::new();
    for (triangulation, bound) in ways {
        let mesh = Arc::new(build(&WaveletOptions::default().with_bound(bound))?);
        let drawing =
            LodOptions::default().with_buffer(VertexBuffer::Whole).with_triangulation(triangulation);
        let values = Values::from(mesh.vertices().positions().to_vec()).with_blending();
        lods.push(WaveletLod::new(mesh.clone(), values, &drawing)?);
    }
    let mut count = |distance: f64| -> Result<Vec<usize>, Box<dyn Error>> {
        let view = pose(distance).view(SIZE.map(|n| n as u32))?;
        let views = [view.with_tolerance_px(PIXELS[0]).with_silhouette_px(PIXELS[1]).of_world()];
        Ok(lods.iter_mut().map(|lod| lod.adapt(&views, 1.0 / 60.0).triangles).collect())
    };
    writeln!(
        says,
        "triangles of the sphere, {} x {}, {} px inside, {} px on the silhouette",
        SIZE[0], SIZE[1], PIXELS[0], PIXELS[1]
    )?;
    writeln!(
        says,
        "radii  exact, conservative  exact, no siblings  minimal, conservative  minimal, no siblings"
    )?;
    for distance in [1.25, 1.5, 1.75, 2.0, 2.5, 3.0, 4.0, 6.0, 8.0, 12.0, 24.0] {
        let [a, b, c, d] = count(distance)?[..] else { continue };
        writeln!(says, "{distance:>5} {a:>20} {b:>19} {c:>22} {d:>21}")?;
    }
    // Every thousandth of a radius from near to far: where each has as many as the paper.
    let mut found: Vec<Vec<f64>> = vec![Vec::new(); ways.len()];
    for step in 1_100..8_000 {
        let distance = f64::from(step) / 1000.0;
        for (way, count) in count(distance)?.into_iter().enumerate() {
            if count == THEIRS {
                found[way].push(distance);
            }
        }
    }
    for ((triangulation, bound), at) in ways.iter().zip(&found) {
        let place = match at[..] {
            [first, .., last] => format!("at {} distances from {first} to {last} radii", at.len()),
            [only] => format!("at {only} radii"),
            [] => "nowhere".to_owned(),
        };
        writeln!(says, "{THEIRS} triangles, {triangulation:?}, {bound:?}: {place}")?;
    }
    // Where the sphere about fills the picture's height.
    let filling = |a: &&f64, b: &&f64| (**a - FILLING).abs().total_cmp(&(**b - FILLING).abs());
    let pictured = found[0].iter().min_by(filling).copied().unwrap_or(FILLING);
    writeln!(says, "pictured from {pictured} radii")?;
    let mesh = Arc::new(build(&WaveletOptions::default())?);
    let painted = Painted::new(&mesh, painted::marble)?;
    Plates { mesh: &mesh, painted: &painted, pixels: PIXELS }.outside(&pose(pictured))
}
