//! Moves corners of cells that face away from the mesh.
//!
//! ```text
//!     b----c         b----c       The map is one to one, but a triangle whose corners lie beside fine folds of the mesh may
//!      \  /          | \ /|       face away from all of it. A corner is moved along the base, within the cells around it,
//!       \/a   --->   |  a |       until none of these cells faces away.
//! ```

use glam::DVec3;

use crate::geometry::parallel;
use crate::mesh::Mesh;
use crate::wavelet::DomainPoint;

use super::Parameterisation;
use super::cells::{BaseEdges, Cell};
use super::corners::{Corner, Corners, barycentric};

/// Passes over the cells that face away.
const PASSES: usize = 8;
/// Distances tried from where a corner is, in cells.
const DISTANCES: [f64; 5] = [0.1, 0.2, 0.4, 0.7, 1.0];

/// Corners that were moved, and cells that still face away.
#[derive(Debug, Clone, Default)]
pub(super) struct Unfolded {
    corners: Option<Corners>,
    /// Per moved corner its place on the base, ascending.
    moved: Vec<(u32, DomainPoint)>,
    /// Cells facing away before, and after.
    pub folded: [usize; 2],
}

impl Unfolded {
    /// Returns where the mesh is to be looked up for a place on the base.
    pub fn apply(&self, domain: &DomainPoint) -> DomainPoint {
        let Some(corners) = &self.corners else { return *domain };
        let (Corner::Inner(number) | Corner::Side(_, number)) = corners.at(domain) else { return *domain };
        let found = self.moved.binary_search_by_key(&number, |moved| moved.0);
        found.map_or(*domain, |at| self.moved[at].1)
    }
}

/// Finds cells of a level that face away from the mesh, and moves their corners.
pub(super) fn unfold(map: &Parameterisation, mesh: &Mesh, level: usize) -> Unfolded {
    let faces = map.base().triangles().len();
    let found = parallel::map(faces, 1, |face| {
        let of_face = Folds { map, mesh, level, corners: None, moved: Vec::new() };
        let rows = map.rows(mesh, face as u32, level);
        let is_folded = |&cell: &Cell| {
            let points = cell.corners().map(|[i, j]| rows[usize::from(j)][usize::from(i)]);
            of_face.fold_of(cell, points) > 0.0
        };
        Cell::of_level(face as u32, level).filter(is_folded).collect::<Vec<Cell>>()
    });
    let folded: Vec<Cell> = found.into_iter().flatten().collect();
    if folded.is_empty() {
        return Unfolded::default();
    }
    let edges = BaseEdges::new(map.base());
    let corners = Corners::new(map.base(), &edges, level);
    let mut folds = Folds { map, mesh, level, corners: Some(&corners), moved: Vec::new() };
    let mut left = folded.clone();
    for _ in 0..PASSES {
        let mut near = left.clone();
        for &cell in &left {
            folds.mend(&edges, cell, &mut near);
        }
        near.sort_unstable();
        near.dedup();
        left = near.into_iter().filter(|&cell| folds.is_folded(cell)).collect();
        if left.is_empty() {
            break;
        }
    }
    let moved = folds.moved;
    Unfolded { moved, folded: [folded.len(), left.len()], corners: Some(corners) }
}

struct Folds<'a> {
    map: &'a Parameterisation,
    mesh: &'a Mesh,
    level: usize,
    corners: Option<&'a Corners>,
    moved: Vec<(u32, DomainPoint)>,
}

impl Folds<'_> {
    /// Returns where a corner is looked up.
    fn place(&self, face: u32, at: [u16; 2]) -> DomainPoint {
        let own = DomainPoint::new(face, barycentric(self.level, at));
        match self.corners.map(|corners| corners.of(face, at)) {
            Some(Corner::Inner(number) | Corner::Side(_, number)) => {
                let found = self.moved.binary_search_by_key(&number, |moved| moved.0);
                found.map_or(own, |at| self.moved[at].1)
            }
            _ => own,
        }
    }

    fn point(&self, place: &DomainPoint) -> (DVec3, DVec3) {
        self.map.point_and_normal(self.mesh, place.base_face, place.barycentric)
    }

    /// Whether a cell faces away from the mesh at its corners and in the middle.
    fn is_folded(&self, cell: Cell) -> bool {
        let points = cell.corners().map(|at| self.point(&self.place(cell.base, at)));
        self.fold_of(cell, points) > 0.0
    }

    /// Returns how far a cell faces away from the mesh: minus the largest cosine between its normal and the mesh's at its
    /// corners and in the middle, 0 if one is not negative.
    fn fold_of(&self, cell: Cell, points: [(DVec3, DVec3); 3]) -> f64 {
        let [a, b, c] = points.map(|point| point.0);
        let facing = (b - a).cross(c - a).normalize_or_zero();
        let away = |normal: DVec3| (-facing.dot(normal.normalize_or_zero())).max(0.0);
        let least = points.iter().map(|point| away(point.1)).fold(1.0, f64::min);
        if least == 0.0 {
            return 0.0;
        }
        let middle = DomainPoint::new(cell.base, cell.point(self.level, [1.0 / 3.0; 3]));
        away(self.point(&middle).1).min(least)
    }

    /// Moves a corner of a cell, if the cells around it then face away less. `near` gets the cells around.
    fn mend(&mut self, edges: &BaseEdges, cell: Cell, near: &mut Vec<Cell>) {
        for at in cell.corners() {
            if !self.is_folded(cell) {
                return;
            }
            let Some(corners) = self.corners else { return };
            let (number, side) = match corners.of(cell.base, at) {
                Corner::Fixed(_) => continue,
                Corner::Inner(number) => (number, None),
                Corner::Side(side, number) => (number, Some(side)),
            };
            let mut around: Vec<(Cell, usize)> = corners.cells(cell.base, at).collect();
            if let Some(side) = side {
                // Faces that run the same way along the edge are of another orientation: left alone.
                for to in edges.across(cell.base, side).filter(|to| !to.same_way) {
                    around.extend(corners.cells(to.face, corners.across(at, side, to.side)));
                }
            }
            let fold = |place: &DomainPoint| {
                let point = self.point(place);
                let of_cell = |&(cell, k): &(Cell, usize)| {
                    let mut points = cell.corners().map(|at| self.point(&self.place(cell.base, at)));
                    points[k] = point;
                    self.fold_of(cell, points)
                };
                around.iter().map(of_cell).sum::<f64>()
            };
            let own = self.place(cell.base, at);
            let mut best = (fold(&own), None);
            for place in candidates(&own, self.level, side) {
                let sum = fold(&place);
                if sum < best.0 {
                    best = (sum, Some(place));
                }
                if best.0 == 0.0 {
                    break;
                }
            }
            if let Some(place) = best.1 {
                near.extend(around.iter().map(|around| around.0));
                match self.moved.binary_search_by_key(&number, |moved| moved.0) {
                    Ok(at) => self.moved[at].1 = place,
                    Err(at) => self.moved.insert(at, (number, place)),
                }
            }
        }
    }
}

/// Places around a place: in its base face, or on the side that it is on.
fn candidates(own: &DomainPoint, level: usize, side: Option<usize>) -> Vec<DomainPoint> {
    let unit = 1.0 / (1u32 << level) as f64;
    let directions: Vec<[f64; 3]> = match side {
        // On the side as it is called where the place is given: the coordinate that is 0 stays 0.
        Some(_) => {
            let opposite =
                (0..3).min_by(|&a, &b| own.barycentric[a].total_cmp(&own.barycentric[b])).unwrap_or(0);
            let mut along = [0.0; 3];
            (along[(opposite + 1) % 3], along[(opposite + 2) % 3]) = (-1.0, 1.0);
            vec![along, along.map(|x| -x)]
        }
        None => (0..12)
            .map(|k| {
                let (sine, cosine) = (f64::from(k) * std::f64::consts::TAU / 12.0).sin_cos();
                [-cosine - sine, cosine, sine]
            })
            .collect(),
    };
    let place = |direction: &[f64; 3], distance: f64| {
        let moved = std::array::from_fn(|k| own.barycentric[k] + distance * unit * direction[k]);
        moved.iter().all(|&weight| weight > -1e-12).then(|| DomainPoint::new(own.base_face, moved))
    };
    let near_first = DISTANCES.iter().flat_map(|&distance| directions.iter().map(move |d| (d, distance)));
    near_first.filter_map(|(direction, distance)| place(direction, distance)).collect()
}
