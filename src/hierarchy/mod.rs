//! Vertex hierarchies: refined where a view needs it, for any mesh that the simplifier takes.
//!
//! Every collapse of a [`CollapseSequence`](crate::CollapseSequence) is undone by a *split*. Splits build on one another: one that gives back
//! a vertex needs that vertex's own taker to be there. A *cut* is a set of splits that holds with each also those it
//! needs, and **the mesh at a cut is the image of the input's triangles under the collapses that are left, less those with two
//! equal corners**. That holds for any cut, so connectivity cannot be corrupted, on open, non-manifold and otherwise odd meshes
//! either; what [`Dependencies`] decide is only how near a cut must stay to meshes that the simplifier has seen.
//!
//! | file | idea |
//! |---|---|
//! | `build.rs` | from a collapse sequence to splits, numbered for locality |
//! | `bounds.rs` | what each split can change, nested |
//! | `context.rs` | what a collapse costs where all around it is fine |
//! | `dependencies.rs` | [`Dependencies`]: what a split needs besides |
//! | `stars.rs` | the corners around every active vertex, in one pool |
//! | `packed.rs` | the vertices in use, packed |
//! | `surface.rs` | the mesh at a cut: splits and collapses |
//! | `instance.rs` | [`HierarchyLod`]: one drawn instance |
//! | `baked.rs` | a hierarchy under the one face of all structures; [`HierarchyOptions`] |
//! | `builder.rs` | [`HierarchyBuilder`]: presets |
//! | `parts.rs` | [`HierarchyParts`]: plain arrays, in and out |
//! | `sink.rs` | what is drawn, as the cut has it moved |
//! | `vertices.rs` | the vertex buffer, and where moving vertices are |
//! | `validate.rs` | every promise checked |
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
use crate::mesh::NONE;
use crate::view::Bounds;

/// Lists in one array: entries of `i` are `items[start[i]..start[i + 1]]`.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Lists {
    start: Vec<u32>,
    items: Vec<u32>,
}

impl Lists {
    /// From pairs of list and item, in the order given within a list. Pairs must be in range.
    fn from_pairs(lists: usize, pairs: impl Iterator<Item = (u32, u32)> + Clone) -> Self {
        let mut start = vec![0_u32; lists + 1];
        pairs.clone().for_each(|(list, _)| start[list as usize + 1] += 1);
        for i in 1..start.len() {
            start[i] += start[i - 1];
        }
        let mut items = vec![0; start[lists] as usize];
        let mut next = start.clone();
        for (list, item) in pairs {
            items[next[list as usize] as usize] = item;
            next[list as usize] += 1;
        }
        Self { start, items }
    }

    #[inline]
    fn get(&self, list: u32) -> &[u32] {
        match self.start.get(list as usize..list as usize + 2) {
            Some(ends) => &self.items[ends[0] as usize..ends[1] as usize],
            None => &[],
        }
    }

    fn memory(&self) -> usize {
        size_of_val(&self.start[..]) + size_of_val(&self.items[..])
    }
}

/// A forest of vertices with everything that refining it by view takes: immutable, shared by all instances.
///
/// Vertices are numbered anew ([`Origins`](crate::lod::Origins)): the input's first, so that all that one vertex stands for are
/// consecutive; then new ones.
///
/// serde goes through [`HierarchyParts`] and validates ([`VertexHierarchy::validate`]).
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "HierarchyParts"))]
pub struct VertexHierarchy {
    /// Per vertex the one that takes its place, or itself.
    substitute: Vec<u32>,
    /// Per vertex the split that brings it back; `NONE` where it is never gone.
    split_of: Vec<u32>,
    /// Per new vertex, the first input vertex that it stands for.
    first_leaf: Vec<u32>,
    leaves: u32,
    /// Per split, the vertices that it brings, in the order in which the collapse took them.
    brings: Lists,
    parents: Lists,
    children: Lists,
    needs: Lists,
    dependencies: Dependencies,
    bounds: Vec<Bounds>,
    roots: Vec<u32>,
    /// Corners at full resolution, as leaves: those never gone first, then by split.
    triangles: Vec<[u32; 3]>,
    /// Per split its first triangle; one more than splits.
    first_triangle: Vec<u32>,
    /// Per triangle an index into `materials`; empty with one material or none.
    group_of: Vec<u16>,
    /// The material ids in use, ascending.
    materials: Vec<u32>,
    diagonal: f64,
    /// Per vertex one far above it; empty where all chains are short.
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

    /// Number of leaves: the input's vertices that a triangle or a collapse uses. They come first.
    pub fn leaf_count(&self) -> usize {
        self.leaves as usize
    }

    /// What splits need besides their parents.
    pub fn dependency_kind(&self) -> Dependencies {
        self.dependencies
    }

    /// Triangles at full resolution, degenerate ones of the input not counted.
    pub fn triangle_count(&self) -> usize {
        self.triangles.len()
    }

    /// Triangles of the coarsest mesh.
    pub fn base_triangle_count(&self) -> usize {
        self.first_triangle[0] as usize
    }

    /// Diagonal of the input's box, object units.
    pub fn diagonal(&self) -> f64 {
        self.diagonal
    }

    /// Corners of all triangles at full resolution, as vertices of the hierarchy: those that are never gone first.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The vertex that stands for a vertex at a cut. O(hops to it); the vertex itself out of range.
    pub fn representative(&self, vertex: u32, cut: &Cut) -> u32 {
        if (vertex as usize) < self.substitute.len() {
            self.active(vertex, |split| cut.holds(split))
        } else {
            vertex
        }
    }

    /// The material ids in use, ascending: triangles are drawn in one group for each. Empty where the mesh has none.
    pub fn materials(&self) -> &[u32] {
        &self.materials
    }

    /// The group of a triangle.
    #[inline]
    fn group_of(&self, triangle: u32) -> usize {
        self.group_of.get(triangle as usize).map_or(0, |&group| group as usize)
    }

    /// The triangles that a split brings back.
    #[inline]
    fn owned(&self, split: u32) -> std::ops::Range<u32> {
        self.first_triangle[split as usize]..self.first_triangle[split as usize + 1]
    }

    /// The vertex that stands for a leaf where those splits are in the mesh that `there` says, a closed set. O(hops), and
    /// O(log n) where chains are long.
    #[inline]
    fn active(&self, leaf: u32, there: impl Fn(u32) -> bool) -> u32 {
        let stays = |vertex: u32| {
            let split = self.split_of[vertex as usize];
            split == NONE || there(split)
        };
        let mut vertex = leaf;
        while !stays(vertex) {
            vertex = match self.jump.get(vertex as usize) {
                // Whoever is above one that stays, stays too.
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

    /// Bytes beyond the triangles, which a plain mesh has too.
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

    /// The first of the leaves that a vertex stands for at its coarsest.
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
