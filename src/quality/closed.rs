//! Tests if a surface is closed and consistently oriented; names the first edge at fault otherwise.

use crate::mesh::{Mesh, Topology};

use super::QualityError;

/// Checks that each edge between two positions is traversed equally often in both directions. The error names the first
/// edge for which this fails. Sides of length 0 do not count. O(n log n).
pub(crate) fn check_closed(mesh: &Mesh, which: &'static str) -> Result<(), QualityError> {
    let topology = Topology::new(mesh);
    let mut sides: Vec<(u64, bool)> = Vec::with_capacity(3 * mesh.triangles().len());
    for triangle in mesh.triangles() {
        let [a, b, c] = triangle.map(|v| topology.point_of()[v as usize]);
        for (p, q) in [(a, b), (b, c), (c, a)] {
            if p != q {
                sides.push((u64::from(p.min(q)) << 32 | u64::from(p.max(q)), p < q));
            }
        }
    }
    sides.sort_unstable();
    let balanced = |edge: &&[(u64, bool)]| edge.iter().filter(|side| side.1).count() * 2 == edge.len();
    let Some(fault) = sides.chunk_by(|a, b| a.0 == b.0).find(|edge| !balanced(edge)) else { return Ok(()) };
    let ends = [(fault[0].0 >> 32) as usize, (fault[0].0 & u64::from(u32::MAX)) as usize];
    let edge = ends.map(|point| topology.vertex_of_point()[point]);
    Err(if fault.len() % 2 == 1 {
        QualityError::Open { which, edge, triangles: fault.len() }
    } else {
        QualityError::Orientation { which, edge }
    })
}
