//! Rounding to single precision toward one side: bounds stay bounds when they are stored.

/// Returns the least finite number of single precision not below `x`; the largest one where there is none.
#[inline]
pub(crate) fn up(x: f64) -> f32 {
    let near = x as f32;
    if f64::from(near) < x { near.next_up() } else { near }.min(f32::MAX)
}

#[cfg(test)]
mod tests {
    use super::up;

    #[test]
    fn never_below() {
        assert_eq!(up(0.5), 0.5);
        assert_eq!(up(1.0 + 1e-12), 1.0_f32.next_up());
        assert_eq!(up(1e300), f32::MAX);
        assert_eq!(up(f64::INFINITY), f32::MAX);
    }
}
