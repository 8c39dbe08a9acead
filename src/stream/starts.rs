//! The first leaves of drawn vertices: which vertex does a leaf belong to?
//!
//! ```text
//!     level 2   1 bit for 64 words        a set as words of 64 bits, and words that tell which words are not empty:
//!     level 1   1 bit a word              the last number up to another is found in a step a level
//!     level 0   1 bit a leaf
//! ```

/// A map from numbers below a count to vertices, with the last number up to any other in a few steps. Memory is taken as it is
/// touched, on systems where zeroed memory is.
#[derive(Debug, Clone, Default)]
pub(super) struct Starts {
    levels: Vec<Vec<u64>>,
    /// Per number in the set, its vertex.
    vertices: Vec<u32>,
}

impl Starts {
    pub fn new(count: usize) -> Self {
        let mut levels = Vec::new();
        let mut words = count.div_ceil(64);
        loop {
            levels.push(vec![0; words]);
            if words <= 1 {
                break;
            }
            words = words.div_ceil(64);
        }
        Self { levels, vertices: vec![0; count] }
    }

    /// Adds a number, or gives it another vertex.
    pub fn insert(&mut self, number: u32, vertex: u32) {
        self.vertices[number as usize] = vertex;
        let mut at = number as usize;
        for level in &mut self.levels {
            let word = &mut level[at / 64];
            let bit = 1 << (at % 64);
            if *word & bit != 0 {
                return;
            }
            let was_empty = *word == 0;
            *word |= bit;
            if !was_empty {
                return;
            }
            at /= 64;
        }
    }

    /// Removes a number.
    pub fn remove(&mut self, number: u32) {
        let mut at = number as usize;
        for level in &mut self.levels {
            let word = &mut level[at / 64];
            let bit = 1 << (at % 64);
            if *word & bit == 0 {
                return;
            }
            *word &= !bit;
            if *word != 0 {
                return;
            }
            at /= 64;
        }
    }

    /// Returns the vertex of the last number up to another.
    #[inline]
    pub fn up_to(&self, number: u32) -> Option<u32> {
        let mut at = number as usize;
        for (height, level) in self.levels.iter().enumerate() {
            let word = level.get(at / 64)? & (u64::MAX >> (63 - at % 64));
            if word != 0 {
                let mut found = at / 64 * 64 + (63 - word.leading_zeros() as usize);
                for lower in self.levels[..height].iter().rev() {
                    found = found * 64 + (63 - lower[found].leading_zeros() as usize);
                }
                return self.vertices.get(found).copied();
            }
            // The words before this one.
            at = (at / 64).checked_sub(1)?;
        }
        None
    }

    pub fn memory(&self) -> usize {
        self.levels.iter().map(|level| size_of_val(&level[..])).sum::<usize>()
            + size_of_val(&self.vertices[..])
    }
}

#[cfg(test)]
mod tests {
    use super::Starts;
    use std::collections::BTreeMap;

    #[test]
    fn is_a_sorted_map() {
        let count = 70_000;
        let (mut starts, mut map) = (Starts::new(count), BTreeMap::new());
        let mut state = 1_u64;
        for round in 0..20_000_u32 {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let number = ((state >> 33) % count as u64) as u32;
            if state >> 60 < 9 {
                starts.insert(number, round);
                map.insert(number, round);
            } else if let Some((&last, _)) = map.range(..=number).next_back() {
                starts.remove(last);
                map.remove(&last);
            }
            assert_eq!(starts.up_to(number), map.range(..=number).next_back().map(|(_, &vertex)| vertex));
        }
    }
}
