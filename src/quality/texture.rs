//! Texture deviation: the difference of texture coordinates between a point and the nearest point of another surface.

use glam::{DVec2, DVec3};

use crate::geometry::{
    bvh::Walker,
    triangle::{angle_at, weights_at},
};
use crate::mesh::{Mesh, names};

use super::{DistanceOptions, QualityError, sums::Sums, surface::Surface};

/// Differences of texture coordinates over the area of a surface, in texture units (1: the whole picture).
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct TextureDeviation {
    /// Largest difference found.
    pub max: f64,
    /// Mean difference over the area.
    pub mean: f64,
    /// Root of the mean square difference over the area.
    pub rms: f64,
    /// Point of the original with the largest difference, object units.
    pub max_at: [f64; 3],
    /// Texture coordinate of the original at `max_at`.
    pub uv_at: [f64; 2],
    /// Texture coordinate of the level at the point nearest to `max_at`.
    pub uv_to: [f64; 2],
}

/// Measures how far a texture appears to slide on a level: the texture coordinates at samples of the original against
/// the coordinates at the nearest points of the level.
///
/// Coordinates are the values of the attribute `uv`, without wrapping. If the nearest point lies on an edge or a
/// corner, perhaps on a seam, the triangle with the smallest difference there counts. If a level's seam has moved
/// sideways, points between both seams see the wrong side of the seam: an error as large as the seam's jump. Mean and
/// rms tell such places from a texture slid everywhere. O((n + samples) log n).
///
/// # Errors
/// A mesh has no surface, or no texture coordinates, or coordinates that are not finite; `samples` is not in `1..2^32`.
///
/// ```
/// use multires::{Simplifier, mesh::shapes, quality::{DistanceOptions, texture_deviation}};
/// let mesh = shapes::demo();
/// let sequence = Simplifier::new().run(&mesh)?;
/// let level = sequence.extract(&mesh, sequence.steps_for_triangles(20_000));
/// let slid = texture_deviation(&mesh, &level, &DistanceOptions::default().with_samples(20_000))?;
/// assert!(slid.mean < slid.rms && slid.mean < 0.02, "{slid:?}");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn texture_deviation(
    original: &Mesh,
    level: &Mesh,
    options: &DistanceOptions,
) -> Result<TextureDeviation, QualityError> {
    options.check()?;
    let (first, second) = (Surface::named(original, "first")?, Surface::named(level, "second")?);
    first.slide(&second, options, "first")
}

impl Surface<'_> {
    /// Measures how far a texture slides from this surface to a level of it: [`texture_deviation`] on prepared
    /// surfaces.
    ///
    /// # Errors
    /// A mesh has no texture coordinates, or coordinates that are not finite; `samples` is not in 1 to 2^32 - 1.
    pub fn texture_deviation_to(
        &self,
        level: &Surface<'_>,
        options: &DistanceOptions,
    ) -> Result<TextureDeviation, QualityError> {
        options.check()?;
        self.slide(level, options, "given")
    }

    fn slide(
        &self,
        level: &Surface<'_>,
        options: &DistanceOptions,
        which: &'static str,
    ) -> Result<TextureDeviation, QualityError> {
        let (from, to) = (Texture::of(self, which)?, Texture::of(level, "second")?);
        let start = || (level.bvh().walker(), Sums::NONE);
        let sums = self.on_faces(options, start, |(walker, sums), slot, weights, point| {
            let here = from.at(slot, weights);
            let there = to.nearest(walker, point, here);
            sums.add((there - here).length(), (point, here, there));
        });
        let sums = sums.into_iter().map(|(_, sums)| sums).fold(Sums::NONE, Sums::join);
        let (max, (max_at, uv_at, uv_to)) = sums.highest().unwrap_or_default();
        Ok(TextureDeviation {
            max,
            mean: sums.mean(options.samples),
            rms: sums.rms(options.samples),
            max_at: max_at.to_array(),
            uv_at: uv_at.to_array(),
            uv_to: uv_to.to_array(),
        })
    }
}

/// A surface with its texture coordinates.
struct Texture<'a> {
    surface: &'a Surface<'a>,
    uv: &'a [f32],
}

impl<'a> Texture<'a> {
    fn of(surface: &'a Surface<'a>, which: &'static str) -> Result<Self, QualityError> {
        let own = surface.mesh().attribute(names::UV).filter(|a| a.width() == 2);
        let uv = own.and_then(|a| a.as_floats()).ok_or(QualityError::NoTexture { which })?;
        match uv.iter().position(|x| !x.is_finite()) {
            Some(at) => Err(QualityError::NonFiniteTexture { which, vertex: at / 2 }),
            None => Ok(Self { surface, uv }),
        }
    }

    /// Returns the coordinate at a point of a slot's triangle.
    fn at(&self, slot: u32, weights: [f64; 3]) -> DVec2 {
        let triangle = self.surface.bvh().triangle_of()[slot as usize] as usize;
        let corner = |v: u32| {
            let first = 2 * v as usize;
            DVec2::new(f64::from(self.uv[first]), f64::from(self.uv[first + 1]))
        };
        let [a, b, c] = self.surface.mesh().triangles()[triangle].map(corner);
        a + (b - a) * weights[1] + (c - a) * weights[2]
    }

    /// Returns the coordinate at the point nearest to `point`; of several triangles there, the coordinate nearest to
    /// `like`.
    fn nearest(&self, walker: &mut Walker<'_>, point: DVec3, like: DVec2) -> DVec2 {
        let bvh = self.surface.bvh();
        let nearest = walker.closest(point);
        let on = |slot: u32| self.at(slot, weights_at(&bvh.corners(slot), nearest.point));
        let mut best = on(nearest.slot);
        if angle_at(&bvh.corners(nearest.slot), nearest.point, 2.0 * bvh.touch()) < std::f64::consts::TAU {
            walker.touching(nearest.point, |slot| {
                let uv = on(slot);
                if (uv - like).length_squared() < (best - like).length_squared() {
                    best = uv;
                }
            });
        }
        best
    }
}
