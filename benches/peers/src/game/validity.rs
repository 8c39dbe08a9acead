//! Attributes that no renderer can use: normals that are not of unit length, skin weights that do not sum to 1, values that
//! are not finite, and triangles whose texture coordinates are mirrored where the original's are not.

use multires::mesh::{Mesh, names};
use multires::quality::Surface;

use super::model::{floats, uv_area};
use super::picture::{cross, dot, minus, unit};

/// How far a length or a sum may be from 1.
const OFF: f32 = 1e-3;
/// Smallest area of texture coordinates, in parts of the square of the longest side, whose orientation means anything.
const THIN: f64 = 1e-3;

/// Vertices, used by a triangle, whose attributes are invalid, beyond what the input's own values explain: where the
/// input's vertices are not all valid in a stream, the stream is not judged.
pub(crate) fn invalid_vertices(original: &Mesh, level: &Mesh) -> usize {
    let mut used = vec![false; level.positions().len()];
    level.indices().iter().for_each(|&v| used[v as usize] = true);
    let mut bad = vec![false; used.len()];
    for attribute in level.attributes() {
        let Some(values) = attribute.as_floats() else { continue };
        let before = original.attribute(attribute.name()).and_then(|a| a.as_floats());
        let valid = |value: &[f32]| is_valid(attribute.name(), value);
        if before.is_some_and(|before| before.chunks_exact(attribute.width()).all(valid)) {
            for (bad, value) in bad.iter_mut().zip(values.chunks_exact(attribute.width())) {
                *bad |= !valid(value);
            }
        }
    }
    bad.iter().zip(&used).filter(|(bad, used)| **bad && **used).count()
}

fn is_valid(name: &str, value: &[f32]) -> bool {
    let near_one = |x: f32| (x - 1.0).abs() <= OFF;
    value.iter().all(|x| x.is_finite())
        && match name {
            names::NORMAL => near_one(value.iter().map(|x| x * x).sum::<f32>().sqrt()),
            names::TANGENT => {
                near_one(value[..3.min(value.len())].iter().map(|x| x * x).sum::<f32>().sqrt())
                    && value.get(3).is_none_or(|side| side.abs() == 1.0)
            }
            name if name.starts_with(names::WEIGHTS) => near_one(value.iter().sum()),
            _ => true,
        }
}

/// Triangles of a level whose texture coordinates run the other way round than those of every original triangle of
/// the same material and side that their middle is nearest to.
pub(crate) fn flipped(original: &Surface<'_>, level: &Mesh) -> usize {
    let before = original.mesh();
    let (Some(from), Some(to)) = (floats(before, names::UV, 2), floats(level, names::UV, 2)) else {
        return 0;
    };
    let middles: Vec<[f64; 3]> = level
        .triangles()
        .iter()
        .map(|t| {
            let corners = t.map(|v| level.positions()[v as usize].map(f64::from));
            [0, 1, 2].map(|i| (corners[0][i] + corners[1][i] + corners[2][i]) / 3.0)
        })
        .collect();
    let mut flipped = 0;
    original.nearest(&middles, |number, places| {
        let triangle = level.triangles()[number];
        let side = orientation(to, triangle);
        if side == 0.0 {
            return;
        }
        let like = places.iter().map(|place| place.triangle as usize).filter(|&other| {
            level.materials().get(number) == before.materials().get(other)
                && dot(facet(level, triangle), facet(before, before.triangles()[other])) > 0.0
        });
        let mut known = like.map(|other| orientation(from, before.triangles()[other])).peekable();
        if known.peek().is_some() && known.all(|other| other * side < 0.0) {
            flipped += 1;
        }
    });
    flipped
}

/// 1 or -1 as a triangle's texture coordinates run; 0 where that means nothing.
fn orientation(uv: &[f32], triangle: [u32; 3]) -> f64 {
    let [a, b, c] = triangle.map(|v| [0, 1].map(|i| f64::from(uv[2 * v as usize + i])));
    let side = |p: [f64; 2], q: [f64; 2]| (p[0] - q[0]).powi(2) + (p[1] - q[1]).powi(2);
    let area = uv_area(uv, triangle);
    let longest = side(a, b).max(side(b, c)).max(side(c, a));
    if area.abs() > THIN * longest && longest > 0.0 { area.signum() } else { 0.0 }
}

fn facet(mesh: &Mesh, triangle: [u32; 3]) -> [f64; 3] {
    let [a, b, c] = triangle.map(|v| mesh.positions()[v as usize].map(f64::from));
    unit(cross(minus(b, a), minus(c, a)))
}
