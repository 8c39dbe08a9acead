//! Triangles by point numbers, to subdivide, roll up and shuffle them. Positions mean nothing but which point it is.
#![allow(dead_code)]

pub mod check;
pub mod uneven;

use std::collections::BTreeMap;

use multires::mesh::{Attribute, Mesh, Topology, names};

/// Triangles over points `0..points`.
#[derive(Debug, Clone, Default)]
pub struct Faces {
    pub points: u32,
    pub corners: Vec<[u32; 3]>,
}

impl Faces {
    /// The triangles of a mesh over its welded points.
    pub fn of(mesh: &Mesh) -> Self {
        let topology = Topology::new(mesh);
        let point = |v: u32| topology.point_of()[v as usize];
        let corners = mesh.triangles().iter().map(|t| t.map(point)).collect();
        Self { points: topology.point_count() as u32, corners }
    }

    /// Every triangle becomes four, in the order corner 0, 1, 2, centre. A midpoint belongs to the pair of points.
    pub fn subdivided(&self) -> Self {
        let mut points = self.points;
        let mut midpoints = BTreeMap::new();
        let mut corners = Vec::new();
        for c in &self.corners {
            let m = [0, 1, 2].map(|k| {
                let (a, b) = (c[k], c[(k + 1) % 3]);
                *midpoints.entry([a.min(b), a.max(b)]).or_insert_with(|| {
                    points += 1;
                    points - 1
                })
            });
            corners.extend([[c[0], m[0], m[2]], [c[1], m[1], m[0]], [c[2], m[2], m[1]], m]);
        }
        Self { points, corners }
    }

    pub fn times(&self, levels: u32) -> Self {
        (0..levels).fold(self.clone(), |faces, _| faces.subdivided())
    }

    pub fn add(&mut self, other: &Self) {
        let first = self.points;
        self.corners.extend(other.corners.iter().map(|t| t.map(|p| p + first)));
        self.points += other.points;
    }

    pub fn mesh(&self) -> Mesh {
        Mesh::new(positions(self.points), self.corners.clone()).unwrap()
    }

    /// A mesh with texture coordinates by chart: wherever triangles of different charts meet is a seam.
    pub fn charted(&self, charts: &[u32]) -> Mesh {
        let mut vertices = BTreeMap::new();
        let place = positions(self.points);
        let (mut at, mut uv) = (Vec::new(), Vec::new());
        let mut triangles = Vec::new();
        for (triangle, &chart) in self.corners.iter().zip(charts) {
            triangles.push(triangle.map(|p| {
                *vertices.entry((p, chart)).or_insert_with(|| {
                    at.push(place[p as usize]);
                    uv.push([chart as f32, p as f32]);
                    at.len() as u32 - 1
                })
            }));
        }
        Mesh::new(at, triangles).unwrap().with_attribute(Attribute::floats(names::UV, &uv)).unwrap()
    }
}

fn positions(points: u32) -> Vec<[f32; 3]> {
    (0..points).map(|p| [(p % 1024) as f32, (p / 1024) as f32, (p % 7) as f32]).collect()
}

/// The triangular lattice rolled up to a torus of `columns` by `rows` points. Triangles `2 * (row * columns + column)`
/// and the next lie above point (column, row).
pub fn torus(columns: u32, rows: u32) -> Faces {
    let at = |i: u32, j: u32| (j % rows) * columns + i % columns;
    let cells = (0..rows).flat_map(|j| (0..columns).map(move |i| (i, j)));
    let corners = cells.flat_map(|(i, j)| {
        let up = [at(i, j), at(i + 1, j), at(i, j + 1)];
        [up, [at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]]
    });
    Faces { points: columns * rows, corners: corners.collect() }
}

/// The triangular lattice rolled up to a Klein bottle: a torus of `columns` by `rows` points, both even, halved by the
/// glide reflection (i, j) -> (-i - j + shift, j + rows / 2). `columns * rows` triangles, whose orientations clash along
/// row `cut`.
pub fn klein_bottle(columns: i32, rows: i32, shift: i32, cut: i32) -> Faces {
    // Twice the glide shifts by (-rows / 2, rows), which is what makes the torus meet itself upwards.
    let reduce = |i: i32, j: i32| {
        let rounds = j.div_euclid(rows);
        ((i + rounds * rows / 2).rem_euclid(columns), j - rounds * rows)
    };
    let point = |[i, j]: [i32; 2]| {
        let here = reduce(i, j);
        let there = reduce(-i - j + shift, j + rows / 2);
        let (i, j) = if (here.1, here.0) < (there.1, there.0) { here } else { there };
        (j * columns + i) as u32
    };
    let mut seen = BTreeMap::new();
    for j in cut..cut + rows / 2 {
        for i in 0..columns {
            for triangle in [[[i, j], [i + 1, j], [i, j + 1]], [[i + 1, j], [i + 1, j + 1], [i, j + 1]]] {
                let corners = triangle.map(point);
                let mut key = corners;
                key.sort_unstable();
                seen.entry(key).or_insert(corners);
            }
        }
    }
    Faces { points: (columns * rows) as u32, corners: seen.into_values().collect() }
}

/// Triangles in another order and turned, vertices in another order; returns which triangle each was, too.
pub fn shuffled(mesh: &Mesh, seed: u64) -> (Mesh, Vec<u32>) {
    let mut state = seed;
    let mut order = |count: usize| {
        let mut order: Vec<u32> = (0..count as u32).collect();
        for i in (1..count).rev() {
            order.swap(i, next(&mut state) as usize % (i + 1));
        }
        order
    };
    let (triangle, vertex) = (order(mesh.triangles().len()), order(mesh.positions().len()));
    let mut to = vec![0; vertex.len()];
    vertex.iter().enumerate().for_each(|(new, &old)| to[old as usize] = new as u32);
    let turned = triangle.iter().map(|&t| {
        let corners = mesh.triangles()[t as usize].map(|v| to[v as usize]);
        let turn = next(&mut state) as usize % 3;
        [0, 1, 2].map(|k| corners[(k + turn) % 3])
    });
    let turned: Vec<_> = turned.collect();
    let positions: Vec<_> = vertex.iter().map(|&v| mesh.positions()[v as usize]).collect();
    let mut result = Mesh::new(positions, turned).unwrap();
    for attribute in mesh.attributes() {
        let (values, width) = (attribute.as_floats().unwrap(), attribute.width());
        let values = vertex.iter().flat_map(|&v| values[v as usize * width..][..width].to_vec());
        let values = multires::mesh::AttributeValues::Float(values.collect());
        result = result.with_attribute(Attribute::new(attribute.name(), width, values)).unwrap();
    }
    if !mesh.materials().is_empty() {
        let materials: Vec<_> = triangle.iter().map(|&t| mesh.materials()[t as usize]).collect();
        result = result.with_materials(materials).unwrap();
    }
    (result, triangle)
}

/// The next of a sequence of random numbers.
pub fn next(state: &mut u64) -> u64 {
    *state = state.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(0x1405_7b7e_f767_814f);
    (*state ^ *state >> 29).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 33
}
