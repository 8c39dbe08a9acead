//! A mesh of some vertices of another.

use super::{Mesh, NONE};

impl Mesh {
    /// A mesh of the vertices in `order`, which all exist, with their attributes and locks, and of triangles and materials
    /// that fit them. O(output).
    pub(crate) fn gather(&self, order: &[u32], triangles: Vec<[u32; 3]>, materials: Vec<u32>) -> Self {
        Self {
            positions: order.iter().map(|&v| self.positions[v as usize]).collect(),
            triangles,
            attributes: self.attributes.iter().map(|attribute| attribute.gather(order)).collect(),
            materials,
            material_names: self.material_names.clone(),
            locks: if self.locks.is_empty() {
                Vec::new()
            } else {
                order.iter().map(|&v| self.locks[v as usize]).collect()
            },
            origin: self.origin,
        }
    }

    /// A mesh of the vertices that triangles use, in their order here, with their attributes and locks. O(n).
    pub(crate) fn gather_used(&self, triangles: &[[u32; 3]], materials: Vec<u32>) -> Self {
        let Used { vertices, number } = Used::new(self.positions.len(), triangles);
        let triangles = triangles.iter().map(|t| t.map(|v| number[v as usize])).collect();
        self.gather(&vertices, triangles, materials)
    }
}

/// The vertices that triangles use.
pub(crate) struct Used {
    /// In ascending order.
    pub vertices: Vec<u32>,
    /// Per vertex its place among them, or `NONE`.
    pub number: Vec<u32>,
}

impl Used {
    /// Of triangles that name some of `count` vertices.
    pub fn new(count: usize, triangles: &[[u32; 3]]) -> Self {
        let mut number = vec![NONE; count];
        triangles.as_flattened().iter().for_each(|&v| number[v as usize] = 0);
        let vertices: Vec<u32> = (0..count as u32).filter(|&v| number[v as usize] == 0).collect();
        (0_u32..).zip(&vertices).for_each(|(new, &old)| number[old as usize] = new);
        Self { vertices, number }
    }
}
