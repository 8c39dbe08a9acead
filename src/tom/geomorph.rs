//! Smooth transitions: where vertices move between a finer and a coarser resolution.

use super::{Resolution, TotallyOrderedMesh};

impl TotallyOrderedMesh {
    /// Fills `targets` with the target of each vertex of the finer resolution, to which it moves on the way to the
    /// coarser resolution. Entry `i` belongs to vertex `coarse.vertices() + i`, up to `fine.vertices()`; earlier
    /// vertices stay. The arguments may come in either order.
    ///
    /// Draw the finer resolution's indices, with vertex `v` at `(1 - w) * v + w * target`. `w = 0` draws the finer
    /// resolution, `w = 1` the coarser, with the triangles between them degenerate. For a morph over the last step
    /// alone, take [`TotallyOrderedMesh::coarser`] (TOM, section 3.4). O(vertices between the two).
    pub fn geomorph(&self, a: Resolution, b: Resolution, targets: &mut Vec<u32>) {
        let (a, b) = (self.clamp(a).vertices, self.clamp(b).vertices);
        let (coarse, fine) = (a.min(b), a.max(b));
        targets.clear();
        targets.reserve((fine - coarse) as usize);
        for &to in &self.substitute[coarse as usize..fine as usize] {
            // Substitutes come before the vertices they replace, so their targets are known already.
            targets.push(if to < coarse { to } else { targets[(to - coarse) as usize] });
        }
    }
}
