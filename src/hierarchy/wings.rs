//! The dependencies that keep cuts of a manifold manifold: a split needs the split that parts its wings.
//!
//! ```text
//!          w1                     the wings w1, w2 of an edge are what its two triangles have besides it. A later collapse b
//!        / |  \                     may join them, where all around i has become w1 or w2. Undone with b still done, both
//!       i--+---o                    triangles would be i, o, w: one upon the other, on edges of four triangles.
//!        \ |  /                     So the split of o into i and o needs the split b.
//!          w2
//! ```
//!
//! **Nothing else is needed.** Take the collapses done at a cut in the order of the sequence. A collapse of u and v among them meets
//! its own star, or a finer one. Common neighbours of u and v there are parts of common neighbours that the simplifier saw, which
//! are the wings of u and v alone (the link condition; Dey et al. 1999, Topology preserving edge contraction). So the condition
//! fails only where a wing is in parts, and two of them touch both u and v. The farther one and the edges to u and v enclose the
//! nearer one, so at the undone collapse that joins them, of i and o, all neighbours of i but o belong to u or v, and the wings of
//! i and o are one in u, one in v. Such a split needs the one of u and v.
//!
//! **At points.** All that is about points. Parents are vertices: where a point has several, at a seam, a later collapse of the point
//! may touch none of those of an earlier one. Then the earlier one's split needs the later one's, too.

use crate::mesh::NONE;

use super::VertexHierarchy;

/// Points joined one after the other: when any two of them became one. Trees by size, so ways up are short.
struct Joins {
    parent: Vec<u32>,
    /// Per point, when it was joined to its parent; `NONE` for roots.
    joined: Vec<u32>,
    size: Vec<u32>,
}

impl Joins {
    fn new(points: usize) -> Self {
        let all = 0..points as u32;
        Self { parent: all.collect(), joined: vec![NONE; points], size: vec![1; points] }
    }

    fn find(&self, mut point: u32) -> u32 {
        while self.parent[point as usize] != point {
            point = self.parent[point as usize];
        }
        point
    }

    fn join(&mut self, a: u32, b: u32, when: u32) {
        let (a, b) = (self.find(a), self.find(b));
        if a != b {
            let (small, large) = if self.size[a as usize] < self.size[b as usize] { (a, b) } else { (b, a) };
            self.parent[small as usize] = large;
            self.joined[small as usize] = when;
            self.size[large as usize] += self.size[small as usize];
        }
    }

    /// Returns when two points became one; 0 for a point and itself, `NONE` if they never did.
    fn when(&self, mut a: u32, mut b: u32) -> u32 {
        let mut when = 0;
        while a != b {
            let lower = if self.joined[a as usize] < self.joined[b as usize] { &mut a } else { &mut b };
            when = self.joined[*lower as usize];
            if when == NONE {
                break;
            }
            *lower = self.parent[*lower as usize];
        }
        when
    }
}

/// Finds, for every split, the splits that part its wings, and those that changed its point next: as pairs of a split and one needed
/// by it, without those that are needed anyway. `order` lists the splits in the order of their collapses, `point_of` the point of every leaf. O(n log n).
pub(super) fn wing_pairs(hierarchy: &VertexHierarchy, order: &[u32], point_of: &[u32]) -> Vec<[u32; 2]> {
    let points = point_of.iter().max().map_or(0, |&point| point as usize + 1);
    // New vertices are points of their own until their collapse joins them with those that they replace.
    let leaves = hierarchy.leaf_count();
    let point = |vertex: u32| match point_of.get(vertex as usize) {
        Some(&point) => point,
        None => (points + vertex as usize - leaves) as u32,
    };
    let mut joins = Joins::new(points + hierarchy.vertex_count() - leaves);
    // Per split, one of its points and wings, in the order of the collapses.
    let mut wings: Vec<[u32; 3]> = Vec::new();
    let mut splits: Vec<u32> = Vec::new();
    let mut pairs = Vec::new();
    // Per point, the last split that changed it.
    let mut last = vec![NONE; joins.parent.len()];
    let (mut ends, mut around): (Vec<u32>, Vec<u32>) = Default::default();
    for (&split, when) in order.iter().zip(1..) {
        ends.clear();
        for &vertex in hierarchy.brings.get(split) {
            ends.extend([vertex, hierarchy.substitute[vertex as usize]].map(|end| joins.find(point(end))));
        }
        for &end in &ends {
            let before = last[end as usize];
            if before != NONE && before != split && !hierarchy.parents.get(before).contains(&split) {
                pairs.push([before, split]);
            }
        }
        around.clear();
        for triangle in hierarchy.owned(split) {
            let corners = hierarchy.triangles[triangle as usize].map(|leaf| joins.find(point(leaf)));
            let mut beside = corners.into_iter().filter(|corner| !ends.contains(corner));
            if let (Some(wing), None) = (beside.next(), beside.next()) {
                around.push(wing);
            }
        }
        around.sort_unstable();
        around.dedup();
        for (at, &first) in around.iter().enumerate() {
            // An edge of a manifold has two wings. Of many, a few are kept apart.
            for &second in &around[at + 1..around.len().min(at + 4)] {
                wings.push([ends[0], first, second]);
                splits.push(split);
            }
        }
        for &vertex in hierarchy.brings.get(split) {
            joins.join(point(vertex), point(hierarchy.substitute[vertex as usize]), when);
        }
        last[joins.find(ends[0]) as usize] = split;
    }
    for (&split, &[own, first, second]) in splits.iter().zip(&wings) {
        let when = joins.when(first, second);
        // Where the point itself was joined with a wing before, the collapses from then on are needed by its split anyway.
        if when != NONE && joins.when(own, first).min(joins.when(own, second)) >= when {
            pairs.push([split, order[when as usize - 1]]);
        }
    }
    pairs
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_become_one_when_the_last_join_between_them_is_made() {
        let mut joins = Joins::new(8);
        for (pair, when) in [[0, 1], [2, 3], [4, 5], [1, 3], [5, 6], [3, 6]].into_iter().zip(1..) {
            joins.join(pair[0], pair[1], when);
        }
        let expected =
            [([0, 1], 1), ([0, 2], 4), ([3, 1], 4), ([4, 6], 5), ([0, 4], 6), ([6, 2], 6), ([3, 3], 0)];
        for ([a, b], when) in expected {
            assert_eq!([joins.when(a, b), joins.when(b, a)], [when; 2], "{a} {b}");
        }
        assert_eq!(joins.when(7, 0), NONE);
    }
}
