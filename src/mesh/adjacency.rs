//! The corners around every point, in flat arrays.
//!
//! ```text
//!     corner 3t + k      corner k of triangle t
//!     start    0     2        5  6           corners of point p: corners[start[p]..start[p + 1]]
//!     corners  0 7 | 1 3 8 | 2 | ...         ascending, so triangles come in order
//! ```
//!
//! Built by counting, prefix sum and filling. The caller numbers the points: stored vertices, or the welded points of
//! [`Topology`](super::Topology).

use crate::geometry::lists::prefix_sum;

use super::MAX_ELEMENTS;

/// The corners around every point. 4 bytes a point and 12 a triangle.
///
/// ```
/// use multires::mesh::{Adjacency, shapes};
///
/// let mesh = shapes::tetrahedron();
/// let adjacency = Adjacency::new(mesh.triangles(), mesh.positions().len());
/// assert!((0..4).all(|point| adjacency.valence(point) == 3));
/// ```
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Adjacency {
    /// Start of every point's corners; `points + 1` entries.
    start: Vec<u32>,
    corners: Vec<u32>,
}

impl Adjacency {
    /// Collects the corners around each of `point_count` points, given the three points of every triangle. O(n).
    ///
    /// A triangle naming a point twice appears twice around it. Leaves out corners whose point is not below
    /// `point_count`, and everything beyond [`MAX_ELEMENTS`] triangles or points, which no [`Mesh`](super::Mesh) has.
    pub fn new(corner_points: &[[u32; 3]], point_count: usize) -> Self {
        let corner_points = &corner_points[..corner_points.len().min(MAX_ELEMENTS)];
        let point_count = point_count.min(MAX_ELEMENTS);
        let points = corner_points.as_flattened();

        let mut start = vec![0_u32; point_count + 1];
        for &point in points {
            if let Some(count) = start[1..].get_mut(point as usize) {
                *count += 1;
            }
        }
        prefix_sum(&mut start);
        let mut corners = vec![0; start[point_count] as usize];
        let mut next = start.clone();
        for (corner, &point) in points.iter().enumerate() {
            if (point as usize) < point_count {
                let slot = &mut next[point as usize];
                corners[*slot as usize] = corner as u32;
                *slot += 1;
            }
        }
        Self { start, corners }
    }

    /// Number of points.
    pub fn point_count(&self) -> usize {
        self.start.len().saturating_sub(1)
    }

    /// Returns the corners at a point, ascending: `3 * triangle + k`. Empty for a point that is unused or does not
    /// exist.
    pub fn corners(&self, point: u32) -> &[u32] {
        let point = point as usize;
        match self.start.get(point..).and_then(|rest| rest.get(..2)) {
            Some(ends) => &self.corners[ends[0] as usize..ends[1] as usize],
            None => &[],
        }
    }

    /// Number of corners at a point.
    pub fn valence(&self, point: u32) -> usize {
        self.corners(point).len()
    }
}
