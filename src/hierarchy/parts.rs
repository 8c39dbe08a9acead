//! Plain arrays of a vertex hierarchy, in and out. Arrays derivable from others are left out.

use crate::geometry::lists::Lists;
use crate::mesh::NONE;
use crate::view::Bounds;

use super::{Dependencies, HierarchyError, VertexHierarchy};

/// The arrays of a [`VertexHierarchy`], for custom file formats.
///
/// A list per split is stored as two arrays: the entries of split `s` are `items[start[s]..start[s + 1]]`, so `start` has
/// one entry more than there are splits. Splits are numbered from coarse to fine, each after its parents.
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct HierarchyParts {
    /// Per vertex, the vertex taking its place, or itself if it is never removed. Leaves come first.
    pub substitute: Vec<u32>,
    /// Per vertex except leaves, the first leaf represented by it.
    pub first_leaf: Vec<u32>,
    /// Starts of `brings`.
    pub brings_start: Vec<u32>,
    /// Per split, the vertices brought back, in the order of the collapse.
    pub brings: Vec<u32>,
    /// Starts of `dependencies`.
    pub dependencies_start: Vec<u32>,
    /// Per split, the splits besides its parents which must be in the mesh before it.
    pub dependencies: Vec<u32>,
    /// Rule by which `dependencies` were chosen.
    pub dependency_kind: Dependencies,
    /// Per split, bounds of the changes made by it and all its descendants.
    pub bounds: Vec<Bounds>,
    /// Corners at full resolution, as leaves. First the triangles never removed, then the others by the split bringing
    /// them back.
    pub triangles: Vec<[u32; 3]>,
    /// Per split, the first triangle brought back; with one more entry than splits.
    pub first_triangle: Vec<u32>,
    /// Per triangle, an index into `materials`; empty if `materials` has fewer than two entries.
    pub group_of: Vec<u16>,
    /// Material ids in use, ascending.
    pub materials: Vec<u32>,
    /// Diagonal of the input's box, object units.
    pub diagonal: f64,
}

impl From<VertexHierarchy> for HierarchyParts {
    fn from(hierarchy: VertexHierarchy) -> Self {
        let VertexHierarchy { substitute, first_leaf, brings, dependencies, dependency_kind, .. } = hierarchy;
        Self {
            substitute,
            first_leaf,
            brings_start: brings.start,
            brings: brings.items,
            dependencies_start: dependencies.start,
            dependencies: dependencies.items,
            dependency_kind,
            bounds: hierarchy.bounds,
            triangles: hierarchy.triangles,
            first_triangle: hierarchy.first_triangle,
            group_of: hierarchy.group_of,
            materials: hierarchy.materials,
            diagonal: hierarchy.diagonal,
        }
    }
}

impl TryFrom<HierarchyParts> for VertexHierarchy {
    type Error = HierarchyError;

    /// Validates as [`VertexHierarchy::validate`] does, and is no slower.
    fn try_from(parts: HierarchyParts) -> Result<Self, HierarchyError> {
        let (vertices, made) = (parts.substitute.len(), parts.first_leaf.len());
        let leaves = vertices.checked_sub(made).ok_or(HierarchyError::Length {
            what: "first leaves of new vertices",
            found: made,
            expected: vertices,
        })?;
        let mut hierarchy = Self {
            substitute: parts.substitute,
            split_of: Vec::new(),
            first_leaf: parts.first_leaf,
            leaves: leaves.min(NONE as usize) as u32,
            brings: Lists { start: parts.brings_start, items: parts.brings },
            parents: Lists::default(),
            children: Lists::default(),
            dependencies: Lists { start: parts.dependencies_start, items: parts.dependencies },
            dependency_kind: parts.dependency_kind,
            bounds: parts.bounds,
            roots: Vec::new(),
            triangles: parts.triangles,
            first_triangle: parts.first_triangle,
            group_of: parts.group_of,
            materials: parts.materials,
            diagonal: parts.diagonal,
            jump: Vec::new(),
        };
        hierarchy.check_arrays()?;
        let Derived { split_of, parents, children, roots } = hierarchy.derived();
        (hierarchy.split_of, hierarchy.parents) = (split_of, parents);
        (hierarchy.children, hierarchy.roots) = (children, roots);
        hierarchy.check_promises()?;
        hierarchy.jump = hierarchy.jumps();
        Ok(hierarchy)
    }
}

/// Arrays derived from the parts.
pub(super) struct Derived {
    pub split_of: Vec<u32>,
    pub parents: Lists,
    pub children: Lists,
    pub roots: Vec<u32>,
}

/// Chains up to this length are walked hop by hop.
const SHORT: u32 = 1024;

impl VertexHierarchy {
    /// Derives the remaining arrays. Every index must be in range; nothing else is assumed. O(n log n).
    pub(super) fn derived(&self) -> Derived {
        let count = self.bounds.len();
        let mut split_of = vec![NONE; self.substitute.len()];
        // A collapse is undone after the next collapse touching any of its vertices.
        let mut last = vec![NONE; self.substitute.len()];
        let mut edges: Vec<[u32; 2]> = Vec::with_capacity(2 * count);
        for split in (0..count as u32).rev() {
            for &vertex in self.brings.get(split) {
                split_of[vertex as usize] = split;
                for touched in [vertex, self.substitute[vertex as usize]] {
                    let before = std::mem::replace(&mut last[touched as usize], split);
                    if before != NONE && before != split {
                        edges.push([before, split]);
                    }
                }
            }
        }
        edges.sort_unstable();
        edges.dedup();
        let parents = Lists::from_pairs(count, edges.iter().map(|&[child, parent]| (child, parent)));
        let children = Lists::from_pairs(count, edges.iter().map(|&[child, parent]| (parent, child)));
        let roots = (0..count as u32).filter(|&split| parents.get(split).is_empty()).collect();
        Derived { split_of, parents, children, roots }
    }

    /// Returns, per vertex, a vertex far above it (Myers 1983), so representatives are found in O(log n) hops. Empty if
    /// all chains are short. Substitutes must form a forest. O(n).
    pub(super) fn jumps(&self) -> Vec<u32> {
        let count = self.substitute.len();
        let mut depth = vec![0_u32; count];
        let mut jump: Vec<u32> = (0..count as u32).collect();
        for split in 0..self.bounds.len() as u32 {
            for &vertex in self.brings.get(split).iter().rev() {
                let above = self.substitute[vertex as usize];
                let near = jump[above as usize];
                let far = jump[near as usize];
                let at = |v: u32| depth[v as usize];
                let even = at(above) - at(near) == at(near) - at(far);
                jump[vertex as usize] = if even { far } else { above };
                depth[vertex as usize] = at(above) + 1;
            }
        }
        if depth.iter().all(|&depth| depth <= SHORT) { Vec::new() } else { jump }
    }
}

/// Serializes the members of [`HierarchyParts`], in the same order, without copying them.
#[cfg(feature = "serde")]
impl serde::Serialize for VertexHierarchy {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(serde::Serialize)]
        #[serde(rename = "HierarchyParts")]
        struct Borrowed<'a> {
            substitute: &'a [u32],
            first_leaf: &'a [u32],
            brings_start: &'a [u32],
            brings: &'a [u32],
            dependencies_start: &'a [u32],
            dependencies: &'a [u32],
            dependency_kind: Dependencies,
            bounds: &'a [Bounds],
            triangles: &'a [[u32; 3]],
            first_triangle: &'a [u32],
            group_of: &'a [u16],
            materials: &'a [u32],
            diagonal: f64,
        }
        let parts = Borrowed {
            substitute: &self.substitute,
            first_leaf: &self.first_leaf,
            brings_start: &self.brings.start,
            brings: &self.brings.items,
            dependencies_start: &self.dependencies.start,
            dependencies: &self.dependencies.items,
            dependency_kind: self.dependency_kind,
            bounds: &self.bounds,
            triangles: &self.triangles,
            first_triangle: &self.first_triangle,
            group_of: &self.group_of,
            materials: &self.materials,
            diagonal: self.diagonal,
        };
        parts.serialize(serializer)
    }
}
