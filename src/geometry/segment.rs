//! A segment between two points.

use glam::Vec3;

/// Returns the weight of `b` in the blend of `a` and `b` nearest to `x` on the segment.
#[inline]
pub(crate) fn blend_weight(a: Vec3, b: Vec3, x: Vec3) -> f32 {
    let ab = b - a;
    let length = ab.length_squared();
    let share = (x - a).dot(ab) / length;
    // NaN where points coincide, or where products overflow far away.
    if share > 0.0 { share.min(1.0) } else { 0.0 }
}
