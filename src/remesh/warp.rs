//! A map of the base onto itself, linear on the cells of a level: moves cells so that their images on the mesh are even.
//!
//! ```text
//!        /\                    /\           Base vertices and points of features stay. Other corners of cells move, across
//!       /__\                  / _\          edges of the base too, by at most one base face; each cell stays face up in the
//!      /\  /\      --->      /\/ /\         chart of its base face, so the map is one to one.
//!     /__\/__\              /_/\/__\
//! ```

use glam::DVec2;

use crate::mesh::Mesh;

use super::cells::{BaseEdges, Cell};
use super::charts::{Charts, clamped, least_of, weights_in};
use super::layout::Place;

/// Where the corners of the cells of a level go.
#[derive(Debug, Clone)]
pub(super) struct Warp {
    pub level: usize,
    pub charts: Charts,
    /// Per side of every base face the first of its inner corners, in the direction of the edge, and whether the side runs
    /// the other way.
    sides: Vec<[(u32, bool); 3]>,
    /// First inner corner of base face 0.
    inner: u32,
    /// Per corner but base vertices the place in the chart of its home.
    places: Vec<DVec2>,
    /// Per edge the base face in whose chart its corners are placed.
    homes: Vec<u32>,
}

/// A corner of a cell, by kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Corner {
    /// A base vertex: the corner of the base face.
    Fixed(usize),
    /// On a side of the base face: the side, and the corner's number.
    Side(usize, u32),
    /// Inside a base face.
    Inner(u32),
}

impl Warp {
    /// The identity.
    pub fn new(base: &Mesh, edges: &BaseEdges, level: usize, charts: Charts) -> Self {
        let n = 1u32 << level;
        let faces = base.triangles().len() as u32;
        let mut homes = vec![u32::MAX; edges.edge_count()];
        let mut sides = Vec::with_capacity(faces as usize);
        for face in 0..faces {
            sides.push([0, 1, 2].map(|side| {
                let edge = edges.edge(face, side);
                let home = &mut homes[edge as usize];
                *home = (*home).min(face);
                (edge * (n - 1), !edges.is_forward(face, side))
            }));
        }
        let inner = edges.edge_count() as u32 * (n - 1);
        let of_face = (n - 1) * n.saturating_sub(2) / 2;
        let mut warp = Self {
            level,
            charts,
            sides,
            inner,
            places: vec![DVec2::ZERO; (inner + faces * of_face) as usize],
            homes,
        };
        for face in (0..faces).rev() {
            for i in 0..=n {
                for j in 0..=n - i {
                    let [u, v] = [i, j].map(|x| f64::from(x) / f64::from(n));
                    let place = warp.charts.point(face, [1.0 - u - v, u, v]);
                    // The home of an edge is its lowest face, which comes last.
                    match warp.corner(face, [i as u16, j as u16]) {
                        Corner::Fixed(_) => {}
                        Corner::Side(_, at) | Corner::Inner(at) => warp.places[at as usize] = place,
                    }
                }
            }
        }
        warp
    }

    /// Returns what the corner (i, j) of cells of a base face is.
    pub fn corner(&self, face: u32, [i, j]: [u16; 2]) -> Corner {
        let n = 1u32 << self.level;
        let (i, j) = (u32::from(i), u32::from(j));
        let side = match (i, j) {
            (0, 0) => return Corner::Fixed(0),
            _ if i == n => return Corner::Fixed(1),
            _ if j == n => return Corner::Fixed(2),
            (_, 0) => (0, i),
            _ if i + j == n => (1, j),
            (0, _) => (2, n - j),
            _ => {
                // Rows j = 1, 2, ... of n - 2, n - 3, ... corners.
                let row = (j - 1) * (2 * (n - 1) - j) / 2;
                let of_face = (n - 1) * (n - 2) / 2;
                return Corner::Inner(self.inner + face * of_face + row + i - 1);
            }
        };
        let (first, against) = self.sides[face as usize][side.0];
        let along = if against { n - side.1 } else { side.1 };
        Corner::Side(side.0, first + along - 1)
    }

    /// Base face in whose chart the corners of a side are placed.
    pub fn home(&self, corner: u32) -> u32 {
        self.homes[(corner / ((1 << self.level) - 1)) as usize]
    }

    /// Returns the place of a corner, by number, in the chart of its home.
    pub fn place(&self, corner: u32) -> DVec2 {
        self.places[corner as usize]
    }

    pub fn set_place(&mut self, corner: u32, place: DVec2) {
        self.places[corner as usize] = place;
    }

    /// Returns the place of a corner of cells of a base face in the face's chart.
    pub fn in_chart(&self, face: u32, at: [u16; 2]) -> DVec2 {
        match self.corner(face, at) {
            Corner::Fixed(k) => self.charts.corners(face)[k],
            Corner::Inner(corner) => self.place(corner),
            Corner::Side(side, corner) => {
                if self.home(corner) == face {
                    return self.place(corner);
                }
                match self.charts.beyond(face, side) {
                    Some(beyond) => beyond.motion.apply(self.place(corner)),
                    // Points of features stay where they are.
                    None => {
                        let n = f64::from(1u32 << self.level);
                        let [u, v] = at.map(|x| f64::from(x) / n);
                        self.charts.point(face, [1.0 - u - v, u, v])
                    }
                }
            }
        }
    }

    /// Returns the corners of a cell in the chart of its base face.
    pub fn cell(&self, cell: Cell) -> [DVec2; 3] {
        cell.corners().map(|at| self.in_chart(cell.base, at))
    }

    /// Maps a point of the base.
    pub fn apply(&self, place: Place) -> Place {
        let cell = Cell::at(place.face, self.level, place.weights);
        let weights = cell.weights(self.level, place.weights);
        let [a, b, c] = self.cell(cell);
        self.charts.locate(place.face, weights[0] * a + weights[1] * b + weights[2] * c).0
    }

    /// Returns the point of the base that is mapped to a point. Walks over the cells from the point itself; O(cells of a base
    /// face) at worst.
    pub fn undo(&self, place: Place) -> Place {
        let mut cell = Cell::at(place.face, self.level, place.weights);
        let mut point = self.charts.point(place.face, place.weights);
        let mut best = (f64::NEG_INFINITY, place);
        for _ in 0..8 << self.level {
            let weights = weights_in(self.cell(cell), point);
            let (least, corner) = least_of(weights);
            if least > best.0 {
                let inside = cell.point(self.level, clamped(weights));
                best = (least, Place { face: cell.base, weights: clamped(inside) });
            }
            if least >= 0.0 {
                break;
            }
            // Across the side opposite of the corner.
            match cell.across(self.level, (corner + 1) % 3) {
                Ok(next) => cell = next,
                Err(side) => {
                    let Some(beyond) = self.charts.beyond(cell.base, side) else { break };
                    point = beyond.motion.undo(point);
                    let last = (1u32 << self.level) as u16 - 1;
                    let along = last - cell.along(self.level, side);
                    cell = Cell::at_side(beyond.face, self.level, beyond.side, along);
                }
            }
        }
        best.1
    }

    /// Number of corners of cells but base vertices.
    pub fn corner_count(&self) -> usize {
        self.places.len()
    }

    /// Bytes of the arrays.
    pub fn memory(&self) -> usize {
        self.charts.memory()
            + size_of_val(&self.sides[..])
            + size_of_val(&self.places[..])
            + size_of_val(&self.homes[..])
    }
}
