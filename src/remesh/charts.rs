//! Charts: every base face in the plane, in its own shape, with the faces across its smooth sides unfolded.
//!
//! ```text
//!            c2_________              The motion of a side takes the chart of the face across to this chart, so that both
//!            / \   g   /              faces share the edge. Across features there is nothing to unfold.
//!           / f \     /
//!         c0_____\___/
//!                 c1
//! ```

use glam::{DVec2, DVec3};

use crate::mesh::Mesh;

use super::cells::{BaseEdges, Neighbour};
use super::layout::Place;

/// A motion of the plane: a turn, then a shift.
#[derive(Debug, Clone, Copy)]
pub(super) struct Motion {
    turn: DVec2,
    shift: DVec2,
}

impl Motion {
    /// Returns the motion that takes `from` to `to`, two points each at equal distances.
    fn between(from: [DVec2; 2], to: [DVec2; 2]) -> Self {
        let turn = conjugate(from[1] - from[0]).rotate(to[1] - to[0]).normalize_or(DVec2::X);
        Self { turn, shift: to[0] - turn.rotate(from[0]) }
    }

    pub fn apply(&self, point: DVec2) -> DVec2 {
        self.turn.rotate(point) + self.shift
    }

    pub fn undo(&self, point: DVec2) -> DVec2 {
        conjugate(self.turn).rotate(point - self.shift)
    }
}

/// The conjugate of a complex number: turns by it are undone.
fn conjugate(turn: DVec2) -> DVec2 {
    DVec2::new(turn.x, -turn.y)
}

/// What lies across a side of a base face.
#[derive(Debug, Clone, Copy)]
pub(super) struct Beyond {
    pub face: u32,
    pub side: usize,
    /// From the chart of `face` to the chart on this side.
    pub motion: Motion,
}

/// The charts of all base faces. 200 bytes a face.
#[derive(Debug, Clone)]
pub(super) struct Charts {
    corners: Vec<[DVec2; 3]>,
    beyond: Vec<[Option<Beyond>; 3]>,
}

impl Charts {
    /// Makes the charts; `is_feature` tells of a side whether it is a feature.
    pub fn new(base: &Mesh, edges: &BaseEdges, is_feature: impl Fn(u32, usize) -> bool) -> Self {
        let corners: Vec<[DVec2; 3]> = base
            .triangles()
            .iter()
            .map(|corners| {
                flat(corners.map(|v| DVec3::from_array(base.positions()[v as usize].map(f64::from))))
            })
            .collect();
        let across = |face: u32, side: usize| {
            let mut all = edges.across(face, side);
            let (first, second): (Option<Neighbour>, _) = (all.next(), all.next());
            let to = first.filter(|to| second.is_none() && !to.same_way && !is_feature(face, side))?;
            let own = corners[face as usize];
            let other = corners[to.face as usize];
            let from = [other[(to.side + 1) % 3], other[to.side]];
            let onto = [own[side], own[(side + 1) % 3]];
            // A face without area has another shape in its chart.
            let (length, here) = (from[0].distance(from[1]), onto[0].distance(onto[1]));
            if (length - here).abs() > 1e-9 * here {
                return None;
            }
            let motion = Motion::between(from, onto);
            Some(Beyond { face: to.face, side: to.side, motion })
        };
        let beyond = (0..corners.len() as u32).map(|face| [0, 1, 2].map(|side| across(face, side))).collect();
        Self { corners, beyond }
    }

    pub fn corners(&self, face: u32) -> [DVec2; 3] {
        self.corners[face as usize]
    }

    pub fn beyond(&self, face: u32, side: usize) -> Option<&Beyond> {
        self.beyond[face as usize][side].as_ref()
    }

    /// Returns the point of a face's chart at barycentric coordinates.
    pub fn point(&self, face: u32, weights: [f64; 3]) -> DVec2 {
        let corners = self.corners(face);
        weights[0] * corners[0] + weights[1] * corners[1] + weights[2] * corners[2]
    }

    /// Returns barycentric coordinates in a face of a point of its chart.
    pub fn weights(&self, face: u32, point: DVec2) -> [f64; 3] {
        weights_in(self.corners(face), point)
    }

    /// Returns the face under a point of a chart: the face itself or a face across a side. Also returns how far the point is
    /// outside, as the least barycentric coordinate: not below 0 inside.
    pub fn locate(&self, face: u32, point: DVec2) -> (Place, f64) {
        let weights = self.weights(face, point);
        let (least, corner) = least_of(weights);
        if least >= 0.0 {
            return (Place { face, weights }, least);
        }
        let own = (Place { face, weights: clamped(weights) }, least);
        let Some(beyond) = self.beyond(face, (corner + 1) % 3) else { return own };
        let weights = self.weights(beyond.face, beyond.motion.undo(point));
        (Place { face: beyond.face, weights: clamped(weights) }, least_of(weights).0)
    }

    /// Bytes of the arrays.
    pub fn memory(&self) -> usize {
        size_of_val(&self.corners[..]) + size_of_val(&self.beyond[..])
    }
}

/// Puts a triangle into the plane. A triangle without area becomes equilateral.
fn flat([a, b, c]: [DVec3; 3]) -> [DVec2; 3] {
    let (e, f) = (b - a, c - a);
    let length = e.length();
    let third = DVec2::new(f.dot(e), e.cross(f).length()) / length;
    let longest = length.max(f.length()).max((c - b).length());
    if third.is_finite() && third.y > 1e-6 * longest && length > 1e-6 * longest {
        return [DVec2::ZERO, DVec2::new(length, 0.0), third];
    }
    let side = if longest > 0.0 { longest } else { 1.0 };
    [DVec2::ZERO, DVec2::new(side, 0.0), side * DVec2::new(0.5, 0.75f64.sqrt())]
}

/// Returns barycentric coordinates of a point in a triangle which has an area.
pub(super) fn weights_in([a, b, c]: [DVec2; 3], point: DVec2) -> [f64; 3] {
    let area = (b - a).perp_dot(c - a);
    let (v, w) = ((point - a).perp_dot(c - a) / area, (b - a).perp_dot(point - a) / area);
    [1.0 - v - w, v, w]
}

/// Returns the least of three numbers, and which it is.
pub(super) fn least_of(weights: [f64; 3]) -> (f64, usize) {
    let mut at = 0;
    for k in 1..3 {
        if weights[k] < weights[at] {
            at = k;
        }
    }
    (weights[at], at)
}

/// Sets negative coordinates to 0 and scales all to sum to 1.
pub(super) fn clamped(weights: [f64; 3]) -> [f64; 3] {
    let positive = weights.map(|weight| weight.max(0.0));
    let sum: f64 = positive.iter().sum();
    positive.map(|weight| weight / sum)
}
