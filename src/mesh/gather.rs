//! A mesh of some vertices of another.

use super::Mesh;

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
}
