//! Enclosed volume, where a surface encloses one.

use glam::DVec3;

use super::{Mesh, Topology};

/// An edge that is not traversed equally often in both directions.
#[cfg_attr(not(feature = "quality"), allow(dead_code))]
pub(crate) struct UnbalancedEdge {
    /// A vertex at each end.
    pub edge: [u32; 2],
    /// Number of sides of triangles along the edge.
    pub triangles: usize,
}

impl Mesh {
    /// Returns the first edge between two positions that is not traversed equally often in both directions; `None` for a
    /// closed, consistently oriented surface. Sides of length 0 do not count. O(n log n).
    pub(crate) fn unbalanced_edge(&self) -> Option<UnbalancedEdge> {
        let topology = Topology::new(self);
        let mut sides: Vec<(u64, bool)> = Vec::with_capacity(3 * self.triangles().len());
        for triangle in self.triangles() {
            let [a, b, c] = triangle.map(|v| topology.point_of()[v as usize]);
            for (p, q) in [(a, b), (b, c), (c, a)] {
                if p != q {
                    sides.push((u64::from(p.min(q)) << 32 | u64::from(p.max(q)), p < q));
                }
            }
        }
        sides.sort_unstable();
        let balanced = |edge: &&[(u64, bool)]| edge.iter().filter(|side| side.1).count() * 2 == edge.len();
        let fault = sides.chunk_by(|a, b| a.0 == b.0).find(|edge| !balanced(edge))?;
        let ends = [(fault[0].0 >> 32) as usize, (fault[0].0 & u64::from(u32::MAX)) as usize];
        let edge = ends.map(|point| topology.vertex_of_point()[point]);
        Some(UnbalancedEdge { edge, triangles: fault.len() })
    }

    /// Returns the enclosed volume in cubic object units, negative if the triangles face inward.
    ///
    /// `None` without triangles, or unless each edge between two positions is traversed equally often in both directions.
    /// Otherwise the surface is open or inconsistently oriented, and the sum would depend on the origin. Vertices at the
    /// same position count as a single vertex. Separate bodies add up; a cavity whose surface faces into it is subtracted.
    /// O(n log n).
    ///
    /// ```
    /// use multires::mesh::Mesh;
    /// let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    /// let tetrahedron = Mesh::new(corners, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])?;
    /// assert_eq!(tetrahedron.volume(), Some(1.0 / 6.0));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn volume(&self) -> Option<f64> {
        let [low, high] = self.bounds()?.map(|p| DVec3::from_array(p.map(f64::from)));
        if self.unbalanced_edge().is_some() {
            return None;
        }
        // Relative to the middle: avoids cancellation far from the origin.
        let middle = low + (high - low) * 0.5;
        let position = |v: u32| DVec3::from_array(self.positions()[v as usize].map(f64::from)) - middle;
        let six = self.triangles().iter().map(|t| {
            let [a, b, c] = t.map(position);
            a.cross(b).dot(c)
        });
        Some(six.sum::<f64>() / 6.0)
    }
}
