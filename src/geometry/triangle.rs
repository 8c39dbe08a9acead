//! Geometry of a single triangle: degeneracy, nearest point, distance, intersection with a ray, angle and weights at a
//! point.
//!
//! Functions that return the same quantity round differently. Results of the crate depend on the last bit, so none
//! stands in for another.

use std::f64::consts::{PI, TAU};

use glam::{DVec3, Vec3};

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

/// Returns the squared distance from a point to a triangle.
#[inline]
pub(crate) fn distance_squared(&[a, b, c]: &Corners, p: DVec3) -> f64 {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let normal = ab.cross(ac);
    let area = normal.length_squared();
    let inside = area > 0.0
        && ab.cross(ap).dot(normal) >= 0.0
        && ap.cross(ac).dot(normal) >= 0.0
        && (c - b).cross(p - b).dot(normal) >= 0.0;
    if inside {
        return ap.dot(normal).powi(2) / area;
    }
    let side = |a: DVec3, b: DVec3| {
        let (along, to) = (b - a, p - a);
        let length = along.length_squared();
        let t = if length > 0.0 { (to.dot(along) / length).clamp(0.0, 1.0) } else { 0.0 };
        (to - along * t).length_squared()
    };
    side(a, b).min(side(b, c)).min(side(c, a))
}

/// Returns the squared distance from a point to a triangle in single precision: to its plane where the point lies over
/// the triangle, else to a side.
#[inline]
pub(crate) fn distance_squared_single([a, b, c]: [Vec3; 3], p: Vec3) -> f32 {
    let normal = (b - a).cross(c - a);
    let sides = [(a, b), (b, c), (c, a)];
    if normal != Vec3::ZERO && sides.iter().all(|&(u, v)| normal.cross(v - u).dot(p - u) >= 0.0) {
        let height = normal.dot(p - a);
        return height * height / normal.length_squared();
    }
    let to_side = |&(u, v): &(Vec3, Vec3)| {
        let (side, to) = (v - u, p - u);
        let t = to.dot(side) / side.length_squared();
        let t = if t > 0.0 { t.min(1.0) } else { 0.0 };
        (to - t * side).length_squared()
    };
    sides.iter().map(to_side).fold(f32::INFINITY, f32::min)
}

/// Returns the weights of the point of a triangle below `p`, and the squared height of `p` over the squared length of
/// the triangle's longest side; `None` where `p` does not lie over the triangle.
#[inline]
pub(crate) fn weights_below(&[a, b, c]: &Corners, p: DVec3) -> Option<([f64; 3], f64)> {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let normal = ab.cross(ac);
    let square = normal.length_squared();
    let (v, w) = (ap.cross(ac).dot(normal), ab.cross(ap).dot(normal));
    if v < 0.0 || w < 0.0 || v + w > square || square <= 0.0 {
        return None;
    }
    let (v, w) = (v / square, w / square);
    let longest = ab.length_squared().max(ac.length_squared()).max((c - b).length_squared());
    Some(([1.0 - v - w, v, w], ap.dot(normal).powi(2) / (square * longest)))
}

/// Returns the weights of the point of a triangle nearest to `p`, and its squared distance.
#[inline]
pub(crate) fn nearest_weights(&[a, b, c]: &Corners, p: DVec3) -> ([f64; 3], f64) {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let normal = ab.cross(ac);
    let square = normal.length_squared();
    let (v, w) = (ap.cross(ac).dot(normal) / square, ab.cross(ap).dot(normal) / square);
    if v >= 0.0 && w >= 0.0 && v + w <= 1.0 {
        return ([1.0 - v - w, v, w], ap.dot(normal).powi(2) / square);
    }
    let along = |from: DVec3, to: DVec3| {
        let edge = to - from;
        let share = ((p - from).dot(edge) / edge.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        (share, (from + edge * share).distance_squared(p))
    };
    let [(x, first), (y, second), (z, third)] = [along(a, b), along(b, c), along(c, a)];
    if first <= second && first <= third {
        ([1.0 - x, x, 0.0], first)
    } else if second <= third {
        ([0.0, 1.0 - y, y], second)
    } else {
        ([z, 0.0, 1.0 - z], third)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_point_is_no_farther_than_any_other() {
        let [a, b, c] = [DVec3::ZERO, DVec3::new(2.0, 0.0, 0.0), DVec3::new(0.5, 1.0, 0.0)];
        for i in 0..1000u32 {
            let random =
                |k: u32| f64::from(i.wrapping_mul(2_654_435_761).wrapping_add(k * 977) % 1000) / 200.0 - 2.0;
            let p = DVec3::new(random(1), random(2), random(3));
            let (w, distance) = nearest_weights(&[a, b, c], p);
            let point = a * w[0] + b * w[1] + c * w[2];
            assert!((point.distance_squared(p) - distance).abs() < 1e-9 && w.iter().all(|w| *w >= 0.0));
            for j in 0..=10 {
                for k in 0..=10 - j {
                    let (v, u) = (f64::from(j) / 10.0, f64::from(k) / 10.0);
                    assert!((a + (b - a) * v + (c - a) * u).distance_squared(p) >= distance - 1e-9);
                }
            }
        }
    }
}
