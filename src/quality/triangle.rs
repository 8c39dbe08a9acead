//! One triangle: whether it has an area, its nearest point, where a ray meets it, and what it subtends at a point.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

/// A corner whose squared sine is below this has weights that rounding may spoil.
const SLIVER: f64 = 1e-10;

/// The corners of a triangle, object units.
pub(crate) type Corners = [DVec3; 3];

/// Whether a triangle has an area. Differences and products of single precision numbers lose next to nothing in
/// double precision, so this needs no tolerance.
pub(crate) fn has_area(&[a, b, c]: &Corners) -> bool {
    (b - a).cross(c - a) != DVec3::ZERO
}

/// The point of a triangle nearest to `p`, and its distance squared.
///
/// Inside the prism over the triangle it is the foot on the plane; elsewhere it lies on one of the at most two edges
/// that `p` is on the outer side of. Whatever rounding does to the weights, the answer is a point of the triangle and
/// its distance from `p`, never less than the true distance. In a sliver all edges are tried too: nothing is farther
/// from them than half its height.
pub(crate) fn closest_on_triangle(&[a, b, c]: &Corners, p: DVec3) -> (DVec3, f64) {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let normal = ab.cross(ac);
    let square = normal.length_squared();
    let (v, w) = (ap.cross(ac).dot(normal) / square, ab.cross(ap).dot(normal) / square);
    let u = 1.0 - v - w;
    let sliver = square <= SLIVER * (ab.length_squared() * ac.length_squared());
    let mut best = (a, f64::INFINITY);
    if u >= 0.0 && v >= 0.0 && w >= 0.0 {
        let point = a + ab * v + ac * w;
        best = (point, (point - p).length_squared());
        if !sliver {
            return best;
        }
    }
    for (weight, from, edge) in [(u, b, c - b), (v, a, ac), (w, a, ab)] {
        if weight < 0.0 || sliver {
            let along = ((p - from).dot(edge) / edge.length_squared()).clamp(0.0, 1.0);
            let point = from + edge * along;
            let distance_squared = (point - p).length_squared();
            if distance_squared < best.1 {
                best = (point, distance_squared);
            }
        }
    }
    best
}

/// Where a ray meets a triangle: `t > 0` and the weights of the corners (Moller and Trumbore 1997).
pub(crate) fn hit_triangle(&[a, b, c]: &Corners, origin: DVec3, direction: DVec3) -> Option<(f64, [f64; 3])> {
    let (ab, ac, ao) = (b - a, c - a, origin - a);
    let normal = ab.cross(ac);
    let facing = -direction.dot(normal);
    if facing == 0.0 {
        return None;
    }
    let turned = ao.cross(direction);
    let (t, v, w) = (ao.dot(normal) / facing, ac.dot(turned) / facing, -ab.dot(turned) / facing);
    // A hair of overlap, so that no ray slips between two triangles.
    let edge = -1e-12;
    (v >= edge && w >= edge && v + w <= 1.0 - edge && t > 0.0).then_some((t, [1.0 - v - w, v, w]))
}

/// The unit normal; zero for a triangle without an area.
pub(crate) fn unit_normal(corners: &Corners) -> DVec3 {
    normal(corners).normalize_or_zero()
}

/// The normal, twice the area long.
pub(crate) fn normal(&[a, b, c]: &Corners) -> DVec3 {
    (b - a).cross(c - a)
}

/// The angle that a triangle fills around a point on it, radians: a full turn inside, half a turn on an edge, its own
/// angle at a corner. Nearer than `snap` to an edge or a corner is on it.
pub(crate) fn angle_at(&[a, b, c]: &Corners, point: DVec3, snap: f64) -> f64 {
    for (corner, next, last) in [(a, b, c), (b, c, a), (c, a, b)] {
        if (point - corner).length() <= snap {
            let (out, back) = (next - corner, last - corner);
            return out.cross(back).length().atan2(out.dot(back));
        }
    }
    let beside = |(from, to): (DVec3, DVec3)| {
        let edge = to - from;
        edge.cross(point - from).length() <= snap * edge.length()
    };
    if [(a, b), (b, c), (c, a)].into_iter().any(beside) { PI } else { TAU }
}
