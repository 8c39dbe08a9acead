//! The triangles removed or changed by a collapse (Southern's TOP and BOT), each once, and sums over them.
//!
//! ```text
//!         w1 --- w2              both ends' triangles: all are input to the costs.
//!        /  \  /   \             The two on the edge vanish, the others follow their corner
//!      w0 -- u === v -- w3       to the new position x.
//!        \  /  \   /
//!         w5 --- w4
//! ```

use glam::{DVec3, Vec3};

use crate::simplify::surface::WorkingSurface;
use crate::simplify::surface::curves::Rim;

use super::loss::attribute_cost;
use super::solve::{Symmetric, nearest_minimum};
use super::{AttributeQuadric, ErrorMetric, Optimum, Pair};

/// A triangle of the region: `p` is an end of the edge, `q` and `r` follow in the triangle's order.
#[derive(Debug, Clone, Copy)]
pub(super) struct Facet {
    pub p: DVec3,
    pub q: DVec3,
    pub r: DVec3,
    /// Whether the triangle exists after the collapse, with the new position in place of `p`.
    pub survives: bool,
}

impl Facet {
    /// Normal, as long as twice the area.
    #[inline]
    pub fn cross(&self) -> DVec3 {
        (self.q - self.p).cross(self.r - self.p)
    }

    /// Normal after the collapse, as long as twice the area.
    #[inline]
    pub fn cross_at(&self, x: DVec3) -> DVec3 {
        (self.q - x).cross(self.r - x)
    }
}

/// Calls `visit` with the triangles around the lost point. Triangles on the edge do not survive.
#[inline]
pub(super) fn for_lost(surface: &WorkingSurface, pair: Pair, visit: impl FnMut(Facet)) {
    for_star(surface, pair.lost, pair.kept, true, visit);
}

/// Calls `visit` with the triangles around either point, each once.
#[inline]
pub(super) fn for_region(surface: &WorkingSurface, pair: Pair, mut visit: impl FnMut(Facet)) {
    for_star(surface, pair.lost, pair.kept, true, &mut visit);
    for_star(surface, pair.kept, pair.lost, false, visit);
}

#[inline]
fn for_star(surface: &WorkingSurface, point: u32, other: u32, on_edge: bool, mut visit: impl FnMut(Facet)) {
    let p = at(surface, point);
    for corner in surface.star(point) {
        let survives = !corner.others.contains(&other);
        if survives || on_edge {
            let [q, r] = corner.others.map(|o| at(surface, o));
            visit(Facet { p, q, r, survives });
        }
    }
}

/// The position of a point in double precision.
#[inline]
pub(super) fn at(surface: &WorkingSurface, point: u32) -> DVec3 {
    surface.at(point).as_dvec3()
}

/// Calls `visit` with the ends of every border edge moved by the collapse, in the direction of its triangle, each once.
/// Includes the collapsed edge if it is a border edge.
pub(super) fn for_border_edges(surface: &WorkingSurface, pair: Pair, mut visit: impl FnMut(DVec3, DVec3)) {
    for (point, other) in [(pair.lost, pair.kept), (pair.kept, pair.lost)] {
        if !surface.is_border(point) {
            continue;
        }
        let p = at(surface, point);
        for corner in surface.star(point) {
            let [a, b] = corner.others;
            for (end, leaves) in [(a, true), (b, false)] {
                let again = end == other && point == pair.kept;
                let is_single = |end| surface.star(point).filter(|c| c.others.contains(&end)).count() == 1;
                if surface.is_border(end) && !again && is_single(end) {
                    let q = at(surface, end);
                    if leaves { visit(p, q) } else { visit(q, p) }
                }
            }
        }
    }
}

/// Calls `visit` with the ends of every rim moved by the collapse, each once: borders, non-manifold edges, borders
/// between materials, creases and seams. Includes the collapsed edge if it is a rim.
pub(super) fn for_rims(surface: &WorkingSurface, pair: Pair, mut visit: impl FnMut(DVec3, DVec3, Rim)) {
    for (point, other) in [(pair.lost, pair.kept), (pair.kept, pair.lost)] {
        if surface.is_on_curve(point) {
            surface.for_rims(point, |end, rim| {
                if !(end == other && point == pair.kept) {
                    visit(at(surface, point), at(surface, end), rim);
                }
            });
        }
    }
}

/// Weight of the areas swept by seams: enough to stop a seam sliding over a flat face with equal colours on both sides.
const SEAM: f64 = 0.1;

/// Returns the area swept by rims, seams weighed by a tenth, if both points go to `x`. Rims of the kept point sweep none
/// if it stays.
pub(super) fn swept_by_rims(surface: &WorkingSurface, pair: Pair, x: DVec3) -> f64 {
    let mut sum = 0.0;
    if surface.is_on_curve(pair.lost) || surface.is_on_curve(pair.kept) {
        for_rims(surface, pair, |p, q, rim| {
            let weight = if rim == Rim::Seam { SEAM } else { 1.0 };
            sum += weight * (p - x).cross(q - x).length();
        });
    }
    0.5 * sum
}

/// Length of a candidate's edge.
#[inline]
pub(super) fn length(surface: &WorkingSurface, pair: Pair) -> f64 {
    (at(surface, pair.kept) - at(surface, pair.lost)).length()
}

/// Clamps a cost for the queue: not negative, finite, not NaN.
#[inline]
pub(super) fn finite(cost: f64) -> f32 {
    if cost > 0.0 { cost.min(f64::from(f32::MAX)) as f32 } else { 0.0 }
}

/// Returns the cheapest of four places for the merged point: both ends, the middle, and the place of least squared swept
/// volume. For metrics whose minimum has no formula.
pub(super) fn cheapest_place(
    metric: &impl ErrorMetric,
    surface: &WorkingSurface,
    pair: Pair,
    attributes: &AttributeQuadric,
) -> Option<Optimum> {
    let cost = |x: [f32; 3]| {
        let cost = metric.cost(surface, pair, x);
        if attributes.area > 0.0 {
            cost + attribute_cost(metric, surface, pair, attributes.at(x))
        } else {
            cost
        }
    };
    let (lost, kept) = (surface.at(pair.lost), surface.at(pair.kept));
    let middle = 0.5 * (lost + kept);
    let mut best: Option<(Vec3, f32)> = None;
    for x in [least_volume(surface, pair), middle, kept, lost] {
        let c = cost(x.into());
        if x.is_finite() && best.is_none_or(|(_, least)| c < least) {
            best = Some((x, c));
        }
    }
    best.map(|(x, c)| Optimum::of_both(x.into(), c))
}

/// Returns the place with the least sum of squared volumes between the point and the region's triangles, nearest to the
/// middle of the edge where the minimum is not unique.
fn least_volume(surface: &WorkingSurface, pair: Pair) -> Vec3 {
    let origin = at(surface, pair.lost);
    let middle = 0.5 * (at(surface, pair.kept) - origin);
    let (mut h, mut gradient) = (Symmetric::ZERO, DVec3::ZERO);
    for_region(surface, pair, |facet| {
        let n = facet.cross();
        h.add_outer(n);
        gradient += n * n.dot(middle - (facet.p - origin));
    });
    (origin + middle + nearest_minimum(&h, gradient)).as_vec3()
}
