//! A mesh of some vertices of another.

use super::{Attribute, AttributeValues, Mesh};

impl Mesh {
    /// A mesh of the vertices in `order`, which all exist, with their attributes and locks, and of triangles and materials
    /// that fit them. O(output).
    pub(crate) fn gather(&self, order: &[u32], triangles: Vec<[u32; 3]>, materials: Vec<u32>) -> Self {
        fn rows<T: Copy>(values: &[T], width: usize, order: &[u32]) -> Vec<T> {
            order.iter().flat_map(|&v| &values[v as usize * width..][..width]).copied().collect()
        }
        let attributes = self.attributes.iter().map(|a| {
            let values = match a.values() {
                AttributeValues::Float(v) => AttributeValues::Float(rows(v, a.width(), order)),
                AttributeValues::Int(v) => AttributeValues::Int(rows(v, a.width(), order)),
                AttributeValues::Uint(v) => AttributeValues::Uint(rows(v, a.width(), order)),
            };
            Attribute::new(a.name(), a.width(), values)
        });
        Self {
            positions: rows(&self.positions, 1, order),
            triangles,
            attributes: attributes.collect(),
            materials,
            material_names: self.material_names.clone(),
            locks: if self.locks.is_empty() { Vec::new() } else { rows(&self.locks, 1, order) },
            origin: self.origin,
        }
    }
}
