//! Self-intersections of a surface.

use glam::DVec3;

use crate::geometry::{bvh::Bvh, crossing::triangles_cross, parallel::map_chunks};
use crate::mesh::Mesh;

/// Counts the pairs of crossing triangles of a mesh.
///
/// Two triangles cross if a side of either passes through the other, from one side of its plane to the other. Not
/// counted: pairs sharing the position of a corner (neighbours touch, and folding is another question), triangles only
/// touching or overlapping in a plane, and triangles without area. Coincident triangles count as a single triangle. O(n
/// log n) expected, plus the pairs whose boxes meet.
///
/// ```
/// use multires::{mesh::shapes, quality::self_intersections};
/// assert_eq!(self_intersections(&shapes::shell(2, 0.9)), 0);
/// // Corners of the inner sphere come through the flat triangles of the outer one where these are large; but not where
/// // both have the same corners up to their size.
/// assert_eq!(self_intersections(&shapes::shell(0, 0.999)), 0);
/// ```
pub fn self_intersections(mesh: &Mesh) -> u64 {
    let Some(bvh) = Bvh::new(mesh.positions(), mesh.triangles()) else { return 0 };
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
