//! Positions that nearly coincide: each snapped to a representative within a distance, by a grid.
//!
//! ```text
//!     +-----+-----+-----+      cells as wide as the distance: what is within it lies in the 27 cells around
//!     |     | r   |     |      r, s  representatives
//!     |     |  x  |     |      x     goes to the nearest of them within the distance
//!     |     |     | s   |            and is one itself where there is none
//!     +-----+-----+-----+
//! ```
//!
//! Items are looked at in order, and a position is only ever snapped to one that stays where it is: so nothing moves by
//! more than the distance, however long a row of positions is. Cells are sorted, not hashed: no input makes them collide.

use super::{Edges, Mesh, NONE, Topology};

/// Representatives of a cell that are looked at. Those within one distance of each other are 27 at most; only where pairs
/// are held apart can there be more.
const MOST_IN_CELL: usize = 64;

/// Border points are one within this share of the shortest edge at either: far less than where a cut starts to matter.
const SHARE_OF_EDGE: f64 = 0.25;

/// For each position the one whose place it takes, an earlier one or itself: the nearest representative within the lesser
/// of both positions' reaches, which are at most `distance`. O(n log n).
fn representatives(positions: &[[f32; 3]], distance: f64, reach: impl Fn(usize) -> f64) -> Vec<u32> {
    let own = || (0..positions.len() as u32).collect();
    // Between different numbers of single precision there is no less.
    if distance.is_nan() || distance < f64::from(f32::from_bits(1)) {
        return own();
    }
    let cell = |p: &[f32; 3]| p.map(|x| (f64::from(x) / distance).floor() + 0.0);
    let before = |a: &[f64; 3], b: &[f64; 3]| {
        a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])).then(a[2].total_cmp(&b[2]))
    };
    let mut cells: Vec<[f64; 3]> = positions.iter().map(cell).collect();
    cells.sort_unstable_by(before);
    cells.dedup();
    // Per cell its latest representative, and per representative the one before it in its cell.
    let mut latest = vec![NONE; cells.len()];
    let mut earlier = vec![NONE; positions.len()];
    let mut representative: Vec<u32> = own();
    for (item, position) in positions.iter().enumerate() {
        let at = cell(position);
        let mut nearest: Option<(f64, u32)> = None;
        for x in -1..=1 {
            for y in -1..=1 {
                // The three cells above each other follow each other, if they are there.
                let column = [at[0] + f64::from(x), at[1] + f64::from(y), at[2]];
                let first =
                    cells.partition_point(|c| before(c, &[column[0], column[1], at[2] - 1.0]).is_lt());
                let near = cells[first..]
                    .iter()
                    .take(3)
                    .enumerate()
                    .take_while(|(_, c)| c[0] == column[0] && c[1] == column[1] && c[2] <= at[2] + 1.0);
                for (i, _) in near {
                    let some = |item: u32| (item != NONE).then_some(item);
                    let all = std::iter::successors(some(latest[first + i]), |&r| some(earlier[r as usize]));
                    for other in all.take(MOST_IN_CELL) {
                        let apart = apart(positions[other as usize], *position);
                        let within = apart <= distance.min(reach(item)).min(reach(other as usize));
                        let closer =
                            nearest.is_none_or(|(least, r)| apart < least || apart == least && other < r);
                        if within && closer {
                            nearest = Some((apart, other));
                        }
                    }
                }
            }
        }
        match nearest {
            Some((_, other)) => representative[item] = other,
            None => {
                let slot = cells.partition_point(|c| before(c, &at).is_lt());
                earlier[item] = std::mem::replace(&mut latest[slot], item as u32);
            }
        }
    }
    representative
}

fn apart(a: [f32; 3], b: [f32; 3]) -> f64 {
    (0..3).map(|i| (f64::from(a[i]) - f64::from(b[i])).powi(2)).sum::<f64>().sqrt()
}

/// For each point the one on whose place it falls, itself where there is none: points on open borders that lie within
/// `distance` of each other and within a quarter of the shortest edge at either. O(triangles + border log border).
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
    let mut looked_at = vec![false; points];
    border.iter().for_each(|&point| looked_at[point as usize] = true);
    let mut shortest = vec![f64::INFINITY; points];
    for corners in mesh.triangles() {
        let corners = corners.map(|v| topology.point_of()[v as usize]);
        for (i, &a) in corners.iter().enumerate() {
            let b = corners[(i + 1) % 3];
            if a != b && (looked_at[a as usize] || looked_at[b as usize]) {
                let length = apart(place(a), place(b));
                for end in [a, b] {
                    shortest[end as usize] = shortest[end as usize].min(length);
                }
            }
        }
    }
    let positions: Vec<[f32; 3]> = border.iter().map(|&point| place(point)).collect();
    let reach = |item: usize| SHARE_OF_EDGE * shortest[border[item] as usize];
    let to = representatives(&positions, distance, reach);
    for (&point, &to) in border.iter().zip(&to) {
        twin[point as usize] = border[to as usize];
    }
    twin
}

/// Border points that nearly coincide with another, and the distance that would weld them; looked for up to 1e-6 of the
/// diagonal, or [`rounding`] where that is more.
pub(super) fn near_twins(mesh: &Mesh, topology: &Topology, edges: &Edges) -> (usize, f64) {
    let mut is_border = vec![false; topology.point_count()];
    for edge in (0..edges.len() as u32).filter(|&edge| edges.is_border(edge)) {
        edges.ends()[edge as usize].iter().for_each(|&point| is_border[point as usize] = true);
    }
    let distance = (1e-6 * mesh.diagonal()).max(rounding(mesh, super::Tolerances::default().position));
    let twin = border_twins(mesh, topology, |point| is_border[point as usize], distance);
    let place = |point: u32| mesh.positions()[topology.vertex_of_point()[point as usize] as usize];
    let pairs = || (0..).zip(&twin).filter(|&(point, &to)| point != to).map(|(point, &to)| [point, to]);
    let farthest = pairs().map(|[point, to]| apart(place(point), place(to))).fold(0.0, f64::max);
    (pairs().count(), farthest)
}

/// So many steps of 2^-23 of the largest coordinate in use, object units.
pub(crate) fn rounding(mesh: &Mesh, steps: f32) -> f64 {
    let largest =
        mesh.bounds().map_or(0.0, |box_| box_.as_flattened().iter().fold(0.0, |m: f32, x| m.max(x.abs())));
    f64::from(steps) * f64::from(f32::EPSILON) * f64::from(largest)
}

impl Mesh {
    /// The mesh with positions that lie within `distance` (object units) of each other made equal, so that they are one
    /// point: cracks between parts that were meant to touch close.
    ///
    /// In the order of their numbers, each point takes the place of the nearest earlier one within the distance that kept
    /// its own, or keeps its own. So none moves by more than `distance`, and a row of close vertices does not fall
    /// into one. Vertices stay as many, with their attributes: where these differ, the point has several wedges. Triangles
    /// stay too; those shorter than the distance become degenerate, which no structure draws. A distance that is 0, below
    /// or no number changes nothing. O(n log n).
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
        let to = representatives(&at, distance, |_| distance);
        // Positions that keep their place keep their bits, negative zeros too.
        let place = |(position, &point): (&[f32; 3], &u32)| match to[point as usize] {
            own if own == point => *position,
            other => at[other as usize],
        };
        let positions = self.positions.iter().zip(topology.point_of()).map(place).collect();
        Self { positions, ..self.clone() }
    }
}
