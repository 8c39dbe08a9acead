//! Rounding to single precision toward one side: bounds stay bounds when they are stored.

/// Returns the least finite number of single precision not below `x`; the largest one where there is none.
#[inline]
pub(crate) fn up(x: f64) -> f32 {
    let near = x as f32;
    if f64::from(near) < x { near.next_up() } else { near }.min(f32::MAX)
}

/// Bits of a float dropped by [`up_short`].
const DROPPED: u32 = 12;

/// Returns a finite number of single precision, not below `x`, with eleven bits behind its leading one: at most 2^-11 of `x`
/// above it. `x` must not be negative. Such numbers compress better.
#[inline]
pub(crate) fn up_short(x: f64) -> f32 {
    let mask = (1 << DROPPED) - 1;
    f32::from_bits((up(x).to_bits() + mask) & !mask).min(f32::MAX)
}

#[cfg(test)]
mod tests {
    use super::{up, up_short};

    #[test]
    fn short_numbers_are_never_below_and_hardly_above() {
        for x in [0.0, 1e-50, 1e-40, 0.3, 1.0, 1.0 + 1e-9, 1.9999, 7e20] {
            let short = up_short(x);
            assert!(f64::from(short) >= x && f64::from(short) <= x * (1.0 + 1.0 / 2048.0) + 1e-41);
            assert_eq!((short.to_bits() % 4096, up_short(f64::from(short))), (0, short));
        }
        assert_eq!(up_short(f64::from(f32::MAX)), f32::MAX);
        assert_eq!(up_short(f64::INFINITY), f32::MAX);
    }

    #[test]
    fn never_below() {
        assert_eq!(up(0.5), 0.5);
        assert_eq!(up(1.0 + 1e-12), 1.0_f32.next_up());
        assert_eq!(up(1e300), f32::MAX);
        assert_eq!(up(f64::INFINITY), f32::MAX);
    }
}
