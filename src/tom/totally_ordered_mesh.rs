//! [`TotallyOrderedMesh`]: the arrays, and what is read off them.

use crate::geometry::array::Array;
use crate::mesh::NONE;

#[cfg(feature = "serde")]
use super::TomParts;

/// A bound for the error from a number of active vertices on.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[repr(C)]
pub struct ErrorMark {
    /// Active vertices of a resolution.
    pub vertices: u32,
    /// Error bound of this resolution and every finer resolution, object units.
    pub error: f32,
}

/// A totally ordered mesh: connectivity of all levels of detail. Immutable; see the [module](super).
///
/// ```
/// use multires::{Level, Structure, mesh::shapes, tom::TotallyOrderedMesh};
///
/// let mesh = shapes::icosphere(3);
/// let model = TotallyOrderedMesh::bake(&mesh)?;
/// let tom = model.structure();
/// let resolution = tom.at(Level::Triangles(200));
/// let mut indices = Vec::new();
/// tom.fill_indices(resolution, &mut indices);
/// assert_eq!(indices.len(), 3 * resolution.triangles());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "TomParts", into = "TomParts"))]
pub struct TotallyOrderedMesh {
    /// Earlier vertex that replaces each vertex; base vertices name themselves.
    pub(super) substitute: Array<u32>,
    /// 1 bit a vertex, set if it comes and goes with the vertex before it. Empty if no bit is set. Kept apart so that
    /// following a chain is a single load a hop.
    pub(super) joined: Array<u64>,
    pub(super) base_vertices: u32,
    /// Corners at full resolution, last vanishing first.
    pub(super) triangles: Array<[u32; 3]>,
    /// Ascending in vertices, falling in error; the first is the base.
    pub(super) error_marks: Array<ErrorMark>,
    /// Per triangle an index into `material_ids`; empty with fewer than 2 materials.
    pub(super) material_of: Array<u32>,
    /// The material ids in use, ascending.
    pub(super) material_ids: Array<u32>,
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

    /// Returns the error bounds behind [`Resolution::error`](super::Resolution::error): about 1 per 128 vertices, at
    /// most 1024, ascending in vertices and falling in error. The first is the base. The full resolution has error 0
    /// and no entry.
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
        let arrays = size_of_val(&self.substitute[..])
            + size_of_val(&self.joined[..])
            + size_of_val(&self.triangles[..])
            + size_of_val(&self.error_marks[..])
            + size_of_val(&self.material_of[..])
            + size_of_val(&self.material_ids[..]);
        vertex_bytes.saturating_mul(self.vertex_count()).saturating_add(arrays)
    }

    /// Returns the substitute of `vertex` among the first `active` vertices. `active` is at least the base.
    pub(super) fn resolve(&self, mut vertex: u32, active: u32) -> u32 {
        while vertex >= active {
            vertex = self.substitute[vertex as usize];
        }
        vertex
    }

    /// Returns the vertex whose substitution makes a triangle vanish, `NONE` for a base triangle: substitutes the last
    /// corner until two corners agree (TOM, section 3.2).
    pub(super) fn last_vertex(&self, triangle: usize) -> u32 {
        self.walk_to_end(triangle, || ())
    }

    /// [`last_vertex`](Self::last_vertex) with a call of `hop` for each substitution on the way.
    pub(super) fn walk_to_end(&self, triangle: usize, mut hop: impl FnMut()) -> u32 {
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
            hop();
            last = a;
            a = self.substitute[a as usize];
        }
        last
    }

    /// Holds if a vertex comes and goes with the vertex before it.
    pub(super) fn is_joined(&self, vertex: u32) -> bool {
        self.joined.get(vertex as usize / 64).is_some_and(|word| word >> (vertex % 64) & 1 != 0)
    }

    /// Holds if this many active vertices are whole groups.
    pub(super) fn is_boundary(&self, vertices: u32) -> bool {
        (self.base_vertices..=self.substitute.len() as u32).contains(&vertices) && !self.is_joined(vertices)
    }

    /// Returns the largest boundary of at most `vertices`, or the base. O(size of a group).
    pub(super) fn boundary_at_most(&self, vertices: u32) -> u32 {
        let mut vertices = vertices.clamp(self.base_vertices, self.substitute.len() as u32);
        while !self.is_boundary(vertices) {
            vertices -= 1;
        }
        vertices
    }

    /// Returns the number of triangles drawn with `vertices` active vertices (whole groups). O(log triangles) walks.
    pub(super) fn triangles_at(&self, vertices: u32) -> u32 {
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
