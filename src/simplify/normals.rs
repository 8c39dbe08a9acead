//! What becomes of normals: they stay with their seams, are computed anew from each level's triangles, or go.
//!
//! ```text
//!     every face its own normals        every edge is a seam, so nothing can be merged
//!     the same without normals          one vertex a point: a surface like any other
//!     its levels, with creases          every face its own normals again
//! ```

use crate::mesh::{Creases, Mesh, names};

use super::OptionError;

/// Normals are hard everywhere where they alone hold more than this share of the points.
const HARD_SHARE: f64 = 0.2;
/// A crease angle explains normals where it gives so many corners theirs.
const EXPLAINED_SHARE: f64 = 0.99;

/// What becomes of normals.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[non_exhaustive]
pub enum Normals {
    /// As [`Normals::Recompute`] where hard edges are everywhere and would hold the mesh: where normals alone make three or
    /// more seams meet at over a fifth of the points, and a crease angle explains the normals of 99 % of the corners to
    /// within five degrees. As [`Normals::Keep`] everywhere else, where there are tangents, and where no target
    /// is asked for: all levels down to the base mesh are what structures are built from, whose vertices are fixed.
    #[default]
    Automatic,
    /// They are carried along, and edges across which they change are seams.
    Keep,
    /// They make no seams, and [`CollapseSequence::extract`](super::CollapseSequence::extract) computes them anew from the
    /// level's triangles.
    ///
    /// Structures whose vertices are fixed (totally ordered meshes, hierarchies, progressive meshes) have one vertex for all
    /// normals of a point then, with those of the lowest: give them normals of your own, or shade by face.
    Recompute {
        /// Edges that turn by more are creases, degrees, 0 to 180. None: the angle that explains the input's normals best.
        crease_angle: Option<f32>,
    },
    /// They make no seams, and levels have none; nor tangents.
    Drop,
}

/// What became of normals.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum NormalsDone {
    /// They were carried along, if there were any.
    #[default]
    Kept,
    /// Levels have normals of their own triangles.
    Recomputed(Creases),
    /// Levels have none.
    Dropped,
}

impl Normals {
    /// What is to be done with the normals of a mesh. O(n log n).
    ///
    /// # Errors
    /// A crease angle that is not 0 to 180 degrees.
    pub fn resolve(self, mesh: &Mesh) -> Result<NormalsDone, OptionError> {
        if let Self::Recompute { crease_angle: Some(angle) } = self {
            if !(0.0..=180.0).contains(&angle) {
                let (option, value) = ("crease angle", f64::from(angle));
                return Err(OptionError::OutOfRange { option, value, expected: "0 to 180" });
            }
        }
        let has_normals =
            mesh.attribute(names::NORMAL).is_some_and(|n| n.width() == 3 && n.as_floats().is_some());
        if !has_normals {
            return Ok(NormalsDone::Kept);
        }
        Ok(match self {
            Self::Keep => NormalsDone::Kept,
            Self::Drop => NormalsDone::Dropped,
            Self::Recompute { crease_angle: Some(angle) } => {
                NormalsDone::Recomputed(Creases::with_angle(mesh, angle))
            }
            Self::Recompute { crease_angle: None } => match Creases::fitted(mesh) {
                Some((creases, _)) => NormalsDone::Recomputed(creases),
                None => NormalsDone::Kept,
            },
            Self::Automatic => match explained(mesh) {
                Some(creases) => NormalsDone::Recomputed(creases),
                None => NormalsDone::Kept,
            },
        })
    }
}

impl NormalsDone {
    /// The mesh as its edges are looked at: without normals that make no seams. None where that is the mesh itself.
    pub(super) fn bare(&self, mesh: &Mesh) -> Option<Mesh> {
        match self {
            Self::Kept => None,
            Self::Recomputed(_) => Some(mesh.without_attribute(names::NORMAL)),
            Self::Dropped => Some(mesh.without_normals()),
        }
    }

    /// A level with the normals that it is to have.
    pub(super) fn finish(&self, level: Mesh) -> Mesh {
        match self {
            Self::Kept => level,
            Self::Recomputed(creases) => level.with_crease_normals(creases),
            Self::Dropped => level.without_normals(),
        }
    }

    /// Whether a file may say so.
    pub(super) fn is_valid(&self) -> bool {
        match self {
            Self::Recomputed(creases) => (0.0..=180.0).contains(&creases.angle),
            _ => true,
        }
    }
}

/// The creases of a mesh that is nothing but creases.
fn explained(mesh: &Mesh) -> Option<Creases> {
    // Points with three seams have three vertices, and a surface has about half as many points as triangles: a fifth of
    // them takes seven vertices for ten triangles.
    let few = mesh.positions().len() * 10 < mesh.triangles().len() * 7;
    if few || mesh.attribute(names::TANGENT).is_some() || Creases::hard_share(mesh) <= HARD_SHARE {
        return None;
    }
    let (creases, share) = Creases::fitted(mesh)?;
    (share >= EXPLAINED_SHARE).then_some(creases)
}
