//! Smooth transitions: where the vertices of a finer resolution move on the way to a coarser one.

use super::{Resolution, TotallyOrderedMesh};

impl TotallyOrderedMesh {
    /// Fills `targets` with the vertex that each vertex of the finer resolution moves to on the way to the coarser one:
    /// entry `i` belongs to vertex `coarse.vertices() + i`, up to `fine.vertices()`; earlier vertices stay. The order of
    /// the two arguments does not matter.
    ///
    /// Draw the finer resolution's indices, with vertex `v` at `(1 - w) * v + w * target`: at `w = 0` that is the finer
    /// resolution and at `w = 1` the coarser one, with the triangles between them degenerate. For a morph over the last
    /// step alone take [`TotallyOrderedMesh::coarser`] (TOM, section 3.4). O(vertices between the two).
    pub fn geomorph(&self, a: Resolution, b: Resolution, targets: &mut Vec<u32>) {
        let (a, b) = (self.clamp(a).vertices, self.clamp(b).vertices);
        let (coarse, fine) = (a.min(b), a.max(b));
        targets.clear();
        targets.reserve((fine - coarse) as usize);
        for &to in &self.substitute[coarse as usize..fine as usize] {
            // Substitutes come before what they stand for, so theirs are known already.
            targets.push(if to < coarse { to } else { targets[(to - coarse) as usize] });
        }
    }
}
