//! Attributes of a level, fitted to the input: the values that are closest to it over its whole surface.
//!
//! ```text
//!   least   sum over the input's triangles of  area * |value at the middle - value of the level where that lies|^2
//! ```
//!
//! Values kept from the input are right at their vertices and, between these, as far off as the input bends; fitted ones
//! are a little off everywhere, and less on average. The least squares are found by passing back what the level is off
//! by, a few times: each vertex takes the mean over the places that it has a share in, by area and share.

use crate::mesh::{Attribute, Mesh, Topology, names};

use super::footprint::{self, Place};
use super::solved::{normalise, straighten_tangents};

/// Times that what is off is passed back. Each time about halves what is left of it.
const ROUNDS: usize = 6;

/// Whether an attribute is fitted: numbers that may be blended and mean something by themselves.
fn is_fitted(attribute: &Attribute) -> bool {
    let name = attribute.name();
    let by_itself = !names::is_set_of(name, names::WEIGHTS) && name != names::TANGENT;
    by_itself && attribute.as_floats().is_some()
}

/// Fits the attributes of a level of a mesh, whose triangles lie at `places` on it; `origin` is the input triangle that each
/// of the level's is the image of. Locked vertices keep their values, and no triangle's texture is mirrored by it.
pub(super) fn refit(mesh: &Mesh, level: &Mesh, origin: &[u32], places: &[Place]) -> Vec<Attribute> {
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
        // Vertices of one place and value are one: a seam of other attributes must not become one of this.
        let one_of = topology.equal_values(target);
        fit(mesh, level, source, target, &one_of, places, &areas);
        if names::is_set_of(source.name(), names::UV) && source.width() == 2 {
            unmirror(mesh, level, origin, source, target, &one_of);
        }
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

/// Gives triangles back their old texture coordinates where the new ones mirror them against the input and the old ones do
/// not; and so on around them, until there are none. O(level) a round, and mostly one or two rounds.
fn unmirror(
    mesh: &Mesh,
    level: &Mesh,
    origin: &[u32],
    source: &Attribute,
    target: &mut Attribute,
    one_of: &[u32],
) {
    let old = level.attribute(source.name()).and_then(|a| a.as_floats());
    let (Some(input), Some(old), Some(new)) = (source.as_floats(), old, target.floats_mut()) else { return };
    let mut is_old = vec![false; one_of.len()];
    for round in 0..=UNMIRRORED {
        let mut any = false;
        for (&corners, &t) in level.triangles().iter().zip(origin) {
            let way = texture_area(input, mesh.triangles()[t as usize]);
            let turned = |uv: &[f32]| texture_area(uv, corners) * way.signum() < 0.0;
            let last = round == UNMIRRORED;
            if (last || way != 0.0 && turned(new) && !turned(old))
                && corners.iter().any(|&v| !is_old[one_of[v as usize] as usize])
            {
                any = true;
                corners.iter().for_each(|&v| is_old[one_of[v as usize] as usize] = true);
            }
        }
        if !any {
            break;
        }
        for vertex in (0..one_of.len()).filter(|&v| is_old[one_of[v] as usize]) {
            new[2 * vertex..][..2].copy_from_slice(&old[2 * vertex..][..2]);
        }
    }
}

/// Rounds after which all texture coordinates stay as they were, should there still be mirrored triangles.
const UNMIRRORED: usize = 16;

/// Twice the signed area of a triangle's texture coordinates.
fn texture_area(uv: &[f32], corners: [u32; 3]) -> f64 {
    let [a, b, c] = corners.map(|v| [0, 1].map(|i| f64::from(uv[2 * v as usize + i])));
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
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
    let mut range = vec![[f32::INFINITY, f32::NEG_INFINITY]; fitted.len()];
    for (t, place) in places.iter().enumerate() {
        let Some(corners) = level.triangles().get(place.triangle as usize) else { continue };
        for (&v, share) in corners.iter().zip(place.weights) {
            let one = one_of[v as usize] as usize;
            shares[one] += areas[t] * share;
            for corner in mesh.triangles()[t] {
                for (range, &x) in range[one * width..][..width].iter_mut().zip(row(corner)) {
                    *range = [range[0].min(x), range[1].max(x)];
                }
            }
        }
    }
    for (vertex, &one) in one_of.iter().enumerate() {
        for scalar in 0..width {
            let own = fitted[vertex * width + scalar];
            let range = &mut range[one as usize * width + scalar];
            *range = [range[0].min(own), range[1].max(own)];
        }
    }
    for _ in 0..ROUNDS {
        sums.fill(0.0);
        for (t, place) in places.iter().enumerate() {
            let Some(corners) = level.triangles().get(place.triangle as usize) else { continue };
            let ones = corners.map(|v| one_of[v as usize] as usize * width);
            let [a, b, c] = mesh.triangles()[t].map(row);
            for scalar in 0..width {
                let there: f32 = (0..3).map(|i| place.weights[i] * fitted[ones[i] + scalar]).sum();
                let off = (a[scalar] + b[scalar] + c[scalar]) / 3.0 - there;
                if off.is_finite() {
                    (0..3).for_each(|i| sums[ones[i] + scalar] += areas[t] * place.weights[i] * off);
                }
            }
        }
        for (one, &share) in shares.iter().enumerate().filter(|(_, share)| **share > 0.0) {
            for scalar in one * width..(one + 1) * width {
                let value = fitted[scalar] + sums[scalar] / share;
                if value.is_finite() {
                    fitted[scalar] = value.clamp(range[scalar][0], range[scalar][1]);
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
