//! Grids with texture coordinates, their smooth normals, and their assembly into a mesh.
//!
//! A part is smooth all over: normals are averaged at each of its positions, seams included. Parts meet in creases.
//! Positions at a join must be equal bit for bit: compute them from equal numbers.

use glam::{DVec3, Vec3};

use super::super::{Attribute, Mesh, Topology, names};
use super::{bare, cells};

/// A smooth piece of surface.
#[derive(Default)]
pub(super) struct Part {
    pub(super) positions: Vec<[f32; 3]>,
    pub(super) uv: Vec<[f32; 2]>,
    pub(super) triangles: Vec<[u32; 3]>,
}

impl Part {
    /// Builds a grid of cells with `(columns + 1) * (rows + 1)` vertices. A cell with coincident corners (at a pole)
    /// has 1 triangle or none.
    pub(super) fn grid(columns: u32, rows: u32, point: impl Fn(u32, u32) -> (DVec3, [f32; 2])) -> Self {
        let mut part = Self::default();
        part.add_grid(columns, rows, point);
        part
    }

    /// Adds a grid to the smooth piece.
    pub(super) fn add_grid(
        &mut self,
        columns: u32,
        rows: u32,
        point: impl Fn(u32, u32) -> (DVec3, [f32; 2]),
    ) {
        let base = self.positions.len() as u32;
        for row in 0..=rows {
            for column in 0..=columns {
                let (position, uv) = point(column, row);
                // Adding zero turns a negative zero into a positive one.
                self.positions.push((position.as_vec3() + Vec3::ZERO).to_array());
                self.uv.push(uv);
            }
        }
        let first = self.triangles.len();
        cells(columns, rows, &mut self.triangles, |column, row| base + row * (columns + 1) + column);
        let positions = &self.positions;
        let mut index = 0;
        self.triangles.retain(|corners| {
            let [a, b, c] = corners.map(|v| positions[v as usize]);
            index += 1;
            index <= first || (a != b && b != c && c != a)
        });
    }

    /// Returns normals averaged over the triangles at each position, weighted by area.
    fn smooth_normals(&self) -> Vec<[f32; 3]> {
        let topology = Topology::new(&bare(self.positions.clone(), self.triangles.clone()));
        let point_of = topology.point_of();
        let mut sums = vec![DVec3::ZERO; topology.point_count()];
        for corners in &self.triangles {
            let [a, b, c] = corners.map(|v| Vec3::from(self.positions[v as usize]).as_dvec3());
            let normal = (b - a).cross(c - a);
            corners.iter().for_each(|&v| sums[point_of[v as usize] as usize] += normal);
        }
        let units: Vec<_> = sums.iter().map(|n| n.normalize_or(DVec3::Y).as_vec3().to_array()).collect();
        point_of.iter().map(|&point| units[point as usize]).collect()
    }
}

/// Assembled parts with normals, texture coordinates and materials.
#[derive(Default)]
pub(super) struct Assembly {
    positions: Vec<[f32; 3]>,
    triangles: Vec<[u32; 3]>,
    normals: Vec<[f32; 3]>,
    uv: Vec<[f32; 2]>,
    materials: Vec<u32>,
}

impl Assembly {
    /// Adds a part with smooth normals.
    pub(super) fn add(&mut self, part: Part, material: u32) {
        let normals = part.smooth_normals();
        self.add_with_normals(part, normals, material);
    }

    /// Adds a part with given normals, by vertex. Leaves out vertices used by no triangle.
    pub(super) fn add_with_normals(&mut self, part: Part, normals: Vec<[f32; 3]>, material: u32) {
        let mut used = vec![false; part.positions.len()];
        part.triangles.as_flattened().iter().for_each(|&v| used[v as usize] = true);
        let mut number = vec![0; used.len()];
        for (vertex, _) in used.iter().enumerate().filter(|(_, used)| **used) {
            number[vertex] = self.positions.len() as u32;
            self.positions.push(part.positions[vertex]);
            self.normals.push(normals[vertex]);
            self.uv.push(part.uv[vertex]);
        }
        self.triangles.extend(part.triangles.iter().map(|corners| corners.map(|v| number[v as usize])));
        self.materials.resize(self.triangles.len(), material);
    }

    /// Returns the mesh. It has materials only if `material_names` has names.
    pub(super) fn finish(self, material_names: &[&str]) -> Mesh {
        let attributes =
            vec![Attribute::floats(names::NORMAL, &self.normals), Attribute::floats(names::UV, &self.uv)];
        let materials = if material_names.is_empty() { Vec::new() } else { self.materials };
        let names = material_names.iter().map(|&name| name.to_owned()).collect();
        Mesh::from_trusted(self.positions, self.triangles, attributes, materials, names, Vec::new())
    }
}
