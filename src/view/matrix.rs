//! Matrix algebra for reading cameras, in double precision.
//!
//! Matrices are given by columns, as in graphics interfaces and glam: `m[column][row]`.

use glam::{DMat3, DMat4, DVec3, DVec4};

/// Converts a matrix from columns; `None` if an entry is not finite.
pub(super) fn columns(m: [[f32; 4]; 4]) -> Option<DMat4> {
    let finite = m.as_flattened().iter().all(|x| x.is_finite());
    finite.then(|| DMat4::from_cols_array_2d(&m.map(|column| column.map(f64::from))))
}

/// Returns the factor by which a matrix scales all lengths. `None` if the matrix shears or scales directions differently
/// (by more than 1 in 10,000), or is not affine.
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

/// If the ratio of least to greatest scale is at most this, the object counts as flattened: single precision tells no
/// more.
const FLAT: f64 = 1e-7;

/// Returns the least and the greatest factor by which a matrix scales a length. The least is rounded down, the greatest
/// up. Both are equal for a uniform scale. The least is 0 if the matrix flattens. `None` if the matrix is not affine.
pub(super) fn scales(m: &DMat4) -> Option<[f64; 2]> {
    if let Some(scale) = uniform_scale(m) {
        return Some([scale; 2]);
    }
    if m.row(3) != DVec4::W {
        return None;
    }
    let a = DMat3::from_mat4(*m);
    let most = greatest_scale(&a);
    let inverse = a.inverse();
    let least = if inverse.is_finite() { 1.0 / greatest_scale(&inverse) } else { 0.0 };
    Some([if least > FLAT * most { least } else { 0.0 }, most])
}

/// Returns the greatest factor by which a matrix scales a length, rounded up: the root of the greatest eigenvalue of
/// `a'a`, by trigonometry, in units of the mean eigenvalue. (The least eigenvalue would be lost in the rounding of the
/// greatest.)
fn greatest_scale(a: &DMat3) -> f64 {
    let square = a.transpose() * *a;
    let mean = (square.x_axis.x + square.y_axis.y + square.z_axis.z) / 3.0;
    if mean <= 0.0 {
        return 0.0;
    }
    let part = square * (1.0 / mean) - DMat3::IDENTITY;
    let squares = part.x_axis.length_squared() + part.y_axis.length_squared() + part.z_axis.length_squared();
    let spread = (squares / 6.0).sqrt();
    let greatest = if spread > 0.0 {
        let angle = (0.5 * (part * (1.0 / spread)).determinant()).clamp(-1.0, 1.0).acos() / 3.0;
        1.0 + 2.0 * spread * angle.cos()
    } else {
        1.0
    };
    (mean * greatest).sqrt() * (1.0 + 1e-7)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scales_of_matrices() {
        let of = |m: DMat3| scales(&DMat4::from_mat3(m)).unwrap();
        // Rounded outward, by no more than a millionth.
        let assert_near = |[least, most]: [f64; 2], [low, high]: [f64; 2]| {
            assert!(least <= low * (1.0 + 1e-12) && least >= low * (1.0 - 1e-6), "{least} is not {low}");
            assert!(most >= high * (1.0 - 1e-12) && most <= high * (1.0 + 1e-6), "{most} is not {high}");
        };
        for (x, y, z) in [
            (1.0, 2.0, 5.0),
            (3.0, 3.0, 1e-3),
            (1e-8, 2e-8, 2e-8),
            (-4.0, 1.0, 1.0),
            (1e-5, 1e-4, 1.0),
            (1e-4, 1e-4, 1.0),
            (1e-3, 1.5e-3, 1.0),
            (1.0, 0.9999, 0.2),
        ] {
            let mut all = [f64::abs(x), f64::abs(y), f64::abs(z)];
            all.sort_by(f64::total_cmp);
            for i in 0..50 {
                let turn = |i: i32| {
                    let angle = |k: i32| f64::from(i * k % 17);
                    DMat3::from_euler(glam::EulerRot::XYZ, angle(3), angle(5), angle(7))
                };
                let m = turn(i) * DMat3::from_diagonal(DVec3::new(x, y, z)) * turn(i + 9);
                assert_near(of(m), [all[0], all[2]]);
            }
        }
        assert_eq!(of(DMat3::from_diagonal(DVec3::new(1.0, 1.0, 0.0)))[0], 0.0);
        assert_eq!(of(DMat3::ZERO), [0.0; 2]);
        let golden = (1.0 + 5f64.sqrt()) / 2.0;
        let shear = DMat3::from_cols(DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::Z);
        assert_near(of(shear), [golden - 1.0, golden]);
        assert_eq!(
            scales(&DMat4::from_cols(DVec4::X, DVec4::Y, DVec4::Z, DVec4::new(0.0, 0.0, 0.0, 2.0))),
            None
        );
    }
}
