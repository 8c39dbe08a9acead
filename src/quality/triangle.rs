//! Geometry of a single triangle: degeneracy, nearest point, intersection with a ray, angle and weights at a point.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

/// Squared sine of a corner below which rounding may spoil the weights.
const SLIVER: f64 = 1e-10;

/// The corners of a triangle, object units.
pub(crate) type Corners = [DVec3; 3];

/// Tests if a triangle has an area. Needs no tolerance: differences and products of single precision numbers lose
/// almost nothing in double precision.
pub(crate) fn has_area(&[a, b, c]: &Corners) -> bool {
    (b - a).cross(c - a) != DVec3::ZERO
}

/// Returns the point of a triangle nearest to `p`, and its squared distance.
///
/// Inside the prism over the triangle it is the projection of `p` onto the plane. Elsewhere it lies on an edge with `p`
/// on its outer side (at most two edges). For any rounding of the weights, the result is a point of the triangle with
/// its distance from `p`, so never below the true distance. In a sliver all edges are tried too: no point of the
/// triangle is farther from the edges than half its height.
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

/// Intersects a ray with a triangle: returns `t > 0` and the weights of the corners (Moller and Trumbore 1997).
pub(crate) fn hit_triangle(&[a, b, c]: &Corners, origin: DVec3, direction: DVec3) -> Option<(f64, [f64; 3])> {
    let (ab, ac, ao) = (b - a, c - a, origin - a);
    let normal = ab.cross(ac);
    let facing = -direction.dot(normal);
    if facing == 0.0 {
        return None;
    }
    let turned = ao.cross(direction);
    let (t, v, w) = (ao.dot(normal) / facing, ac.dot(turned) / facing, -ab.dot(turned) / facing);
    // Triangles overlap slightly, so no ray slips between two neighbours.
    let edge = -1e-12;
    (v >= edge && w >= edge && v + w <= 1.0 - edge && t > 0.0).then_some((t, [1.0 - v - w, v, w]))
}

/// Returns the unit normal; zero for a triangle without an area.
pub(crate) fn unit_normal(corners: &Corners) -> DVec3 {
    normal(corners).normalize_or_zero()
}

/// Returns the normal; its length is twice the area.
pub(crate) fn normal(&[a, b, c]: &Corners) -> DVec3 {
    (b - a).cross(c - a)
}

/// Returns the angle filled by a triangle around a point on it, radians: 2 pi inside, pi on an edge, the corner's angle
/// at a corner. A point within `snap` of an edge or a corner counts as on it.
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

/// Returns the weights of the corners at a point of the triangle, none negative. In a sliver, weights along its longest
/// edge.
pub(crate) fn weights_at(corners @ &[a, b, c]: &Corners, point: DVec3) -> [f64; 3] {
    let (ab, ac, ap) = (b - a, c - a, point - a);
    let normal = ab.cross(ac);
    let square = normal.length_squared();
    if square > SLIVER * (ab.length_squared() * ac.length_squared()) {
        let v = (ap.cross(ac).dot(normal) / square).clamp(0.0, 1.0);
        let w = (ab.cross(ap).dot(normal) / square).clamp(0.0, 1.0 - v);
        return [1.0 - v - w, v, w];
    }
    let length = |i: usize| (corners[(i + 1) % 3] - corners[i]).length_squared();
    let longest = (1..3).fold(0, |best, i| if length(i) > length(best) { i } else { best });
    let (from, to) = (corners[longest], corners[(longest + 1) % 3]);
    let along = ((point - from).dot(to - from) / length(longest)).clamp(0.0, 1.0);
    let mut weights = [0.0; 3];
    weights[longest] = 1.0 - along;
    weights[(longest + 1) % 3] = along;
    weights
}
