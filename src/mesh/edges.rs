//! Every undirected edge once, with the half-edges along it, in flat arrays.
//!
//! ```text
//!           b = high end                 half-edge 3t + k runs from corner k to corner k + 1 of triangle t
//!          /|\                           forward:  from the low end to the high end
//!         / | \                          backward: from the high end to the low end
//!        /  ^  \
//!        \  |  /       one of each way   an inner edge of an oriented surface
//!         \ | /        one in all        a border
//!          \|/         two the same way  clashing orientation
//!           a          three or more     a non-manifold edge
//! ```
//!
//! Built by a counting sort over the low ends and a sort of each bucket: O(k log k) around a point of valence k. No
//! hashing, so no hash order shows.

use super::{MAX_ELEMENTS, NONE};
use crate::geometry::lists::prefix_sum;

/// Every undirected edge once, with the half-edges along it. 16 bytes an edge and 4 a half-edge.
///
/// Edges are numbered in ascending order of `[low end, high end]`.
///
/// ```
/// use multires::mesh::{Edges, shapes};
///
/// let mesh = shapes::tetrahedron();
/// let edges = Edges::new(mesh.triangles(), mesh.positions().len());
/// assert_eq!(edges.len(), 6);
/// assert!((0..6).all(|edge| !edges.is_border(edge)));
/// ```
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Edges {
    ends: Vec<[u32; 2]>,
    /// Start of every edge's half-edges; `edges + 1` entries.
    start: Vec<u32>,
    /// Start of every edge's backward half-edges.
    backward: Vec<u32>,
    half_edges: Vec<u32>,
}

impl Edges {
    /// Collects the edges of triangles given by the points at their corners. O(n), plus O(k log k) around a point of
    /// valence k.
    ///
    /// Leaves out triangles naming a point twice or a point not below `point_count`, and everything beyond
    /// [`MAX_ELEMENTS`] triangles or points, which no [`Mesh`](super::Mesh) has.
    pub fn new(corner_points: &[[u32; 3]], point_count: usize) -> Self {
        let corner_points = &corner_points[..corner_points.len().min(MAX_ELEMENTS)];
        let point_count = point_count.min(MAX_ELEMENTS);

        let mut bucket = vec![0_u32; point_count + 1];
        for_each_half_edge(corner_points, point_count, |_, from, to| {
            bucket[from.min(to) as usize + 1] += 1;
        });
        prefix_sum(&mut bucket);
        let mut keys = vec![0_u64; bucket[point_count] as usize];
        let mut next = bucket.clone();
        for_each_half_edge(corner_points, point_count, |half_edge, from, to| {
            let slot = &mut next[from.min(to) as usize];
            keys[*slot as usize] = key(half_edge, from, to);
            *slot += 1;
        });
        drop(next);

        // A closed surface has two half-edges an edge. Borders make the number of edges grow.
        let mut edges = Self { half_edges: Vec::with_capacity(keys.len()), ..Self::default() };
        edges.reserve(keys.len() / 2 + 1);
        for low in 0..point_count {
            let around = &mut keys[bucket[low] as usize..bucket[low + 1] as usize];
            around.sort_unstable();
            for run in around.chunk_by(|a, b| high_end(*a) == high_end(*b)) {
                let start = edges.half_edges.len();
                let forward = run.partition_point(|&k| !is_backward(k));
                edges.ends.push([low as u32, high_end(run[0])]);
                edges.start.push(start as u32);
                edges.backward.push((start + forward) as u32);
                // The low half of the key is the half-edge.
                edges.half_edges.extend(run.iter().map(|&k| k as u32));
            }
        }
        edges.start.push(edges.half_edges.len() as u32);
        edges
    }

    fn reserve(&mut self, edges: usize) {
        self.ends.reserve(edges);
        self.start.reserve(edges);
        self.backward.reserve(edges);
    }

    /// Number of edges.
    pub fn len(&self) -> usize {
        self.ends.len()
    }

    /// Whether there are no edges.
    pub fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }

    /// Points at the ends of every edge, `[low, high]`, in ascending order.
    pub fn ends(&self) -> &[[u32; 2]] {
        &self.ends
    }

    /// Finds the edge between two points, in either order. O(log n).
    pub fn find(&self, a: u32, b: u32) -> Option<u32> {
        self.ends.binary_search(&[a.min(b), a.max(b)]).ok().map(|edge| edge as u32)
    }

    /// Returns all half-edges along an edge: forward half-edges, then backward half-edges, each ascending. Empty for an
    /// edge that does not exist. Half-edge `h` belongs to triangle `h / 3`.
    pub fn half_edges(&self, edge: u32) -> &[u32] {
        self.range(edge).map_or(&[], |[start, _, end]| &self.half_edges[start..end])
    }

    /// Returns the half-edges running from the low end to the high end, ascending.
    pub fn forward(&self, edge: u32) -> &[u32] {
        self.range(edge).map_or(&[], |[start, turn, _]| &self.half_edges[start..turn])
    }

    /// Returns the half-edges running from the high end to the low end, ascending.
    pub fn backward(&self, edge: u32) -> &[u32] {
        self.range(edge).map_or(&[], |[_, turn, end]| &self.half_edges[turn..end])
    }

    /// Whether the edge has exactly 1 triangle.
    pub fn is_border(&self, edge: u32) -> bool {
        self.half_edges(edge).len() == 1
    }

    /// Whether the edge has 3 or more triangles.
    pub fn is_non_manifold(&self, edge: u32) -> bool {
        self.half_edges(edge).len() > 2
    }

    /// Whether the edge has exactly 2 triangles, both running along it in the same direction: their orientations clash.
    pub fn is_flipped(&self, edge: u32) -> bool {
        self.half_edges(edge).len() == 2 && self.forward(edge).len() != 1
    }

    /// Returns the edge of every half-edge of `triangle_count` triangles, three per triangle; `u32::MAX` for triangles
    /// left out by [`Edges::new`]. O(n).
    pub fn of_half_edges(&self, triangle_count: usize) -> Vec<[u32; 3]> {
        let mut edge_of = vec![[NONE; 3]; triangle_count];
        for edge in 0..self.len() as u32 {
            for &half_edge in self.half_edges(edge) {
                if let Some(slot) = edge_of.as_flattened_mut().get_mut(half_edge as usize) {
                    *slot = edge;
                }
            }
        }
        edge_of
    }

    fn range(&self, edge: u32) -> Option<[usize; 3]> {
        let edge = edge as usize;
        let turn = *self.backward.get(edge)?;
        Some([self.start[edge], turn, self.start[edge + 1]].map(|x| x as usize))
    }
}

/// Returns the next half-edge of the triangle: it starts at the corner where `half_edge` ends.
pub(crate) fn next_half_edge(half_edge: u32) -> u32 {
    if half_edge % 3 == 2 { half_edge - 2 } else { half_edge + 1 }
}

fn for_each_half_edge(corner_points: &[[u32; 3]], point_count: usize, mut visit: impl FnMut(u32, u32, u32)) {
    for (triangle, &[a, b, c]) in corner_points.iter().enumerate() {
        let in_range = (a.max(b).max(c) as usize) < point_count;
        if in_range && a != b && b != c && c != a {
            let first = 3 * triangle as u32;
            visit(first, a, b);
            visit(first + 1, b, c);
            visit(first + 2, c, a);
        }
    }
}

/// Key sorting by high end, then direction, then half-edge. Points are below 2^30, so all three fit.
fn key(half_edge: u32, from: u32, to: u32) -> u64 {
    u64::from(from.max(to)) << 33 | u64::from(from > to) << 32 | u64::from(half_edge)
}

fn high_end(key: u64) -> u32 {
    (key >> 33) as u32
}

fn is_backward(key: u64) -> bool {
    key >> 32 & 1 == 1
}
