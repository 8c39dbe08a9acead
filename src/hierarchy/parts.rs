//! The plain arrays that a vertex hierarchy is made of, in and out. What follows from others is not among them.

use crate::mesh::NONE;
use crate::view::Bounds;

use super::{Dependencies, HierarchyError, Lists, VertexHierarchy};

/// The arrays of a [`VertexHierarchy`], for file formats of your own.
///
/// A list per split is two arrays: the entries of split `s` are `items[start[s]..start[s + 1]]`, so `start` has one entry
/// more than there are splits. Splits are numbered from coarse to fine, each after its parents.
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct HierarchyParts {
    /// Per vertex the one that takes its place, or itself where it is never gone. Leaves come first.
    pub substitute: Vec<u32>,
    /// Per vertex that is no leaf, the first leaf that it stands for.
    pub first_leaf: Vec<u32>,
    /// Starts of `brings`.
    pub brings_start: Vec<u32>,
    /// Per split the vertices that it brings back, in the order in which its collapse took them.
    pub brings: Vec<u32>,
    /// Starts of `needs`.
    pub needs_start: Vec<u32>,
    /// Per split those that must be in the mesh before it, besides its parents.
    pub needs: Vec<u32>,
    /// By which rule `needs` were chosen.
    pub dependencies: Dependencies,
    /// Per split what it and all that is nested in it can change.
    pub bounds: Vec<Bounds>,
    /// Corners at full resolution, as leaves: triangles that are never gone first, then by the split that brings them back.
    pub triangles: Vec<[u32; 3]>,
    /// Per split the first triangle that it brings back; one more than splits.
    pub first_triangle: Vec<u32>,
    /// Per triangle an index into `materials`; empty where that has fewer than two entries.
    pub group_of: Vec<u16>,
    /// The material ids in use, ascending.
    pub materials: Vec<u32>,
    /// Diagonal of the input's box, object units.
    pub diagonal: f64,
}

impl From<VertexHierarchy> for HierarchyParts {
    fn from(hierarchy: VertexHierarchy) -> Self {
        let VertexHierarchy { substitute, first_leaf, brings, needs, dependencies, .. } = hierarchy;
        Self {
            substitute,
            first_leaf,
            brings_start: brings.start,
            brings: brings.items,
            needs_start: needs.start,
            needs: needs.items,
            dependencies,
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

    /// As [`VertexHierarchy::validate`], and no slower.
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
            needs: Lists { start: parts.needs_start, items: parts.needs },
            dependencies: parts.dependencies,
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

/// What follows from the parts.
pub(super) struct Derived {
    pub split_of: Vec<u32>,
    pub parents: Lists,
    pub children: Lists,
    pub roots: Vec<u32>,
}

/// Chains up to this long are walked hop by hop.
const SHORT: u32 = 1024;

impl VertexHierarchy {
    /// Every index must be in range; nothing else is relied on. O(n log n).
    pub(super) fn derived(&self) -> Derived {
        let count = self.bounds.len();
        let mut split_of = vec![NONE; self.substitute.len()];
        // A collapse is undone after the next one that touches a vertex that it touched.
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

    /// Per vertex one far above it (Myers 1983), so that who stands for it is found in O(log n) hops; none where all chains
    /// are short. Substitutes must form a forest. O(n).
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

/// The same members in the same order as [`HierarchyParts`], without a copy of them.
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
            needs_start: &'a [u32],
            needs: &'a [u32],
            dependencies: Dependencies,
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
            needs_start: &self.needs.start,
            needs: &self.needs.items,
            dependencies: self.dependencies,
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
