//! Totally ordered mesh (TOM): all levels of detail in a vertex array, a triangle array and an index per vertex.
//!
//! ```text
//!     vertices    base | last removed ... first removed        the first `resolution.vertices()` are active
//!     substitute   =   | an earlier vertex each                takes its place when it is not active
//!     triangles   base | last vanishing ... first vanishing    the first `resolution.triangles()` are drawn
//! ```
//!
//! An inactive corner is replaced by its substitute until it is active: no other connectivity is stored (Bouvier and
//! Gobbetti, *TOM: Totally Ordered Mesh*, section 3). With positions and normals of 24 bytes a vertex, the whole takes at
//! most 108.5 % of the plain mesh.
//!
//! Vertices removed by a single step form a *group*. They come and go together, so the wedges of a seam never part, and
//! the paper's degenerate triangles are not needed. The structure holds topology only. [`TotallyOrderedMesh::build`]
//! returns the order for positions and all other vertex data; [`Baked`](crate::lod::Baked) stores the data in this order.
//!
//! | file | idea |
//! |---|---|
//! | `build.rs` | from a collapse sequence to the total order |
//! | `level.rs` | from a [`Level`] to a [`Resolution`] |
//! | `extract.rs` | the indices of a resolution, whole or by material |
//! | `geomorph.rs` | where vertices move between two resolutions |
//! | `steps.rs` | [`TomSteps`]: the corners rewritten by every step |
//! | `baked.rs` | the interface common to all structures |
//! | `instance.rs` | [`TomLod`]: a drawn instance following the view |
//! | `indices.rs` | an index buffer, moved at the cost of the difference |
//! | `cursor.rs` | [`TomCursor`]: an index buffer, moved by its owner |
//! | `validate.rs` | [`TomParts`] in and out, all promises checked |
//!
//! # Drawing
//!
//! ```
//! use multires::lod::Structure;
//! use multires::{Level, TotallyOrderedMesh, mesh::shapes};
//!
//! let mesh = shapes::rock(2_000, 1);
//! let model = TotallyOrderedMesh::bake(&mesh)?;
//! let positions = model.arrange(mesh.positions())?; // upload once
//!
//! let tom = model.structure();
//! let resolution = tom.at(Level::Ratio(0.5));
//! let mut indices = Vec::new();
//! tom.fill_indices(resolution, &mut indices); // upload and draw
//! assert_eq!(indices.len(), 3 * resolution.triangles());
//! assert!(indices.iter().all(|&v| (v as usize) < resolution.vertices() && resolution.vertices() <= positions.len()));
//! # Ok::<(), multires::Error>(())
//! ```
//!
//! To follow a view, use [`TomLod`]: it finds the level, and moves its indices at the cost of the difference.

mod baked;
mod build;
mod cursor;
mod error;
mod extract;
mod geomorph;
mod indices;
mod instance;
mod level;
mod steps;
mod validate;

#[doc(no_inline)]
pub use crate::lod::Level;
pub use baked::{TomBuilder, TomOptions};
pub use build::TomBuild;
pub use cursor::{Change, TomCursor};
pub use error::TomError;
pub use extract::MaterialRange;
pub use instance::TomLod;
pub use level::Resolution;
pub use steps::TomSteps;
pub use validate::TomParts;

use crate::mesh::NONE;

/// A bound for the error from a number of active vertices on.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ErrorMark {
    /// Active vertices of a resolution.
    pub vertices: u32,
    /// Error bound of this resolution and every finer resolution, object units.
    pub error: f32,
}

/// A totally ordered mesh: connectivity of all levels of detail. Immutable; see the [module](self).
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "TomParts", into = "TomParts"))]
pub struct TotallyOrderedMesh {
    /// Earlier vertex that replaces each vertex; base vertices name themselves.
    substitute: Vec<u32>,
    /// 1 bit a vertex, set if it comes and goes with the vertex before it. Empty if no bit is set. Kept apart so that
    /// following a chain is a single load a hop.
    joined: Vec<u64>,
    base_vertices: u32,
    /// Corners at full resolution, last vanishing first.
    triangles: Vec<[u32; 3]>,
    /// Ascending in vertices, falling in error; the first is the base.
    error_marks: Vec<ErrorMark>,
    /// Per triangle an index into `material_ids`; empty with fewer than 2 materials.
    material_of: Vec<u32>,
    /// The material ids in use, ascending.
    material_ids: Vec<u32>,
}

impl TotallyOrderedMesh {
    /// Returns the number of vertices of the full resolution: the input's, without duplicates and unused vertices.
    pub fn vertex_count(&self) -> usize {
        self.substitute.len()
    }

    /// Returns the number of triangles of the full resolution: the input's, without degenerate triangles.
    pub fn triangle_count(&self) -> usize {
        self.triangles.len()
    }

    /// Returns the corners of all triangles at full resolution, last vanishing first.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Returns the vertex that replaces an inactive vertex: itself for a base vertex, `None` out of range.
    pub fn substitute(&self, vertex: u32) -> Option<u32> {
        self.substitute.get(vertex as usize).copied()
    }

    /// Returns the error bounds behind [`Resolution::error`]: about 1 per 128 vertices, at most 1024, ascending in
    /// vertices and falling in error. The first is the base. The full resolution has error 0 and no entry.
    pub fn error_marks(&self) -> &[ErrorMark] {
        &self.error_marks
    }

    /// Returns the material ids in use, ascending; empty where the mesh has no materials.
    pub fn material_ids(&self) -> &[u32] {
        &self.material_ids
    }

    /// Returns the bytes of this structure's arrays plus `vertex_bytes` (position and attributes) for every vertex: the
    /// memory of an object at all levels of detail.
    pub fn memory(&self, vertex_bytes: usize) -> usize {
        size_of_val(&self.substitute[..])
            + size_of_val(&self.joined[..])
            + size_of_val(&self.triangles[..])
            + size_of_val(&self.error_marks[..])
            + size_of_val(&self.material_of[..])
            + size_of_val(&self.material_ids[..])
            + vertex_bytes * self.vertex_count()
    }

    /// Returns the substitute of `vertex` among the first `active` vertices. `active` is at least the base.
    fn resolve(&self, mut vertex: u32, active: u32) -> u32 {
        while vertex >= active {
            vertex = self.substitute[vertex as usize];
        }
        vertex
    }

    /// Returns the vertex whose substitution makes a triangle vanish, `NONE` for a base triangle: substitutes the last
    /// corner until two corners agree (TOM, section 3.2).
    fn last_vertex(&self, triangle: usize) -> u32 {
        let [mut a, mut b, mut c] = self.triangles[triangle];
        let mut last = NONE;
        while a != b && b != c && c != a {
            // Bring the highest to `a`; the order of the others does not matter.
            if b > a {
                (a, b) = (b, a);
            }
            if c > a {
                (a, c) = (c, a);
            }
            if a < self.base_vertices {
                return NONE;
            }
            last = a;
            a = self.substitute[a as usize];
        }
        last
    }

    /// Holds if a vertex comes and goes with the vertex before it.
    fn is_joined(&self, vertex: u32) -> bool {
        self.joined.get(vertex as usize / 64).is_some_and(|word| word >> (vertex % 64) & 1 != 0)
    }

    /// Holds if this many active vertices are whole groups.
    fn is_boundary(&self, vertices: u32) -> bool {
        (self.base_vertices..=self.substitute.len() as u32).contains(&vertices) && !self.is_joined(vertices)
    }

    /// Returns the largest boundary of at most `vertices`, or the base. O(size of a group).
    fn boundary_at_most(&self, vertices: u32) -> u32 {
        let mut vertices = vertices.clamp(self.base_vertices, self.substitute.len() as u32);
        while !self.is_boundary(vertices) {
            vertices -= 1;
        }
        vertices
    }

    /// Returns the number of triangles drawn with `vertices` active vertices (whole groups). O(log triangles) walks.
    fn triangles_at(&self, vertices: u32) -> u32 {
        if vertices as usize == self.substitute.len() {
            return self.triangles.len() as u32;
        }
        let (mut low, mut high) = (0, self.triangles.len());
        while low < high {
            let middle = low + (high - low) / 2;
            let last = self.last_vertex(middle);
            if last == NONE || last < vertices {
                low = middle + 1;
            } else {
                high = middle;
            }
        }
        low as u32
    }
}
