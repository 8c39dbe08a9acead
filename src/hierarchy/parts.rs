//! Plain arrays of a vertex hierarchy, in and out. Arrays derivable from others are left out.

use crate::geometry::array::Array;
use crate::geometry::lists::Lists;
use crate::mesh::NONE;
use crate::view::Bounds;

use super::validate::check_owners;
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
        let VertexHierarchy { substitute, first_leaf, brings, dependency_kind, .. } = hierarchy;
        Self {
            substitute: substitute.into_vec(),
            first_leaf: first_leaf.into_vec(),
            brings_start: brings.start.into_vec(),
            brings: brings.items.into_vec(),
            dependencies_start: hierarchy.dependencies.starts(hierarchy.bounds.len()).into_owned(),
            dependencies: hierarchy.dependencies.items.into_vec(),
            dependency_kind,
            bounds: hierarchy.bounds.into_vec(),
            triangles: hierarchy.triangles.into_vec(),
            first_triangle: hierarchy.first_triangle.into_vec(),
            group_of: hierarchy.group_of.into_vec(),
            materials: hierarchy.materials.into_vec(),
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
        // Without dependencies their starts are dropped.
        let (start, items) = (parts.dependencies_start, parts.dependencies);
        let (dropped, dependencies) = match items.is_empty() {
            true => (Some(start), Lists::default()),
            false => (None, Lists { start: start.into(), items: items.into() }),
        };
        let mut hierarchy = Self {
            substitute: parts.substitute.into(),
            split_of: Array::default(),
            first_leaf: parts.first_leaf.into(),
            leaves: leaves.min(NONE as usize) as u32,
            brings: Lists { start: parts.brings_start.into(), items: parts.brings.into() },
            parents: Lists::default(),
            children: Lists::default(),
            dependencies,
            dependency_kind: parts.dependency_kind,
            bounds: parts.bounds.into(),
            roots: Array::default(),
            triangles: parts.triangles.into(),
            first_triangle: parts.first_triangle.into(),
            group_of: parts.group_of.into(),
            materials: parts.materials.into(),
            diagonal: parts.diagonal,
            jump: Array::default(),
        };
        hierarchy.complete()?;
        if let Some(start) = dropped {
            let (found, expected) = (start.len(), hierarchy.bounds.len() + 1);
            if found != expected {
                return Err(HierarchyError::Length { what: "starts of dependencies", found, expected });
            }
            if let Some(at) = start.iter().position(|&start| start != 0) {
                return Err(HierarchyError::Broken { what: "the start of dependencies of split", at });
            }
        }
        Ok(hierarchy)
    }
}

/// Arrays derived from the parts.
pub(super) struct Derived {
    pub split_of: Vec<u32>,
    pub parents: Lists,
    pub children: Lists,
    pub roots: Vec<u32>,
    /// The first triangle that does not belong to its split.
    pub wrong: Option<u32>,
}

/// Chains up to this length are walked hop by hop.
const SHORT: u32 = 1024;

impl VertexHierarchy {
    /// Checks the arrays of [`HierarchyParts`], and derives the others. O(n).
    pub(super) fn complete(&mut self) -> Result<(), HierarchyError> {
        self.check_arrays()?;
        let Derived { split_of, parents, children, roots, wrong } = self.derived()?;
        (self.split_of, self.parents) = (split_of.into(), parents);
        (self.children, self.roots) = (children, roots.into());
        self.check_promises()?;
        check_owners(wrong)?;
        self.jump = self.jumps().into();
        Ok(())
    }

    /// Derives the remaining arrays, and checks all collapses. Every index must be in range. O(n).
    pub(super) fn derived(&self) -> Result<Derived, HierarchyError> {
        let count = self.bounds.len();
        let mut split_of = vec![NONE; self.substitute.len()];
        for split in (0..count as u32).rev() {
            self.brings.get(split).iter().for_each(|&vertex| split_of[vertex as usize] = split);
        }
        // From fine to coarse: the last list comes first.
        let (mut start, mut items) = (vec![0; count + 1], Vec::with_capacity(2 * count));
        let wrong = self.replay(&split_of, |split, below| {
            start[split as usize] = below.len() as u32;
            items.extend(below.iter().rev());
            true
        })?;
        items.reverse();
        let mut sum = 0;
        for start in &mut start {
            sum += std::mem::replace(start, sum);
        }
        let children = Lists { start: start.into(), items: items.into() };
        let parents = children.transposed(count);
        let roots = (0..count as u32).filter(|&split| parents.get(split).is_empty()).collect();
        Ok(Derived { split_of, parents, children, roots, wrong })
    }

    /// Returns, per vertex, a vertex far above it (Myers 1983), so representatives are found in O(log n) hops. Empty if
    /// all chains are short. Substitutes must form a forest. O(n).
    pub(super) fn jumps(&self) -> Vec<u32> {
        let count = self.substitute.len();
        let mut depth = vec![0_u32; count];
        let mut most = 0;
        for split in 0..self.bounds.len() as u32 {
            for &vertex in self.brings.get(split).iter().rev() {
                let own = depth[self.substitute[vertex as usize] as usize] + 1;
                depth[vertex as usize] = own;
                most = most.max(own);
            }
        }
        if most <= SHORT {
            return Vec::new();
        }
        let mut jump: Vec<u32> = (0..count as u32).collect();
        for split in 0..self.bounds.len() as u32 {
            for &vertex in self.brings.get(split).iter().rev() {
                let above = self.substitute[vertex as usize];
                let near = jump[above as usize];
                let far = jump[near as usize];
                let at = |v: u32| depth[v as usize];
                let even = at(above) - at(near) == at(near) - at(far);
                jump[vertex as usize] = if even { far } else { above };
            }
        }
        jump
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
            dependencies_start: &self.dependencies.starts(self.bounds.len()),
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
