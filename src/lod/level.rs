//! A level of detail of the whole model, by size or by error.

use crate::mesh::Mesh;

/// A level of detail to ask for. A count or ratio gives the finest level within it, or else the coarsest level of the
/// model. An error gives the coarsest level within it.
///
/// ```
/// use multires::{Level, Structure, hierarchy::VertexHierarchy, mesh::shapes};
///
/// let model = VertexHierarchy::bake(&shapes::icosphere(3))?;
/// let level = model.level(Level::Triangles(300));
/// assert!(level.mesh.triangles().len() <= 300);
/// assert!(level.error <= model.level(Level::Triangles(100)).error);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Level {
    /// At most this many triangles.
    Triangles(usize),
    /// At most this many vertices.
    Vertices(usize),
    /// The coarsest level with a known error of at most this, object units. A totally ordered mesh keeps at most 1024
    /// bounds, about 1 per 128 vertices
    /// ([`TotallyOrderedMesh::error_marks`](crate::tom::TotallyOrderedMesh::error_marks)), so the level may be finer
    /// than needed by the vertices between two bounds. Below the finest bound, and for NaN, gives the full resolution.
    Error(f32),
    /// At most this share of the triangles, 0 to 1; NaN is 0.
    Ratio(f32),
}

/// A level of detail as a mesh.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Extracted {
    /// The mesh.
    pub mesh: Mesh,
    /// Bound for its error, object units.
    pub error: f32,
}

impl Extracted {
    pub(crate) fn new(mesh: Mesh, error: f32) -> Self {
        Self { mesh, error }
    }
}
