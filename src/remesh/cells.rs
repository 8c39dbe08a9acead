//! Cells: the faces of a base subdivided four to one, by number; and their neighbours, across base edges too.
//!
//! ```text
//!     j                            Corner (i, j) of level l has barycentric coordinates
//!     2 +                          (1 - u - v, u, v) with u = i / 2^l, v = j / 2^l.
//!       |\
//!     1 +--+                       An upward cell (i, j) has the corners (i, j), (i + 1, j), (i, j + 1),
//!       |\ |\                      a downward cell (i, j) the corners (i + 1, j + 1), (i, j + 1), (i + 1, j).
//!     0 +--+--+
//!       0  1  2 i                  Side k of a cell runs from its corner k to its corner k + 1.
//! ```

use crate::mesh::{Edges, Mesh, NONE, Topology};

/// Deepest level: numbers of corners have 15 bits.
pub(super) const DEEPEST: usize = 14;

/// A face of some level. Ordered by base face.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Cell {
    pub base: u32,
    pub i: u16,
    pub j: u16,
    pub down: bool,
}

impl Cell {
    pub fn base(base: u32) -> Self {
        Self { base, i: 0, j: 0, down: false }
    }

    /// Returns all cells of a level.
    pub fn of_level(base: u32, level: usize) -> impl Iterator<Item = Self> {
        let n = 1u16 << level;
        let row = move |j: u16| {
            let down = move |i: u16| (i + j + 1 < n).then_some(Self { base, i, j, down: true });
            (0..n - j).flat_map(move |i| [Some(Self { base, i, j, down: false }), down(i)])
        };
        (0..n).flat_map(row).flatten()
    }

    /// Numbers of the corners.
    pub fn corners(self) -> [[u16; 2]; 3] {
        let (i, j) = (self.i, self.j);
        match self.down {
            false => [[i, j], [i + 1, j], [i, j + 1]],
            true => [[i + 1, j + 1], [i, j + 1], [i + 1, j]],
        }
    }

    /// Returns the cell of a level with these barycentric coordinates at its corners.
    pub fn of_corners(base: u32, level: usize, barycentric: &[[f64; 3]; 3]) -> Self {
        let n = (1u32 << level) as f64;
        let of = |k: usize| barycentric.map(|corner| (corner[k] * n).round() as u16);
        let (i, j) = (of(1).into_iter().min().unwrap_or(0), of(2).into_iter().min().unwrap_or(0));
        // An upward cell has its least numbers at the same corner.
        let down =
            !barycentric.iter().any(|c| (c[1] * n).round() as u16 == i && (c[2] * n).round() as u16 == j);
        Self { base, i, j, down }
    }

    /// Returns the cell of a level that contains a point of the base face.
    pub fn at(base: u32, level: usize, weights: [f64; 3]) -> Self {
        let n = (1u32 << level) as f64;
        let most = n - 1.0;
        let (u, v) = (weights[1] * n, weights[2] * n);
        let (i, j) = (u.floor().clamp(0.0, most), v.floor().clamp(0.0, most));
        // Beyond the last diagonal there are no cells.
        let over = (i + j - most).max(0.0);
        let (i, j) = if u - i < v - j { ((i - over).max(0.0), j) } else { (i, (j - over).max(0.0)) };
        let down = (u - i) + (v - j) > 1.0 && i + j < most;
        Self { base, i: i as u16, j: j as u16, down }
    }

    /// Returns the barycentric coordinates, in this cell of a level, of a point of the base face.
    pub fn weights(self, level: usize, weights: [f64; 3]) -> [f64; 3] {
        let n = (1u32 << level) as f64;
        let (u, v) = (weights[1] * n - f64::from(self.i), weights[2] * n - f64::from(self.j));
        match self.down {
            false => [1.0 - u - v, u, v],
            true => [u + v - 1.0, 1.0 - u, 1.0 - v],
        }
    }

    /// Returns the point of the base face at barycentric coordinates in this cell of a level.
    pub fn point(self, level: usize, weights: [f64; 3]) -> [f64; 3] {
        let scale = 1.0 / (1u32 << level) as f64;
        let corners = self.corners();
        let sum = |axis: usize| (0..3).map(|k| weights[k] * f64::from(corners[k][axis])).sum::<f64>() * scale;
        let (u, v) = (sum(0), sum(1));
        [1.0 - u - v, u, v]
    }

    /// Returns the four cells of the next level: at the corners, then the middle.
    pub fn children(self) -> [Self; 4] {
        let Self { base, i, j, down } = self;
        let (i, j) = (2 * i, 2 * j);
        let cell = |i, j, down| Self { base, i, j, down };
        match down {
            false => [cell(i, j, false), cell(i + 1, j, false), cell(i, j + 1, false), cell(i, j, true)],
            true => [
                cell(i + 1, j + 1, true),
                cell(i, j + 1, true),
                cell(i + 1, j, true),
                cell(i + 1, j + 1, false),
            ],
        }
    }

    /// Returns the cell of the level before.
    pub fn parent(self) -> Self {
        let Self { base, i, j, down } = self;
        let odd = (i & 1) + (j & 1);
        // Upward parents have three upward children at even sums, downward parents have one, in the middle.
        let down = match down {
            false => odd == 2,
            true => odd != 0,
        };
        Self { base, i: i / 2, j: j / 2, down }
    }

    /// Returns the cell across a side, in the same base face; `None` at a side of the base face, with the side of the base
    /// face.
    pub fn across(self, level: usize, side: usize) -> Result<Self, usize> {
        let Self { base, i, j, down } = self;
        let last = (1u32 << level) as u16 - 1;
        let cell = |i, j| Ok(Self { base, i, j, down: !down });
        match (down, side) {
            (false, 0) if j == 0 => Err(0),
            (false, 0) => cell(i, j - 1),
            (false, 1) if i + j == last => Err(1),
            (false, 1) => cell(i, j),
            (false, _) if i == 0 => Err(2),
            (false, _) => cell(i - 1, j),
            (true, 0) => cell(i, j + 1),
            (true, 1) => cell(i, j),
            (true, _) => cell(i + 1, j),
        }
    }

    /// Returns the number of an upward cell at a side of its base face, counted along the side.
    pub fn along(self, level: usize, side: usize) -> u16 {
        match side {
            0 => self.i,
            1 => self.j,
            _ => (1u32 << level) as u16 - 1 - self.j,
        }
    }

    /// Returns the upward cell with a number along a side of a base face.
    pub fn at_side(base: u32, level: usize, side: usize, along: u16) -> Self {
        let last = (1u32 << level) as u16 - 1;
        let (i, j) = match side {
            0 => (along, 0),
            1 => (last - along, along),
            _ => (0, last - along),
        };
        Self { base, i, j, down: false }
    }
}

/// A side of another base face on the same edge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Neighbour {
    pub face: u32,
    pub side: usize,
    /// Whether both sides run the same way: the faces are not oriented alike.
    pub same_way: bool,
}

/// Base faces across the sides of base faces.
#[derive(Debug, Clone)]
pub(super) struct BaseEdges {
    edges: Edges,
    of_side: Vec<[u32; 3]>,
}

impl BaseEdges {
    pub fn new(base: &Mesh) -> Self {
        let topology = Topology::new(base);
        let points: Vec<[u32; 3]> =
            base.triangles().iter().map(|t| t.map(|v| topology.point_of()[v as usize])).collect();
        let edges = Edges::new(&points, topology.point_count());
        let of_side = edges.of_half_edges(points.len());
        Self { edges, of_side }
    }

    /// Edge of a side.
    pub fn edge(&self, face: u32, side: usize) -> u32 {
        self.of_side[face as usize][side]
    }

    /// Returns which sides of base faces are features: borders, and edges beside which faces have other vertices (one for each
    /// side of a feature, at one end at least).
    pub fn features(&self, base: &Mesh) -> Vec<[bool; 3]> {
        let triangles = base.triangles();
        let ends = |face: u32, from: usize, to: usize| [from, to].map(|k| triangles[face as usize][k % 3]);
        let is_feature = |face: u32, side: usize| {
            let mut across = self.across(face, side);
            let first = across.next();
            first.is_none_or(|to| {
                across.next().is_some()
                    || to.same_way
                    || ends(to.face, to.side + 1, to.side) != ends(face, side, side + 1)
            })
        };
        (0..triangles.len() as u32).map(|face| [0, 1, 2].map(|side| is_feature(face, side))).collect()
    }

    /// Whether a side runs from the low end of its edge to the high end.
    pub fn is_forward(&self, face: u32, side: usize) -> bool {
        let edge = self.edge(face, side);
        edge != NONE && self.edges.forward(edge).contains(&(3 * face + side as u32))
    }

    pub fn edge_count(&self) -> usize {
        self.edges.len()
    }

    /// All sides on the edge of a side, but the side itself.
    pub fn across(&self, face: u32, side: usize) -> impl Iterator<Item = Neighbour> + '_ {
        let own = 3 * face + side as u32;
        let edge = self.edge(face, side);
        let (forward, backward) = match edge {
            NONE => (&[][..], &[][..]),
            edge => (self.edges.forward(edge), self.edges.backward(edge)),
        };
        let is_forward = forward.contains(&own);
        let neighbour = move |&h: &u32, of_forward: bool| Neighbour {
            face: h / 3,
            side: (h % 3) as usize,
            same_way: of_forward == is_forward,
        };
        let of = move |list: &'_ [u32], of_forward: bool| {
            list.iter().filter(move |&&h| h != own).map(move |h| neighbour(h, of_forward)).collect::<Vec<_>>()
        };
        of(forward, true).into_iter().chain(of(backward, false))
    }

    /// Calls `visit` with every cell across a side of a cell.
    pub fn for_neighbours(&self, cell: Cell, level: usize, side: usize, mut visit: impl FnMut(Cell)) {
        match cell.across(level, side) {
            Ok(cell) => visit(cell),
            Err(side) => {
                let along = cell.along(level, side);
                let last = (1u32 << level) as u16 - 1;
                for to in self.across(cell.base, side) {
                    let along = if to.same_way { along } else { last - along };
                    visit(Cell::at_side(to.face, level, to.side, along));
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::shapes;

    #[test]
    fn cells_of_a_level_are_the_children_of_the_level_before() {
        let mut cells = vec![Cell::base(0)];
        for level in 0..4 {
            let next: Vec<Cell> = cells.iter().flat_map(|cell| cell.children()).collect();
            assert!(next.iter().all(|cell| cells.contains(&cell.parent())));
            for (cell, child) in cells.iter().flat_map(|cell| cell.children().map(|child| (*cell, child))) {
                assert_eq!(child.parent(), cell);
                let middle = child.point(level + 1, [1.0 / 3.0; 3]);
                assert_eq!(Cell::at(0, level + 1, middle), child);
                assert_eq!(Cell::at(0, level, middle), cell);
                assert!(cell.weights(level, middle).iter().all(|&weight| weight > 0.1));
                let corners =
                    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|w| child.point(level + 1, w));
                assert_eq!(Cell::of_corners(0, level + 1, &corners), child);
            }
            cells = next;
            let distinct: std::collections::BTreeSet<Cell> = cells.iter().copied().collect();
            assert_eq!(distinct.len(), 4usize.pow(level as u32 + 1));
            assert_eq!(Cell::of_level(0, level + 1).collect::<std::collections::BTreeSet<Cell>>(), distinct);
        }
    }

    #[test]
    fn neighbours_share_two_corners() {
        let base = shapes::icosphere(0);
        let edges = BaseEdges::new(&base);
        let at = |cell: Cell, level: usize, [i, j]: [u16; 2]| {
            let scale = 1.0 / f64::from(1 << level);
            let w = [1.0 - f64::from(i + j) * scale, f64::from(i) * scale, f64::from(j) * scale];
            let corners = base.triangles()[cell.base as usize].map(|v| base.positions()[v as usize]);
            [0, 1, 2].map(|axis| {
                ((0..3).map(|k| w[k] * f64::from(corners[k][axis])).sum::<f64>() * 1e4).round() as i64
            })
        };
        for level in 0..4 {
            for base_face in [0, 7, 19] {
                let mut cells = vec![Cell::base(base_face)];
                (0..level).for_each(|_| cells = cells.iter().flat_map(|cell| cell.children()).collect());
                for cell in cells {
                    for side in 0..3 {
                        let ends = [side, (side + 1) % 3].map(|k| at(cell, level, cell.corners()[k]));
                        let mut count = 0;
                        edges.for_neighbours(cell, level, side, |other| {
                            count += 1;
                            let corners = other.corners().map(|corner| at(other, level, corner));
                            assert!(
                                ends.iter().all(|end| corners.contains(end)),
                                "{cell:?} {side} {other:?}"
                            );
                        });
                        assert_eq!(count, 1);
                    }
                }
            }
        }
    }
}
