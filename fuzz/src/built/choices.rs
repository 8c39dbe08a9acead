//! Choices by bytes: whatever is left of the data when it ends is 0.

use arbitrary::Unstructured;

/// The bytes of a run, as choices.
pub struct Choices<'a>(Unstructured<'a>);

impl<'a> Choices<'a> {
    /// Of data.
    pub fn new(data: &'a [u8]) -> Self {
        Self(Unstructured::new(data))
    }

    /// A number from 0 to `count - 1`.
    pub fn below(&mut self, count: usize) -> usize {
        self.0.int_in_range(0..=count.max(1) as u32 - 1).unwrap_or(0) as usize
    }

    /// One of some.
    pub fn one<T: Copy>(&mut self, of: &[T]) -> T {
        of[self.below(of.len())]
    }

    /// True once in so many times.
    pub fn once_in(&mut self, times: usize) -> bool {
        // Where the data ends: no.
        self.below(times) == times - 1
    }

    /// A number between two.
    pub fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * (self.0.arbitrary::<u16>().unwrap_or(0) as f32 / 65_535.0)
    }

    /// A number between two, or nothing.
    pub fn perhaps_between(&mut self, low: f32, high: f32) -> Option<f32> {
        self.once_in(2).then(|| self.between(low, high))
    }

    /// Any bits that are a number.
    pub fn float(&mut self) -> f32 {
        /// The largest, the least, what rounds to nothing, and what lies between.
        const EXTREMES: [f32; 12] = [
            f32::MAX,
            -f32::MAX,
            3.4e38,
            -1.7e38,
            2.0e19,
            -1.0,
            0.0,
            1.0,
            1e-19,
            f32::MIN_POSITIVE,
            1e-45,
            -1e-40,
        ];
        match self.below(4) {
            0 => self.one(&EXTREMES),
            1 => {
                Some(f32::from_bits(self.0.arbitrary().unwrap_or(0))).filter(|x| x.is_finite()).unwrap_or(0.5)
            }
            _ => self.between(-2.0, 2.0),
        }
    }

    /// Whether all data is used.
    pub fn is_over(&self) -> bool {
        self.0.is_empty()
    }
}
