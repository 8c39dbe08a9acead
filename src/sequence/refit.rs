//! Fits attributes of a level to the input: least squares over the input's whole surface.
//!
//! ```text
//!   least   sum over the input's triangles of  area * |value at the middle - value of the level where that lies|^2
//! ```
//!
//! Values kept from the input are exact at their vertices and, between vertices, deviate as far as the input bends.
//! Fitted values deviate a little everywhere, and less on average. The least squares are found iteratively: each round
//! adds to each vertex the mean residual over the places in which it has a share, weighted by area times share.

use crate::mesh::{Attribute, Mesh, Topology, names};

use super::footprint::{self, Place};
use super::solved::{normalise, straighten_tangents};

/// Number of rounds of passing back residuals. Each round about halves the residual.
const ROUNDS: usize = 4;

/// Returns true if an attribute is fitted: it is numeric, may be blended, and is meaningful without other attributes.
fn is_fitted(attribute: &Attribute) -> bool {
    let name = attribute.name();
    let by_itself = !names::is_set_of(name, names::WEIGHTS) && name != names::TANGENT;
    by_itself && attribute.as_floats().is_some()
}

/// Fits the attributes of `level`. `places`: place of each triangle of `mesh` on it. Locked vertices keep their values.
pub(super) fn refit(mesh: &Mesh, level: &Mesh, places: &[Place]) -> Vec<Attribute> {
    let mut attributes = level.attributes().to_vec();
    if !attributes.iter().any(is_fitted) || level.triangles().is_empty() {
        return attributes;
    }
    let whole = mesh.diagonal().powi(2).max(f64::MIN_POSITIVE);
    let areas: Vec<f32> = mesh.triangles().iter().map(|t| (area(mesh, *t) / whole) as f32).collect();
    let topology = Topology::new(level);
    let locked = |v: usize| level.locks().get(v).copied().unwrap_or(false);
    for (source, target) in mesh.attributes().iter().zip(&mut attributes) {
        if !is_fitted(source) {
            continue;
        }
        // Vertices of equal position and value are fitted together: a seam of other attributes must not become a seam
        // of this attribute.
        let one_of = topology.equal_values(target);
        fit(mesh, level, source, target, &one_of, places, &areas);
        for vertex in 0..level.positions().len() {
            if locked(vertex) {
                let width = source.width();
                let old = level.attribute(source.name()).and_then(|a| a.as_floats()).unwrap_or_default();
                if let (Some(new), Some(old)) =
                    (target.floats_mut(), old.get(vertex * width..(vertex + 1) * width))
                {
                    new[vertex * width..][..width].copy_from_slice(old);
                }
            } else {
                normalise(target, vertex);
            }
        }
    }
    straighten_tangents(&mut attributes, |row| !locked(row));
    attributes
}

fn area(mesh: &Mesh, [a, b, c]: [u32; 3]) -> f64 {
    let [p, q, r] = [a, b, c].map(|v| footprint::at(mesh, v));
    (q - p).cross(r - p).length()
}

fn fit(
    mesh: &Mesh,
    level: &Mesh,
    source: &Attribute,
    target: &mut Attribute,
    one_of: &[u32],
    places: &[Place],
    areas: &[f32],
) {
    let width = source.width();
    let (Some(values), Some(fitted)) = (source.as_floats(), target.floats_mut()) else { return };
    let row = |v: u32| &values[v as usize * width..][..width];
    let mut sums = vec![0.0f32; fitted.len()];
    let mut shares = vec![0.0f32; one_of.len()];
    let mut range: Vec<[f32; 2]> = fitted.iter().map(|&own| [own, own]).collect();
    // Place and value of each sample.
    let mut samples = Vec::with_capacity(places.len());
    let mut middles = Vec::with_capacity(places.len() * width);
    for ((place, &area), corners) in places.iter().zip(areas).zip(mesh.triangles()) {
        let Some(ends) = level.triangles().get(place.triangle as usize) else { continue };
        let ones = ends.map(|v| one_of[v as usize] as usize * width);
        let weights = place.weights.map(|share| area * share);
        samples.push((ones, place.weights, weights));
        let [a, b, c] = corners.map(row);
        for scalar in 0..width {
            let (x, y, z) = (a[scalar], b[scalar], c[scalar]);
            middles.push((x + y + z) / 3.0);
            let (low, high) = (x.min(y).min(z), x.max(y).max(z));
            for one in ones {
                let [least, most] = &mut range[one + scalar];
                (*least, *most) = (least.min(low), most.max(high));
            }
        }
        ones.iter().zip(weights).for_each(|(one, weight)| shares[one / width] += weight);
    }
    for _ in 0..ROUNDS {
        sums.fill(0.0);
        for ((ones, shares, weights), middle) in samples.iter().zip(middles.chunks_exact(width)) {
            let [a, b, c] = *ones;
            for (scalar, middle) in middle.iter().enumerate() {
                let there = shares[0] * fitted[a + scalar]
                    + shares[1] * fitted[b + scalar]
                    + shares[2] * fitted[c + scalar];
                let off = middle - there;
                if off.is_finite() {
                    sums[a + scalar] += weights[0] * off;
                    sums[b + scalar] += weights[1] * off;
                    sums[c + scalar] += weights[2] * off;
                }
            }
        }
        for (one, &share) in shares.iter().enumerate().filter(|(_, share)| **share > 0.0) {
            for scalar in one * width..(one + 1) * width {
                let value = fitted[scalar] + sums[scalar] / share;
                if value.is_finite() {
                    let [low, high] = range[scalar];
                    fitted[scalar] = value.max(low).min(high);
                }
            }
        }
    }
    for (vertex, &one) in one_of.iter().enumerate() {
        if one as usize != vertex {
            fitted.copy_within(one as usize * width..(one as usize + 1) * width, vertex * width);
        }
    }
}
