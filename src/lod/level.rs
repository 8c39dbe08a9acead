//! A level of detail of the whole model, asked for by its size or by its error.

use crate::mesh::Mesh;

/// A level of detail to ask for. What is given is the finest that does not exceed it, and never less than the coarsest.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Level {
    /// At most so many triangles.
    Triangles(usize),
    /// At most so many vertices.
    Vertices(usize),
    /// The coarsest level known to err by at most this many object units. A totally ordered mesh keeps bounds for about one
    /// resolution in 128 ([`TotallyOrderedMesh::error_marks`](crate::TotallyOrderedMesh::error_marks)), so up to that many
    /// vertices more than needed are given. Below the finest bound, and for NaN, the full resolution.
    Error(f32),
    /// At most this share of the triangles, 0 to 1; NaN is 0.
    Ratio(f32),
}

/// A level of detail as a mesh of its own.
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
