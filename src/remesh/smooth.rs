//! Smooths a map from a base to a mesh, so that edges and vertices of the base do not show: a discrete harmonic map.
//!
//! ```text
//!     from the coarsest level to the finest:
//!         halve the cells
//!         a few times: for every corner of cells but base vertices and points of features
//!             goal  = mean of the six corners around it on the mesh, weighted by cotangents of the base's angles
//!             move the corner over the base towards the goal's preimage, as long as all cells stay face up
//!                 and the energy falls
//! ```
//!
//! The energy `sum of w |x - x'|^2` over the edges of all cells is Dirichlet's. MAPS (Lee et al. 1998, section 4) smooths
//! places on the base by Loop's stencils instead, which does not look at the mesh.

use glam::{DVec2, DVec3};

use crate::mesh::Mesh;

use super::cells::BaseEdges;
use super::charts::Charts;
use super::corners::Corner;
use super::layout::{Layout, Place};
use super::warp::Warp;

/// Passes over the corners, from the second coarsest level on: many where corners are few.
const PASSES: [usize; 4] = [6, 4, 3, 2];
/// Least area of a moved cell, as a share of its area at rest.
const LEAST_AREA: f64 = 0.05;

/// The mesh under the base.
pub(super) struct Target<'a> {
    pub base: &'a Mesh,
    pub edges: &'a BaseEdges,
    pub layout: &'a Layout,
    /// Which sides of base faces are features.
    pub features: &'a [[bool; 3]],
    /// Layout face of every base face.
    pub faces: &'a [u32],
    pub mesh: &'a Mesh,
}

impl Target<'_> {
    fn position(&self, place: Place) -> DVec3 {
        let face = self.faces[place.face as usize];
        let place = self.layout.up(Place { face, ..place });
        let corners = self.mesh.triangles()[place.face as usize];
        let at = |k: usize| DVec3::from_array(self.mesh.positions()[corners[k] as usize].map(f64::from));
        (0..3).map(|k| place.weights[k] * at(k)).sum()
    }
}

/// Returns a smooth map for cells of a level.
pub(super) fn smooth(target: &Target<'_>, level: usize) -> Warp {
    let charts = Charts::new(target.base, target.edges, |face, side| target.features[face as usize][side]);
    let mut warp = Warp::new(target.base, target.edges, 0, charts);
    for finer in 1..=level {
        warp = halved(target, &warp);
        let passes = PASSES[(finer - 1).min(PASSES.len() - 1)];
        let mut smoothing = Smoothing::new(target, warp);
        (0..passes).for_each(|_| smoothing.pass());
        warp = smoothing.warp;
    }
    warp
}

/// Returns the same map for the cells of the next level.
fn halved(target: &Target<'_>, coarse: &Warp) -> Warp {
    let level = coarse.corners.level + 1;
    let mut warp = Warp::new(target.base, target.edges, level, coarse.charts.clone());
    let Warp { corners, places, .. } = &mut warp;
    corners.for_all(|face, [i, j], _, number| {
        // The ends of the coarser edge whose middle this is.
        let (x, y) = (i / 2, j / 2);
        let [a, b] = match (i % 2, j % 2) {
            (0, 0) => [[x, y], [x, y]],
            (1, 0) => [[x, y], [x + 1, y]],
            (0, _) => [[x, y], [x, y + 1]],
            _ => [[x + 1, y], [x, y + 1]],
        };
        places[number as usize] = 0.5 * (coarse.in_chart(face, a) + coarse.in_chart(face, b));
    });
    warp
}

struct Smoothing<'a> {
    target: &'a Target<'a>,
    warp: Warp,
    /// Positions on the mesh: of corners by number, then of base vertices.
    positions: Vec<DVec3>,
    /// Cotangents of the angles of every base face.
    cotangents: Vec<[f64; 3]>,
    ring: Vec<Around>,
}

/// A cell around a corner, in the corner's chart.
#[derive(Debug, Clone, Copy)]
struct Around {
    /// Places of the two other corners of the cell.
    places: [DVec2; 2],
    positions: [DVec3; 2],
    /// Weights of the edges to them.
    weights: [f64; 2],
    /// Twice the area at rest.
    area: f64,
}

impl<'a> Smoothing<'a> {
    fn new(target: &'a Target<'a>, warp: Warp) -> Self {
        let triangles = target.base.triangles();
        let (faces, corners) = (triangles.len() as u32, warp.corners.count());
        let fixed = target.base.positions().iter().map(|&p| DVec3::from_array(p.map(f64::from)));
        let mut positions: Vec<DVec3> = vec![DVec3::ZERO; corners];
        positions.extend(fixed);
        warp.corners.for_all(|face, _, _, number| {
            let place = warp.charts.locate(face, warp.places[number as usize]).0;
            positions[number as usize] = target.position(place);
        });
        let cotangents = (0..faces).map(|face| {
            let c = warp.charts.corners(face);
            [0, 1, 2].map(|k| {
                let (a, b) = (c[(k + 1) % 3] - c[k], c[(k + 2) % 3] - c[k]);
                a.dot(b) / a.perp_dot(b)
            })
        });
        Self { target, cotangents: cotangents.collect(), warp, positions, ring: Vec::new() }
    }

    fn pass(&mut self) {
        let corners = self.warp.corners.clone();
        corners.for_all(|face, at, corner, number| match corner {
            Corner::Side(side, _) if self.warp.charts.beyond(face, side).is_none() => {}
            Corner::Side(side, _) => self.relax(face, at, number, Some(side)),
            _ => self.relax(face, at, number, None),
        });
    }

    /// Moves a corner, placed in the chart of `face`, on `side` if on an edge.
    fn relax(&mut self, face: u32, at: [u16; 2], corner: u32, side: Option<usize>) {
        let mut ring = std::mem::take(&mut self.ring);
        ring.clear();
        self.collect(face, at, &mut ring, |place| place);
        let across = side.and_then(|side| Some((side, self.warp.charts.beyond(face, side)?)));
        if let Some((side, beyond)) = across {
            let there = self.warp.corners.across(at, side, beyond.side);
            self.collect(beyond.face, there, &mut ring, |place| beyond.motion.apply(place));
        }
        self.step(face, corner, side, &ring);
        self.ring = ring;
    }

    /// Collects the cells of a base face around a corner, with places moved to the corner's chart.
    fn collect(&self, face: u32, at: [u16; 2], ring: &mut Vec<Around>, motion: impl Fn(DVec2) -> DVec2) {
        let n = f64::from(self.warp.corners.along());
        let c = self.warp.charts.corners(face);
        let area = (c[1] - c[0]).perp_dot(c[2] - c[0]) / (n * n);
        let cotangents = self.cotangents[face as usize];
        for (cell, k) in self.warp.corners.cells(face, at) {
            let others = [(k + 1) % 3, (k + 2) % 3];
            let corners = cell.corners();
            ring.push(Around {
                places: others.map(|o| motion(self.warp.in_chart(face, corners[o]))),
                positions: others.map(|o| self.position(face, corners[o])),
                // The edge to a corner is opposite of the other corner.
                weights: [cotangents[others[1]], cotangents[others[0]]],
                area,
            });
        }
    }

    fn position(&self, face: u32, at: [u16; 2]) -> DVec3 {
        let number = match self.warp.corners.of(face, at) {
            Corner::Fixed(k) => {
                self.warp.corners.count() + self.target.base.triangles()[face as usize][k] as usize
            }
            Corner::Inner(corner) | Corner::Side(_, corner) => corner as usize,
        };
        self.positions[number]
    }

    fn step(&mut self, face: u32, corner: u32, side: Option<usize>, ring: &[Around]) {
        let (place, position) = (self.warp.places[corner as usize], self.positions[corner as usize]);
        let edges = || {
            ring.iter()
                .flat_map(|around| (0..2).map(|k| (around.places[k], around.positions[k], around.weights[k])))
        };
        let energy = |x: DVec3| edges().map(|(_, p, weight)| weight * (p - x).length_squared()).sum::<f64>();
        let sum: f64 = edges().map(|(_, _, weight)| weight).sum();
        let goal = edges().map(|(_, p, weight)| weight * p).sum::<DVec3>() / sum;
        let (mut m, mut dx, mut dy) = ([0.0f64; 3], DVec3::ZERO, DVec3::ZERO);
        for (u, p, weight) in edges() {
            let (u, p) = (u - place, p - position);
            m[0] += weight * u.x * u.x;
            m[1] += weight * u.x * u.y;
            m[2] += weight * u.y * u.y;
            dx += weight * u.x * p;
            dy += weight * u.y * p;
        }
        let determinant = m[0] * m[2] - m[1] * m[1];
        // Derivatives of the position by the place: least squares over the ring.
        let (jx, jy) = ((dx * m[2] - dy * m[1]) / determinant, (dy * m[0] - dx * m[1]) / determinant);
        let (a, b, c) = (jx.length_squared(), jx.dot(jy), jy.length_squared());
        let (d, e) = (jx.dot(goal - position), jy.dot(goal - position));
        let step = DVec2::new(d * c - e * b, e * a - d * b) / (a * c - b * b);
        if !step.is_finite() {
            return;
        }
        let before = energy(position);
        for share in [1.0, 0.5, 0.25] {
            let to = place + share * step;
            let is_up = |around: &Around| {
                (around.places[0] - to).perp_dot(around.places[1] - to) > LEAST_AREA * around.area
            };
            if !ring.iter().all(is_up) {
                continue;
            }
            let Some(found) = self.allowed(face, side, to) else { continue };
            let position = self.target.position(found);
            if energy(position) < before {
                self.warp.places[corner as usize] = to;
                self.positions[corner as usize] = position;
                return;
            }
        }
    }

    /// Returns the place on the base, if the corner may go there: corners inside a face to the face and those across its
    /// sides, corners on a side to both faces there.
    fn allowed(&self, face: u32, side: Option<usize>, to: DVec2) -> Option<Place> {
        let (place, least) = self.warp.charts.locate(face, to);
        let is_there = match side {
            Some(side) => {
                place.face == face
                    || self.warp.charts.beyond(face, side).is_some_and(|b| b.face == place.face)
            }
            None => true,
        };
        (least >= 0.0 && is_there).then_some(place)
    }
}
