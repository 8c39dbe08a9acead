//! Mean, root mean square and maximum of many values, summed by chunks and joined in order.

/// Sums of values and of their squares, and where the largest value is. Squares of single precision numbers are far
/// inside the range of double precision.
#[derive(Clone, Copy)]
pub(super) struct Sums<At> {
    sum: f64,
    sum_of_squares: f64,
    highest: Option<(f64, At)>,
}

impl<At: Copy> Sums<At> {
    pub(super) const NONE: Self = Self { sum: 0.0, sum_of_squares: 0.0, highest: None };

    pub(super) fn add(&mut self, value: f64, at: At) {
        self.sum += value;
        self.sum_of_squares += value * value;
        if self.highest.is_none_or(|(highest, _)| value > highest) {
            self.highest = Some((value, at));
        }
    }

    /// Adds the sums of later values. Of equal maxima, the first is kept.
    pub(super) fn join(self, later: Self) -> Self {
        let highest = match (self.highest, later.highest) {
            (Some(first), Some(second)) => Some(if second.0 > first.0 { second } else { first }),
            (first, second) => first.or(second),
        };
        Self {
            sum: self.sum + later.sum,
            sum_of_squares: self.sum_of_squares + later.sum_of_squares,
            highest,
        }
    }

    pub(super) fn mean(&self, count: usize) -> f64 {
        self.sum / count.max(1) as f64
    }

    pub(super) fn rms(&self, count: usize) -> f64 {
        (self.sum_of_squares / count.max(1) as f64).sqrt()
    }

    /// Returns the largest value and where it is.
    pub(super) fn highest(&self) -> Option<(f64, At)> {
        self.highest
    }
}
