//! A camera as lines: its eye, and what it sees.

use glam::DVec3;

use crate::camera::{Lens, Pose};
use crate::renderer::{LineEnd, linear};

/// Ends of the lines of a frustum, two each: from the eye to the corners of its picture at that distance, and around it.
pub fn lines(pose: &Pose, lens: &Lens, distance: f64) -> Vec<LineEnd> {
    let [right, up, ahead] = pose.axes().map(DVec3::from_array);
    let high = (lens.field_of_view * 0.5).tan();
    let wide = high * f64::from(lens.size[0]) / f64::from(lens.size[1].max(1));
    let eye = DVec3::from_array(pose.eye);
    let corner = |x: f64, y: f64, share: f64| {
        eye + (ahead + right * (x * wide) + up * (y * high)) * (distance * share)
    };
    let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    let mut ends = Vec::with_capacity(32);
    let mut line = |a: DVec3, b: DVec3, colour: [f32; 4]| {
        ends.extend([a, b].map(|p| LineEnd { position: p.as_vec3().to_array(), colour }));
    };
    let strong = linear([208, 64, 24], 0.95);
    let faint = linear([208, 64, 24], 0.45);
    for i in 0..4 {
        let ([x, y], [u, v]) = (<[f64; 2]>::from(corners[i]), <[f64; 2]>::from(corners[(i + 1) % 4]));
        line(eye, corner(x, y, 1.0), strong);
        line(corner(x, y, 1.0), corner(u, v, 1.0), strong);
        line(corner(x, y, 0.15), corner(u, v, 0.15), faint);
    }
    // What is up.
    line(corner(-0.3, 1.0, 0.15), corner(0.0, 1.4, 0.15), strong);
    line(corner(0.3, 1.0, 0.15), corner(0.0, 1.4, 0.15), strong);
    ends
}
