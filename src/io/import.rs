//! What a reader is asked for, and what it returns beside the mesh.

use crate::mesh::Mesh;

/// Origin of a mesh being read, chosen while its coordinates are in double precision.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[non_exhaustive]
pub enum SceneOrigin {
    /// Keeps the file's coordinates, unless single precision would round them by more than 1e-6 of the diagonal: then a
    /// point near the middle.
    #[default]
    Automatic,
    /// Keeps the file's coordinates.
    Keep,
    /// The middle of the box around all vertices used by triangles.
    Center,
    /// A point in the file's coordinates.
    At([f64; 3]),
}

/// Options for reading a file.
#[derive(Debug, Clone, Default, PartialEq)]
#[non_exhaustive]
pub struct ReadOptions {
    /// Origin of the mesh; by default moved only if needed. Single precision has 24 bits: a mesh with details of
    /// centimetres in map coordinates of kilometres keeps its shape only if its origin is moved.
    pub origin: SceneOrigin,
}

impl ReadOptions {
    /// Sets the choice of the origin.
    #[must_use]
    pub fn with_origin(mut self, origin: SceneOrigin) -> Self {
        self.origin = origin;
        self
    }
}

/// A mesh read from a file, with notes about the reading.
#[derive(Debug, Clone, Default, PartialEq)]
#[non_exhaustive]
pub struct Imported {
    /// The mesh.
    pub mesh: Mesh,
    /// Offset subtracted from the file's coordinates, equal to [`Mesh::origin`]. Writers add it again.
    pub origin: [f64; 3],
    /// Content skipped or assumed by the reader, a line each; empty for a clean file.
    pub notes: Vec<String>,
}
