//! The input's points in a tree of boxes, to find the nearest points of other parts.
//!
//! ```text
//!     node 1     all points            children of node i: 2 i and 2 i + 1, halves along the longest side of its box
//!     2     3    halves                each node knows how many of its points still count, and which part they are all
//!    4 5   6 7   leaves                of: the asking part, and what is gone, are skipped whole
//! ```
//!
//! Points keep their place in the tree while they are merged: each point stands for the point it was merged into. The
//! tree is built anew of the points that count once half of them are gone, O(n log n) in all. A search takes O(log n)
//! expected.

use glam::Vec3;

use crate::geometry::boxes::{self, Place};
use crate::mesh::NONE;

/// Points in a leaf, at most.
const LEAF: usize = 16;

/// Points of a tree worth building anew.
const MANY: usize = 4 * LEAF;

/// The points of a surface in a tree of boxes.
#[derive(Debug, Clone)]
pub(crate) struct Near {
    /// Points and their positions in the input, in the order of the leaves.
    points: Vec<(Vec3, u32)>,
    /// Start of each leaf; length leaves + 1.
    start: Vec<u32>,
    /// Per point its leaf; `NONE` if the point is in no leaf.
    leaf_of: Vec<u32>,
    /// Per node: its box, the number of its points that count, and their common part (`NONE` for several parts).
    boxes: Vec<[Vec3; 2]>,
    live: Vec<u32>,
    part: Vec<u32>,
    stack: Vec<(f32, u32)>,
}

impl Near {
    /// Builds the tree of the points of a surface of `count` points; `part` gives the part of each point.
    pub fn new(points: Vec<(Vec3, u32)>, count: usize, part: impl Fn(u32) -> u32) -> Self {
        let mut near = Self {
            points,
            start: Vec::new(),
            leaf_of: vec![NONE; count],
            boxes: Vec::new(),
            live: Vec::new(),
            part: Vec::new(),
            stack: Vec::new(),
        };
        near.build(&part);
        near
    }

    /// Builds the tree of all points in `points`.
    fn build(&mut self, part: &impl Fn(u32) -> u32) {
        let mut points = std::mem::take(&mut self.points);
        let leaves = points.len().div_ceil(LEAF).next_power_of_two();
        self.start = vec![0; leaves + 1];
        self.boxes = vec![<Vec3 as Place>::EMPTY; 2 * leaves];
        self.live = vec![0; 2 * leaves];
        self.part = vec![NONE; 2 * leaves];
        self.split(&mut points, 0, 1, part);
        self.start[leaves] = points.len() as u32;
        self.points = points;
    }

    /// Builds the tree anew if half of its points are gone: searches would wander about in boxes of points that do not count.
    fn tidy(&mut self, part: &impl Fn(u32) -> u32) {
        if self.points.len() > MANY && 2 * (self.live[1] as usize) < self.points.len() {
            let Self { points, leaf_of, .. } = self;
            points.retain(|&(_, point)| leaf_of[point as usize] != NONE);
            self.build(part);
        }
    }

    /// Arranges the points of a node, which start at index `first` of the tree, and fills the node.
    fn split(&mut self, points: &mut [(Vec3, u32)], first: usize, node: usize, part: &impl Fn(u32) -> u32) {
        self.boxes[node] = boxes::around(points.iter().map(|&(p, _)| p));
        self.live[node] = points.len() as u32;
        let leaves = self.start.len() - 1;
        if node >= leaves {
            let leaf = node - leaves;
            self.start[leaf] = first as u32;
            points.iter().for_each(|&(_, p)| self.leaf_of[p as usize] = leaf as u32);
            let of = points.first().map_or(NONE, |&(_, p)| part(p));
            self.part[node] = if points.iter().all(|&(_, p)| part(p) == of) { of } else { NONE };
            return;
        }
        let axis = boxes::longest_side(self.boxes[node]);
        let half = points.len() / 2;
        if half > 0 {
            points.select_nth_unstable_by_key(half, |&(p, point)| key(p[axis], point));
        }
        let (a, b) = points.split_at_mut(half);
        self.split(a, first, 2 * node, part);
        self.split(b, first + half, 2 * node + 1, part);
        self.merge_parts(node, |part| part);
    }

    /// Takes the part of a node from its children; `root` maps a part to the part it was joined into.
    fn merge_parts(&mut self, node: usize, root: impl Fn(u32) -> u32) {
        let [a, b] = [2 * node, 2 * node + 1];
        let of = |child: usize| if self.part[child] == NONE { NONE } else { root(self.part[child]) };
        self.part[node] = match (self.live[a], self.live[b]) {
            (_, 0) => of(a),
            (0, _) => of(b),
            _ if of(a) == of(b) => of(a),
            _ => NONE,
        };
    }

    /// Excludes a point from further searches. O(log n).
    pub fn remove(&mut self, point: u32) {
        let leaf = std::mem::replace(&mut self.leaf_of[point as usize], NONE);
        if leaf == NONE {
            return;
        }
        let mut node = leaf as usize + self.start.len() - 1;
        while node > 0 {
            self.live[node] -= 1;
            node /= 2;
        }
    }

    /// Finds the `most` points of parts other than `own` nearest to `at`, at a distance of at most `reach`. Returns them
    /// in `found`, nearest first, as `(distance squared, point)`; of equal distances the lower number first. `part` gives
    /// the part of a point, and `root` maps a part to the part it was joined into.
    pub fn nearest(
        &mut self,
        at: Vec3,
        own: u32,
        (most, reach): (usize, f32),
        part: impl Fn(u32) -> u32,
        root: impl Fn(u32) -> u32,
        found: &mut Vec<(f32, u32)>,
    ) {
        found.clear();
        self.tidy(&part);
        let leaves = self.start.len() - 1;
        let limit = reach * reach;
        let distance = |[low, high]: [Vec3; 2]| (low - at).max(at - high).max(Vec3::ZERO).length_squared();
        let mut stack = std::mem::take(&mut self.stack);
        stack.clear();
        stack.push((0.0, 1));
        while let Some((bound, node)) = stack.pop() {
            let node = node as usize;
            let worst = if found.len() == most { found[most - 1].0 } else { limit };
            if self.live[node] == 0 || bound > worst {
                continue;
            }
            if self.part[node] == NONE && node < leaves {
                self.merge_parts(node, &root);
            }
            if self.part[node] != NONE && root(self.part[node]) == own {
                continue;
            }
            if node >= leaves {
                let leaf = node - leaves;
                for &(p, point) in &self.points[self.start[leaf] as usize..self.start[leaf + 1] as usize] {
                    // Most points are too far, and what else there is to know of a point lies elsewhere in memory.
                    let one = (p.distance_squared(at), point);
                    let is_near = one.0 <= limit && (found.len() < most || one < found[most - 1]);
                    if is_near && self.leaf_of[point as usize] != NONE && part(point) != own {
                        let place = found.partition_point(|other| *other < one);
                        found.insert(place, one);
                        found.truncate(most);
                    }
                }
                continue;
            }
            let children = [2 * node, 2 * node + 1].map(|child| (distance(self.boxes[child]), child as u32));
            let [near, far] = if children[1].0 < children[0].0 { [1, 0] } else { [0, 1] };
            stack.push(children[far]);
            stack.push(children[near]);
        }
        self.stack = stack;
    }
}

/// Sort key of a coordinate and, for equal coordinates, the point's number: a single comparison for both.
#[inline]
fn key(x: f32, point: u32) -> u64 {
    // Positive numbers are in the order of their bits, negative ones in the opposite order.
    let bits = x.to_bits();
    let ordered = bits ^ (((bits as i32 >> 31) as u32) | 1 << 31);
    u64::from(ordered) << 32 | u64::from(point)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares with an exhaustive search, while points are removed and parts are joined.
    #[test]
    fn finds_what_trying_all_finds() {
        let mut state = 1u32;
        let mut random = |n: u32| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) % n
        };
        let mut place = |n| Vec3::new(random(n) as f32, random(n) as f32, random(n) as f32);
        let points: Vec<(Vec3, u32)> = (0..500).map(|p| (place(20), p)).collect();
        let mut parts: Vec<u32> = (0..50).collect();
        let mut gone = vec![false; 500];
        let mut near = Near::new(points.clone(), 500, |p| p / 10);
        for round in 0..60u32 {
            let own = parts[(round % 50) as usize];
            let at = place(20);
            let (root, part) = (|part: u32| parts[part as usize], |p: u32| parts[p as usize / 10]);
            let mut all: Vec<(f32, u32)> = points
                .iter()
                .filter(|&&(_, p)| part(p) != own && !gone[p as usize])
                .map(|&(x, p)| (x.distance_squared(at), p))
                .filter(|&(d, _)| d <= 64.0)
                .collect();
            all.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            all.truncate(6);
            let mut found = Vec::new();
            near.nearest(at, own, (6, 8.0), part, root, &mut found);
            assert_eq!(found, all, "round {round}");
            // A part is removed, and two parts are joined.
            let lost = (7 * round) % 50;
            for p in (10 * lost..10 * lost + 10).filter(|_| round % 3 == 0) {
                gone[p as usize] = true;
                near.remove(p);
            }
            let (from, to) = (parts[(round % 50) as usize], parts[((round * 3 + 1) % 50) as usize]);
            parts.iter_mut().filter(|part| **part == from).for_each(|part| *part = to);
        }
    }
}
