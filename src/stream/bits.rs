//! A set of small numbers, a bit each.

/// A set of numbers below a count.
#[derive(Debug, Clone, Default)]
pub(super) struct Bits {
    words: Vec<u64>,
}

impl Bits {
    pub fn new(count: usize) -> Self {
        Self { words: vec![0; count.div_ceil(64)] }
    }

    #[inline]
    pub fn has(&self, number: u32) -> bool {
        self.words[number as usize / 64] >> (number % 64) & 1 == 1
    }

    #[inline]
    pub fn add(&mut self, number: u32) {
        self.words[number as usize / 64] |= 1 << (number % 64);
    }

    #[inline]
    pub fn remove(&mut self, number: u32) {
        self.words[number as usize / 64] &= !(1 << (number % 64));
    }

    /// Calls `each` with all numbers of this set that are not in another of the same count, ascending.
    pub fn without(&self, other: &Self, mut each: impl FnMut(u32)) {
        for (at, (&word, &out)) in self.words.iter().zip(&other.words).enumerate() {
            let mut left = word & !out;
            while left != 0 {
                each(at as u32 * 64 + left.trailing_zeros());
                left &= left - 1;
            }
        }
    }

    pub fn memory(&self) -> usize {
        size_of_val(&self.words[..])
    }
}
