//! The matrix of a camera that looks at a point.

use glam::DVec3;

/// Returns the matrix from world to eye, for [`View::perspective`](super::View::perspective), of a camera at `eye`
/// looking at `target`, with `up` upwards in its picture.
///
/// If `up` is parallel to the view or has no direction, the picture is turned about another axis. If `eye` equals
/// `target`, the camera looks along -z. Numbers which are not finite give a matrix which is not finite; views refuse such
/// matrices.
///
/// ```
/// use multires::view::{View, look_at};
///
/// let camera = look_at([0.0, 0.0, 5.0], [0.0; 3], [0.0, 1.0, 0.0]);
/// let view = View::perspective(camera, 1.0, [1920, 1080])?;
/// assert_eq!(view.forward(), [0.0, 0.0, -1.0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn look_at(eye: [f32; 3], target: [f32; 3], up: [f32; 3]) -> [[f32; 4]; 4] {
    if ![eye, target, up].as_flattened().iter().all(|x| x.is_finite()) {
        return [[f32::NAN; 4]; 4];
    }
    let [eye, target, up] = [eye, target, up].map(|v| DVec3::from_array(v.map(f64::from)));
    let ahead = (target - eye).try_normalize().unwrap_or(DVec3::NEG_Z);
    // Below this sine of its angle to the view, a direction does not tell which way is up.
    let across = |up: DVec3| {
        let right = ahead.cross(up.try_normalize()?);
        (right.length() > 1e-6).then(|| right.normalize())
    };
    // At least one of two axes is not along the view.
    let right = across(up).or_else(|| across(DVec3::Y)).or_else(|| across(DVec3::Z)).unwrap_or(DVec3::X);
    let rows = [right, right.cross(ahead), -ahead];
    let column = |i: usize| {
        let [x, y, z] = rows.map(|row| row[i] as f32);
        [x, y, z, 0.0]
    };
    let [x, y, z] = rows.map(|row| -row.dot(eye) as f32);
    [column(0), column(1), column(2), [x, y, z, 1.0]]
}

#[cfg(test)]
mod tests {
    use super::super::View;
    use super::*;

    #[test]
    fn the_target_is_straight_ahead_and_up_is_up() {
        let somewhere =
            [[0.0, 0.0, 0.0], [1.0, -2.0, 3.0], [0.0, 5.0, 0.0], [1e4, 1.0, -7.0], [0.0, 0.0, -4.0]];
        let directions = [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, -3.0, 0.0], [1.0, 1.0, 1.0], [0.0; 3]];
        for eye in somewhere {
            for target in somewhere {
                for up in directions {
                    let matrix = look_at(eye, target, up);
                    let view = View::perspective(matrix, 1.0, [640, 480]).unwrap();
                    let [e, t, u] = [eye, target, up].map(|v| DVec3::from_array(v.map(f64::from)));
                    let ahead = DVec3::from_array(view.forward().map(f64::from));
                    let seen = DVec3::from_array(view.eye().unwrap().map(f64::from));
                    assert!(seen.distance(e) <= 1e-6 * (1.0 + e.length()) * 4.0, "{eye:?} {seen}");
                    let expected = (t - e).try_normalize().unwrap_or(DVec3::NEG_Z);
                    assert!(ahead.distance(expected) < 1e-5, "{eye:?} {target:?} {up:?} {ahead}");
                    let upwards = DVec3::new(matrix[0][1].into(), matrix[1][1].into(), matrix[2][1].into());
                    assert!(upwards.dot(u) >= -1e-5 && upwards.dot(ahead).abs() < 1e-5);
                }
            }
        }
    }

    #[test]
    fn what_is_not_finite_is_refused() {
        for bad in [f32::NAN, f32::INFINITY] {
            for which in 0..3 {
                let mut all = [[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]];
                all[which][1] = bad;
                let [eye, target, up] = all;
                assert!(View::perspective(look_at(eye, target, up), 1.0, [4, 4]).is_err());
            }
        }
    }
}
