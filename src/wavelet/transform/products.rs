//! Exact inner products of hats, added up face by face, so borders, any valence and edges of many faces come out right.
//!
//! The measure is parametric: every base face has area 1, so a face of level j has area 4^-j whatever its shape. In a face of
//! area A, the hat of a corner has product A/6 with itself and A/12 with the hat of another corner. The finer hat at the
//! midpoint of a side has product 5A/48 with the hats at the side's ends and 2A/48 with the third hat. All products are stored
//! as multiples of A/12 or A/48, so equal patterns are equal to the last bit.

use super::super::{Subdivision, WaveletError};
use super::domain::{Domain, SplitFace};

/// Products of a midpoint's hat with the hats at the ends of its side and with the third hat, in 48ths of the area of the face.
pub(super) const END: u32 = 5;
pub(super) const OPPOSITE: u32 = 2;

/// Inner products of the hats of a level with each other, and with the hats at the midpoints of its edges.
#[derive(Debug)]
pub(super) struct Products {
    /// Per node the product of its hat with itself, in twelfths of the area of a face.
    pub diagonal: Vec<u32>,
    offsets: Vec<usize>,
    /// Per node the other nodes sharing a face with it, ascending, and the products.
    items: Vec<(u32, u32)>,
    /// First node of the midpoints.
    first: usize,
    side_offsets: Vec<usize>,
    /// Per midpoint the sides containing it: their ends and the third corner.
    sides: Vec<[u32; 3]>,
}

impl Products {
    /// Computes the products of a level from its split faces. The midpoints are the nodes of the next level.
    pub fn new(domain: &Domain, level: usize, faces: &[SplitFace]) -> Self {
        let nodes = domain.nodes_of(level).end;
        let mut diagonal = vec![0; nodes];
        let pairs = |face: &SplitFace| {
            let c = face.corners;
            [[c[0], c[1]], [c[1], c[0]], [c[1], c[2]], [c[2], c[1]], [c[2], c[0]], [c[0], c[2]]]
        };
        let mut offsets = vec![0; nodes + 1];
        for face in faces {
            face.corners.iter().for_each(|&corner| diagonal[corner as usize] += 2);
            pairs(face).iter().for_each(|pair| offsets[pair[0] as usize + 1] += 1);
        }
        sum_up(&mut offsets);
        let mut next = offsets.clone();
        let mut items = vec![(0, 1); offsets[nodes]];
        for [a, b] in faces.iter().flat_map(pairs) {
            items[next[a as usize]].0 = b;
            next[a as usize] += 1;
        }
        // Sort rows and add equal entries, in place.
        let mut end = 0;
        for node in 0..nodes {
            let row = offsets[node]..offsets[node + 1];
            offsets[node] = end;
            items[row.clone()].sort_unstable();
            for at in row {
                let (other, count) = items[at];
                if other as usize == node {
                    diagonal[node] += count;
                } else if end > offsets[node] && items[end - 1].0 == other {
                    items[end - 1].1 += count;
                } else {
                    items[end] = (other, count);
                    end += 1;
                }
            }
        }
        offsets[nodes] = end;
        items.truncate(end);

        let midpoints = domain.nodes_of(level + 1);
        let first = midpoints.start;
        let mut side_offsets = vec![0; midpoints.len() + 1];
        let of_sides = || faces.iter().flat_map(|face| face.midpoints);
        of_sides().for_each(|midpoint| side_offsets[midpoint as usize - first + 1] += 1);
        sum_up(&mut side_offsets);
        let mut next = side_offsets.clone();
        let mut sides = vec![[0; 3]; 3 * faces.len()];
        for face in faces {
            for k in 0..3 {
                let slot = &mut next[face.midpoints[k] as usize - first];
                sides[*slot] = [0, 1, 2].map(|i| face.corners[(k + i) % 3]);
                *slot += 1;
            }
        }
        Self { diagonal, offsets, items, first, side_offsets, sides }
    }

    /// Products of a node's hat with the hats of other nodes, in twelfths of the area of a face: node and product, ascending.
    #[inline]
    pub fn row(&self, node: u32) -> &[(u32, u32)] {
        &self.items[self.offsets[node as usize]..self.offsets[node as usize + 1]]
    }

    /// Products of the hat at a midpoint with hats of this level, in 48ths of the area of a face: node and product; a node may
    /// occur several times.
    pub fn of_midpoint(&self, midpoint: usize) -> impl Iterator<Item = (u32, u32)> + '_ {
        let at = midpoint - self.first;
        let sides = &self.sides[self.side_offsets[at]..self.side_offsets[at + 1]];
        sides.iter().flat_map(|&[a, b, c]| [(a, END), (b, END), (c, OPPOSITE)])
    }
}

/// Turns counts at i + 1 into offsets.
fn sum_up(counts: &mut [usize]) {
    let mut sum = 0;
    for count in counts {
        sum += *count;
        *count = sum;
    }
}

/// Returns the L2 distance of two functions on a subdivision: the root of the mean square of their difference, in the unit of
/// the values.
///
/// A function has `width` scalars a vertex, vertex by vertex, and is linear on every unsplit face. All base faces have the same
/// weight in the mean (the parametric measure: the hats of a level are alike). The result is exact up to rounding: it uses the
/// mass matrix of the finest level. O(n).
///
/// # Errors
/// Not `width` values a vertex, a width of 0, or an unsplit face beside a split face, where functions are not linear on faces.
///
/// ```
/// use multires::mesh::shapes;
/// use multires::wavelet::{WaveletBuilder, WaveletOptions, l2_error};
///
/// let mut builder = WaveletBuilder::new(&shapes::icosphere(0))?;
/// builder.subdivide(|midpoint| midpoint.middle)?;
/// let mesh = builder.build(&WaveletOptions::default())?;
/// let values = mesh.vertices().positions().as_flattened();
/// let moved: Vec<f32> = values.iter().map(|x| x + 0.5).collect();
/// let error = l2_error(mesh.subdivision(), 3, values, &moved)?;
/// assert!((error - 0.75_f64.sqrt()).abs() < 1e-6);
/// # Ok::<(), multires::wavelet::WaveletError>(())
/// ```
pub fn l2_error(subdivision: &Subdivision, width: usize, a: &[f32], b: &[f32]) -> Result<f64, WaveletError> {
    super::wavelet_transform::check_length(a.len(), subdivision.vertex_count(), width)?;
    super::wavelet_transform::check_length(b.len(), subdivision.vertex_count(), width)?;
    for wavelet in 0..subdivision.wavelet_count() as u32 {
        if subdivision.faces_along(wavelet).any(|side| !subdivision.is_split(side.face())) {
            let what = "faces along an edge are not split equally deep: that of the wavelet";
            return Err(WaveletError::Invalid { what, at: wavelet as usize });
        }
    }
    let mut square = 0.0;
    let mut area = 1.0;
    for level in 0..=subdivision.depth() {
        let mut sum = 0.0;
        for face in subdivision.faces_of(level).filter(|&face| !subdivision.is_split(face)) {
            let corners = subdivision.corners(face).map(|vertex| vertex as usize * width);
            for i in 0..width {
                let d = corners.map(|at| f64::from(a[at + i]) - f64::from(b[at + i]));
                let all = d[0] + d[1] + d[2];
                sum += d[0] * d[0] + d[1] * d[1] + d[2] * d[2] + all * all;
            }
        }
        square += area / 12.0 * sum;
        area *= 0.25;
    }
    Ok((square / subdivision.base_face_count().max(1) as f64).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Integral over a triangle of area 1 of the product of two functions, each linear on the four parts. The rule of the
    /// middles of sides is exact for quadratics.
    fn integral(f: impl Fn([f64; 3]) -> f64, g: impl Fn([f64; 3]) -> f64) -> f64 {
        let middle = |a: [f64; 3], b: [f64; 3]| [0, 1, 2].map(|i| 0.5 * (a[i] + b[i]));
        let c = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let m = [middle(c[0], c[1]), middle(c[1], c[2]), middle(c[2], c[0])];
        let parts = [[c[0], m[0], m[2]], [c[1], m[1], m[0]], [c[2], m[2], m[1]], m];
        let sides = parts.iter().flat_map(|t| [middle(t[0], t[1]), middle(t[1], t[2]), middle(t[2], t[0])]);
        sides.map(|p| f(p) * g(p)).sum::<f64>() / 12.0
    }

    /// The hat at the middle of the side from corner 0 to corner 1, at barycentric coordinates.
    fn midpoint([a, b, c]: [f64; 3]) -> f64 {
        match (a > 0.5, b > 0.5, c > 0.5) {
            (true, ..) => 2.0 * b,
            (_, true, _) => 2.0 * a,
            (.., true) => 0.0,
            // The centre: linear from 1 at the middle to 0 at the other two corners.
            _ => 1.0 - 2.0 * c,
        }
    }

    #[test]
    fn constants_are_the_integrals() {
        assert_eq!(midpoint([0.5, 0.5, 0.0]), 1.0);
        assert_eq!(midpoint([0.25, 0.75, 0.0]), 0.5);
        let close = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-15, "{found}");
        close(integral(|p| p[0], |p| p[0]), 1.0 / 6.0);
        close(integral(|p| p[0], |p| p[1]), 1.0 / 12.0);
        close(integral(midpoint, |p| p[0]), f64::from(END) / 48.0);
        close(integral(midpoint, |p| p[1]), f64::from(END) / 48.0);
        close(integral(midpoint, |p| p[2]), f64::from(OPPOSITE) / 48.0);
        close(integral(midpoint, midpoint), 6.0 / 48.0);
        close(integral(midpoint, |[a, b, c]| midpoint([b, c, a])), 2.0 / 48.0);
    }
}
