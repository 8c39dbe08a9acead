//! Least number of a range: blocks, and a table over blocks.
//!
//! ```text
//!     numbers    | block | block | block | block |        a range: two ends of blocks, scanned, and between them
//!     table[k]   least of 2^k blocks from each on         two overlapping entries of the table
//! ```

/// Numbers in a block, as a power of two.
const SHIFT: u32 = 4;

/// Answers for the least number in a range. O(1) a question; O(n) to make.
pub(crate) struct RangeMinima<'a> {
    numbers: &'a [u32],
    /// `table[k][i]`: the least number of blocks `i..i + 2^k`.
    table: Vec<Vec<u32>>,
}

impl<'a> RangeMinima<'a> {
    pub fn new(numbers: &'a [u32]) -> Self {
        let mut table = vec![numbers.chunks(1 << SHIFT).map(least).collect::<Vec<u32>>()];
        let mut reach = 1;
        while let Some(last) = table.last().filter(|last| last.len() > reach) {
            let pairs = last.iter().zip(&last[reach..]);
            let next = pairs.map(|(&a, &b)| a.min(b)).collect();
            table.push(next);
            reach *= 2;
        }
        Self { numbers, table }
    }

    /// Returns the least number at places `first..=last`, which must exist.
    #[inline]
    pub fn of(&self, first: u32, last: u32) -> u32 {
        let [from, to] = [first >> SHIFT, last >> SHIFT];
        let [first, last] = [first, last].map(|at| at as usize);
        if to - from < 2 {
            return least(&self.numbers[first..=last]);
        }
        let inner = to - from - 1;
        let level = inner.ilog2();
        let table = &self.table[level as usize];
        let middle = table[from as usize + 1].min(table[(to - (1 << level)) as usize]);
        let ends = [
            &self.numbers[first..(from as usize + 1) << SHIFT],
            &self.numbers[(to as usize) << SHIFT..=last],
        ];
        ends.map(least).into_iter().fold(middle, u32::min)
    }
}

#[inline]
fn least(numbers: &[u32]) -> u32 {
    numbers.iter().fold(u32::MAX, |least, &number| least.min(number))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_range_agrees_with_a_scan() {
        let mut state = 1_u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            state >> 12
        };
        for count in [1_u32, 15, 16, 17, 32, 48, 200, 333] {
            let numbers: Vec<u32> = (0..count).map(|_| random()).collect();
            let minima = RangeMinima::new(&numbers);
            for first in 0..count {
                for last in first..count {
                    let scan = numbers[first as usize..=last as usize].iter().min();
                    assert_eq!(Some(&minima.of(first, last)), scan, "{first}..={last} of {count}");
                }
            }
        }
    }
}
