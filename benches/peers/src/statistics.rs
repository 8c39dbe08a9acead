//! Order statistics of measured values.

/// Values in ascending order.
pub(crate) fn sorted(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values
}

/// The middle of sorted values: the mean of both middle ones where their number is even.
pub(crate) fn median(sorted: &[f64]) -> f64 {
    let half = sorted.len() / 2;
    match sorted {
        [] => f64::NAN,
        _ if sorted.len() % 2 == 1 => sorted[half],
        _ => (sorted[half - 1] + sorted[half]) / 2.0,
    }
}

/// The value that 99 of 100 sorted values do not exceed.
pub(crate) fn percentile_99(sorted: &[f64]) -> f64 {
    match sorted.len() {
        0 => f64::NAN,
        n => sorted[(n * 99).div_ceil(100) - 1],
    }
}

/// The arithmetic mean.
pub(crate) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_is_the_middle() {
        assert_eq!(median(&sorted([3.0, 1.0, 2.0].into_iter())), 2.0);
        assert_eq!(median(&sorted([4.0, 1.0, 3.0, 2.0].into_iter())), 2.5);
        assert!(median(&[]).is_nan());
    }

    #[test]
    fn one_in_a_hundred_is_beyond_the_99th_percentile() {
        let values = sorted((1..=200).map(f64::from));
        assert_eq!(percentile_99(&values), 198.0);
        assert_eq!(percentile_99(&values[..1]), 1.0);
        assert_eq!(mean(&values), 100.5);
    }
}
