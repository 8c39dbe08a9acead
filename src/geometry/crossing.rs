//! Crossing test of two triangles.
//!
//! ```text
//!         /|            A side of one triangle pierces the other: its ends lie strictly on either side of the other's
//!     ---/-|---         plane, and it meets that within the triangle or on its rim. Triangles that only touch, and
//!       /__|            triangles in one plane, do not cross.
//! ```

use glam::DVec3;

use super::triangle::Corners;

/// Whether two triangles cross, whose corners were single precision: differences of corners are as good as exact.
/// Symmetric. A sign within rounding counts as 0.
pub(crate) fn triangles_cross(a: &Corners, b: &Corners) -> bool {
    let sides = |b: &Corners| a_sides(b).iter().any(|&[p, q]| pierces(p, q, a));
    sides(b) || a_sides(a).iter().any(|&[p, q]| pierces(p, q, b))
}

fn a_sides(&[a, b, c]: &Corners) -> [[DVec3; 2]; 3] {
    [[a, b], [b, c], [c, a]]
}

/// Whether the segment from `p` to `q` passes through a triangle.
fn pierces(p: DVec3, q: DVec3, &[a, b, c]: &Corners) -> bool {
    let (above, below) = (side(a, b, c, p), side(a, b, c, q));
    if above * below >= 0 {
        return false;
    }
    let [ab, bc, ca] = [side(p, q, a, b), side(p, q, b, c), side(p, q, c, a)];
    (ab >= 0 && bc >= 0 && ca >= 0) || (ab <= 0 && bc <= 0 && ca <= 0)
}

/// Returns the side of the plane of `a`, `b`, `c` on which `d` lies: the sign of the determinant, 0 within its
/// rounding.
fn side(a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> i32 {
    let (u, v, w) = (a - d, b - d, c - d);
    let (x, y, z) = (v.y * w.z, v.z * w.x, v.x * w.y);
    let (x2, y2, z2) = (v.z * w.y, v.x * w.z, v.y * w.x);
    let determinant = u.x * (x - x2) + u.y * (y - y2) + u.z * (z - z2);
    let size = u.x.abs() * (x.abs() + x2.abs())
        + u.y.abs() * (y.abs() + y2.abs())
        + u.z.abs() * (z.abs() + z2.abs());
    if determinant.abs() <= 16.0 * f64::EPSILON * size {
        0
    } else if determinant > 0.0 {
        1
    } else {
        -1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FLAT: Corners = [DVec3::ZERO, DVec3::new(4.0, 0.0, 0.0), DVec3::new(0.0, 4.0, 0.0)];

    fn cross(b: Corners) -> bool {
        let result = triangles_cross(&FLAT, &b);
        // In either order, from any corner, with either orientation.
        let [p, q, r] = b;
        assert_eq!(triangles_cross(&b, &FLAT), result);
        assert_eq!(triangles_cross(&FLAT, &[r, q, p]), result);
        assert_eq!(triangles_cross(&FLAT, &[q, r, p]), result);
        result
    }

    #[test]
    fn only_what_passes_through_crosses() {
        let v = DVec3::new;
        // A tip through the middle; through the rim only; through a side; beside.
        assert!(cross([v(1.0, 1.0, -1.0), v(1.2, 1.0, 2.0), v(1.0, 1.4, 2.0)]));
        assert!(cross([v(2.0, 0.0, -1.0), v(2.0, 0.0, 1.0), v(2.0, -3.0, 0.0)]));
        assert!(cross([v(-1.0, 1.0, -1.0), v(-1.0, 1.0, 1.0), v(1.0, 1.0, 0.5)]));
        assert!(!cross([v(-1.0, -1.0, -1.0), v(-1.0, -1.0, 1.0), v(-2.0, 1.0, 0.5)]));
        // Above; touching with a tip; lying in the plane; far beyond.
        assert!(!cross([v(1.0, 1.0, 0.5), v(2.0, 1.0, 0.5), v(1.0, 2.0, 1.0)]));
        assert!(!cross([v(1.0, 1.0, 0.0), v(1.2, 1.0, 2.0), v(1.0, 1.4, 2.0)]));
        assert!(!cross([v(1.0, 1.0, 0.0), v(9.0, 1.0, 0.0), v(1.0, 9.0, 0.0)]));
        assert!(!cross([v(5.0, 5.0, -1.0), v(5.0, 5.0, 1.0), v(6.0, 5.0, 0.0)]));
    }
}
