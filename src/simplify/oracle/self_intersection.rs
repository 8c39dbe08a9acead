//! Keeps sheets apart: refuses collapses after which the surface would cross itself where it did not before.
//!
//! ```text
//!     ----------.            two sheets of a thin shell. The outer one is made flatter by a collapse, and would
//!       ---.     \           come to lie through the inner one.
//!           \     \
//! ```
//!
//! Stores the surface's triangles in a tree of boxes, laid out once: a triangle keeps its leaf however it changes, and
//! only the boxes above it are refitted. A collapse costs O(log n) for every changed triangle. A query costs O(log n)
//! expected, plus the triangles found.

use glam::Vec3;

use crate::geometry::{boxes, crossing::triangles_cross};
use crate::mesh::NONE;
use crate::simplify::oracle::{Collapse, Oracle};
use crate::simplify::surface::WorkingSurface;
use crate::simplify::surface::patch::Facet;

/// Maximum number of triangles in a leaf.
const LEAF: usize = 4;

/// Refuses collapses whose new triangles would cross triangles of the surface not crossed now. Triangles sharing a point
/// do not count.
///
/// Not among the default rules: a simplification takes several times as long. A surface without self-intersections then
/// gets none, except between neighbours folding over, which [`NormalFlip`](super::NormalFlip) refuses.
#[derive(Debug, Clone, Default)]
pub struct SelfIntersection {
    /// Triangles in the order of the leaves. `start`: first triangle of every leaf.
    triangles: Vec<u32>,
    start: Vec<u32>,
    leaf_of: Vec<u32>,
    /// Per node the box of its live triangles. Children of node i: 2 i and 2 i + 1.
    boxes: Vec<Bounds>,
}

#[derive(Debug, Clone, Copy)]
struct Bounds {
    low: Vec3,
    high: Vec3,
}

impl Bounds {
    const NONE: Self = Self { low: Vec3::INFINITY, high: Vec3::NEG_INFINITY };

    fn of(corners: &[Vec3; 3]) -> Self {
        let [a, b, c] = *corners;
        Self { low: a.min(b).min(c), high: a.max(b).max(c) }
    }

    fn and(&self, other: &Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// Whether boxes meet; an empty box meets none.
    fn meets(&self, other: &Self) -> bool {
        (self.low.cmple(other.high) & self.high.cmpge(other.low)).all()
    }
}

impl SelfIntersection {
    /// Creates the rule.
    pub fn new() -> Self {
        Self::default()
    }

    /// Distributes the triangles of a node over its leaves by their centroids.
    fn split(&mut self, items: &mut [(Vec3, u32)], first: usize, node: usize) {
        let leaves = self.start.len() - 1;
        if node >= leaves {
            self.start[node - leaves] = first as u32;
            items.iter().for_each(|&(_, t)| self.leaf_of[t as usize] = (node - leaves) as u32);
            return;
        }
        let axis = boxes::longest_side(boxes::around(items.iter().map(|&(p, _)| p)));
        let half = items.len() / 2;
        if half > 0 {
            items.select_nth_unstable_by(half, |a, b| a.0[axis].total_cmp(&b.0[axis]).then(a.1.cmp(&b.1)));
        }
        let (a, b) = items.split_at_mut(half);
        self.split(a, first, 2 * node);
        self.split(b, first + half, 2 * node + 1);
    }

    /// Returns the box of the live triangles in a leaf.
    fn leaf_box(&self, surface: &WorkingSurface, leaf: usize) -> Bounds {
        let range = self.start[leaf] as usize..self.start[leaf + 1] as usize;
        let corners = self.triangles[range].iter().filter_map(|&t| corners(surface, t));
        corners.fold(Bounds::NONE, |all, corners| all.and(&Bounds::of(&corners)))
    }

    /// Refits the boxes above a triangle.
    fn refit(&mut self, surface: &WorkingSurface, triangle: u32) {
        let leaf = self.leaf_of[triangle as usize];
        if leaf == NONE {
            return;
        }
        let mut node = leaf as usize + self.start.len() - 1;
        self.boxes[node] = self.leaf_box(surface, leaf as usize);
        while node > 1 {
            node /= 2;
            let both = self.boxes[2 * node].and(&self.boxes[2 * node + 1]);
            let before = std::mem::replace(&mut self.boxes[node], both);
            if before.low == both.low && before.high == both.high {
                break;
            }
        }
    }

    /// Whether `yes` is true for any triangle in the leaves whose boxes meet `bounds`.
    fn any(&self, node: usize, bounds: &Bounds, yes: &mut impl FnMut(u32) -> bool) -> bool {
        if !self.boxes[node].meets(bounds) {
            return false;
        }
        let leaves = self.start.len() - 1;
        if node >= leaves {
            let range = self.start[node - leaves] as usize..self.start[node - leaves + 1] as usize;
            return self.triangles[range].iter().any(|&t| yes(t));
        }
        self.any(2 * node, bounds, yes) || self.any(2 * node + 1, bounds, yes)
    }
}

fn corners(surface: &WorkingSurface, triangle: u32) -> Option<[Vec3; 3]> {
    surface.triangle(triangle).map(|corners| corners.map(|p| surface.at(p)))
}

impl Oracle for SelfIntersection {
    fn name(&self) -> &str {
        "self-intersection"
    }

    fn begin(&mut self, surface: &WorkingSurface) -> bool {
        let live = |t: u32| corners(surface, t).map(|[a, b, c]| ((a + b + c) / 3.0, t));
        let mut items: Vec<(Vec3, u32)> = (0..surface.triangle_count() as u32).filter_map(live).collect();
        let leaves = items.len().div_ceil(LEAF).next_power_of_two();
        self.start = vec![0; leaves + 1];
        self.leaf_of = vec![NONE; surface.triangle_count()];
        self.split(&mut items, 0, 1);
        self.start[leaves] = items.len() as u32;
        self.triangles = items.iter().map(|&(_, t)| t).collect();
        self.boxes = vec![Bounds::NONE; 2 * leaves];
        for leaf in 0..leaves {
            self.boxes[leaves + leaf] = self.leaf_box(surface, leaf);
        }
        for node in (1..leaves).rev() {
            self.boxes[node] = self.boxes[2 * node].and(&self.boxes[2 * node + 1]);
        }
        true
    }

    fn changed(&mut self, surface: &WorkingSurface, kept: Option<u32>, dead: &[u32]) {
        for &triangle in dead {
            self.refit(surface, triangle);
        }
        for triangle in kept.into_iter().flat_map(|kept| surface.star_triangles(kept)) {
            self.refit(surface, triangle);
        }
    }

    fn allows(&self, surface: &WorkingSurface, collapse: &Collapse) -> bool {
        let facets = collapse.patch.facets();
        if self.boxes.is_empty() || facets.is_empty() {
            return true;
        }
        let ends = [collapse.pair.lost, collapse.pair.kept];
        let x = Vec3::from(collapse.position);
        let after = |facet: &Facet| [x, surface.at(facet.others[0]), surface.at(facet.others[1])];
        let all = facets.iter().fold(Bounds::NONE, |all, facet| all.and(&Bounds::of(&after(facet))));
        // Query the tree once with the box of all new triangles, then compare single boxes.
        !self.any(1, &all, &mut |other| {
            let Some(points) = surface.triangle(other) else { return false };
            if points.iter().any(|p| ends.contains(p)) {
                return false;
            }
            let corners = points.map(|p| surface.at(p));
            let bounds = Bounds::of(&corners);
            if !bounds.meets(&all) {
                return false;
            }
            facets.iter().any(|facet| {
                let after = after(facet);
                bounds.meets(&Bounds::of(&after))
                    && !points.iter().any(|p| facet.others.contains(p))
                    && crosses(after, &corners)
                    && !crosses([x + facet.back, after[1], after[2]], &corners)
            })
        })
    }
}

fn crosses(a: [Vec3; 3], b: &[Vec3; 3]) -> bool {
    triangles_cross(&a.map(Vec3::as_dvec3), &b.map(Vec3::as_dvec3))
}
