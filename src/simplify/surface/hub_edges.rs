//! Edges between hubs: points with so many triangles that a search around either end costs too much.
//!
//! Only a merge makes an edge between two hubs, at a triangle that it moves to the merged point, or makes a hub of the
//! merged point. So a look at the triangles moved, or at all triangles of the new hub, finds every such edge.

use std::collections::HashMap;

/// A point with more triangles is a hub.
pub(crate) const HUB: usize = 64;

/// A triangle on each edge between two hubs. May still hold edges that are gone.
#[derive(Debug, Clone, Default)]
pub(super) struct HubEdges {
    triangle_on: HashMap<[u32; 2], u32>,
}

impl HubEdges {
    /// Records an edge of a triangle.
    pub fn insert(&mut self, u: u32, v: u32, triangle: u32) {
        self.triangle_on.insert([u.min(v), u.max(v)], triangle);
    }

    /// Returns the triangle last recorded at an edge. None was ever there if this is `None`.
    pub fn get(&self, u: u32, v: u32) -> Option<u32> {
        self.triangle_on.get(&[u.min(v), u.max(v)]).copied()
    }
}
