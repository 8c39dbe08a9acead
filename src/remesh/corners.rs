//! The corners of all cells of a level, numbered: corners on an edge of the base once, whatever the face they are seen from.

use crate::mesh::Mesh;
use crate::wavelet::DomainPoint;

use super::cells::{BaseEdges, Cell};

/// A corner of a cell, by kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Corner {
    /// A base vertex: this corner of the base face.
    Fixed(usize),
    /// On a side of the base face: the side, and the corner's number.
    Side(usize, u32),
    /// Inside a base face.
    Inner(u32),
}

/// Numbers of the corners of a level; base vertices have none.
#[derive(Debug, Clone)]
pub(super) struct Corners {
    pub level: usize,
    /// Per side of every base face the first number of its edge, and whether the side runs against the edge.
    sides: Vec<[(u32, bool); 3]>,
    /// Per edge the lowest base face there.
    homes: Vec<u32>,
    /// First number inside base face 0.
    inner: u32,
}

impl Corners {
    pub fn new(base: &Mesh, edges: &BaseEdges, level: usize) -> Self {
        let of_edge = (1u32 << level) - 1;
        let mut homes = vec![u32::MAX; edges.edge_count()];
        let sides = (0..base.triangles().len() as u32).map(|face| {
            [0, 1, 2].map(|side| {
                let edge = edges.edge(face, side);
                let home = &mut homes[edge as usize];
                *home = (*home).min(face);
                (edge * of_edge, !edges.is_forward(face, side))
            })
        });
        let sides = sides.collect();
        Self { level, sides, homes, inner: edges.edge_count() as u32 * of_edge }
    }

    /// Cells along a side of a base face.
    pub fn along(&self) -> u16 {
        1 << self.level
    }

    /// Number of corners, without base vertices.
    pub fn count(&self) -> usize {
        let n = u32::from(self.along());
        (self.inner + self.sides.len() as u32 * ((n - 1) * n.saturating_sub(2) / 2)) as usize
    }

    /// Returns what the corner (i, j) of a base face is.
    pub fn of(&self, face: u32, [i, j]: [u16; 2]) -> Corner {
        let n = u32::from(self.along());
        let (i, j) = (u32::from(i), u32::from(j));
        let (side, along) = match (i, j) {
            (0, 0) => return Corner::Fixed(0),
            _ if i == n => return Corner::Fixed(1),
            _ if j == n => return Corner::Fixed(2),
            (_, 0) => (0, i),
            _ if i + j == n => (1, j),
            (0, _) => (2, n - j),
            _ => {
                // Rows j = 1, 2, ... have n - 2, n - 3, ... corners.
                let row = (j - 1) * (2 * (n - 1) - j) / 2;
                return Corner::Inner(self.inner + face * ((n - 1) * (n - 2) / 2) + row + i - 1);
            }
        };
        let (first, against) = self.sides[face as usize][side];
        Corner::Side(side, first + if against { n - along } else { along } - 1)
    }

    /// Returns the corner nearest to a place on the base.
    pub fn at(&self, domain: &DomainPoint) -> Corner {
        let n = f64::from(self.along());
        self.of(domain.base_face, [1, 2].map(|k| (domain.barycentric[k] * n).round() as u16))
    }

    /// Returns the lowest base face at a corner on an edge.
    pub fn home(&self, corner: u32) -> u32 {
        self.homes[(corner / u32::from(self.along() - 1)) as usize]
    }

    /// Calls `visit` with every corner but base vertices once, seen from its lowest base face.
    pub fn for_all(&self, mut visit: impl FnMut(u32, [u16; 2], Corner, u32)) {
        let n = self.along();
        for face in 0..self.sides.len() as u32 {
            for i in 0..=n {
                for j in 0..=n - i {
                    match self.of(face, [i, j]) {
                        corner @ Corner::Inner(number) => visit(face, [i, j], corner, number),
                        corner @ Corner::Side(_, number) if self.home(number) == face => {
                            visit(face, [i, j], corner, number);
                        }
                        _ => {}
                    }
                }
            }
        }
    }

    /// Returns the corner on a side of another base face that lies on the corner of this side, if both run against each
    /// other.
    pub fn across(&self, [i, j]: [u16; 2], side: usize, to_side: usize) -> [u16; 2] {
        let n = self.along();
        let along = n - [i, j, n - j][side];
        [[along, 0], [n - along, along], [0, n - along]][to_side]
    }

    /// Returns the cells of a base face around a corner, each with the corner's number in it.
    pub fn cells(&self, face: u32, [i, j]: [u16; 2]) -> impl Iterator<Item = (Cell, usize)> {
        let n = i32::from(self.along());
        let (i, j) = (i32::from(i), i32::from(j));
        let around = [
            (i, j, false, 0),
            (i - 1, j, false, 1),
            (i, j - 1, false, 2),
            (i - 1, j - 1, true, 0),
            (i, j - 1, true, 1),
            (i - 1, j, true, 2),
        ];
        around
            .into_iter()
            .filter(move |&(i, j, down, _)| i >= 0 && j >= 0 && i + j < n - i32::from(down))
            .map(move |(i, j, down, k)| (Cell { base: face, i: i as u16, j: j as u16, down }, k))
    }

    /// Bytes of the arrays.
    pub fn memory(&self) -> usize {
        size_of_val(&self.sides[..]) + size_of_val(&self.homes[..])
    }
}

/// Barycentric coordinates of the corner (i, j) of a level.
pub(super) fn barycentric(level: usize, [i, j]: [u16; 2]) -> [f64; 3] {
    let [u, v] = [i, j].map(|x| f64::from(x) / (1u32 << level) as f64);
    [1.0 - u - v, u, v]
}
