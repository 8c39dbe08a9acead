//! A totally ordered mesh together with its vertices: all levels of detail of a mesh in one value, as baked to a file.
//!
//! Positions, attributes and locks lie in the total order, triangles and materials in the structure alone, so nothing
//! is stored twice. Duplicates and vertices that no triangle uses are left out. So the full
//! resolution is the input up to the tolerances of the simplification: a vertex is drawn in place of those folded into it,
//! and where it was snapped to.

use crate::mesh::{Mesh, NONE};
use crate::simplify::CollapseSequence;

use super::{Level, Resolution, TomError, TotallyOrderedMesh};

/// A [`TotallyOrderedMesh`] and the vertices that it orders. Immutable; made by [`TomMesh::new`], and by serde, which
/// validates.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "Parts"))]
pub struct TomMesh {
    mesh: Mesh,
    tom: TotallyOrderedMesh,
}

impl TomMesh {
    /// The kind that this is baked as.
    pub const KIND: &'static str = "tom";

    /// Orders a mesh by a simplification of it with endpoint placement. O((vertices + triangles) log vertices).
    ///
    /// # Errors
    /// As [`TotallyOrderedMesh::build`].
    pub fn new(mesh: &Mesh, sequence: &CollapseSequence) -> Result<Self, TomError> {
        let built = TotallyOrderedMesh::build(mesh, sequence)?;
        let order = &built.vertex_order[..built.tom.vertex_count()];
        Ok(Self { mesh: sequence.assemble(mesh, order, Vec::new(), Vec::new()), tom: built.tom })
    }

    /// The vertices in the total order: positions, attributes, locks, and the names of materials. Has no triangles;
    /// those are the structure's.
    pub fn vertices(&self) -> &Mesh {
        &self.mesh
    }

    /// The structure.
    pub fn tom(&self) -> &TotallyOrderedMesh {
        &self.tom
    }

    /// A level of detail as a mesh of its own: the vertices that it uses, in the total order, with attributes and
    /// locks, and its triangles with their materials. What is given is the finest resolution that does not exceed
    /// `level` ([`TotallyOrderedMesh::at`]). O(vertices + output).
    pub fn level(&self, level: Level) -> Mesh {
        self.mesh_at(self.tom.at(level))
    }

    /// A resolution of [`TomMesh::tom`] as a mesh of its own; see [`TomMesh::level`].
    pub fn mesh_at(&self, resolution: Resolution) -> Mesh {
        let mut indices = Vec::new();
        self.tom.fill_indices(resolution, &mut indices);
        let mut number = vec![NONE; self.tom.vertex_count()];
        indices.iter().for_each(|&v| number[v as usize] = 0);
        let used: Vec<u32> = (0..number.len() as u32).filter(|&v| number[v as usize] == 0).collect();
        for (new, &old) in used.iter().enumerate() {
            number[old as usize] = new as u32;
        }
        let triangles: Vec<[u32; 3]> =
            indices.chunks_exact(3).map(|c| [c[0], c[1], c[2]].map(|v| number[v as usize])).collect();
        let materials = match self.tom.material_ids[..] {
            [] => Vec::new(),
            [one] => vec![one; triangles.len()],
            ref ids => self.tom.material_of[..triangles.len()].iter().map(|&m| ids[m as usize]).collect(),
        };
        self.mesh.gather(&used, triangles, materials)
    }

    /// Bytes of all levels of detail together: vertices and structure.
    pub fn memory(&self) -> usize {
        self.mesh.memory() + self.tom.memory(0)
    }

    /// Bytes of the full resolution as a plain indexed mesh, to compare [`TomMesh::memory`] with.
    pub fn plain_memory(&self) -> usize {
        let material = if self.tom.material_ids.is_empty() { 0 } else { size_of::<u32>() };
        self.mesh.memory() + (size_of::<[u32; 3]>() + material) * self.tom.triangle_count()
    }
}

/// What comes out of a file, each valid by itself.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
struct Parts {
    mesh: Mesh,
    tom: TotallyOrderedMesh,
}

#[cfg(feature = "serde")]
impl TryFrom<Parts> for TomMesh {
    type Error = TomError;

    fn try_from(Parts { mesh, tom }: Parts) -> Result<Self, TomError> {
        let fits = |what, found, expected| {
            if found == expected { Ok(()) } else { Err(TomError::Length { what, found, expected }) }
        };
        fits("vertices", mesh.positions().len(), tom.vertex_count())?;
        fits("triangles beside the ordered ones", mesh.triangles().len(), 0)?;
        Ok(Self { mesh, tom })
    }
}
