//! Tori, torus knots, open cylinders and Moebius strips.

use glam::DVec3;

use super::super::Mesh;
use super::noise::sin_cos;
use super::part::{Assembly, Part};
use super::{MAX_CELLS, bare, cells, fit, length_or};

/// A torus around the y axis: `2 * segments * sides` triangles, all vertices shared, closed, genus 1.
///
/// `major` is the distance from the axis to the middle of the tube, `minor` the tube's radius, in object units. With
/// `minor > major` the torus cuts itself. Lengths outside 1e-18 to 1e18 count as 1 and 0.4. At least 3 segments and 3
/// sides, at most 2^28 cells. O(n).
pub fn torus(major: f32, minor: f32, segments: u32, sides: u32) -> Mesh {
    let [segments, sides] = fit(segments, sides, [3, 3]);
    let (major, minor) = (length_or(major, 1.0), length_or(minor, 0.4));
    let mut positions = Vec::with_capacity(segments as usize * sides as usize);
    for side in 0..sides {
        let [up, out] = sin_cos(f64::from(side) / f64::from(sides));
        for segment in 0..segments {
            let [sin, cos] = sin_cos(f64::from(segment) / f64::from(segments));
            let radius = major + minor * out;
            positions.push(DVec3::new(radius * cos, minor * up, -radius * sin).as_vec3().to_array());
        }
    }
    let mut triangles = Vec::new();
    cells(segments, sides, &mut triangles, |s, r| (r % sides) * segments + s % segments);
    bare(positions, triangles)
}

/// A tube along a torus knot winding `p` times around the y axis and `q` times through the hole, with normals and
/// texture coordinates: `2 * segments * sides` triangles.
///
/// Two seams: along and around the tube. Welded, it is closed and has genus 1. The torus has radii 1 and 0.4; the tube
/// is too thin to touch itself. `p` and `q` are 1 to 1000, divided by their common divisor. At least 3 segments
/// (sensibly 50 a winding) and 3 sides, at most 2^28 cells. O(n).
pub fn torus_knot(p: u32, q: u32, segments: u32, sides: u32) -> Mesh {
    let knot = Knot::new(p, q);
    let [segments, sides] = fit(segments, sides, [3, 3]);
    let part = Part::grid(segments, sides, |column, row| {
        let (along, around) = (f64::from(column % segments), f64::from(row % sides));
        let frame = knot.frame(along / f64::from(segments));
        let uv = [column as f32 / segments as f32, row as f32 / sides as f32];
        (frame.point(around / f64::from(sides), knot.tube), uv)
    });
    let mut assembly = Assembly::default();
    assembly.add(part, 0);
    assembly.finish(&[])
}

/// A torus knot and the radius of a tube around it.
pub(super) struct Knot {
    windings: [f64; 2],
    pub(super) tube: f64,
}

/// The middle of a tube at a place, and two directions across it.
pub(super) struct Frame {
    middle: DVec3,
    across: [DVec3; 2],
}

impl Knot {
    const MAJOR: f64 = 1.0;
    const MINOR: f64 = 0.4;

    pub(super) fn new(p: u32, q: u32) -> Self {
        let (p, q) = (p.clamp(1, 1000), q.clamp(1, 1000));
        let common = greatest_common_divisor(p, q);
        let windings = [p / common, q / common].map(f64::from);
        // On the inner side of the torus, rolled flat: the area over the length of the curve is the distance between
        // neighbouring windings.
        let turn = std::f64::consts::TAU;
        let (wide, high) = (turn * (Self::MAJOR - Self::MINOR), turn * Self::MINOR);
        let [along, across] = [windings[0] * wide, windings[1] * high];
        let apart = wide * high / (along * along + across * across).sqrt();
        Self { windings, tube: (0.3 * apart).min(0.16) }
    }

    /// Returns the frame at `t` of the way along, 0 to 1. The first direction across is the normal of the torus: the
    /// frame closes after a round, without twist. The second is perpendicular to the first and to the curve.
    pub(super) fn frame(&self, t: f64) -> Frame {
        let [sin, cos] = sin_cos(self.windings[0] * t);
        let [up, out] = sin_cos(self.windings[1] * t);
        let radial = DVec3::new(cos, 0.0, -sin);
        let forward = DVec3::new(-sin, 0.0, -cos);
        let normal = radial * out + DVec3::Y * up;
        let radius = Self::MAJOR + Self::MINOR * out;
        let tangent = forward * (radius * self.windings[0])
            + (DVec3::Y * out - radial * up) * (Self::MINOR * self.windings[1]);
        let tangent = tangent.normalize();
        Frame { middle: radial * Self::MAJOR + normal * Self::MINOR, across: [normal, normal.cross(tangent)] }
    }
}

impl Frame {
    /// Returns the point at an angle (turns) around the middle, at a distance from it.
    pub(super) fn point(&self, turns: f64, distance: f64) -> DVec3 {
        let [sin, cos] = sin_cos(turns);
        self.middle + (self.across[0] * cos + self.across[1] * sin) * distance
    }
}

fn greatest_common_divisor(a: u32, b: u32) -> u32 {
    if b == 0 { a } else { greatest_common_divisor(b, a % b) }
}

/// The side of a cylinder around the y axis, radius 1, y from -1 to 1, without caps: `2 * segments * rows` triangles,
/// all vertices shared, two border loops.
///
/// At least 3 segments and 1 row, at most 2^28 cells. O(n).
pub fn open_cylinder(segments: u32, rows: u32) -> Mesh {
    let [segments, rows] = fit(segments, rows, [3, 1]);
    let mut positions = Vec::with_capacity(segments as usize * (rows as usize + 1));
    for row in 0..=rows {
        let height = 2.0 * f64::from(row) / f64::from(rows) - 1.0;
        for segment in 0..segments {
            let [sin, cos] = sin_cos(f64::from(segment) / f64::from(segments));
            positions.push(DVec3::new(cos, height, -sin).as_vec3().to_array());
        }
    }
    let mut triangles = Vec::new();
    cells(segments, rows, &mut triangles, |s, r| r * segments + s % segments);
    bare(positions, triangles)
}

/// A Moebius strip of `n` cells: `2 * n` vertices and triangles, a single border loop, no consistent orientation. A
/// single edge, where the strip closes, has two triangles running along it in the same direction.
///
/// 3 to 2^28 cells. O(n).
pub fn moebius(n: u32) -> Mesh {
    let n = n.clamp(3, MAX_CELLS);
    let mut positions = Vec::with_capacity(2 * n as usize);
    for cell in 0..n {
        let t = f64::from(cell) / f64::from(n);
        let [sin, cos] = sin_cos(t);
        let [half_sin, half_cos] = sin_cos(t / 2.0);
        for side in [-0.4, 0.4] {
            let radius = 1.0 + side * half_cos;
            positions.push(DVec3::new(radius * cos, side * half_sin, -radius * sin).as_vec3().to_array());
        }
    }
    let mut triangles = Vec::new();
    // The strip comes back turned over: low and high side swap.
    cells(n, 1, &mut triangles, |cell, side| if cell == n { 1 - side } else { 2 * cell + side });
    bare(positions, triangles)
}
