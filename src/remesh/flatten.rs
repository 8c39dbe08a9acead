//! Flattens the triangles around a vertex: the conformal map `z^a` of the unrolled star (Lee et al. 1998, section 3.2).
//!
//! ```text
//!        r2 ___ r1               closed: angles are scaled to 2 pi        b --- v --- a   open: angles are scaled to pi,
//!         /\   /\                in all, radii are raised to the           \   / \   /    so that the two edges of the
//!     r3 /__\v/__\ r0            power a of the same scale                  \ /   \ /     curve form a straight line
//!        \  / \  /                                                          r2 --- r1
//!         \/___\/
//! ```
//!
//! Along an open star's line the ratio of both edges is kept: the stars on both sides of a curve agree on it.

use std::f64::consts::{PI, TAU};

use glam::{DVec2, DVec3};

/// Least angle of a corner, radians: corners of needles get room.
const LEAST_ANGLE: f64 = 1e-3;
/// Largest angle of a flattened corner, as a share of pi.
const LARGEST_ANGLE: f64 = 0.97;

/// Flattens a star; `ring` runs counter-clockwise around `centre`, which goes to the origin. The last vertex of a closed
/// ring is joined to the first. Returns false, with `flat` undefined, if a triangle would be turned over.
pub(super) fn flatten(centre: DVec3, ring: &[DVec3], closed: bool, flat: &mut Vec<DVec2>) -> bool {
    flat.clear();
    let count = if closed { ring.len() } else { ring.len().saturating_sub(1) };
    if ring.len() < 3 {
        return false;
    }
    let arm = |i: usize| ring[i % ring.len()] - centre;
    // Angles first, stored where positions go.
    let mut sum = 0.0;
    for i in 0..count {
        let (a, b) = (arm(i), arm(i + 1));
        let angle = a.cross(b).length().atan2(a.dot(b)).max(LEAST_ANGLE);
        flat.push(DVec2::new(sum, angle));
        sum += angle;
    }
    let power = if closed { TAU } else { PI } / sum;
    if flat.iter().any(|corner| corner.y * power > LARGEST_ANGLE * PI) {
        return false;
    }
    if !closed {
        flat.push(DVec2::new(sum, 0.0));
    }
    // Radii at both ends of an open star are as measured: the correction is blended between them.
    let radius = |i: usize| arm(i).length();
    let ends =
        [radius(0), radius(ring.len() - 1)].map(|end| if closed { 0.0 } else { (1.0 - power) * end.ln() });
    for (i, at) in flat.iter_mut().enumerate() {
        let share = at.x / sum;
        let length = radius(i).powf(power) * (ends[0] + (ends[1] - ends[0]) * share).exp();
        let (sine, cosine) = (at.x * power).sin_cos();
        *at = length * DVec2::new(cosine, sine);
    }
    if !closed {
        // Exactly straight.
        flat[0].y = 0.0;
        if let Some(last) = flat.last_mut() {
            last.y = 0.0;
        }
    }
    flat.iter().all(|at| at.is_finite())
}

/// Least quality of a triangle of the fan around a ring vertex: `2 area / longest side^2`.
const LEAST_QUALITY: f64 = 0.02;

/// Whether the fan of triangles around ring vertex `hub` covers the flattened ring with every triangle facing up.
pub(super) fn is_fan(flat: &[DVec2], hub: usize) -> bool {
    let n = flat.len();
    (0..n).all(|i| {
        let j = (i + 1) % n;
        i == hub || j == hub || {
            let (a, b) = (flat[i] - flat[hub], flat[j] - flat[hub]);
            let longest = a.length_squared().max(b.length_squared()).max((b - a).length_squared());
            a.perp_dot(b) > LEAST_QUALITY * longest
        }
    })
}
