//! Complexes: faces glued along edges, at a single level of coarsening.
//!
//! ```text
//!     half-edge 3f + k     side k of face f, from corner k to corner k + 1
//!     edge                 named by number, not by its ends: two edges may join the same two points
//!     next                 the half-edges along one edge in a ring; a border edge is its own next
//! ```
//!
//! Corners are *wedges* of the input at every level, so seams stay known. Gluing is defined by edges. The three corners of a
//! face are distinct points.

use crate::mesh::NONE;

/// Properties of the input shared by all levels of all components.
#[derive(Clone, Copy)]
pub(super) struct FaceComplex<'a> {
    /// The point of every input vertex.
    pub point_of: &'a [u32],
    /// Material per input triangle, or empty.
    pub materials: &'a [u32],
    /// Whether seams may run inside coarse faces.
    pub across_seams: bool,
}

impl FaceComplex<'_> {
    pub fn point(&self, wedge: u32) -> u32 {
        self.point_of[wedge as usize]
    }

    pub fn material(&self, triangle: u32) -> u32 {
        self.materials.get(triangle as usize).copied().unwrap_or(NONE)
    }
}

/// Faces glued along edges.
pub(super) struct Complex {
    /// The lowest input triangle of every face; ascending.
    pub lowest: Vec<u32>,
    /// The wedges at the corners of every face.
    pub corners: Vec<[u32; 3]>,
    /// The edges of every face, numbered from 0 without gaps.
    pub edges: Vec<[u32; 3]>,
    pub edge_count: usize,
    /// Per face a bit for each of its corners that may be corner 0 of the face in the forest; empty: all of them. Triangles that
    /// close cracks show where corner 0 is.
    pub turns: Vec<u8>,
    /// The first half-edge along every edge.
    first: Vec<u32>,
    /// The next half-edge along the same edge, in a ring.
    next: Vec<u32>,
}

impl Complex {
    pub fn new(lowest: Vec<u32>, corners: Vec<[u32; 3]>, edges: Vec<[u32; 3]>, edge_count: usize) -> Self {
        let mut first = vec![NONE; edge_count];
        let mut next = vec![NONE; 3 * edges.len()];
        for (half_edge, &edge) in edges.as_flattened().iter().enumerate() {
            let first = &mut first[edge as usize];
            if *first == NONE {
                *first = half_edge as u32;
                next[half_edge] = half_edge as u32;
            } else {
                next[half_edge] = next[*first as usize];
                next[*first as usize] = half_edge as u32;
            }
        }
        Self { lowest, corners, edges, edge_count, turns: Vec::new(), first, next }
    }

    pub fn face_count(&self) -> usize {
        self.edges.len()
    }

    /// Whether a corner of a face, given as `3 * face + corner`, may be corner 0 of the face in the forest.
    pub fn may_start(&self, corner: u32) -> bool {
        self.turns.get((corner / 3) as usize).is_none_or(|turns| turns >> (corner % 3) & 1 == 1)
    }

    /// Returns the lowest half-edge along an edge.
    pub fn first(&self, edge: u32) -> u32 {
        self.first[edge as usize]
    }

    /// Returns the next half-edge along the same edge; the half-edge itself at a border.
    pub fn next(&self, half_edge: u32) -> u32 {
        self.next[half_edge as usize]
    }

    /// Whether the edge of a half-edge has more than two half-edges.
    pub fn is_non_manifold(&self, half_edge: u32) -> bool {
        self.next(self.next(half_edge)) != half_edge
    }
}
