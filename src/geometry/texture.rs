//! A triangle in texture space: its area, and the side that it shows.

/// Height over length below which a triangle of texture space has no side.
const FLAT: f64 = 1e-6;

/// Returns 1 for a counterclockwise triangle of texture space, -1 for a clockwise triangle, 0 without a side.
#[inline]
pub(crate) fn side(corners: [[f32; 2]; 3]) -> i8 {
    let (area, scale) = area(corners);
    if area > FLAT * scale {
        1
    } else if area < -FLAT * scale {
        -1
    } else {
        0
    }
}

/// Returns twice the signed area of a triangle of texture space, and the sum of two squared sides.
#[inline]
pub(crate) fn area(corners: [[f32; 2]; 3]) -> (f64, f64) {
    let [a, b, c] = corners.map(|p| p.map(f64::from));
    let (e, f) = ([b[0] - a[0], b[1] - a[1]], [c[0] - a[0], c[1] - a[1]]);
    (e[0] * f[1] - e[1] * f[0], e[0] * e[0] + e[1] * e[1] + f[0] * f[0] + f[1] * f[1])
}
