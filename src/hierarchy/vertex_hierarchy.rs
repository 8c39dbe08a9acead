//! [`VertexHierarchy`]: the arrays, and what is read off them.

use crate::adapt::{Cut, Refinements};
use crate::geometry::array::Array;
use crate::geometry::lists::Lists;
use crate::mesh::NONE;
use crate::view::Bounds;

use super::Dependencies;
#[cfg(feature = "serde")]
use super::HierarchyParts;

/// A forest of vertices for view-dependent refinement: immutable, shared by all instances.
///
/// Vertices have new numbers ([`Origins`](crate::lod::Origins)). Leaves (vertices of the input) come first, and all
/// leaves represented by a vertex are consecutive. New vertices follow.
///
/// serde uses [`HierarchyParts`], and validates ([`VertexHierarchy::validate`]).
///
/// ```
/// use multires::view::{View, look_at};
/// use multires::{Lod, LodOptions, Structure, hierarchy::VertexHierarchy, mesh::shapes};
///
/// let mesh = shapes::rock(2_000, 1);
/// let model = VertexHierarchy::bake(&mesh)?;
/// let mut lod = model.instance(model.arrange(mesh.positions())?, &LodOptions::default())?;
/// let camera = look_at([0.0, 0.5, 3.0], [0.0; 3], [0.0, 1.0, 0.0]);
/// let change = lod.adapt(&[View::perspective(camera, 1.0, [1920, 1080])?.of_world()], 1.0 / 60.0);
/// assert!(change.triangles <= model.structure().triangle_count());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "HierarchyParts"))]
pub struct VertexHierarchy {
    /// Per vertex, the vertex taking its place, or itself.
    pub(super) substitute: Array<u32>,
    /// Per vertex, the split bringing it back; `NONE` if it is never removed.
    pub(super) split_of: Array<u32>,
    /// Per new vertex, the first leaf represented by it.
    pub(super) first_leaf: Array<u32>,
    pub(super) leaves: u32,
    /// Per split, the vertices brought back, in the order of the collapse.
    pub(super) brings: Lists,
    pub(super) parents: Lists,
    pub(super) children: Lists,
    pub(super) dependencies: Lists,
    pub(super) dependency_kind: Dependencies,
    pub(super) bounds: Array<Bounds>,
    pub(super) roots: Array<u32>,
    /// Corners at full resolution, as leaves. First the triangles never removed, then the others by split.
    pub(super) triangles: Array<[u32; 3]>,
    /// Per split, its first triangle; with one more entry than splits.
    pub(super) first_triangle: Array<u32>,
    /// Per triangle, an index into `materials`; empty with at most one material.
    pub(super) group_of: Array<u16>,
    /// Material ids in use, ascending.
    pub(super) materials: Array<u32>,
    pub(super) diagonal: f64,
    /// Per vertex, a vertex far above it; empty if all chains are short.
    pub(super) jump: Array<u32>,
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
        self.dependency_kind
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
    pub(crate) fn group_of(&self, triangle: u32) -> usize {
        self.group_of.get(triangle as usize).map_or(0, |&group| group as usize)
    }

    /// Returns the triangles brought back by a split.
    #[inline]
    pub(crate) fn owned(&self, split: u32) -> std::ops::Range<u32> {
        self.first_triangle[split as usize]..self.first_triangle[split as usize + 1]
    }

    /// Returns the vertex representing a leaf, for the closed set of splits given by `there`. O(hops), and O(log n) if
    /// chains are long.
    #[inline]
    pub(crate) fn active(&self, leaf: u32, there: impl Fn(u32) -> bool) -> u32 {
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
            + self.dependencies.memory()
            + size_of_val(&self.bounds[..])
            + size_of_val(&self.roots[..])
            + size_of_val(&self.first_triangle[..])
            + size_of_val(&self.group_of[..])
            + size_of_val(&self.materials[..])
            + size_of_val(&self.jump[..])
    }

    /// Returns the first leaf represented by a vertex at its coarsest.
    #[inline]
    pub(crate) fn first_leaf(&self, vertex: u32) -> u32 {
        if vertex < self.leaves { vertex } else { self.first_leaf[(vertex - self.leaves) as usize] }
    }

    /// Returns the vertices brought by a split, in the order of the collapse.
    #[cfg(feature = "stream")]
    pub(crate) fn brings(&self, split: u32) -> &[u32] {
        self.brings.get(split)
    }

    /// Returns the vertex that takes a vertex's place, or the vertex itself if it is never removed.
    #[cfg(feature = "stream")]
    pub(crate) fn substitute(&self, vertex: u32) -> u32 {
        self.substitute[vertex as usize]
    }

    /// Returns the split that brings a vertex; `NONE` if it is never removed.
    #[cfg(feature = "stream")]
    pub(crate) fn split_of(&self, vertex: u32) -> u32 {
        self.split_of[vertex as usize]
    }

    pub(crate) fn has_dependencies(&self) -> bool {
        !self.dependencies.items.is_empty()
    }

    pub(super) fn is_root(&self, vertex: u32) -> bool {
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
        // A split that is not there changes nothing.
        self.bounds.get(split as usize).copied().unwrap_or(bytemuck::Zeroable::zeroed())
    }

    #[inline]
    fn error(&self, split: u32) -> f32 {
        self.bounds.get(split as usize).map_or(0.0, |bounds| bounds.error)
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
        self.dependencies.get(split).iter().copied()
    }
}
