//! Spheres and boxes.

use glam::{DVec3, Vec3};

use super::super::{Attribute, Edges, Mesh, names};
use super::noise::sin_cos;
use super::part::{Assembly, Part};
use super::{bare, cells, fit};

/// A unit sphere by midpoint subdivision of the icosahedron: `20 * 4^levels` triangles, all vertices shared, closed.
///
/// Levels nest: the vertices of a level are the first vertices of the next, bit for bit. Triangle `t` becomes triangles
/// `4t` (in the middle) to `4t + 3` (at corners 0, 1, 2). At most 12 levels; more count as 12. O(n log n).
pub fn icosphere(levels: u32) -> Mesh {
    let (mut positions, mut triangles) = icosahedron();
    for _ in 0..levels.min(12) {
        let edges = Edges::new(&triangles, positions.len());
        let first = positions.len() as u32;
        positions.extend(
            edges
                .ends()
                .iter()
                .map(|ends| {
                    let [a, b] = ends.map(|v| Vec3::from(positions[v as usize]).as_dvec3());
                    (a + b).normalize().as_vec3().to_array()
                })
                .collect::<Vec<_>>(),
        );
        let middle = edges.of_half_edges(triangles.len());
        triangles = triangles
            .iter()
            .zip(middle)
            .flat_map(|(&[a, b, c], middle)| {
                let [ab, bc, ca] = middle.map(|edge| first + edge);
                [[ab, bc, ca], [a, ab, ca], [b, bc, ab], [c, ca, bc]]
            })
            .collect();
    }
    bare(positions, triangles)
}

/// The icosahedron: vertex 0 at the top, 1 to 5 above the equator, 6 to 10 below it, 11 at the bottom.
pub(super) fn icosahedron() -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
    let height = 0.2_f64.sqrt();
    let ring = |turns: f64, height: f64| {
        let [sin, cos] = sin_cos(turns);
        let radius = (1.0 - height * height).sqrt();
        DVec3::new(radius * cos, height, -radius * sin).as_vec3().to_array()
    };
    let mut positions = vec![[0.0, 1.0, 0.0]];
    positions.extend((0..5).map(|i| ring(f64::from(i) / 5.0, height)));
    positions.extend((0..5).map(|i| ring((f64::from(i) + 0.5) / 5.0, -height)));
    positions.push([0.0, -1.0, 0.0]);

    let mut triangles = Vec::with_capacity(20);
    for i in 0..5 {
        let (upper, lower) = ([1 + i, 1 + (i + 1) % 5], [6 + i, 6 + (i + 1) % 5]);
        triangles.push([0, upper[0], upper[1]]);
        triangles.push([upper[0], lower[0], upper[1]]);
        triangles.push([upper[1], lower[0], lower[1]]);
        triangles.push([11, lower[1], lower[0]]);
    }
    (positions, triangles)
}

/// Cuts each of the icosahedron's triangles into `frequency^2`, projected to the unit sphere. Returns directions in
/// double precision, and triangles. All vertices are shared. Frequency 1 to 7000.
pub(super) fn geodesic(frequency: u32) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let (corners, faces) = icosahedron();
    let corners: Vec<_> = corners.iter().map(|&p| Vec3::from(p).as_dvec3().normalize()).collect();
    let edges = Edges::new(&faces, corners.len());
    let edge_of = edges.of_half_edges(faces.len());
    let f = frequency.clamp(1, 7000);
    let between = |a: DVec3, b: DVec3, steps: u32| a + (b - a) * (f64::from(steps) / f64::from(f));

    let mut points = corners.clone();
    for ends in edges.ends() {
        let [a, b] = ends.map(|v| corners[v as usize]);
        points.extend((1..f).map(|step| between(a, b, step).normalize()));
    }
    let mut triangles = Vec::with_capacity(20 * f as usize * f as usize);
    for (face, on_edge) in faces.iter().zip(edge_of) {
        let [a, b, c] = face.map(|v| corners[v as usize]);
        let inner = points.len() as u32;
        for row in 1..f {
            for step in 1..f - row {
                let p = a
                    + (b - a) * (f64::from(step) / f64::from(f))
                    + (c - a) * (f64::from(row) / f64::from(f));
                points.push(p.normalize());
            }
        }
        // The vertex `steps` along the half-edge from corner `k`.
        let along = |k: usize, steps: u32| {
            let forward = face[k] < face[(k + 1) % 3];
            corners.len() as u32 + on_edge[k] * (f - 1) + if forward { steps } else { f - steps } - 1
        };
        // Row `row` towards corner c, `step` towards corner b.
        let at = |step: u32, row: u32| match (step, row) {
            (0, 0) => face[0],
            (step, 0) if step == f => face[1],
            (0, row) if row == f => face[2],
            (step, 0) => along(0, step),
            (0, row) => along(2, f - row),
            (step, row) if step + row == f => along(1, row),
            // Earlier rows hold f - 2, f - 3, ... vertices.
            (step, row) => inner + (row - 1) * (2 * f - row - 2) / 2 + step - 1,
        };
        for row in 0..f {
            for step in 0..f - row {
                triangles.push([at(step, row), at(step + 1, row), at(step, row + 1)]);
                if step + row + 1 < f {
                    triangles.push([at(step + 1, row), at(step + 1, row + 1), at(step, row + 1)]);
                }
            }
        }
    }
    (points, triangles)
}

/// A unit sphere of meridians and parallels, with normals and texture coordinates: `2 * segments * (rings - 1)`
/// triangles.
///
/// A seam runs along a meridian, and both poles have a vertex per segment. Welded, it is closed. At least 3 segments
/// and 2 rings, at most 2^28 cells. O(n).
pub fn uv_sphere(segments: u32, rings: u32) -> Mesh {
    let [segments, rings] = fit(segments, rings, [3, 2]);
    let part = Part::grid(segments, rings, |column, row| {
        let pole = row == 0 || row == rings;
        let [sin, cos] = sin_cos(f64::from(column % segments) / f64::from(segments));
        let [radius, height] = sin_cos(f64::from(row) / f64::from(2 * rings));
        let radius = if pole { 0.0 } else { radius };
        // Each vertex at a pole serves a single triangle, whose middle is half a column on.
        let shift = if row == 0 {
            0.5
        } else if pole {
            -0.5
        } else {
            0.0
        };
        let u = (f64::from(column) + shift) / f64::from(segments);
        let uv = [u as f32, (f64::from(row) / f64::from(rings)) as f32];
        (DVec3::new(radius * cos, -height, -radius * sin), uv)
    });
    let normals = part.positions.clone();
    let mut assembly = Assembly::default();
    assembly.add_with_normals(part, normals, 0);
    assembly.finish(&[])
}

/// The cube from -1 to 1: 8 vertices, 12 triangles, all vertices shared, closed.
pub fn cube() -> Mesh {
    // Bit k of a vertex's number is 1 on the positive side of axis k.
    let positions =
        (0..8).map(|v| [0, 1, 2].map(|axis| if v >> axis & 1 == 1 { 1.0 } else { -1.0 })).collect();
    let mut triangles = Vec::with_capacity(12);
    for (axis, side) in FACES {
        let [right, up] = face_axes(axis, side);
        let corner = |column: u32, row: u32| u32::from(side) << axis | column << right | row << up;
        cells(1, 1, &mut triangles, corner);
    }
    bare(positions, triangles)
}

/// The cube from -1 to 1 with a normal and texture coordinates per face, each face cut into `n` by `n` cells: `6 * (n +
/// 1)^2` vertices, `12 * n^2` triangles.
///
/// Faces share positions but no vertices: 24 vertices at `n` = 1. `n`: 1 to 6000. O(n^2).
pub fn box_with_face_normals(n: u32) -> Mesh {
    let n = n.clamp(1, 6000);
    let (mut positions, mut normals, mut uv) = (Vec::new(), Vec::new(), Vec::new());
    let mut triangles = Vec::new();
    for (axis, side) in FACES {
        let [right, up] = face_axes(axis, side);
        let base = positions.len() as u32;
        let sign = if side { 1.0 } else { -1.0 };
        for row in 0..=n {
            for column in 0..=n {
                let mut position = [sign; 3];
                position[right] = (2.0 * f64::from(column) / f64::from(n) - 1.0) as f32;
                position[up] = (2.0 * f64::from(row) / f64::from(n) - 1.0) as f32;
                let mut normal = [0.0; 3];
                normal[axis] = sign;
                positions.push(position);
                normals.push(normal);
                uv.push([column as f32 / n as f32, row as f32 / n as f32]);
            }
        }
        cells(n, n, &mut triangles, |column, row| base + row * (n + 1) + column);
    }
    let attributes = vec![Attribute::floats(names::NORMAL, &normals), Attribute::floats(names::UV, &uv)];
    Mesh::from_trusted(positions, triangles, attributes, Vec::new(), Vec::new(), Vec::new())
}

/// The faces of a cube: axis, and whether the face is on its positive side.
pub(super) const FACES: [(usize, bool); 6] =
    [(0, true), (0, false), (1, true), (1, false), (2, true), (2, false)];

/// Returns the axes to the right and up on a cube's face, seen from outside.
pub(super) fn face_axes(axis: usize, side: bool) -> [usize; 2] {
    let [first, second] = [(axis + 1) % 3, (axis + 2) % 3];
    if side { [first, second] } else { [second, first] }
}
