//! The texture of a wavelet mesh, by its base: one picture that lies on every level of detail as it lies on the full mesh.

use multires::Baked;
use multires::io;
use multires::quality::palette;
use multires::wavelet::{Atlas, AtlasOptions, SurfacePoint, WaveletMesh};

use crate::renderer::Vertex;

/// Texels along a side: the first that leaves charts at least so many, or the last.
const SIDES: [u32; 3] = [1024, 2048, 4096];
const LEAST_CHART: u32 = 16;
/// Texels of no chart. Filters of small pictures reach them, so they are no colour.
const BETWEEN: [u8; 4] = [168, 168, 168, 255];

/// Most texels along a side of a picture that is read: what cards take.
const LARGEST: u32 = 8192;

/// A picture to paint surfaces with.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Texture {
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Row by row, sRGB and opacity.
    pub pixels: Vec<[u8; 4]>,
}

impl Texture {
    /// Decodes a PNG.
    ///
    /// # Errors
    /// It is no PNG, or larger than cards take.
    pub fn from_png(bytes: &[u8]) -> Result<Self, String> {
        let mut decoder = png::Decoder::new(std::io::Cursor::new(bytes));
        decoder
            .set_transformations(png::Transformations::normalize_to_color8() | png::Transformations::ALPHA);
        let mut reader = decoder.read_info().map_err(|error| error.to_string())?;
        let size = [reader.info().width, reader.info().height];
        if size.iter().any(|&side| side > LARGEST) {
            return Err(format!("{} x {} pixels are more than {LARGEST} on a side", size[0], size[1]));
        }
        let mut bytes = vec![0; reader.output_buffer_size().ok_or("the picture is too large")?];
        reader.next_frame(&mut bytes).map_err(|error| error.to_string())?;
        let pixels = match reader.output_color_type().0 {
            png::ColorType::GrayscaleAlpha => {
                bytes.as_chunks().0.iter().map(|&[l, a]| [l, l, l, a]).collect()
            }
            _ => bytes.as_chunks().0.to_vec(),
        };
        Ok(Self { size, pixels })
    }
}

/// A model with the coordinates of an atlas of its base instead of those that it had, and a texture for them, where it is a wavelet
/// mesh and can be; else as it is.
pub(super) fn worn(
    baked: Box<dyn io::StoredModel<Vertex>>,
) -> (Box<dyn io::StoredModel<Vertex>>, Option<Texture>) {
    let wavelets = baked.as_any().downcast_ref::<Baked<WaveletMesh>>();
    match wavelets.and_then(|wavelets| by_base(wavelets.structure())) {
        Some((mesh, texture)) => (Box::new(Baked::from(mesh)), Some(texture)),
        None => (baked, None),
    }
}

/// The mesh with the coordinates of an atlas instead of those that it had, and a colour for each base face, with a checker in its
/// barycentric coordinates, as the texture. `None` where there are too many base faces for a picture that cards take.
fn by_base(mesh: &WaveletMesh) -> Option<(WaveletMesh, Texture)> {
    let faces = mesh.subdivision().base_face_count();
    // Two charts share a square cell.
    let across = ((faces as f64 / 2.0).sqrt().ceil() as u32).max(1);
    let side = SIDES.into_iter().find(|side| side / across >= LEAST_CHART).unwrap_or(SIDES[2]);
    // A wide gutter keeps small pictures from mixing charts, but must not eat them up.
    let gutter = (side / across / 16).clamp(1, 8);
    let atlas = Atlas::new(mesh, &AtlasOptions::default().with_resolution(side).with_gutter(gutter)).ok()?;
    // About as many squares on a base of few faces as on one of many.
    let squares = (64.0 / (faces as f64).sqrt()).log2().round().clamp(1.0, 5.0).exp2();
    // Borders between small triangles are as wide as a texel.
    let texel = squares * f64::from(across) / f64::from(side);
    let mut pixels = atlas.bake(mesh, |point| colour(point, squares, texel)).ok()?;
    pixels.iter_mut().filter(|pixel| pixel[3] == 0).for_each(|pixel| *pixel = BETWEEN);
    Some((mesh.with_atlas(&atlas).ok()?, Texture { size: [side; 2], pixels }))
}

/// Small triangles of a base face in turns in its colour and half-way to white, `squares` along an edge. Borders between them are
/// blurred over `width`, in edges of small triangles.
fn colour(point: &SurfacePoint, squares: f64, width: f64) -> [u8; 4] {
    // 1 and -1 in turns, through 0 at whole numbers.
    let turns = |at: f64| {
        let (whole, part) = (at.floor(), at - at.floor());
        // At 0 another face begins.
        let below = if whole > 0.0 { part } else { 1.0 };
        let near = (below.min(1.0 - part) / (0.5 * width).max(1e-9)).min(1.0);
        if whole % 2.0 == 0.0 { near } else { -near }
    };
    let product: f64 = point.domain.barycentric.iter().map(|weight| turns(weight * squares)).product();
    let white = 0.25 - 0.25 * product;
    let mix = |channel: u8| (f64::from(channel) * (1.0 - white) + 255.0 * white).round() as u8;
    let [r, g, b] = palette::categorical(point.domain.base_face).map(mix);
    [r, g, b, 255]
}
