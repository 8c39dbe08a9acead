//! Turned boxes: a second box for each node of a hierarchy, along its triangles, where these are long, thin and askew.
//!
//! ```text
//!     .-----------.     The upright box of a thin triangle along its diagonal is nearly empty. Around the hub of a fan,
//!     |        _ /|     all of them overlap: a query would meet every one. A box turned along a triangle, or along a
//!     |    _ / /  |     bundle of triangles side by side, has hardly more room than they fill.
//!     |_ / _/     |
//!     '-----------'
//! ```

use glam::{DVec3, Mat3A, Vec3A};
use obvhs::bvh2::node::Bvh2Node;

use super::triangle::Corners;

/// Turned boxes are worth their cost where the upright boxes of all leaves are together this many times as large as the
/// box of all. Those of a closed surface of small triangles are a few times as large.
const CROWDED: f32 = 8.0;
/// Shortens the axes, so that rounding never makes a distance too large.
const SHORT: f32 = 1.0 - 1e-6;
/// More than the rounding of a direction along an axis.
const ROUNDING: f32 = 4.0 * f32::EPSILON;

/// A box along three axes of its own.
#[derive(Debug, Clone, Copy)]
pub(super) struct TurnedBox {
    /// Its rows are the axes: frame coordinates to the box's.
    turn: Mat3A,
    low: Vec3A,
    high: Vec3A,
}

impl TurnedBox {
    fn around(turn: Mat3A, points: impl Iterator<Item = Vec3A>) -> Self {
        let empty = Self { turn, low: Vec3A::INFINITY, high: Vec3A::NEG_INFINITY };
        points.map(|p| turn * p).fold(empty, |all, p| Self {
            low: all.low.min(p),
            high: all.high.max(p),
            ..all
        })
    }

    fn half_area(&self) -> f32 {
        let size = self.high - self.low;
        size.x * size.y + size.y * size.z + size.z * size.x
    }

    /// Returns a lower bound for the squared distance of a point.
    #[inline]
    pub fn distance_squared(&self, p: Vec3A) -> f32 {
        let p = self.turn * p;
        (self.low - p).max(p - self.high).max(Vec3A::ZERO).length_squared()
    }

    /// Whether a plane along a side has the box on one side and all points on the other.
    pub fn misses(&self, points: [Vec3A; 3]) -> bool {
        let [a, b, c] = points.map(|p| self.turn * p);
        (a.max(b).max(c).cmplt(self.low) | a.min(b).min(c).cmpgt(self.high)).any()
    }

    /// Returns where a ray enters the box, never later than without rounding (0: starts inside); infinity if it misses.
    #[inline]
    pub fn entry(&self, start: Vec3A, direction: Vec3A) -> f32 {
        let (start, direction) = (self.turn * start, self.turn * direction);
        // How far to go along each axis, 0 between its planes, and how fast; a ray that flees never arrives.
        let way = (self.low - start).max(start - self.high).max(Vec3A::ZERO);
        let towards = Vec3A::select(start.cmplt(self.low), direction, -direction) + Vec3A::splat(ROUNDING);
        let flees = way.cmpgt(Vec3A::ZERO) & towards.cmple(Vec3A::ZERO);
        if flees.any() {
            return f32::INFINITY;
        }
        Vec3A::select(way.cmpgt(Vec3A::ZERO), way / towards, Vec3A::ZERO).max_element()
    }
}

/// Returns a turned box for every node of a tree, wider by `margin` than its triangles; none where upright boxes do.
/// `corners`: of a slot, frame coordinates. The slots of a subtree follow each other. O(n depth).
pub(super) fn of_nodes(nodes: &[Bvh2Node], corners: impl Fn(u32) -> Corners, margin: f32) -> Vec<TurnedBox> {
    let leaves = || nodes.iter().filter(|node| node.is_leaf());
    let all: f32 = leaves().map(|node| node.aabb.half_area()).sum();
    if nodes.is_empty() || all <= CROWDED * nodes[0].aabb.half_area() {
        return Vec::new();
    }
    let slots = leaves().map(|node| node.first_index + node.prim_count).max().unwrap_or(0);
    let points: Vec<[Vec3A; 3]> = (0..slots).map(|slot| corners(slot).map(|p| p.as_vec3a())).collect();
    let upright = TurnedBox { turn: Mat3A::IDENTITY, low: Vec3A::NEG_INFINITY, high: Vec3A::INFINITY };
    let mut boxes = vec![upright; nodes.len()];
    let mut slots = vec![0..0; nodes.len()];
    for index in children_first(nodes) {
        let node = &nodes[index];
        let first = node.first_index as usize;
        let turns = if node.is_leaf() {
            slots[index] = first..first + node.prim_count as usize;
            [along(&corners(node.first_index)); 3]
        } else {
            let [a, b] = [first, first + 1];
            slots[index] = slots[a].start.min(slots[b].start)..slots[a].end.max(slots[b].end);
            let [a, b] = [boxes[a].turn, boxes[b].turn];
            [between(a, b), a, b]
        };
        let within = points[slots[index].clone()].as_flattened();
        let candidates = turns.map(|turn| TurnedBox::around(turn, within.iter().copied()));
        let least = candidates.into_iter().min_by(|a, b| a.half_area().total_cmp(&b.half_area()));
        if let Some(TurnedBox { turn, low, high }) = least {
            boxes[index] = TurnedBox { turn, low: low - margin, high: high + margin };
        }
    }
    boxes
}

/// Returns the axes along the longest side of a triangle, across it, and along the normal.
fn along(&[a, b, c]: &Corners) -> Mat3A {
    let sides = [b - a, c - b, a - c];
    let longest = sides.into_iter().fold(DVec3::ZERO, |longest, side| {
        if side.length_squared() > longest.length_squared() { side } else { longest }
    });
    axes(longest.normalize_or_zero().as_vec3a(), (b - a).cross(c - a).normalize_or_zero().as_vec3a())
}

/// Returns axes halfway between others.
fn between(a: Mat3A, b: Mat3A) -> Mat3A {
    let [a, b] = [a.transpose(), b.transpose()];
    let middle = |a: Vec3A, b: Vec3A| if a.dot(b) < 0.0 { a - b } else { a + b };
    axes(middle(a.x_axis, b.x_axis).normalize_or_zero(), middle(a.z_axis, b.z_axis).normalize_or_zero())
}

/// Returns axes along `first`, and as near as can be to `last`; upright axes where the two do not define any.
fn axes(first: Vec3A, last: Vec3A) -> Mat3A {
    let second = last.cross(first).normalize_or_zero();
    let last = first.cross(second);
    if second == Vec3A::ZERO {
        return Mat3A::from_diagonal(glam::Vec3::splat(SHORT));
    }
    Mat3A::from_cols(first * SHORT, second * SHORT, last * SHORT).transpose()
}

/// Returns the nodes in an order with children before parents.
fn children_first(nodes: &[Bvh2Node]) -> Vec<usize> {
    let mut order = Vec::with_capacity(nodes.len());
    let mut stack = vec![0];
    while let Some(index) = stack.pop() {
        order.push(index);
        let node = &nodes[index];
        if !node.is_leaf() {
            stack.extend([node.first_index as usize, node.first_index as usize + 1]);
        }
    }
    order.reverse();
    order
}
