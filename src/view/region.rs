//! The sphere and the packed cone of normals shared by all kinds of bounds.
//!
//! A cone takes four bytes: the axis in 127ths, and the half-angle in 255ths of a right angle. 255: normals of all
//! directions.

use std::f64::consts::FRAC_PI_2;
use std::sync::LazyLock;

use glam::DVec3;

/// Steps of the half-angle in its byte, and of an axis component.
const ANGLE_STEPS: f64 = 255.0;
const AXIS_STEPS: f64 = 127.0;
/// Radius for all of space.
const EVERYWHERE: f64 = 1e40;

/// A cone of all directions, without an axis.
pub(super) const ALL: [i8; 4] = [0, 0, 0, ANY];
/// The byte of the half-angle for all directions.
pub(super) const ANY: i8 = -1;

/// Sine and cosine of every half-angle.
static ANGLES: LazyLock<[[f64; 2]; 256]> =
    LazyLock::new(|| std::array::from_fn(|step| (step as f64 * (FRAC_PI_2 / ANGLE_STEPS)).sin_cos().into()));

/// Returns a radius. For all of space, it exceeds any distance between single-precision points.
#[inline]
pub(super) fn reach(radius: f32) -> f64 {
    if radius < f32::MAX { f64::from(radius) } else { EVERYWHERE }
}

/// Whether the sphere at `a` contains the sphere at `b`.
pub(super) fn sphere_holds((a, radius): ([f32; 3], f32), (b, inner): ([f32; 3], f32)) -> bool {
    let [x, y, z] = [0, 1, 2].map(|axis| f64::from(a[axis]) - f64::from(b[axis]));
    radius == f32::MAX || (x * x + y * y + z * z).sqrt() + reach(inner) <= reach(radius)
}

/// Whether a cone contains another cone.
pub(super) fn cone_holds(outer: [i8; 4], inner: [i8; 4]) -> bool {
    surely_holds(outer, inner) || holds_exactly(outer, inner)
}

/// Whether a cone contains another cone by more than rounding, or they have one axis: cosines instead of angles.
fn surely_holds(outer: [i8; 4], inner: [i8; 4]) -> bool {
    let [wide, narrow] = [outer[3] as u8, inner[3] as u8];
    let [a, b] = [outer, inner].map(|[x, y, z, _]| [x, y, z].map(i32::from));
    if outer[3] == ANY || inner[3] == ANY || wide < narrow || a == [0; 3] || b == [0; 3] {
        return false;
    }
    let dot = |a: [i32; 3], b: [i32; 3]| f64::from(a[0] * b[0] + a[1] * b[1] + a[2] * b[2]);
    let [_, cosine] = ANGLES[usize::from(wide - narrow)];
    let (cosine, along) = (cosine + 1e-9, dot(a, b));
    a == b || along > 0.0 && along * along > cosine * cosine * (dot(a, a) * dot(b, b))
}

fn holds_exactly(outer: [i8; 4], inner: [i8; 4]) -> bool {
    match (unpack(outer), unpack(inner)) {
        (None, _) => true,
        (Some(_), None) => false,
        (Some((a, wide)), Some((b, narrow))) => angle_between(a, b) + narrow <= wide + 1e-12,
    }
}

/// Returns a cone's axis, in 127ths; 0 without an axis.
#[inline]
pub(super) fn axis([x, y, z, _]: [i8; 4]) -> DVec3 {
    DVec3::new(f64::from(x), f64::from(y), f64::from(z))
}

/// Returns a cone's axis (unit length) and half-angle in radians; `None` if the cone contains all directions.
pub(super) fn unpack(cone: [i8; 4]) -> Option<(DVec3, f64)> {
    if cone[3] == ANY {
        return None;
    }
    Some((axis(cone).try_normalize()?, f64::from(cone[3] as u8) * (FRAC_PI_2 / ANGLE_STEPS)))
}

/// Returns a cone as used by tests: its axis at any length, and sine and cosine of its half-angle; `None` if the cone
/// contains all directions.
#[inline]
pub(super) fn facing(cone: [i8; 4]) -> Option<(DVec3, [f64; 2])> {
    let [x, y, z, angle] = cone;
    if angle == ANY || (x | y | z) == 0 {
        return None;
    }
    Some((axis(cone), ANGLES[usize::from(angle as u8)]))
}

/// Sine and cosine of every half-angle, in single precision.
static LANE_ANGLES: LazyLock<[[f32; 2]; 256]> = LazyLock::new(|| ANGLES.map(|angle| angle.map(|x| x as f32)));

/// Returns the table for [`lane_angle`].
pub(super) fn lane_angles() -> &'static [[f32; 2]; 256] {
    &LANE_ANGLES
}

/// Returns sine and cosine of a cone's half-angle, in single precision; 2 and 0 for all directions.
#[inline(always)]
pub(super) fn lane_angle([x, y, z, angle]: [i8; 4], angles: &[[f32; 2]; 256]) -> [f32; 2] {
    if angle == ANY || (x | y | z) == 0 { [2.0, 0.0] } else { angles[usize::from(angle as u8)] }
}

/// Rounds an axis, and widens the angle by the rotation due to rounding. `None` if the axis has no direction.
pub(super) fn pack(axis: DVec3, half_angle: f64) -> Option<[i8; 4]> {
    let axis = axis.try_normalize()?;
    let rounded = axis.to_array().map(|x| (x * AXIS_STEPS).round() as i8);
    let turned = DVec3::from_array(rounded.map(f64::from)).try_normalize()?;
    let wide = half_angle + angle_between(axis, turned);
    let steps = (wide * (ANGLE_STEPS / FRAC_PI_2)).ceil();
    let [x, y, z] = rounded;
    let angle = if (0.0..ANGLE_STEPS).contains(&steps) { steps as u8 as i8 } else { ANY };
    Some([x, y, z, angle])
}

/// Returns the angle between two unit vectors, exact for small angles too.
pub(crate) fn angle_between(a: DVec3, b: DVec3) -> f64 {
    2.0 * (a - b).length().atan2((a + b).length())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packing_only_widens() {
        let mut state = 1u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 33) as f64 / (1u64 << 31) as f64 * 2.0 - 1.0
        };
        for _ in 0..20_000 {
            let axis = DVec3::new(random(), random(), random());
            let angle = random().abs() * 1.6;
            let cone = pack(axis, angle).unwrap();
            if let Some((packed, wide)) = unpack(cone) {
                assert!(angle_between(packed, axis.normalize()) + angle <= wide + 1e-9);
                assert!(wide <= angle + 0.02);
            } else {
                assert!(angle > FRAC_PI_2 - 0.02);
            }
        }
    }

    /// Cosines say yes only where angles do.
    #[test]
    fn the_quick_answer_is_right() {
        let mut state = 1u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 40) as i8
        };
        let mut quick = 0;
        for _ in 0..200_000 {
            let outer: [i8; 4] = std::array::from_fn(|_| random());
            let mut inner: [i8; 4] = std::array::from_fn(|i| outer[i].saturating_add(random() / 16));
            inner[3] = random();
            if surely_holds(outer, inner) {
                quick += 1;
                assert!(holds_exactly(outer, inner), "{outer:?} {inner:?}");
            }
        }
        assert!(quick > 10_000, "{quick}");
    }
}
