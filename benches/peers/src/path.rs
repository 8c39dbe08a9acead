//! Camera paths: an approach to a mesh, from a formula or from a file, and slow ones around single poses of it.
//!
//! ```text
//!     0 ... 399    from 3 diagonals away down to a tenth, one and a half turns around
//!   400 ... 499    a third of a turn, close by
//!   500 ... 599    away again
//! ```

use std::error::Error;
use std::path::Path;

use multires::mesh::Mesh;
use multires::view::{View, ViewError};

/// Distance of the surface from the middle of the box, about, in diagonals: so much farther is the eye.
const OFFSET: f64 = 0.3;
const FAR: f64 = 3.0;
const NEAR: f64 = 0.1;

/// Where the eye is and what it looks at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Pose {
    pub eye: [f64; 3],
    pub target: [f64; 3],
}

/// The path by its formula, about the origin, in diagonals.
pub(crate) fn approach() -> Vec<Pose> {
    let frame = |k: u32| {
        let k = f64::from(k);
        let (distance, degrees) = if k < 400.0 {
            let s = k / 399.0;
            (FAR * (NEAR / FAR).powf(s), 540.0 * s)
        } else if k < 500.0 {
            (NEAR, 540.0 + 120.0 * (k - 399.0) / 100.0)
        } else {
            let s = (k - 499.0) / 100.0;
            (NEAR * (FAR / NEAR).powf(s), 660.0 + 180.0 * s)
        };
        let theta = degrees.to_radians();
        let phi = (20.0 + 10.0 * theta.sin()).to_radians();
        let r = OFFSET + distance;
        let eye = [r * phi.cos() * theta.cos(), r * phi.sin(), r * phi.cos() * theta.sin()];
        Pose { eye, target: [0.0; 3] }
    };
    (0..600).map(frame).collect()
}

/// A path from lines of `frame,eye_x,eye_y,eye_z,target_x,target_y,target_z`, about the origin, in diagonals; lines that start
/// with anything but a digit are left out.
pub(crate) fn read(path: &Path) -> Result<Vec<Pose>, Box<dyn Error>> {
    let text = std::fs::read_to_string(path)?;
    let lines = text.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit()));
    let poses: Vec<Pose> = lines
        .map(|line| {
            let numbers: Vec<f64> = line.split(',').map(|x| x.trim().parse()).collect::<Result<_, _>>()?;
            match numbers[..] {
                [_, ex, ey, ez, tx, ty, tz] if numbers.iter().all(|x| x.is_finite()) => {
                    Ok(Pose { eye: [ex, ey, ez], target: [tx, ty, tz] })
                }
                _ => Err(format!("not seven numbers: {line}").into()),
            }
        })
        .collect::<Result<_, Box<dyn Error>>>()?;
    if poses.is_empty() { Err("no frames".into()) } else { Ok(poses) }
}

/// A path about the origin in diagonals, moved to a mesh.
pub(crate) fn around(mesh: &Mesh, path: &[Pose]) -> Vec<Pose> {
    let Some([low, high]) = mesh.bounds() else { return path.to_vec() };
    let diagonal = mesh.diagonal();
    let middle: [f64; 3] = std::array::from_fn(|i| (f64::from(low[i]) + f64::from(high[i])) * 0.5);
    let place = |p: [f64; 3]| std::array::from_fn(|i| middle[i] + diagonal * p[i]);
    path.iter().map(|pose| Pose { eye: place(pose.eye), target: place(pose.target) }).collect()
}

/// The eye stays, and turns by one degree a frame: there and back through 30 degrees.
pub(crate) fn turning(pose: Pose) -> Vec<Pose> {
    let away = sub(pose.target, pose.eye);
    let turn = |frame: i32| {
        let degrees = if frame < 30 { frame } else { 60 - frame };
        let (sine, cosine) = f64::from(degrees).to_radians().sin_cos();
        let [x, y, z] = away;
        let turned = [cosine * x + sine * z, y, cosine * z - sine * x];
        Pose { target: add(pose.eye, turned, 1.0), ..pose }
    };
    (0..=60).map(turn).collect()
}

/// The eye moves by 0.2 % of its distance a frame: towards its target, and then sideways.
pub(crate) fn moving(pose: Pose, sideways: bool) -> Vec<Pose> {
    let mut path = vec![pose];
    for _ in 0..60 {
        let last = path[path.len() - 1];
        let away = sub(last.target, last.eye);
        let distance = dot(away, away).sqrt();
        let side = unit(cross(away, [0.0, 1.0, 0.0])).map(|x| x * distance);
        path.push(Pose { eye: add(last.eye, if sideways { side } else { away }, 0.002), ..last });
    }
    path
}

impl Pose {
    /// From world to an eye that looks along -z, its y axis as far up as the target lets it; and the rows of its rotation.
    fn matrix(&self) -> [[f32; 4]; 4] {
        let ahead = unit(sub(self.target, self.eye));
        let up = if ahead[1].abs() > 0.999 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
        let right = unit(cross(ahead, up));
        let rows = [right, cross(right, ahead), ahead.map(|x| -x)];
        let column = |i: usize| [rows[0][i] as f32, rows[1][i] as f32, rows[2][i] as f32, 0.0];
        let [x, y, z] = rows.map(|row| -dot(row, self.eye) as f32);
        [column(0), column(1), column(2), [x, y, z, 1.0]]
    }

    /// The view from here.
    pub(crate) fn view(
        &self,
        field_of_view: f32,
        viewport: [u32; 2],
        tolerance: f32,
    ) -> Result<View, ViewError> {
        Ok(View::perspective(self.matrix(), field_of_view, viewport)?.with_tolerance_px(tolerance))
    }

    /// Inward unit normals and offsets of the four sides and of the plane through the eye.
    pub(crate) fn planes(&self, field_of_view: f64, aspect: f64) -> [[f64; 4]; 5] {
        let m = self.matrix().map(|column| column.map(f64::from));
        let row = |i: usize| [m[0][i], m[1][i], m[2][i], m[3][i]];
        let high = 1.0 / (field_of_view * 0.5).tan();
        let (x, y) = (row(0).map(|c| c * high / aspect), row(1).map(|c| c * high));
        let w = row(2).map(|c| -c);
        let sum = |a: [f64; 4], sign: f64| std::array::from_fn(|i| w[i] + sign * a[i]);
        [sum(x, 1.0), sum(x, -1.0), sum(y, 1.0), sum(y, -1.0), w].map(|plane: [f64; 4]| {
            let length = dot([plane[0], plane[1], plane[2]], [plane[0], plane[1], plane[2]]).sqrt();
            plane.map(|x| x / length)
        })
    }
}

fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    add(a, b, -1.0)
}

fn add(a: [f64; 3], b: [f64; 3], times: f64) -> [f64; 3] {
    std::array::from_fn(|i| a[i] + times * b[i])
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn unit(a: [f64; 3]) -> [f64; 3] {
    let length = dot(a, a).sqrt();
    a.map(|x| x / length)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_formula_starts_far_and_ends_near() {
        let path = approach();
        assert_eq!(path.len(), 600);
        let distance = |pose: &Pose| dot(pose.eye, pose.eye).sqrt();
        assert!((distance(&path[0]) - 3.3).abs() < 1e-12);
        assert!((distance(&path[450]) - 0.4).abs() < 1e-12);
        assert!((distance(&path[599]) - 3.3).abs() < 1e-12);
    }

    #[test]
    fn slow_paths_are_slow() {
        let pose = approach()[300];
        for pair in turning(pose).windows(2) {
            assert_eq!(pair[0].eye, pair[1].eye);
            let [a, b] = [0, 1].map(|i| sub(pair[i].target, pair[i].eye));
            // The turn is about the y axis: no more than a degree on the whole.
            let angle = (dot(a, b) / (dot(a, a) * dot(b, b)).sqrt()).min(1.0).acos().to_degrees();
            assert!((0.8..=1.0 + 1e-6).contains(&angle), "{angle}");
        }
        for sideways in [false, true] {
            for pair in moving(pose, sideways).windows(2) {
                let step = sub(pair[1].eye, pair[0].eye);
                let away = sub(pair[0].target, pair[0].eye);
                assert!((dot(step, step) / dot(away, away)).sqrt() - 0.002 < 1e-9);
            }
        }
    }
}
