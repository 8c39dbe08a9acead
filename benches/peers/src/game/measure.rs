//! What a level is worth, measured against the model: one struct, every number 0 for the model itself.

use std::error::Error;

use multires::mesh::{Mesh, names};
use multires::quality::{DistanceOptions, Surface, SurfacePoint};

use super::model::{Model, floats, uv_area};
use super::picture::{Pictures, blend, dot, twice_area, unit, units_per_uv};
use super::validity;

/// Share of the diagonal beyond which a texture has not slid but is another: seams count as that much.
const ELSEWHERE: f64 = 0.1;
/// How much finer or coarser than on average a triangle's texture counts at most.
const DENSITY: f64 = 16.0;

/// How far a level is from its model.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Measures {
    pub triangles: usize,
    /// Two-sided distance, mean and maximum, percent of the model's diagonal.
    pub mean: f64,
    pub max: f64,
    /// Mean angle between the normals to shade with, degrees.
    pub normals: f64,
    /// Mean angle between facets, degrees.
    pub facets: f64,
    /// Mean distance by which the texture slides, percent of the diagonal; a tenth of the diagonal at most anywhere.
    pub slide: f64,
    /// Mean difference of pictures, levels of 255.
    pub image: f64,
    /// Triangles whose texture is mirrored where the model's is not.
    pub flipped: usize,
    /// Vertices with invalid attributes.
    pub invalid: usize,
}

/// A model prepared to measure levels of it.
pub(crate) struct Reference<'a> {
    surface: Surface<'a>,
    options: DistanceOptions,
    samples: Vec<SurfacePoint>,
    points: Vec<[f64; 3]>,
    pictures: Option<Pictures>,
}

impl<'a> Reference<'a> {
    /// With that many samples; without pictures where they are not wanted.
    pub(crate) fn new(model: &'a Model, samples: usize, pictures: bool) -> Result<Self, Box<dyn Error>> {
        let surface = Surface::new(&model.mesh)?;
        let options = DistanceOptions::default().with_samples(samples);
        let samples = surface.samples(&options)?;
        let points = samples.iter().map(|sample| sample.position).collect();
        let pictures = pictures.then(|| Pictures::new(&model.mesh));
        Ok(Self { surface, options, samples, points, pictures })
    }

    pub(crate) fn pictures(&self) -> Option<&Pictures> {
        self.pictures.as_ref()
    }

    /// Measures a level; nothing where it has no surface.
    pub(crate) fn measure(&self, level: &Mesh) -> Result<Option<Measures>, Box<dyn Error>> {
        let Ok(surface) = Surface::new(level) else { return Ok(None) };
        let original = self.surface.mesh();
        let distance = self.surface.distance(&surface, &self.options)?;
        let facets = self.surface.normal_deviation_to(&surface, &self.options)?.oriented.mean;
        let (turned, slide) = self.appearance(&surface);
        Ok(Some(Measures {
            triangles: level.triangles().len(),
            mean: distance.mean_percent(),
            max: distance.hausdorff_percent(),
            normals: turned.unwrap_or(facets),
            facets,
            slide: slide.map_or(0.0, |slide| 100.0 * slide / self.surface.diagonal()),
            image: self.pictures.as_ref().map_or(0.0, |pictures| pictures.difference(level)),
            flipped: validity::flipped(&self.surface, level),
            invalid: validity::invalid_vertices(original, level),
        }))
    }

    /// Mean angle between normals in degrees, and mean slide of the texture in object units, from samples of the model to
    /// the nearest points of the level; of several triangles there, the one that differs least counts.
    fn appearance(&self, level: &Surface<'_>) -> (Option<f64>, Option<f64>) {
        let (from, to) = (self.surface.mesh(), level.mesh());
        let pair = |name, width| Some((floats(from, name, width)?, floats(to, name, width)?));
        let (normals, uv) = (pair(names::NORMAL, 3), pair(names::UV, 2));
        let overall = units_per_uv(from);
        let (mut turned, mut slid) = (0.0, 0.0);
        level.nearest(&self.points, |number, places| {
            let here = &self.samples[number];
            let corners = from.triangles()[here.triangle as usize];
            let there = |place: &SurfacePoint| (to.triangles()[place.triangle as usize], place.weights);
            if let Some((a, b)) = normals {
                let own = unit(blend(a, 3, corners, here.weights));
                let angle = |place: &SurfacePoint| {
                    let (corners, weights) = there(place);
                    dot(own, unit(blend(b, 3, corners, weights))).clamp(-1.0, 1.0).acos().to_degrees()
                };
                turned += places.iter().map(angle).fold(180.0, f64::min);
            }
            if let Some((a, b)) = uv {
                let own = blend(a, 2, corners, here.weights);
                let apart = |place: &SurfacePoint| {
                    let (corners, weights) = there(place);
                    let other = blend(b, 2, corners, weights);
                    (own[0] - other[0]).hypot(own[1] - other[1])
                };
                let covered = uv_area(a, corners).abs();
                let units = if covered > 0.0 { (twice_area(from, corners) / covered).sqrt() } else { 0.0 };
                let units = units.clamp(overall / DENSITY, overall * DENSITY);
                let least = places.iter().map(apart).fold(f64::MAX, f64::min);
                slid += (least * units).min(ELSEWHERE * self.surface.diagonal());
            }
        });
        let count = self.samples.len() as f64;
        (normals.map(|_| turned / count), uv.map(|_| slid / count))
    }
}
