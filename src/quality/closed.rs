//! Tests if a surface is closed and consistently oriented; names the first edge at fault otherwise.

use crate::mesh::Mesh;

use super::QualityError;

/// Checks that each edge between two positions is traversed equally often in both directions. The error names the first
/// edge for which this fails. Sides of length 0 do not count. O(n log n).
pub(crate) fn check_closed(mesh: &Mesh, which: &'static str) -> Result<(), QualityError> {
    let Some(fault) = mesh.unbalanced_edge() else { return Ok(()) };
    let (edge, triangles) = (fault.edge, fault.triangles);
    Err(if triangles % 2 == 1 {
        QualityError::Open { which, edge, triangles }
    } else {
        QualityError::Orientation { which, edge }
    })
}
