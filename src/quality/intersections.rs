//! How often a surface crosses itself.

use glam::DVec3;

use crate::mesh::{Mesh, crossing::triangles_cross};

use super::bvh::Bvh;
use super::map_chunks;

/// The number of pairs of triangles of a mesh that cross.
///
/// Two triangles cross where a side of one passes through the other, from one side of its plane to the other. Pairs that share
/// a corner's position are left out: neighbours touch, and whether they fold over is another question. So are triangles that
/// only touch, or overlap in one plane, and triangles without area. Coincident triangles count as one. O(n log n) expected, and
/// the pairs whose boxes meet.
///
/// ```
/// use multires::{mesh::shapes, quality::self_intersections};
/// assert_eq!(self_intersections(&shapes::shell(2, 0.9)), 0);
/// // Corners of the inner sphere come through the flat triangles of the outer one where these are large; but not where
/// // both have the same corners up to their size.
/// assert_eq!(self_intersections(&shapes::shell(0, 0.999)), 0);
/// ```
pub fn self_intersections(mesh: &Mesh) -> u64 {
    let Some(bvh) = Bvh::new(mesh) else { return 0 };
    let counts = map_chunks(bvh.len(), 256, |slots| {
        let mut walker = bvh.walker();
        let mut count = 0;
        for slot in slots {
            let corners = bvh.corners(slot as u32);
            walker.overlapping(slot as u32, |other| {
                let others = bvh.corners(other);
                let share = corners.iter().any(|p: &DVec3| others.contains(p));
                count += u64::from(!share && triangles_cross(&corners, &others));
            });
        }
        count
    });
    counts.into_iter().sum()
}
