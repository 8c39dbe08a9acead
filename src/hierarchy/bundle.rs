//! A vertex hierarchy together with its vertices: a mesh that can be refined by view, in one value, as baked to a file.
//!
//! Positions, attributes and locks lie in the hierarchy's order, triangles and materials in the hierarchy alone, so nothing
//! is stored twice. Duplicates and vertices that no triangle uses are left out. So the full
//! resolution is the input up to the tolerances of the simplification: a vertex is drawn in place of those folded into it,
//! and where it was snapped to.

use std::sync::Arc;

use crate::adapt::LevelOfDetail;
use crate::mesh::{Mesh, NONE};
use crate::simplify::CollapseSequence;

use super::{Dependencies, HierarchyError, HierarchyLod, VertexHierarchy};

/// A [`VertexHierarchy`] and its vertices, new ones included. Immutable; made by [`HierarchyMesh::new`],
/// [`HierarchyBuilder`](super::HierarchyBuilder), and by serde, which validates.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "Parts"))]
pub struct HierarchyMesh {
    mesh: Mesh,
    #[cfg_attr(feature = "serde", serde(serialize_with = "shared"))]
    hierarchy: Arc<VertexHierarchy>,
}

impl HierarchyMesh {
    /// The kind that this is baked as.
    pub const KIND: &'static str = "hierarchy";

    /// The hierarchy of a simplification of a mesh, with any placement. Attributes of new vertices are blended as their
    /// collapses say. O(n log n), and O(n x neighbours) more with dependencies.
    ///
    /// # Errors
    /// As [`VertexHierarchy::build`].
    pub fn new(
        mesh: &Mesh,
        sequence: &CollapseSequence,
        dependencies: Dependencies,
    ) -> Result<Self, HierarchyError> {
        let built = VertexHierarchy::build(mesh, sequence, dependencies)?;
        let vertices = sequence.assemble(mesh, &built.vertex_order, Vec::new(), Vec::new());
        Ok(Self { mesh: vertices, hierarchy: Arc::new(built.hierarchy) })
    }

    /// The vertices in the hierarchy's order: positions, attributes, locks, and the names of materials. What an instance
    /// with static vertices uploads once. Has no triangles; those are the hierarchy's.
    pub fn vertices(&self) -> &Mesh {
        &self.mesh
    }

    /// The structure, shared with all instances ([`HierarchyLod`]).
    pub fn hierarchy(&self) -> &Arc<VertexHierarchy> {
        &self.hierarchy
    }

    /// Smallest and largest corner of the box around the full resolution; `None` without triangles. O(triangles).
    pub fn bounds(&self) -> Option<[[f32; 3]; 2]> {
        let mut all = self.hierarchy.triangles().as_flattened().iter();
        let position = |&leaf: &u32| self.mesh.positions()[leaf as usize];
        let first = all.next().map(position)?;
        Some(all.map(position).fold([first; 2], |[low, high], p| {
            [std::array::from_fn(|i| low[i].min(p[i])), std::array::from_fn(|i| high[i].max(p[i]))]
        }))
    }

    /// What an instance draws as a mesh of its own: the vertices that it uses, with attributes and locks, and its triangles
    /// with their materials, in the hierarchy's order: the same mesh for the same cut. Of an instance of another hierarchy,
    /// an empty mesh. O(vertices + output log output).
    pub fn mesh_at(&self, lod: &HierarchyLod) -> Mesh {
        if !Arc::ptr_eq(&self.hierarchy, lod.hierarchy()) && self.hierarchy != *lod.hierarchy() {
            return Mesh::default();
        }
        let vertex = |name: u32| lod.vertices().map_or(name, |slots| slots[name as usize]);
        let mut drawn: Vec<(u32, [u32; 3])> = Vec::new();
        for group in 0..lod.groups() {
            let corners = lod.triangles(group).iter().map(|t| t.map(vertex));
            drawn.extend(lod.surface().drawn(group).iter().copied().zip(corners));
        }
        drawn.sort_unstable();
        let mut number = vec![NONE; self.hierarchy.vertex_count()];
        drawn.iter().for_each(|(_, t)| t.iter().for_each(|&v| number[v as usize] = 0));
        let used: Vec<u32> = (0..number.len() as u32).filter(|&v| number[v as usize] == 0).collect();
        for (new, &old) in used.iter().enumerate() {
            number[old as usize] = new as u32;
        }
        let ids = self.hierarchy.materials();
        let material = |&(t, _): &(u32, [u32; 3])| ids[self.hierarchy.group_of(t)];
        let materials = if ids.is_empty() { Vec::new() } else { drawn.iter().map(material).collect() };
        let triangles = drawn.iter().map(|(_, t)| t.map(|v| number[v as usize])).collect();
        self.mesh.gather(&used, triangles, materials)
    }

    /// Bytes of the structure and all its vertices; instances not counted.
    pub fn memory(&self) -> usize {
        self.mesh.memory() + self.hierarchy.memory()
    }

    /// Bytes of the full resolution as a plain indexed mesh, to compare [`HierarchyMesh::memory`] with.
    pub fn plain_memory(&self) -> usize {
        let attributes: usize = self.mesh.attributes().iter().map(|a| size_of::<f32>() * a.width()).sum();
        let lock = usize::from(!self.mesh.locks().is_empty());
        let material = if self.hierarchy.materials().is_empty() { 0 } else { size_of::<u32>() };
        (size_of::<[f32; 3]>() + attributes + lock) * self.hierarchy.leaf_count()
            + (size_of::<[u32; 3]>() + material) * self.hierarchy.triangle_count()
    }
}

#[cfg(feature = "serde")]
fn shared<S: serde::Serializer>(hierarchy: &Arc<VertexHierarchy>, serializer: S) -> Result<S::Ok, S::Error> {
    serde::Serialize::serialize(&**hierarchy, serializer)
}

/// What comes out of a file, each valid by itself.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
struct Parts {
    mesh: Mesh,
    hierarchy: VertexHierarchy,
}

#[cfg(feature = "serde")]
impl TryFrom<Parts> for HierarchyMesh {
    type Error = HierarchyError;

    fn try_from(Parts { mesh, hierarchy }: Parts) -> Result<Self, HierarchyError> {
        let fits = |what, found, expected| {
            if found == expected { Ok(()) } else { Err(HierarchyError::Length { what, found, expected }) }
        };
        fits("vertices", mesh.positions().len(), hierarchy.vertex_count())?;
        fits("triangles beside the hierarchy's", mesh.triangles().len(), 0)?;
        Ok(Self { mesh, hierarchy: Arc::new(hierarchy) })
    }
}
