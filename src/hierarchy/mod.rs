//! Vertex hierarchies: view-dependent refinement of any mesh accepted by the simplifier.
//!
//! Every collapse of a [`CollapseSequence`](crate::CollapseSequence) is undone by a *split*. Splits build on one another:
//! a split which brings back a vertex needs the vertex's substitute in the mesh. A *cut* is a set of splits closed under
//! needs. **The mesh at a cut is the image of the input's triangles under the remaining collapses, without triangles with
//! two equal corners.** This holds for any cut, so connectivity cannot be corrupted, also on open, non-manifold and
//! otherwise odd meshes. [`Dependencies`] decide only how near a cut must stay to meshes seen by the simplifier.
//!
//! | file | idea |
//! |---|---|
//! | `build.rs` | builds splits from a collapse sequence, numbered for locality |
//! | `bounds.rs` | nested bounds of splits |
//! | `context.rs` | error of a split left out of an otherwise fine mesh |
//! | `dependencies.rs` | [`Dependencies`] of splits besides parents |
//! | `stars.rs` | the corners around every active vertex, in a pool |
//! | `packed.rs` | the vertices in use, packed |
//! | `surface.rs` | the mesh at a cut: splits and collapses |
//! | `instance.rs` | [`HierarchyLod`]: a drawn instance |
//! | `baked.rs` | the common interface of all structures; [`HierarchyOptions`] |
//! | `builder.rs` | [`HierarchyBuilder`]: presets |
//! | `parts.rs` | [`HierarchyParts`]: plain arrays, in and out |
//! | `sink.rs` | applies splits and collapses to the drawn mesh |
//! | `vertices.rs` | the vertex buffer, with moving vertices |
//! | `validate.rs` | checks of all invariants |
//! | `error.rs` | [`HierarchyError`] |

mod baked;
mod bounds;
mod build;
mod builder;
mod context;
mod dependencies;
mod error;
mod instance;
mod packed;
mod parts;
mod sink;
mod stars;
mod surface;
mod validate;
mod vertices;

pub use baked::HierarchyOptions;
pub use build::HierarchyBuild;
pub use builder::HierarchyBuilder;
pub use dependencies::Dependencies;
pub use error::HierarchyError;
pub use instance::HierarchyLod;
pub use parts::HierarchyParts;
pub use surface::CutSurface;

use crate::adapt::{Cut, Refinements};
use crate::geometry::lists::Lists;
use crate::mesh::NONE;
use crate::view::Bounds;

/// A forest of vertices for view-dependent refinement: immutable, shared by all instances.
///
/// Vertices have new numbers ([`Origins`](crate::lod::Origins)). Leaves (vertices of the input) come first, and all
/// leaves represented by a vertex are consecutive. New vertices follow.
///
/// serde uses [`HierarchyParts`], and validates ([`VertexHierarchy::validate`]).
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "HierarchyParts"))]
pub struct VertexHierarchy {
    /// Per vertex, the vertex taking its place, or itself.
    substitute: Vec<u32>,
    /// Per vertex, the split bringing it back; `NONE` if it is never removed.
    split_of: Vec<u32>,
    /// Per new vertex, the first leaf represented by it.
    first_leaf: Vec<u32>,
    leaves: u32,
    /// Per split, the vertices brought back, in the order of the collapse.
    brings: Lists,
    parents: Lists,
    children: Lists,
    needs: Lists,
    dependencies: Dependencies,
    bounds: Vec<Bounds>,
    roots: Vec<u32>,
    /// Corners at full resolution, as leaves. First the triangles never removed, then the others by split.
    triangles: Vec<[u32; 3]>,
    /// Per split, its first triangle; with one more entry than splits.
    first_triangle: Vec<u32>,
    /// Per triangle, an index into `materials`; empty with at most one material.
    group_of: Vec<u16>,
    /// Material ids in use, ascending.
    materials: Vec<u32>,
    diagonal: f64,
    /// Per vertex, a vertex far above it; empty if all chains are short.
    jump: Vec<u32>,
}

impl VertexHierarchy {
    /// Number of splits.
    pub fn split_count(&self) -> usize {
        self.bounds.len()
    }

    /// Number of vertices at all levels.
    pub fn vertex_count(&self) -> usize {
        self.substitute.len()
    }

    /// Number of leaves: the input's vertices used by a triangle or a collapse. They come first.
    pub fn leaf_count(&self) -> usize {
        self.leaves as usize
    }

    /// Returns the kind of dependencies of splits besides their parents.
    pub fn dependency_kind(&self) -> Dependencies {
        self.dependencies
    }

    /// Number of triangles at full resolution, without degenerate triangles of the input.
    pub fn triangle_count(&self) -> usize {
        self.triangles.len()
    }

    /// Number of triangles of the coarsest mesh.
    pub fn base_triangle_count(&self) -> usize {
        self.first_triangle[0] as usize
    }

    /// Diagonal of the input's box, object units.
    pub fn diagonal(&self) -> f64 {
        self.diagonal
    }

    /// Returns the corners of all triangles at full resolution, as vertices of the hierarchy. Triangles never removed
    /// come first.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Returns the vertex representing `vertex` at a cut. O(hops to it). Returns `vertex` itself if it is out of range.
    pub fn representative(&self, vertex: u32, cut: &Cut) -> u32 {
        if (vertex as usize) < self.substitute.len() {
            self.active(vertex, |split| cut.holds(split))
        } else {
            vertex
        }
    }

    /// Returns the material ids in use, ascending. Triangles are drawn in a group for each. Empty if the mesh has no
    /// materials.
    pub fn materials(&self) -> &[u32] {
        &self.materials
    }

    /// Returns the group of a triangle.
    #[inline]
    fn group_of(&self, triangle: u32) -> usize {
        self.group_of.get(triangle as usize).map_or(0, |&group| group as usize)
    }

    /// Returns the triangles brought back by a split.
    #[inline]
    fn owned(&self, split: u32) -> std::ops::Range<u32> {
        self.first_triangle[split as usize]..self.first_triangle[split as usize + 1]
    }

    /// Returns the vertex representing a leaf, for the closed set of splits given by `there`. O(hops), and O(log n) if
    /// chains are long.
    #[inline]
    fn active(&self, leaf: u32, there: impl Fn(u32) -> bool) -> u32 {
        let stays = |vertex: u32| {
            let split = self.split_of[vertex as usize];
            split == NONE || there(split)
        };
        let mut vertex = leaf;
        while !stays(vertex) {
            vertex = match self.jump.get(vertex as usize) {
                // All vertices above a present vertex are present too.
                Some(&far) if !stays(far) => far,
                _ => self.substitute[vertex as usize],
            };
        }
        vertex
    }

    /// Bytes of all arrays, triangles included.
    pub fn memory(&self) -> usize {
        size_of_val(&self.triangles[..]) + self.overhead()
    }

    /// Bytes of all arrays except the triangles, since a plain mesh has triangles too.
    pub fn overhead(&self) -> usize {
        size_of_val(&self.substitute[..])
            + size_of_val(&self.split_of[..])
            + size_of_val(&self.first_leaf[..])
            + self.brings.memory()
            + self.parents.memory()
            + self.children.memory()
            + self.needs.memory()
            + size_of_val(&self.bounds[..])
            + size_of_val(&self.roots[..])
            + size_of_val(&self.first_triangle[..])
            + size_of_val(&self.group_of[..])
            + size_of_val(&self.materials[..])
            + size_of_val(&self.jump[..])
    }

    /// Returns the first leaf represented by a vertex at its coarsest.
    #[inline]
    fn first_leaf(&self, vertex: u32) -> u32 {
        if vertex < self.leaves { vertex } else { self.first_leaf[(vertex - self.leaves) as usize] }
    }

    pub(crate) fn has_dependencies(&self) -> bool {
        !self.needs.items.is_empty()
    }

    fn is_root(&self, vertex: u32) -> bool {
        self.split_of[vertex as usize] == NONE
    }
}

impl Refinements for VertexHierarchy {
    type Bounds = Bounds;

    fn len(&self) -> usize {
        self.bounds.len()
    }

    fn roots(&self) -> impl Iterator<Item = u32> {
        self.roots.iter().copied()
    }

    #[inline]
    fn bounds(&self, split: u32) -> Bounds {
        self.bounds[split as usize]
    }

    #[inline]
    fn error(&self, split: u32) -> f32 {
        self.bounds[split as usize].error
    }

    #[inline]
    fn parents(&self, split: u32) -> impl Iterator<Item = u32> {
        self.parents.get(split).iter().copied()
    }

    #[inline]
    fn children(&self, split: u32) -> impl Iterator<Item = u32> {
        self.children.get(split).iter().copied()
    }

    #[inline]
    fn dependencies(&self, split: u32) -> impl Iterator<Item = u32> {
        self.needs.get(split).iter().copied()
    }
}
