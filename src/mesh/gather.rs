//! Submeshes: selected vertices of a mesh with their attributes and locks.

use super::{Mesh, NONE};

impl Mesh {
    /// Builds a mesh of the vertices in `order`, which must all exist, with their attributes and locks. `triangles`
    /// index the new vertices; `materials` fit `triangles`. O(output).
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

    /// Builds a mesh of the vertices used by `triangles`, in the order of this mesh, with attributes and locks. O(n).
    pub(crate) fn gather_used(&self, triangles: &[[u32; 3]], materials: Vec<u32>) -> Self {
        let Used { vertices, number } = Used::new(self.positions.len(), triangles);
        let triangles = triangles.iter().map(|t| t.map(|v| number[v as usize])).collect();
        self.gather(&vertices, triangles, materials)
    }
}

/// The vertices used by a list of triangles.
pub(crate) struct Used {
    /// Used vertices, ascending.
    pub vertices: Vec<u32>,
    /// Index into `vertices` by vertex; `NONE` if unused.
    pub number: Vec<u32>,
}

impl Used {
    /// Collects the vertices used by `triangles`, out of `count` vertices.
    pub fn new(count: usize, triangles: &[[u32; 3]]) -> Self {
        let mut number = vec![NONE; count];
        triangles.as_flattened().iter().for_each(|&v| number[v as usize] = 0);
        let vertices: Vec<u32> = (0..count as u32).filter(|&v| number[v as usize] == 0).collect();
        (0_u32..).zip(&vertices).for_each(|(new, &old)| number[old as usize] = new);
        Self { vertices, number }
    }
}
