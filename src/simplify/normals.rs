//! Treatment of normals: kept with their seams, recomputed from each level's triangles, or dropped.
//!
//! ```text
//!     every face its own normals        every edge is a seam, so nothing can be merged
//!     the same without normals          one vertex a point: a surface like any other
//!     its levels, with creases          every face its own normals again
//! ```

use crate::mesh::{Creases, Mesh, names};
use crate::sequence::NormalsDone;

use super::OptionError;

/// Least share of points held by normals alone for [`Normals::Automatic`] to recompute.
const HARD_SHARE: f64 = 0.2;
/// Least share of corners whose normals a crease angle must explain.
const EXPLAINED_SHARE: f64 = 0.99;

/// Treatment of normals in a simplification.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[non_exhaustive]
pub enum Normals {
    /// Recomputes normals if hard edges everywhere would hold the mesh, otherwise keeps them. Acts as
    /// [`Normals::Recompute`] if normals alone make three or more seams meet at over a fifth of the points, and a crease
    /// angle explains the normals of 99 % of the corners to within five degrees. Acts as [`Normals::Keep`] in all other
    /// cases, with tangents, with normals among the chosen attributes, and without a target: all levels down to the base
    /// mesh are needed for structures with fixed vertices.
    #[default]
    Automatic,
    /// Keeps normals. Edges across which normals change are seams.
    Keep,
    /// Normals make no seams. [`CollapseSequence::extract`](super::CollapseSequence::extract) recomputes them from the
    /// level's triangles.
    ///
    /// Structures with fixed vertices (totally ordered meshes, hierarchies, progressive meshes) then have a single vertex
    /// for all normals of a point, with the normal of the lowest vertex: give them your own normals, or shade by face.
    Recompute {
        /// Edges with a larger angle between normals are creases, degrees, 0 to 180. `None`: the angle that explains the
        /// input's normals best.
        crease_angle: Option<f32>,
    },
    /// Normals make no seams, and levels have neither normals nor tangents.
    Drop,
}

impl Normals {
    /// Decides the treatment of a mesh's normals. O(n log n).
    ///
    /// # Errors
    /// A crease angle outside 0 to 180 degrees.
    pub fn resolve(self, mesh: &Mesh) -> Result<NormalsDone, OptionError> {
        if let Self::Recompute { crease_angle: Some(angle) } = self
            && !(0.0..=180.0).contains(&angle)
        {
            let (option, value) = ("crease angle", f64::from(angle));
            return Err(OptionError::OutOfRange { option, value, expected: "0 to 180" });
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

/// Returns the creases of a mesh whose normals are hard everywhere.
fn explained(mesh: &Mesh) -> Option<Creases> {
    // Points with three seams have three vertices, and a surface has about half as many points as triangles: with a fifth
    // of such points there are 7 vertices for 10 triangles.
    let few = mesh.positions().len() * 10 < mesh.triangles().len() * 7;
    if few || mesh.attribute(names::TANGENT).is_some() || Creases::hard_share(mesh) <= HARD_SHARE {
        return None;
    }
    let (creases, share) = Creases::fitted(mesh)?;
    (share >= EXPLAINED_SHARE).then_some(creases)
}
