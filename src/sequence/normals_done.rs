//! What a simplification did with normals, and how its levels get theirs.

use crate::mesh::{Creases, Mesh, names};

/// Treatment that normals received.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum NormalsDone {
    /// Normals were kept, if there were any.
    #[default]
    Kept,
    /// Levels have normals recomputed from their own triangles.
    Recomputed(Creases),
    /// Levels have no normals.
    Dropped,
}

impl NormalsDone {
    /// Returns the mesh without normals that make no seams; `None` if it is the mesh itself.
    pub(crate) fn bare(&self, mesh: &Mesh) -> Option<Mesh> {
        match self {
            Self::Kept => None,
            Self::Recomputed(_) => Some(mesh.without_attribute(names::NORMAL)),
            Self::Dropped => Some(mesh.without_normals()),
        }
    }

    /// Gives a level its final normals.
    pub(super) fn finish(&self, level: Mesh) -> Mesh {
        match self {
            Self::Kept => level,
            Self::Recomputed(creases) => level.with_crease_normals(creases),
            Self::Dropped => level.without_normals(),
        }
    }

    /// Whether the values are in range, as read from a file.
    pub(super) fn is_valid(&self) -> bool {
        match self {
            Self::Recomputed(creases) => (0.0..=180.0).contains(&creases.angle),
            _ => true,
        }
    }
}
