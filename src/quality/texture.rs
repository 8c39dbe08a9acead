//! How far a texture slides: the difference of texture coordinates between a point and the one nearest to it.

use glam::{DVec2, DVec3};

use crate::mesh::{Mesh, names};

use super::{
    DistanceOptions, QualityError,
    bvh::Walker,
    sums::Sums,
    surface::Surface,
    triangle::{angle_at, weights_at},
};

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
    /// Where on the original the largest difference is, object units.
    pub max_at: [f64; 3],
    /// The texture coordinate there.
    pub uv_at: [f64; 2],
    /// The texture coordinate of the level at the point nearest to it.
    pub uv_to: [f64; 2],
}

/// How far a texture slides on a level as one sees it: the texture coordinate at samples of the original against that at
/// the nearest point of the level.
///
/// Coordinates are those of the attribute `uv`, as they are: no wrapping around. Where the nearest point lies on an edge
/// or a corner, and so perhaps on a seam, the triangle there that differs least counts. Where a level's seam has moved
/// sideways, the points between both seams see the wrong side of it: that is an error, and it is as large as the
/// seam's jump. Mean and rms tell such places from a texture that has slid everywhere. O((n + samples) log n).
///
/// # Errors
/// A mesh without a surface, without texture coordinates or with any that are not finite; a number of samples that is
/// not 1 to 2^32 - 1.
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
    /// How far a texture slides from this surface to a level of it: [`texture_deviation`] without building anything.
    ///
    /// # Errors
    /// A mesh without texture coordinates or with any that are not finite; a number of samples that is not 1 to 2^32 - 1.
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

    /// The coordinate inside a slot's triangle.
    fn at(&self, slot: u32, weights: [f64; 3]) -> DVec2 {
        let triangle = self.surface.bvh().triangle_of()[slot as usize] as usize;
        let corner = |v: u32| {
            let first = 2 * v as usize;
            DVec2::new(f64::from(self.uv[first]), f64::from(self.uv[first + 1]))
        };
        let [a, b, c] = self.surface.mesh().triangles()[triangle].map(corner);
        a + (b - a) * weights[1] + (c - a) * weights[2]
    }

    /// The coordinate at the point nearest to `point`; of several triangles there, the one nearest to `like`.
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
