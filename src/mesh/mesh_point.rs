//! A point of a mesh's surface.

use glam::DVec3;

use super::Mesh;

/// A point of a mesh's surface: a triangle, and barycentric coordinates in it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct MeshPoint {
    /// The triangle.
    pub triangle: u32,
    /// Barycentric coordinates in the triangle; they sum to 1.
    pub barycentric: [f64; 3],
}

impl MeshPoint {
    /// Makes a point of a triangle.
    pub fn new(triangle: u32, barycentric: [f64; 3]) -> Self {
        Self { triangle, barycentric }
    }

    /// Returns the position on a mesh, object units; `None` if the mesh has no such triangle.
    pub fn position(&self, mesh: &Mesh) -> Option<[f64; 3]> {
        let corners = mesh.triangles().get(self.triangle as usize)?;
        let at = |k: usize| DVec3::from_array(mesh.positions()[corners[k] as usize].map(f64::from));
        Some((0..3).map(|k| self.barycentric[k] * at(k)).sum::<DVec3>().to_array())
    }
}
