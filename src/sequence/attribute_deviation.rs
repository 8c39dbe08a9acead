//! Deviations of a level's attributes, each in its own unit, separate from the geometric error.

use glam::{DVec2, DVec3};

use crate::mesh::{Attribute, Mesh, names};

use super::footprint::{self, Place};

/// Maximum ratio between a triangle's texture density and the average density, in either direction.
const DENSITY: f64 = 16.0;

/// Deviation of an attribute of a level: the difference between its value in the middle of every input triangle and the
/// level's value at the nearest place in the same chart. Samples each input triangle once: neither a bound nor a
/// measurement between the samples.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct AttributeDeviation {
    /// Name of the attribute.
    pub name: String,
    /// Mean weighted by the area of the input's triangles: degrees for normals, object units for texture coordinates
    /// (distance by which the texture has slid), else the largest difference of a channel (colours: 0 to 1).
    pub mean: f64,
    /// Maximum, in the unit of `mean`.
    pub max: f64,
}

/// Returns the deviations of every float attribute except skin weights and tangents.
pub(super) fn deviations(mesh: &Mesh, level: &Mesh, places: &[Place]) -> Vec<AttributeDeviation> {
    let is_measured =
        |a: &&Attribute| !names::is_set_of(a.name(), names::WEIGHTS) && a.name() != names::TANGENT;
    let measured = mesh.attributes().iter().filter(is_measured);
    measured.filter_map(|attribute| one(mesh, level, attribute, places)).collect()
}

fn one(mesh: &Mesh, level: &Mesh, source: &Attribute, places: &[Place]) -> Option<AttributeDeviation> {
    let target = level.attribute(source.name()).filter(|a| a.width() == source.width())?.as_floats()?;
    let (values, width) = (source.as_floats()?, source.width());
    let is_normal = source.name() == names::NORMAL && width == 3;
    let is_texture = names::is_set_of(source.name(), names::UV) && width == 2;
    let overall = if is_texture { density(mesh, values) } else { 1.0 };
    let (mut sum, mut whole, mut max) = (0.0f64, 0.0f64, 0.0f64);
    for (corners, place) in mesh.triangles().iter().zip(places) {
        let Some(ends) = level.triangles().get(place.triangle as usize) else { continue };
        let here =
            |i: usize| corners.iter().map(|&v| f64::from(values[v as usize * width + i])).sum::<f64>() / 3.0;
        let there = |i: usize| {
            let shares = ends.iter().zip(place.weights);
            shares.map(|(&v, w)| f64::from(w) * f64::from(target[v as usize * width + i])).sum::<f64>()
        };
        let area = double_area(mesh, *corners);
        let off = if is_normal {
            let vector = |of: &dyn Fn(usize) -> f64| DVec3::new(of(0), of(1), of(2));
            let (a, b) = (vector(&here), vector(&there));
            a.cross(b).length().atan2(a.dot(b)).to_degrees()
        } else if is_texture {
            let covered = texture_area(values, *corners).abs();
            let units = if covered > 0.0 { (area / covered).sqrt() } else { 0.0 };
            let units = units.clamp(overall / DENSITY, overall * DENSITY);
            units * DVec2::new(here(0) - there(0), here(1) - there(1)).length()
        } else {
            (0..width).map(|i| (here(i) - there(i)).abs()).fold(0.0, f64::max)
        };
        if off.is_finite() && area.is_finite() {
            sum += area * off;
            whole += area;
            max = max.max(off);
        }
    }
    let mean = if whole > 0.0 { sum / whole } else { 0.0 };
    Some(AttributeDeviation { name: source.name().to_owned(), mean, max })
}

fn double_area(mesh: &Mesh, corners: [u32; 3]) -> f64 {
    let [p, q, r] = corners.map(|v| footprint::at(mesh, v));
    (q - p).cross(r - p).length()
}

fn texture_area(uv: &[f32], corners: [u32; 3]) -> f64 {
    let [a, b, c] = corners.map(|v| {
        let at = 2 * v as usize;
        DVec2::new(f64::from(uv[at]), f64::from(uv[at + 1]))
    });
    (b - a).perp_dot(c - a)
}

/// Returns the mean object units covered by a unit of the texture; 0 where the texture covers no area.
fn density(mesh: &Mesh, uv: &[f32]) -> f64 {
    let (mut surface, mut texture) = (0.0, 0.0);
    for &corners in mesh.triangles() {
        let covered = texture_area(uv, corners).abs();
        if covered.is_finite() {
            surface += double_area(mesh, corners);
            texture += covered;
        }
    }
    if texture > 0.0 { (surface / texture).sqrt() } else { 0.0 }
}
