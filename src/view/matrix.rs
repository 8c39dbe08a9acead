//! The little matrix algebra that reading cameras takes, in double precision.
//!
//! Matrices are columns, as graphics interfaces and glam hand them over: `m[column][row]`.

use glam::{DMat3, DMat4, DVec3, DVec4};

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

/// The least and the greatest factor by which a matrix scales a length, the least rounded down and the greatest up; both the
/// same where it scales evenly. `None` where it is no affine map; the least is 0 where it flattens.
pub(super) fn scales(m: &DMat4) -> Option<[f64; 2]> {
    if let Some(scale) = uniform_scale(m) {
        return Some([scale; 2]);
    }
    if m.row(3) != DVec4::W {
        return None;
    }
    let a = DMat3::from_mat4(*m);
    // Eigenvalues of a'a, by trigonometry, in parts of their mean.
    let square = a.transpose() * a;
    let mean = (square.x_axis.x + square.y_axis.y + square.z_axis.z) / 3.0;
    if mean <= 0.0 {
        return Some([0.0; 2]);
    }
    let part = square * (1.0 / mean) - DMat3::IDENTITY;
    let spread =
        ((part.x_axis.length_squared() + part.y_axis.length_squared() + part.z_axis.length_squared()) / 6.0)
            .sqrt();
    if spread <= 0.0 {
        return Some([mean.sqrt(); 2]);
    }
    let angle = (0.5 * (part * (1.0 / spread)).determinant()).clamp(-1.0, 1.0).acos() / 3.0;
    let third = std::f64::consts::TAU / 3.0;
    let [least, greatest] = [angle + third, angle].map(|angle| 1.0 + 2.0 * spread * angle.cos());
    // Rounding of the least is in parts of the greatest.
    Some([(mean * (least - 1e-12 * greatest).max(0.0)).sqrt(), (mean * greatest).sqrt() * (1.0 + 1e-12)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scales_of_matrices() {
        let of = |m: DMat3| scales(&DMat4::from_mat3(m)).unwrap();
        let near = |[a, b]: [f64; 2], [c, d]: [f64; 2]| (a - c).abs() < 1e-6 * d && (b - d).abs() < 1e-6 * d;
        let turn = DMat3::from_euler(glam::EulerRot::XYZ, 0.3, -1.2, 2.0);
        for (x, y, z) in [(1.0, 2.0, 5.0), (3.0, 3.0, 1e-3), (1e-8, 2e-8, 2e-8), (-4.0, 1.0, 1.0)] {
            let [least, _, greatest] = {
                let mut all = [f64::abs(x), f64::abs(y), f64::abs(z)];
                all.sort_by(f64::total_cmp);
                all
            };
            let m = turn * DMat3::from_diagonal(DVec3::new(x, y, z)) * turn.transpose() * turn;
            assert!(near(of(m), [least, greatest]), "{x} {y} {z}: {:?}", of(m));
        }
        assert_eq!(of(DMat3::from_diagonal(DVec3::new(1.0, 1.0, 0.0)))[0], 0.0);
        assert_eq!(of(DMat3::ZERO), [0.0; 2]);
        let golden = (1.0 + 5f64.sqrt()) / 2.0;
        let shear = DMat3::from_cols(DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::Z);
        assert!(near(of(shear), [golden - 1.0, golden]), "{:?}", of(shear));
        assert_eq!(
            scales(&DMat4::from_cols(DVec4::X, DVec4::Y, DVec4::Z, DVec4::new(0.0, 0.0, 0.0, 2.0))),
            None
        );
    }
}
