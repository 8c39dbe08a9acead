//! Welding of nearly coincident positions: each snaps to a representative within a distance, found by a grid.
//!
//! ```text
//!     +-----------+-----------+      cells several distances wide: what is within the distance mostly lies in one cell,
//!     |           |    r      |      and in eight at most
//!     |         x |           |      r, s  representatives
//!     |     s     |           |      x     goes to the nearest of them within the distance, and is one itself where
//!     +-----------+-----------+            there is none
//! ```
//!
//! Items are processed in order. A position snaps only to a representative, which never moves: no position moves by
//! more than the distance, however long a row of positions is. Cells are sorted, not hashed: no input makes them
//! collide.

use crate::geometry::boxes;

use super::{Edges, Mesh, NONE, Topology};

/// Border points merge only within this share of the shortest edge at either: far less than where a cut starts to
/// matter.
const SHARE_OF_EDGE: f64 = 0.25;
/// More than the distance between any two positions of single precision.
const FARTHEST: f64 = 2e39;

/// The grid: side of a cell in units of the distance, and how many representatives per cell are compared, the latest
/// first.
struct Grid {
    side: f64,
    most: usize,
}

/// For representatives at least the distance apart: a cell holds at most a few hundred.
const DENSE: Grid = Grid { side: 4.0, most: usize::MAX };
/// For positions of which hardly any two lie within the distance. Pairs held apart may crowd a cell in any number.
const SPARSE: Grid = Grid { side: 16.0, most: 64 };

/// Returns the representative of each position: the nearest earlier representative within `distance` and within the
/// `reach` of both, or the position itself. O(n log n).
fn representatives(
    positions: &[[f32; 3]],
    distance: f64,
    grid: &Grid,
    reach: impl Fn(usize) -> f64,
) -> Vec<u32> {
    let mut representative: Vec<u32> = (0..positions.len() as u32).collect();
    // No two different single-precision numbers are closer than this.
    if distance.is_nan() || distance < f64::from(f32::from_bits(1)) {
        return representative;
    }
    let distance = distance.min(FARTHEST);
    // Adding zero turns a negative zero into a positive one.
    let cell = |p: [f64; 3]| p.map(|x| (x / (grid.side * distance)).floor() + 0.0);
    let before = |a: &[f64; 3], b: &[f64; 3]| {
        a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])).then(a[2].total_cmp(&b[2]))
    };
    let items = (0..).zip(positions);
    let mut sorted: Vec<([f64; 3], u32)> = items.map(|(item, p)| (cell(p.map(f64::from)), item)).collect();
    sorted.sort_unstable_by(|a, b| before(&a.0, &b.0).then(a.1.cmp(&b.1)));
    let mut cells: Vec<[f64; 3]> = Vec::new();
    let mut cell_of = vec![0_u32; positions.len()];
    for (key, item) in sorted {
        if cells.last() != Some(&key) {
            cells.push(key);
        }
        cell_of[item as usize] = cells.len() as u32 - 1;
    }

    // Per cell its latest representative; per representative the previous representative in its cell.
    let mut latest = vec![NONE; cells.len()];
    let mut earlier = vec![NONE; positions.len()];
    let some = |item: u32| (item != NONE).then_some(item);
    for (item, &position) in positions.iter().enumerate() {
        let own = cell_of[item] as usize;
        let mut nearest: Option<(f64, u32)> = None;
        let mut look_at = |slot: usize| {
            let all = std::iter::successors(some(latest[slot]), |&r| some(earlier[r as usize]));
            for other in all.take(grid.most) {
                let apart = boxes::distance(positions[other as usize], position);
                let within = apart <= distance.min(reach(item)).min(reach(other as usize));
                if within && nearest.is_none_or(|(least, r)| apart < least || apart == least && other < r) {
                    nearest = Some((apart, other));
                }
            }
        };
        // Slightly more than the distance, for rounding.
        let ends = [-1.000_001, 1.000_001].map(|d| cell(position.map(|x| f64::from(x) + d * distance)));
        for corner in 0..8 {
            let axes = [0, 1, 2].map(|axis| corner >> axis & 1);
            // Where both ends lie in the same cell, visit it once.
            if (0..3).any(|axis| axes[axis] == 1 && ends[0][axis] == ends[1][axis]) {
                continue;
            }
            let key = [0, 1, 2].map(|axis| ends[axes[axis]][axis]);
            if key == cells[own] {
                look_at(own);
            } else if let Ok(slot) = cells.binary_search_by(|c| before(c, &key)) {
                look_at(slot);
            }
        }
        match nearest {
            Some((_, other)) => representative[item] = other,
            None => earlier[item] = std::mem::replace(&mut latest[own], item as u32),
        }
    }
    representative
}

/// Returns the twin of each point, or the point itself: an earlier point on an open border, within `distance` and
/// within a quarter of the shortest edge at either. O(triangles + border log border).
pub(crate) fn border_twins(
    mesh: &Mesh,
    topology: &Topology,
    is_border: impl Fn(u32) -> bool,
    distance: f64,
) -> Vec<u32> {
    let points = topology.point_count();
    let mut twin: Vec<u32> = (0..points as u32).collect();
    let border: Vec<u32> = (0..points as u32).filter(|&point| is_border(point)).collect();
    if border.is_empty() || distance.is_nan() || distance <= 0.0 {
        return twin;
    }
    let place = |point: u32| mesh.positions()[topology.vertex_of_point()[point as usize] as usize];
    let positions: Vec<[f32; 3]> = border.iter().map(|&point| place(point)).collect();
    // Mostly there are no twins, and edges need not be visited.
    let all = representatives(&positions, distance, &SPARSE, |_| distance);
    if all.iter().zip(0..).all(|(&to, item)| to == item) {
        return twin;
    }
    let mut looked_at = vec![false; points];
    border.iter().for_each(|&point| looked_at[point as usize] = true);
    let mut shortest = vec![f64::INFINITY; points];
    for corners in mesh.triangles() {
        let corners = corners.map(|v| topology.point_of()[v as usize]);
        for (i, &a) in corners.iter().enumerate() {
            let b = corners[(i + 1) % 3];
            if a != b && (looked_at[a as usize] || looked_at[b as usize]) {
                let length = boxes::distance(place(a), place(b));
                for end in [a, b] {
                    shortest[end as usize] = shortest[end as usize].min(length);
                }
            }
        }
    }
    let reach = |item: usize| SHARE_OF_EDGE * shortest[border[item] as usize];
    let to = representatives(&positions, distance, &SPARSE, reach);
    for (&point, &to) in border.iter().zip(&to) {
        twin[point as usize] = border[to as usize];
    }
    twin
}

/// Returns the number of border points with a twin, and the distance that welds them. Searches within 1e-6 of the
/// diagonal, or [`rounding`] if that is more.
pub(super) fn near_twins(mesh: &Mesh, topology: &Topology, edges: &Edges) -> (usize, f64) {
    let mut is_border = vec![false; topology.point_count()];
    for edge in (0..edges.len() as u32).filter(|&edge| edges.is_border(edge)) {
        edges.ends()[edge as usize].iter().for_each(|&point| is_border[point as usize] = true);
    }
    let distance = (1e-6 * mesh.diagonal()).max(rounding(mesh, super::Tolerances::default().position));
    let twin = border_twins(mesh, topology, |point| is_border[point as usize], distance);
    let place = |point: u32| mesh.positions()[topology.vertex_of_point()[point as usize] as usize];
    let pairs = || (0..).zip(&twin).filter(|&(point, &to)| point != to).map(|(point, &to)| [point, to]);
    let farthest = pairs().map(|[point, to]| boxes::distance(place(point), place(to))).fold(0.0, f64::max);
    (pairs().count(), farthest)
}

/// Returns `steps` times 2^-23 of the largest coordinate in use, object units.
pub(crate) fn rounding(mesh: &Mesh, steps: f32) -> f64 {
    let largest =
        mesh.bounds().map_or(0.0, |box_| box_.as_flattened().iter().fold(0.0, |m: f32, x| m.max(x.abs())));
    f64::from(steps) * f64::from(f32::EPSILON) * f64::from(largest)
}

impl Mesh {
    /// Moves vertices within `distance` (object units) of each other to equal positions: they become a single point,
    /// and cracks between parts meant to touch close. O(n log n).
    ///
    /// Processes points in ascending order. Each point moves to the nearest earlier unmoved point within `distance`, or
    /// stays. No point moves by more than `distance`, and a row of close vertices does not collapse to a point. All
    /// vertices and triangles stay. Where attributes differ at a point, it has several wedges. Triangles shorter than
    /// `distance` become degenerate; structures do not draw degenerate triangles. A distance of 0, below 0 or NaN
    /// changes nothing.
    ///
    /// ```
    /// use multires::mesh::{Mesh, Report};
    ///
    /// // Two triangles whose common edge was computed twice.
    /// let positions = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1e-7, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 1e-7]];
    /// let mesh = Mesh::new(positions, [[0, 1, 2], [3, 4, 5]])?;
    /// assert_eq!(Report::welded(&mesh).border_edges, 6);
    /// assert_eq!(Report::welded(&mesh.welded(1e-6)).border_edges, 4);
    /// # Ok::<(), multires::MeshError>(())
    /// ```
    #[must_use]
    pub fn welded(&self, distance: f64) -> Self {
        let topology = Topology::new(self);
        let at: Vec<[f32; 3]> =
            topology.vertex_of_point().iter().map(|&v| self.positions[v as usize]).collect();
        let to = representatives(&at, distance, &DENSE, |_| distance);
        // A point that stays keeps its bits, negative zeros too.
        let place = |(position, &point): (&[f32; 3], &u32)| match to[point as usize] {
            own if own == point => *position,
            other => at[other as usize],
        };
        let positions = self.positions.iter().zip(topology.point_of()).map(place).collect();
        Self { positions, ..self.clone() }
    }
}
