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
use super::corners::{Corner, Corners, barycentric};
use super::layout::Place;

/// Where the corners of the cells of a level go.
#[derive(Debug, Clone)]
pub(super) struct Warp {
    pub corners: Corners,
    pub charts: Charts,
    /// Per corner the place in the chart of its home.
    pub places: Vec<DVec2>,
}

impl Warp {
    /// The identity.
    pub fn new(base: &Mesh, edges: &BaseEdges, level: usize, charts: Charts) -> Self {
        let corners = Corners::new(base, edges, level);
        let mut places = vec![DVec2::ZERO; corners.count()];
        corners.for_all(|face, at, _, number| {
            places[number as usize] = charts.point(face, barycentric(level, at));
        });
        Self { corners, charts, places }
    }

    fn level(&self) -> usize {
        self.corners.level
    }

    /// Returns the place of a corner of cells of a base face in the face's chart.
    pub fn in_chart(&self, face: u32, at: [u16; 2]) -> DVec2 {
        match self.corners.of(face, at) {
            Corner::Fixed(k) => self.charts.corners(face)[k],
            Corner::Inner(corner) => self.places[corner as usize],
            Corner::Side(side, corner) => match self.charts.beyond(face, side) {
                _ if self.corners.home(corner) == face => self.places[corner as usize],
                Some(beyond) => beyond.motion.apply(self.places[corner as usize]),
                // Points of features stay where they are.
                None => self.charts.point(face, barycentric(self.level(), at)),
            },
        }
    }

    /// Returns the corners of a cell in the chart of its base face.
    pub fn cell(&self, cell: Cell) -> [DVec2; 3] {
        cell.corners().map(|at| self.in_chart(cell.base, at))
    }

    /// Maps a point of the base.
    pub fn apply(&self, place: Place) -> Place {
        let cell = Cell::at(place.face, self.level(), place.weights);
        let weights = cell.weights(self.level(), place.weights);
        let [a, b, c] = self.cell(cell);
        self.charts.locate(place.face, weights[0] * a + weights[1] * b + weights[2] * c).0
    }

    /// Returns the point of the base that is mapped to a point. Walks over the cells from the point itself; O(cells of a base
    /// face) at worst.
    pub fn undo(&self, place: Place) -> Place {
        let mut cell = Cell::at(place.face, self.level(), place.weights);
        let mut point = self.charts.point(place.face, place.weights);
        let mut best = (f64::NEG_INFINITY, place);
        for _ in 0..8 << self.level() {
            let weights = weights_in(self.cell(cell), point);
            let (least, corner) = least_of(weights);
            if least > best.0 {
                let inside = cell.point(self.level(), clamped(weights));
                best = (least, Place { face: cell.base, weights: clamped(inside) });
            }
            if least >= 0.0 {
                break;
            }
            // Across the side opposite of the corner.
            match cell.across(self.level(), (corner + 1) % 3) {
                Ok(next) => cell = next,
                Err(side) => {
                    let Some(beyond) = self.charts.beyond(cell.base, side) else { break };
                    point = beyond.motion.undo(point);
                    let last = (1u32 << self.level()) as u16 - 1;
                    let along = last - cell.along(self.level(), side);
                    cell = Cell::at_side(beyond.face, self.level(), beyond.side, along);
                }
            }
        }
        best.1
    }

    /// Bytes of the arrays.
    pub fn memory(&self) -> usize {
        self.charts.memory() + self.corners.memory() + size_of_val(&self.places[..])
    }
}
