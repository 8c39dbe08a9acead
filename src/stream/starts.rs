//! The first leaves of drawn vertices: which vertex does a leaf belong to?
//!
//! ```text
//!     page      4,096 leaves: a bit and a vertex for each, and a bit for each word of 64 that is not empty
//!     levels    a bit for each page that is not empty, a bit for each word of those ...
//! ```
//!
//! The last number up to another is found in a step a level. A page takes memory once a number of it comes, so that a client
//! that is told of many leaves has taken nothing yet.

/// Words of a page.
const WORDS: usize = 64;
const PAGE: usize = 64 * WORDS;

#[derive(Debug, Clone)]
struct Page {
    /// The words that are not empty.
    words: u64,
    bits: [u64; WORDS],
    vertices: [u32; PAGE],
}

/// A map from numbers below a count to vertices, with the last number up to any other in a few steps.
#[derive(Debug, Clone, Default)]
pub(super) struct Starts {
    pages: Vec<Option<Box<Page>>>,
    /// Pages that are not empty, by levels of words.
    levels: Vec<Vec<u64>>,
}

/// Returns the highest bit of a word up to a bit.
#[inline]
fn highest(word: u64, up_to: usize) -> Option<usize> {
    (word & (u64::MAX >> (63 - up_to))).checked_ilog2().map(|bit| bit as usize)
}

impl Starts {
    pub fn new(count: usize) -> Self {
        let pages = count.div_ceil(PAGE);
        let mut levels = Vec::new();
        let mut words = pages;
        while words > 1 || levels.is_empty() {
            words = words.div_ceil(64);
            levels.push(vec![0; words]);
        }
        Self { pages: vec![None; pages], levels }
    }

    /// Adds a number, or gives it another vertex.
    pub fn insert(&mut self, number: u32, vertex: u32) {
        let (page, at) = (number as usize / PAGE, number as usize % PAGE);
        let empty = || Box::new(Page { words: 0, bits: [0; WORDS], vertices: [0; PAGE] });
        let found = self.pages[page].get_or_insert_with(empty);
        found.vertices[at] = vertex;
        found.bits[at / 64] |= 1 << (at % 64);
        let was_empty = found.words == 0;
        found.words |= 1 << (at / 64);
        let mut at = page;
        let mut go_on = was_empty;
        for level in &mut self.levels {
            if !go_on {
                return;
            }
            let word = &mut level[at / 64];
            go_on = *word == 0;
            *word |= 1 << (at % 64);
            at /= 64;
        }
    }

    /// Removes a number.
    pub fn remove(&mut self, number: u32) {
        let (page, at) = (number as usize / PAGE, number as usize % PAGE);
        let Some(found) = &mut self.pages[page] else { return };
        found.bits[at / 64] &= !(1 << (at % 64));
        if found.bits[at / 64] != 0 {
            return;
        }
        found.words &= !(1 << (at / 64));
        let mut at = page;
        let mut go_on = found.words == 0;
        for level in &mut self.levels {
            if !go_on {
                return;
            }
            let word = &mut level[at / 64];
            *word &= !(1 << (at % 64));
            go_on = *word == 0;
            at /= 64;
        }
    }

    /// Returns the vertex of the last number up to another.
    #[inline]
    pub fn up_to(&self, number: u32) -> Option<u32> {
        let (page, at) = (number as usize / PAGE, number as usize % PAGE);
        if let Some(found) = self.pages.get(page)? {
            let beside = highest(found.bits[at / 64], at % 64).map(|bit| at / 64 * 64 + bit);
            let before = || {
                let word = highest(found.words, (at / 64).checked_sub(1)?)?;
                highest(found.bits[word], 63).map(|bit| word * 64 + bit)
            };
            if let Some(at) = beside.or_else(before) {
                return Some(found.vertices[at]);
            }
        }
        let mut at = page.checked_sub(1)?;
        for (height, level) in self.levels.iter().enumerate() {
            if let Some(bit) = highest(level[at / 64], at % 64) {
                let mut last = at / 64 * 64 + bit;
                for lower in self.levels[..height].iter().rev() {
                    last = last * 64 + highest(lower[last], 63)?;
                }
                let found = self.pages[last].as_ref()?;
                let word = highest(found.words, 63)?;
                return highest(found.bits[word], 63).map(|bit| found.vertices[word * 64 + bit]);
            }
            at = (at / 64).checked_sub(1)?;
        }
        None
    }

    pub fn memory(&self) -> usize {
        let pages = self.pages.iter().flatten().count() * size_of::<Page>();
        let levels: usize = self.levels.iter().map(|level| size_of_val(&level[..])).sum();
        pages + levels + size_of_val(&self.pages[..])
    }
}

#[cfg(test)]
mod tests {
    use super::Starts;
    use std::collections::BTreeMap;

    #[test]
    fn is_a_sorted_map() {
        let count = 700_000;
        let (mut starts, mut map) = (Starts::new(count), BTreeMap::new());
        let mut state = 1_u64;
        for round in 0..30_000_u32 {
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
