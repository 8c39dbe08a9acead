//! Moves the vertices of a remesh off the mesh, so that its triangles and not its vertices come closest to the mesh.
//!
//! ```text
//!           _____                                      Between vertices on a bulge (its outline is drawn) a remesh lies
//!        *---------*          *--_-----_--*            inside of it. Vertices moved along their normals by least squares
//!      on the mesh                fitted               leave as much outside as inside.
//! ```
//!
//! Vertices of the base and on features stay, and so do the corners of triangles which would face away from the mesh.

use glam::DVec3;

use crate::geometry::parallel;
use crate::mesh::Mesh;
use crate::wavelet::DomainPoint;

use super::Parameterisation;
use super::cells::{BaseEdges, Cell};
use super::corners::{Corner, Corners, barycentric};
use super::unfold::Unfolded;

/// Steps of the solver: a third gains nothing, since the first takes out what is smooth.
const STEPS: usize = 2;

/// By how much corners of a level's cells are moved off the mesh.
#[derive(Debug, Clone, Default)]
pub(super) struct Fitted {
    corners: Option<Corners>,
    shifts: Vec<DVec3>,
    /// Cells that still face away from the mesh.
    pub folded: usize,
}

impl Fitted {
    /// Moves nothing.
    pub fn none(folded: usize) -> Self {
        Self { folded, ..Self::default() }
    }

    /// Returns the displacement of the corner at a place on the base.
    pub fn shift(&self, domain: &DomainPoint) -> DVec3 {
        let Some(corners) = &self.corners else { return DVec3::ZERO };
        match corners.at(domain) {
            Corner::Inner(number) | Corner::Side(_, number) => self.shifts[number as usize],
            Corner::Fixed(_) => DVec3::ZERO,
        }
    }
}

/// Fits the cells of a level, their corners at the places where `unfolded` has them.
pub(super) fn fit(map: &Parameterisation, mesh: &Mesh, level: usize, unfolded: &Unfolded) -> Fitted {
    let edges = BaseEdges::new(map.base());
    let corners = Corners::new(map.base(), &edges, level);
    let mut fit = Fit::new(map, mesh, &corners, unfolded);
    fit.solve();
    let folded = fit.keep_facing();
    let Fit { mut shifts, .. } = fit;
    shifts.truncate(corners.count());
    Fitted { corners: Some(corners), shifts, folded }
}

/// A cell and the mesh over it.
struct Over {
    cell: Cell,
    /// Numbers of the corners; base vertices come after all others.
    corners: [u32; 3],
    /// Normal, as long as twice the area, before any move.
    normal: DVec3,
    /// Of the mesh's normals at the corners, the one closest to the cell's.
    facing: DVec3,
    /// Heights of the mesh over the middles of the sides: their mean is that of any quadratic surface over the cell.
    heights: [f64; 3],
}

struct Fit<'a> {
    map: &'a Parameterisation,
    mesh: &'a Mesh,
    unfolded: &'a Unfolded,
    level: usize,
    cells: Vec<Over>,
    positions: Vec<DVec3>,
    shifts: Vec<DVec3>,
    is_free: Vec<bool>,
}

impl<'a> Fit<'a> {
    fn new(map: &'a Parameterisation, mesh: &'a Mesh, corners: &Corners, unfolded: &'a Unfolded) -> Self {
        let level = corners.level;
        let bases = map.base().triangles();
        let number = |face: u32, at: [u16; 2]| match corners.of(face, at) {
            Corner::Fixed(k) => corners.count() as u32 + bases[face as usize][k],
            Corner::Inner(number) | Corner::Side(_, number) => number,
        };
        let n = 2u16 << level;
        let of_faces = parallel::map(bases.len(), 1, |face| {
            let face = face as u32;
            // Corners of the next level: those of this level, and the middles of the sides.
            let point = |i: u16, j: u16| {
                let place = DomainPoint::new(face, barycentric(level + 1, [i, j]));
                let place = if (i | j).is_multiple_of(2) { unfolded.apply(&place) } else { place };
                map.point_and_normal(mesh, place.base_face, place.barycentric)
            };
            let rows: Vec<Vec<(DVec3, DVec3)>> =
                (0..=n).map(|j| (0..=n - j).map(|i| point(i, j)).collect()).collect();
            let at = |[i, j]: [u16; 2]| rows[usize::from(j)][usize::from(i)];
            let over = |cell: Cell| {
                let ends = cell.corners().map(|at| at.map(|x| 2 * x));
                let points = ends.map(at);
                let [a, b, c] = points.map(|point| point.0);
                let normal = (b - a).cross(c - a);
                let unit = normal.normalize_or_zero();
                let heights = [0, 1, 2].map(|side| {
                    let ([i, j], [x, y]) = (ends[side], ends[(side + 1) % 3]);
                    let middle = 0.5 * (points[side].0 + points[(side + 1) % 3].0);
                    (at([(i + x) / 2, (j + y) / 2]).0 - middle).dot(unit)
                });
                let nearest = |a: DVec3, b: DVec3| if b.dot(unit) > a.dot(unit) { b } else { a };
                let facing = points.map(|point| point.1.normalize_or_zero());
                let facing = facing.into_iter().reduce(nearest).unwrap_or_default();
                Over { cell, corners: cell.corners().map(|at| number(face, at)), normal, facing, heights }
            };
            let cells: Vec<Over> = Cell::of_level(face, level).map(over).collect();
            (rows, cells)
        });
        let total = corners.count() + map.base().positions().len();
        let mut positions = vec![DVec3::ZERO; total];
        let mut cells = Vec::with_capacity(bases.len() << (2 * level));
        for (face, (rows, of_face)) in (0..).zip(of_faces) {
            for (j, row) in (0..).zip(rows.iter().step_by(2)) {
                for (i, point) in (0..).zip(row.iter().step_by(2)) {
                    positions[number(face, [i, j]) as usize] = point.0;
                }
            }
            cells.extend(of_face);
        }
        let mut is_free = vec![false; total];
        corners.for_all(|face, _, corner, number| {
            is_free[number as usize] = match corner {
                Corner::Side(side, _) => !map.is_feature(face, side),
                _ => true,
            };
        });
        let shifts = vec![DVec3::ZERO; total];
        Self { map, mesh, unfolded, level, cells, positions, shifts, is_free }
    }

    /// Moves corners along their normals so that the sum of squares of the heights falls: Richardson's iteration, with the
    /// sums of the rows as preconditioner.
    fn solve(&mut self) {
        let mut normals = vec![DVec3::ZERO; self.positions.len()];
        for cell in &self.cells {
            cell.corners.iter().for_each(|&corner| normals[corner as usize] += cell.normal);
        }
        normals.iter_mut().for_each(|normal| *normal = normal.normalize_or_zero());
        for _ in 0..STEPS {
            let mut sums = vec![[0.0; 2]; self.positions.len()];
            for cell in &self.cells {
                let (area, unit) = (cell.normal.length(), cell.normal.normalize_or_zero());
                let lifted = cell.corners.map(|corner| self.shifts[corner as usize].dot(unit));
                for side in 0..3 {
                    let ends = [side, (side + 1) % 3];
                    let left = cell.heights[side] - 0.5 * ends.map(|k| lifted[k]).iter().sum::<f64>();
                    for corner in ends.map(|k| cell.corners[k] as usize) {
                        sums[corner][0] += area * left;
                        sums[corner][1] += area;
                    }
                }
            }
            for (corner, &[sum, weight]) in sums.iter().enumerate() {
                if self.is_free[corner] && weight > 0.0 {
                    self.shifts[corner] += sum / weight * normals[corner];
                }
            }
        }
    }

    /// Whether a cell faces away from the mesh at its corners and in the middle.
    fn is_folded(&self, over: &Over) -> bool {
        let [a, b, c] = over.corners.map(|corner| self.position(corner));
        let own = (b - a).cross(c - a);
        if own.dot(over.facing) >= 0.0 {
            return false;
        }
        let Over { cell, .. } = over;
        let corners = cell
            .corners()
            .map(|at| self.unfolded.apply(&DomainPoint::new(cell.base, barycentric(self.level, at))));
        let middle = DomainPoint::new(cell.base, cell.point(self.level, [1.0 / 3.0; 3]));
        corners.iter().chain([&middle]).all(|place| {
            own.dot(self.map.point_and_normal(self.mesh, place.base_face, place.barycentric).1) < 0.0
        })
    }

    fn position(&self, corner: u32) -> DVec3 {
        self.positions[corner as usize] + self.shifts[corner as usize]
    }

    /// Takes back the moves of corners at cells which face away; most do so only since. Returns how many are left.
    fn keep_facing(&mut self) -> usize {
        loop {
            let folded: Vec<[u32; 3]> =
                self.cells.iter().filter(|over| self.is_folded(over)).map(|over| over.corners).collect();
            let mut is_over = true;
            for &corner in folded.as_flattened() {
                is_over &= std::mem::take(&mut self.shifts[corner as usize]) == DVec3::ZERO;
            }
            if is_over {
                return folded.len();
            }
        }
    }
}
