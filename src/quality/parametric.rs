//! Parametric deviation: how far the points of a mesh travel under the collapses of a sequence.
//!
//! ```text
//!        b                    every vertex has an ancestor in the level (what it was merged into), and every triangle
//!       / \        b = c      of the original an image: the map is linear in each triangle. A point travels by the
//!      /   \  -->    |        blend of what the corners travel, so none travels farther than the farthest vertex.
//!     a-----c        a
//! ```

use glam::DVec3;

use crate::{
    geometry::{
        parallel::map_chunks,
        triangle::{Corners, has_area, normal},
    },
    mesh::Mesh,
    sequence::{CollapseSequence, Origin},
};

use super::{QualityError, surface::CHUNK};

/// Distances of points from their images in a level, object units.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct ParametricDeviation {
    /// Largest over the whole surface. Attained at a vertex, so it is exact and no sample can exceed it.
    pub max: f64,
    /// Mean over the area, accurate to about a thousandth: by the seven-point rule, refined where a point inside a
    /// triangle stays in place.
    pub mean: f64,
    /// Root of the mean square over the area, exact.
    pub rms: f64,
    /// Vertex with the largest distance.
    pub vertex: u32,
}

/// Measures how far the points of the original travel to their images in the level after `steps` steps (all steps, if
/// there are fewer).
///
/// [`max`](ParametricDeviation::max) is a proven bound, not an estimate. No point of the level is farther from the
/// original than `max`, and no point of the original is farther from its image. The image consists of the level and of
/// the remains of vanished triangles. The remains lie on the level unless a whole piece of the mesh has shrunk to
/// nothing. A texture painted on the original and carried along by the map slides by at most `max`. On flat parts,
/// where vertices move within the surface, `max` is far above [`distance()`](super::distance()).
/// [`ErrorMeasure::Parametric`](crate::simplify::ErrorMeasure) bounds it step by step.
///
/// Vertices used by no triangle do not count. O(n).
///
/// # Errors
/// The sequence belongs to another mesh ([`CollapseSequence::fits`]); the mesh has no surface.
///
/// ```
/// use multires::{Simplifier, mesh::shapes, quality::parametric_deviation};
/// let mesh = shapes::icosphere(4);
/// let sequence = Simplifier::new().run(&mesh)?;
/// assert_eq!(parametric_deviation(&mesh, &sequence, 0)?.max, 0.0);
/// let half = parametric_deviation(&mesh, &sequence, sequence.len() / 2)?;
/// assert!(0.0 < half.mean && half.mean < half.rms && half.rms < half.max);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn parametric_deviation(
    original: &Mesh,
    sequence: &CollapseSequence,
    steps: usize,
) -> Result<ParametricDeviation, QualityError> {
    if !sequence.fits(original) {
        let (vertices, triangles) = (sequence.input_vertices(), sequence.input_triangles());
        return Err(QualityError::Sequence { vertices, triangles });
    }
    let image = sequence.representatives(steps);
    let place = |v: u32| {
        let position = match sequence.origin(v) {
            Origin::Input(v) => original.positions()[v as usize],
            Origin::Blend(new) => new.position,
        };
        DVec3::from_array(position.map(f64::from))
    };
    let travel = |v: u32| place(image[v as usize]) - place(v);

    let (mut max, mut vertex) = (0.0, 0);
    for &v in original.indices() {
        let far = travel(v).length();
        if far > max {
            (max, vertex) = (far, v);
        }
    }
    let sums = map_chunks(original.triangles().len(), CHUNK, |range| {
        let mut sums = [0.0; 3];
        for corners in &original.triangles()[range] {
            let places: Corners = corners.map(place);
            if has_area(&places) {
                let area = normal(&places).length();
                let [mean, mean_square] = over_triangle(corners.map(travel));
                sums = [sums[0] + area, sums[1] + area * mean, sums[2] + area * mean_square];
            }
        }
        sums
    });
    let [area, mean, square] =
        sums.into_iter().fold([0.0; 3], |all, part| [all[0] + part[0], all[1] + part[1], all[2] + part[2]]);
    if area == 0.0 {
        return Err(QualityError::NoSurface { which: "given", triangles: original.triangles().len() });
    }
    // The seven-point rule may exceed the maximum by rounding.
    Ok(ParametricDeviation {
        max,
        mean: (mean / area).min(max),
        rms: (square / area).sqrt().min(max),
        vertex,
    })
}

/// Returns the mean length and mean square length over a triangle of a vector linear in it.
fn over_triangle(corners: [DVec3; 3]) -> [f64; 2] {
    let [a, b, c] = corners;
    let squares = a.length_squared() + b.length_squared() + c.length_squared();
    [mean_length(corners, DEPTH), ((a + b + c).length_squared() + squares) / 12.0]
}

/// Most quarterings of a triangle where the seven-point rule is too coarse, and the relative error allowed.
const DEPTH: usize = 5;
const OFF: f64 = 1e-4;

/// Returns the mean length by the seven-point rule, quartering the triangle where this changes the result: the length
/// has a kink if a point inside stays in place.
fn mean_length([a, b, c]: [DVec3; 3], depth: usize) -> f64 {
    let whole = seven_points([a, b, c]);
    let [ab, bc, ca] = [(a + b) * 0.5, (b + c) * 0.5, (c + a) * 0.5];
    let quarters = [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]];
    let finer = quarters.map(seven_points).iter().sum::<f64>() * 0.25;
    if depth == 0 || (finer - whole).abs() <= OFF * finer {
        return finer;
    }
    quarters.map(|quarter| mean_length(quarter, depth - 1)).iter().sum::<f64>() * 0.25
}

/// Applies Radon's rule of degree five to the length: the centre, and two sets of three points.
fn seven_points([a, b, c]: [DVec3; 3]) -> f64 {
    let root = 15f64.sqrt();
    let length = |u: f64, v: f64, w: f64| (a * u + b * v + c * w).length();
    let set = |near: f64| {
        let far = 1.0 - 2.0 * near;
        length(far, near, near) + length(near, far, near) + length(near, near, far)
    };
    let third = 1.0 / 3.0;
    0.225 * length(third, third, third)
        + (155.0 - root) / 1200.0 * set((6.0 - root) / 21.0)
        + (155.0 + root) / 1200.0 * set((6.0 + root) / 21.0)
}
