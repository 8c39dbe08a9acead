//! Attribute values of new vertices, fitted to the surface merged into each.
//!
//! ```text
//!   on an input triangle an attribute is linear:      s(x) = s_w + g . (x - p_w)
//!   a vertex at x stands for the triangles around every vertex merged into it, each counted at its corners:
//!   its best value:                                   sum of area * (s_w + g . (x - p_w))  /  sum of area
//! ```
//!
//! This value has the least squared deviation (Hoppe 1999). Vertices of equal position and value are solved together,
//! so a seam of an attribute does not become a seam of another. All other vertices are solved separately, so charts
//! stay apart. The value is clamped to the range of the triangles it averages: where `x` lies off the surface, slopes
//! reach too far.

use glam::DVec3;

use crate::mesh::{Attribute, Mesh, Topology, names};

use super::collapse_sequence::CollapseSequence;
use super::footprint::parts;

/// Least height over length of a triangle with a trusted slope. On thinner triangles values count as constant.
const THINNEST: f64 = 1e-5;

/// Wedges of a point searched for equal wedges; at points with more wedges, not all equal wedges are found.
const FEW: usize = 16;

/// Gives new vertices among `vertices` their best-fitting values. Row `i` of `attributes` belongs to `vertices[i]`.
/// Only attributes counted by the sequence; tangents follow their normals. O(input + substitutions) per attribute.
pub(super) fn solve_new(
    sequence: &CollapseSequence,
    mesh: &Mesh,
    vertices: &[u32],
    attributes: &mut [Attribute],
) {
    let first = sequence.input_vertices() as u32;
    if sequence.solved.is_empty() || vertices.iter().all(|&v| v < first) {
        return;
    }
    let topology = Topology::new(mesh);
    // A vertex replacing a vanished part takes nothing of its values.
    let mut part = if sequence.report().parts_removed > 0 { parts(mesh) } else { Vec::new() };
    for new in sequence.new_vertices().iter().filter(|_| sequence.report().parts_removed > 0) {
        part.push(part[new.from[0] as usize]);
    }
    let is_solved = |a: &Attribute| sequence.solved.iter().any(|name| name == a.name());
    let is_tangent = |a: &Attribute| a.name() == names::TANGENT && a.width() == 4;
    for (source, target) in mesh.attributes().iter().zip(&mut *attributes) {
        if !is_solved(source) && !is_tangent(source) {
            continue;
        }
        // A tangent's handedness is not fitted.
        let fitted = if is_tangent(source) { 3 } else { source.width() };
        let Some(values) = source.as_floats() else { continue };
        let width = source.width();
        let mut class = topology.equal_values(source);
        // Nearly equal vertices were folded, so they share a class.
        for &[duplicate, kept] in sequence.aliases() {
            class[duplicate as usize] = class[kept as usize];
        }
        class.resize(sequence.vertex_count(), 0);
        let solved = Sums::new(mesh, values, width, fitted, class).solve(sequence, &part);
        for (row, &vertex) in vertices.iter().enumerate().filter(|(_, v)| **v >= first) {
            let Some(floats) = target.floats_mut() else { break };
            let best = &solved[(vertex - first) as usize * fitted..][..fitted];
            let row = &mut floats[row * width..][..width];
            if best.iter().all(|x| x.is_finite()) {
                row[..fitted].copy_from_slice(best);
            }
        }
    }
    for (source, target) in mesh.attributes().iter().zip(&mut *attributes) {
        if is_solved(source) || is_tangent(source) {
            for row in (0..vertices.len()).filter(|&row| vertices[row] >= first) {
                normalise(target, row);
            }
        }
    }
    straighten_tangents(attributes, |row| vertices[row] >= first);
}

/// Normalises a row to unit length, if the attribute is a direction.
pub(super) fn normalise(attribute: &mut Attribute, row: usize) {
    let width = attribute.width();
    let mut value = [0.0; 16];
    let Some(floats) = attribute.floats_mut() else { return };
    value[..width].copy_from_slice(&floats[row * width..][..width]);
    attribute.normalise_direction(&mut value[..width]);
    if let Some(floats) = attribute.floats_mut() {
        floats[row * width..][..width].copy_from_slice(&value[..width]);
    }
}

/// Makes the tangents of wanted rows unit vectors at right angles to their normals. A tangent along its normal stays as
/// it is.
pub(super) fn straighten_tangents(attributes: &mut [Attribute], is_wanted: impl Fn(usize) -> bool) {
    let find = |name: &str, width: usize| {
        attributes.iter().position(|a| a.name() == name && a.width() == width && a.as_floats().is_some())
    };
    let (Some(normal), Some(tangent)) = (find(names::NORMAL, 3), find(names::TANGENT, 4)) else { return };
    let normals = attributes[normal].as_floats().map(<[f32]>::to_vec).unwrap_or_default();
    let Some(tangents) = attributes[tangent].floats_mut() else { return };
    for (row, (t, n)) in tangents.chunks_exact_mut(4).zip(normals.chunks_exact(3)).enumerate() {
        if is_wanted(row) {
            let vector = |v: &[f32]| DVec3::new(f64::from(v[0]), f64::from(v[1]), f64::from(v[2]));
            let (normal, tangent) = (vector(n).normalize_or_zero(), vector(t));
            let level = tangent - normal * normal.dot(tangent);
            if level.length_squared() > 1e-6 * tangent.length_squared() {
                t[..3].copy_from_slice(&level.normalize().as_vec3().to_array());
            }
        }
    }
}

/// Sums of an attribute over the surface merged into each vertex.
struct Sums {
    /// Number of fitted scalars per vertex.
    width: usize,
    /// Lowest vertex of equal position and value, per vertex. The sums are kept there.
    class: Vec<u32>,
    areas: Vec<f64>,
    scalars: Vec<Scalar>,
}

/// Sums of a scalar: `offset + slope . x` is the sum of area times value at `x`; `low` and `high` are the range of the
/// values.
#[derive(Clone, Copy)]
struct Scalar {
    slope: DVec3,
    offset: f64,
    low: f32,
    high: f32,
}

impl Sums {
    /// Returns the initial sums of a mesh's vertices: of the first `fitted` of `width` scalars.
    fn new(mesh: &Mesh, values: &[f32], width: usize, fitted: usize, class: Vec<u32>) -> Self {
        let count = class.len();
        let nothing = Scalar { slope: DVec3::ZERO, offset: 0.0, low: f32::INFINITY, high: f32::NEG_INFINITY };
        let mut sums =
            Self { width: fitted, class, areas: vec![0.0; count], scalars: vec![nothing; count * fitted] };
        let at = |v: u32| DVec3::from_array(mesh.positions()[v as usize].map(f64::from));
        for corners in mesh.triangles() {
            let [p, q, r] = corners.map(at);
            let Some((area, along_e, along_f)) = slopes(p, q, r) else { continue };
            let classes = corners.map(|v| sums.class[v as usize] as usize);
            classes.iter().for_each(|&v| sums.areas[v] += area);
            for scalar in 0..fitted {
                let [a, b, c] = corners.map(|v| values[v as usize * width + scalar]);
                let (da, db, dc) = (f64::from(a), f64::from(b), f64::from(c));
                let slope = ((db - da) * along_e + (dc - da) * along_f) * area;
                let offset = da * area - slope.dot(p);
                for v in classes {
                    let sum = &mut sums.scalars[v * fitted + scalar];
                    sum.slope += slope;
                    sum.offset += offset;
                    sum.low = sum.low.min(a).min(b).min(c);
                    sum.high = sum.high.max(a).max(b).max(c);
                }
            }
        }
        sums
    }

    /// Adds the sums of `from` to the sums of `to`.
    fn pass(&mut self, [from, to]: [u32; 2]) {
        let (from, to) = (from as usize, to as usize);
        self.areas[to] += self.areas[from];
        for scalar in 0..self.width {
            let more = self.scalars[from * self.width + scalar];
            let sum = &mut self.scalars[to * self.width + scalar];
            sum.slope += more.slope;
            sum.offset += more.offset;
            sum.low = sum.low.min(more.low);
            sum.high = sum.high.max(more.high);
        }
    }

    /// Returns the best value of a vertex's scalar at `x`; NaN where undetermined.
    fn best(&self, vertex: usize, scalar: usize, x: DVec3) -> f32 {
        let sum = &self.scalars[vertex * self.width + scalar];
        let value = ((sum.offset + sum.slope.dot(x)) / self.areas[vertex]) as f32;
        if value.is_finite() && sum.low <= sum.high { value.clamp(sum.low, sum.high) } else { f32::NAN }
    }

    /// Returns the values of all new vertices, each as of the end of the step making it. A vertex kept later takes in
    /// more.
    fn solve(mut self, sequence: &CollapseSequence, part: &[u32]) -> Vec<f32> {
        let first = sequence.input_vertices();
        let mut solved = Vec::with_capacity(sequence.new_vertices().len() * self.width);
        let mut next = first;
        let mut passed = Vec::new();
        for step in 0..sequence.len() {
            let substitutions = sequence.substitutions(step);
            let reach = substitutions.iter().fold(next, |reach, pair| reach.max(pair[1] as usize + 1));
            for new in next..reach {
                let sources =
                    |v: usize| sequence.new_vertices()[v - first].from.map(|v| self.class[v as usize]);
                let mut earlier = next.max(new.saturating_sub(FEW))..new;
                let one = earlier.find(|&other| sources(other) == sources(new)).unwrap_or(new);
                self.class[new] = one as u32;
            }
            passed.clear();
            for pair in substitutions {
                if !part.is_empty() && part[pair[0] as usize] != part[pair[1] as usize] {
                    continue;
                }
                let classes = pair.map(|v| self.class[v as usize]);
                if !passed.iter().rev().take(FEW).any(|other| *other == classes) {
                    passed.push(classes);
                    self.pass(classes);
                }
            }
            for new in next..reach {
                let x = DVec3::from_array(sequence.new_vertices()[new - first].position.map(f64::from));
                solved.extend((0..self.width).map(|i| self.best(self.class[new] as usize, i, x)));
            }
            next = reach;
        }
        // New vertices made by no step.
        solved.resize(sequence.new_vertices().len() * self.width, f32::NAN);
        solved
    }
}

/// Returns twice the area of triangle `p q r`, and the vectors `u` and `v` of the slope
/// `(s_q - s_p) u + (s_r - s_p) v`; `None` without an area.
pub(super) fn slopes(p: DVec3, q: DVec3, r: DVec3) -> Option<(f64, DVec3, DVec3)> {
    let (e, f) = (q - p, r - p);
    let cross = e.cross(f);
    let area = cross.length();
    if !(area > 0.0 && area.is_finite()) {
        return None;
    }
    let longest = e.length_squared().max(f.length_squared()).max(q.distance_squared(r));
    let inverse = if area > THINNEST * longest { 1.0 / area } else { 0.0 };
    let normal = cross * inverse;
    Some((area, f.cross(normal) * inverse, normal.cross(e) * inverse))
}
