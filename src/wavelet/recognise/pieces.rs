//! Components: sets of triangles joined by edges, in order of their lowest triangle.
//!
//! Sharing only a point does not join triangles. A triangle naming a point twice has no edges and is a component of its own.

use crate::mesh::{Edges, NONE};

/// The triangles of every component.
pub(super) struct Pieces {
    /// Start of every component's triangles, and the end of the last.
    start: Vec<u32>,
    /// Ascending within a component.
    triangles: Vec<u32>,
}

impl Pieces {
    /// Groups triangles by the edges of their sides, `u32::MAX` for triangles without edges. O(n).
    pub fn new(edges: &Edges, sides: &[[u32; 3]]) -> Self {
        let mut piece_of = vec![NONE; sides.len()];
        let mut edge_done = vec![false; edges.len()];
        let mut start = vec![0];
        let mut pending = Vec::new();
        for seed in 0..sides.len() {
            if piece_of[seed] != NONE {
                continue;
            }
            let piece = start.len() as u32 - 1;
            let mut count = 1;
            piece_of[seed] = piece;
            pending.push(seed);
            while let Some(triangle) = pending.pop() {
                for &edge in sides[triangle].iter().filter(|&&edge| edge != NONE) {
                    if std::mem::replace(&mut edge_done[edge as usize], true) {
                        continue;
                    }
                    for other in edges.half_edges(edge).iter().map(|&half_edge| half_edge as usize / 3) {
                        if piece_of[other] == NONE {
                            piece_of[other] = piece;
                            count += 1;
                            pending.push(other);
                        }
                    }
                }
            }
            start.push(start[piece as usize] + count);
        }
        let mut next = start.clone();
        let mut triangles = vec![0; sides.len()];
        for (triangle, &piece) in piece_of.iter().enumerate() {
            let slot = &mut next[piece as usize];
            triangles[*slot as usize] = triangle as u32;
            *slot += 1;
        }
        Self { start, triangles }
    }

    /// Iterates over the triangles of each component.
    pub fn iter(&self) -> impl Iterator<Item = &[u32]> {
        self.start.windows(2).map(|ends| &self.triangles[ends[0] as usize..ends[1] as usize])
    }
}
