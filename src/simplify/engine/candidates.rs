//! Candidates: which point is merged into which, where, and at what cost.
//!
//! ```text
//!     endpoint      lost -> kept, in either direction        every pair is two candidates
//!     any other     both -> x, where that costs least        every pair is one, looked at from its lower point
//! ```
//!
//! A point on a feature edge holds a point off feature edges, so borders and seams stay where they are.

use glam::Vec3;

use crate::mesh::NONE;
use crate::simplify::metric::{AttributeQuadric, ErrorMetric, Optimum, Pair, cost_at_kept};
use crate::simplify::placement::Placement;
use crate::simplify::surface::classify::kind;
use crate::simplify::surface::{HUB, WorkingSurface};

/// Maximum distance of an optimum from the middle of the edge, in edge lengths, accepted without further checks.
const FAR: f32 = 1.0;

/// The cheapest candidate of a point.
#[derive(Debug, Clone, Copy)]
pub(super) struct Best {
    pub cost: f32,
    pub other: u32,
}

/// A candidate allowed by every oracle.
#[derive(Debug, Clone, Copy)]
pub(super) struct Candidate {
    pub pair: Pair,
    pub x: Vec3,
    /// Position `x` in object units; `None` where the kept point does not move.
    pub object: Option<[f32; 3]>,
}

pub(super) const NO_BEST: Best = Best { cost: f32::INFINITY, other: NONE };

/// Computes costs and positions of candidates.
#[derive(Clone, Copy)]
pub(super) struct Judge<'a, M> {
    pub metric: &'a M,
    pub surface: &'a WorkingSurface,
    pub placement: Placement,
}

impl<M: ErrorMetric> Judge<'_, M> {
    /// Returns the cost of a candidate.
    #[inline]
    pub fn cost(&self, point: u32, other: u32) -> f32 {
        if self.placement == Placement::Endpoint {
            let cost = cost_at_kept(self.metric, self.surface, Pair { lost: point, kept: other });
            if cost > 0.0 { cost } else { 0.0 }
        } else {
            self.evaluate(point, other).2
        }
    }

    /// Computes the costs of merging `point` with each of `others` into `costs` (of the same length).
    #[inline]
    pub fn costs(&self, point: u32, others: &[u32], costs: &mut [f32]) {
        if self.placement == Placement::Endpoint {
            self.metric.costs_at_kept(self.surface, point, others, costs);
            costs.iter_mut().for_each(|cost| *cost = if *cost > 0.0 { *cost } else { 0.0 });
        } else {
            for (&other, cost) in others.iter().zip(costs) {
                *cost = self.evaluate(point, other).2;
            }
        }
    }

    /// Returns which point is merged into which, and the position.
    #[inline]
    pub fn place(&self, point: u32, other: u32) -> (Pair, Vec3) {
        if self.placement == Placement::Endpoint {
            return (Pair { lost: point, kept: other }, self.surface.at(other));
        }
        let (pair, x, _) = self.evaluate(point, other);
        (pair, x)
    }

    /// Returns pair, position and cost, for placements other than `Endpoint`.
    fn evaluate(&self, point: u32, other: u32) -> (Pair, Vec3, f32) {
        let pair = Pair { lost: point, kept: other };
        let clean = |cost: f32| if cost > 0.0 { cost } else { 0.0 };
        let (pair, bound) = self.orient(pair);
        let kept = self.surface.at(pair.kept);
        if bound {
            return (pair, kept, clean(self.metric.cost(self.surface, pair, kept.into())));
        }
        let lost = self.surface.at(pair.lost);
        let middle = 0.5 * (lost + kept);
        let cost = |pair: Pair, x: Vec3| clean(self.metric.cost(self.surface, pair, x.into()));
        match self.placement {
            Placement::Optimal => {
                let optimum = self.metric.optimum(self.surface, pair, &AttributeQuadric::NONE);
                if let Some(Optimum { position, cost, .. }) = optimum {
                    let x = Vec3::from(position);
                    let near = (FAR * FAR) * lost.distance_squared(kept);
                    if x.distance_squared(middle) <= near || x.is_finite() && self.is_among(pair, middle, x) {
                        return (pair, x, clean(cost));
                    }
                    return self.best_of_three(pair, middle);
                }
                (pair, middle, cost(pair, middle))
            }
            Placement::Subset => self.best_of_three(pair, middle),
            _ => (pair, middle, cost(pair, middle)),
        }
    }

    /// Returns the cheapest of both ends and their middle.
    fn best_of_three(&self, pair: Pair, middle: Vec3) -> (Pair, Vec3, f32) {
        let Pair { lost, kept } = pair;
        let swapped = Pair { lost: kept, kept: lost };
        let options = [(pair, self.surface.at(kept)), (swapped, self.surface.at(lost)), (pair, middle)];
        let mut best = (options[0].0, options[0].1, f32::INFINITY);
        for (pair, x) in options {
            let cost = self.metric.cost(self.surface, pair, x.into());
            let cost = if cost > 0.0 { cost } else { 0.0 };
            if cost < best.2 {
                best = (pair, x, cost);
            }
        }
        best
    }

    /// Whether `x` is no farther from the middle than the farthest neighbour. With few planes the optimum is
    /// underdetermined and may lie anywhere. O(valences).
    #[cold]
    fn is_among(&self, pair: Pair, middle: Vec3, x: Vec3) -> bool {
        let mut farthest = 0.0f32;
        for point in [pair.lost, pair.kept] {
            self.surface.for_neighbours(point, |n| {
                farthest = farthest.max(self.surface.at(n).distance_squared(middle));
            });
        }
        x.distance_squared(middle) <= farthest
    }

    /// Puts the freer point first; returns whether the other point must stay where it is.
    fn orient(&self, pair: Pair) -> (Pair, bool) {
        let held = |p: u32| {
            let bits = self.surface.kind(p);
            let rank = if bits & kind::LOCKED != 0 {
                3
            } else if bits & kind::FEATURE == 0 {
                0
            } else if bits & kind::CURVE != 0 {
                1
            } else {
                2
            };
            (rank, bits & kind::FEATURE)
        };
        let (lost, kept) = (held(pair.lost), held(pair.kept));
        let hub = |point: u32| self.surface.valence(point) > HUB;
        if lost == kept && (hub(pair.lost) || hub(pair.kept)) {
            // A hub stays: merging into it then costs no more than the lost point's few triangles.
            let turned = self.surface.valence(pair.lost) > self.surface.valence(pair.kept);
            return (if turned { Pair { lost: pair.kept, kept: pair.lost } } else { pair }, true);
        }
        if lost.0 > kept.0 {
            (Pair { lost: pair.kept, kept: pair.lost }, true)
        } else {
            (pair, lost != kept || lost.0 > 1)
        }
    }

    /// Returns the position as it will be stored, rounded to single precision in object units: in the inner frame, and
    /// in object units. A kept point which does not move keeps its exact position and its vertices.
    pub fn snap(&self, pair: Pair, x: Vec3) -> (Vec3, Option<[f32; 3]>) {
        if x == self.surface.at(pair.kept) {
            return (x, None);
        }
        let object = self.surface.frame().object(x.into());
        (Vec3::from(self.surface.frame().inner(object)), Some(object))
    }
}
