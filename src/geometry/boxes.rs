//! Boxes along the axes: `[low, high]`, the smallest and the largest corner.

use glam::{DVec3, Vec3, Vec3A};

/// A position whose coordinates can be compared one by one.
pub(crate) trait Place: Copy {
    /// The box of no points: every point enlarges it.
    const EMPTY: [Self; 2];

    /// Returns the smaller of each coordinate.
    fn low(self, other: Self) -> Self;

    /// Returns the larger of each coordinate.
    fn high(self, other: Self) -> Self;
}

macro_rules! place {
    ($vector:ty) => {
        impl Place for $vector {
            const EMPTY: [Self; 2] = [Self::INFINITY, Self::NEG_INFINITY];

            #[inline]
            fn low(self, other: Self) -> Self {
                self.min(other)
            }

            #[inline]
            fn high(self, other: Self) -> Self {
                self.max(other)
            }
        }
    };
    ($number:ident; 3) => {
        impl Place for [$number; 3] {
            const EMPTY: [Self; 2] = [[$number::INFINITY; 3], [$number::NEG_INFINITY; 3]];

            #[inline]
            fn low(self, other: Self) -> Self {
                std::array::from_fn(|i| self[i].min(other[i]))
            }

            #[inline]
            fn high(self, other: Self) -> Self {
                std::array::from_fn(|i| self[i].max(other[i]))
            }
        }
    };
}

place!(Vec3);
place!(Vec3A);
place!(DVec3);
place!(f32; 3);
place!(f64; 3);

/// Returns the box of points; [`Place::EMPTY`] without points.
#[inline]
pub(crate) fn around<P: Place>(points: impl IntoIterator<Item = P>) -> [P; 2] {
    points.into_iter().fold(P::EMPTY, |[low, high], p| [low.low(p), high.high(p)])
}

/// Returns the box of points; `None` without points.
#[inline]
pub(crate) fn around_any<P: Place>(points: impl IntoIterator<Item = P>) -> Option<[P; 2]> {
    let mut points = points.into_iter();
    let first = points.next()?;
    Some(points.fold([first; 2], |[low, high], p| [low.low(p), high.high(p)]))
}

/// Returns the length of a box's diagonal. Double precision: finite for every finite box.
pub(crate) fn diagonal([low, high]: [[f32; 3]; 2]) -> f64 {
    distance(low, high)
}

/// Returns the distance of two positions. Double precision: finite for all finite positions.
pub(crate) fn distance(a: [f32; 3], b: [f32; 3]) -> f64 {
    (0..3).map(|i| (f64::from(b[i]) - f64::from(a[i])).powi(2)).sum::<f64>().sqrt()
}

/// Returns the axis along the longest side of a box; of equal sides the first.
#[inline]
pub(crate) fn longest_side([low, high]: [Vec3; 2]) -> usize {
    let sides = high - low;
    if sides.x >= sides.y.max(sides.z) { 0 } else { 1 + usize::from(sides.z > sides.y) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_of_points() {
        let points = [[0.0, 2.0, -1.0], [1.0, -3.0, 0.5]];
        let expected = [[0.0, -3.0, -1.0], [1.0, 2.0, 0.5]];
        assert_eq!(
            around::<[f32; 3]>(points.map(|p| p.map(|x| x as f32))),
            expected.map(|p| p.map(|x| x as f32))
        );
        assert_eq!(around_any::<[f64; 3]>(points), Some(expected));
        assert_eq!(around(points.map(DVec3::from_array)), expected.map(DVec3::from_array));
        assert_eq!(around_any::<DVec3>([]), None);
        assert!(diagonal([[0.0; 3], [f32::MAX; 3]]).is_finite());
        assert_eq!(longest_side([Vec3::ZERO, Vec3::new(1.0, 2.0, 2.0)]), 1);
    }
}
