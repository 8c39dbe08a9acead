//! The little matrix algebra that reading cameras takes, in double precision.
//!
//! Matrices are columns, as graphics interfaces and glam hand them over: `m[column][row]`.

use glam::{DMat4, DVec3, DVec4};

/// A matrix from columns; `None` where an entry is not finite.
pub(super) fn columns(m: [[f32; 4]; 4]) -> Option<DMat4> {
    let finite = m.as_flattened().iter().all(|x| x.is_finite());
    finite.then(|| DMat4::from_cols_array_2d(&m.map(|column| column.map(f64::from))))
}

/// Factor by which a matrix scales all lengths; `None` where it shears or scales directions differently (by more than
/// 1 in 10,000), or is no affine map.
pub(super) fn uniform_scale(m: &DMat4) -> Option<f64> {
    if m.row(3) != DVec4::W {
        return None;
    }
    let [x, y, z] = [m.x_axis, m.y_axis, m.z_axis].map(|axis| axis.truncate());
    let scale = ((x.length_squared() + y.length_squared() + z.length_squared()) / 3.0).sqrt();
    let square = scale * scale;
    let even = |a: DVec3| (a.length_squared() - square).abs() <= 2e-4 * square;
    let apart = |a: DVec3, b: DVec3| a.dot(b).abs() <= 1e-4 * square;
    (scale > 0.0 && even(x) && even(y) && even(z) && apart(x, y) && apart(y, z) && apart(z, x))
        .then_some(scale)
}
