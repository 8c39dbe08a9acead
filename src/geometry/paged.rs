//! Arrays in which most elements are alike: memory follows the others.
//!
//! ```text
//!     table    0   8   0   0   4         per page, where it starts in the pool
//!              |    \          \
//!     pool     . . . .   7 . 2 .   . 9 . .         the first page has no others, and is shared
//! ```
//!
//! A read is two loads, without a branch. Whether a page is still needed, nobody counts: [`Paged::sweep`] looks through a few pages
//! a frame. A page without other elements is used again, and where most pages are free, the pool is packed.

use super::lists::NONE;

/// Pages which may be free at any time.
const SPARE: usize = 8;
/// Calls of [`Paged::sweep`] that look through all pages.
const ROUND: usize = 256;

/// An array of `len` elements, in pages of `2^BITS`. Elements are at rest, or other.
#[derive(Debug, Clone)]
pub(crate) struct Paged<T, const BITS: u32> {
    rest: T,
    table: Vec<u32>,
    pool: Vec<T>,
    /// Per page in the pool: its number; `NONE` if it is free, with all elements at rest.
    pages: Vec<u32>,
    /// Where free pages start in the pool.
    free: Vec<u32>,
    /// The last page in the pool looked through.
    swept: usize,
}

impl<T: Copy + PartialEq, const BITS: u32> Paged<T, BITS> {
    const SIZE: usize = 1 << BITS;

    /// Makes an array without elements.
    pub const fn new(rest: T) -> Self {
        Self { rest, table: Vec::new(), pool: Vec::new(), pages: Vec::new(), free: Vec::new(), swept: 0 }
    }

    /// Makes an array of elements at rest.
    pub fn of(count: usize, rest: T) -> Self {
        let mut paged = Self::new(rest);
        paged.reach(count);
        paged
    }

    /// Makes room for `count` elements: the new ones are at rest.
    pub fn reach(&mut self, count: usize) {
        let pages = count.div_ceil(Self::SIZE);
        if pages > self.table.len() {
            if self.pages.is_empty() {
                self.add_page(NONE);
            }
            self.table.resize(pages, 0);
        }
    }

    /// Whether another page needs more memory.
    fn is_full(&self) -> bool {
        self.pool.len() + Self::SIZE > self.pool.capacity()
    }

    fn add_page(&mut self, number: u32) -> usize {
        let start = self.pool.len();
        if self.is_full() {
            let more = (self.pages.len() / 4).max(1);
            self.pool.reserve_exact(more * Self::SIZE);
            self.pages.reserve_exact(more);
            self.free.reserve_exact(self.pages.len() + more - self.free.len());
        }
        self.pool.resize(start + Self::SIZE, self.rest);
        self.pages.push(number);
        start
    }

    /// Returns the place of an element in its page.
    #[inline]
    fn within(index: u32) -> usize {
        index as usize % Self::SIZE
    }

    /// Returns an element.
    ///
    /// # Panics
    /// The index is beyond the last page.
    #[inline]
    pub fn at(&self, index: u32) -> T {
        self.pool[self.table[(index >> BITS) as usize] as usize + Self::within(index)]
    }

    /// Returns an element; one at rest if there is none of this index.
    #[inline]
    pub fn get(&self, index: u32) -> T {
        match self.table.get((index >> BITS) as usize) {
            Some(&start) => self.pool[start as usize + Self::within(index)],
            None => self.rest,
        }
    }

    /// Returns an element, to be changed.
    ///
    /// # Panics
    /// The index is beyond the last page.
    #[inline]
    pub fn entry(&mut self, index: u32) -> &mut T {
        let page = (index >> BITS) as usize;
        let mut start = self.table[page] as usize;
        if start == 0 {
            start = self.take(page);
        }
        &mut self.pool[start + Self::within(index)]
    }

    /// Brings an element to rest. Returns what it was.
    ///
    /// # Panics
    /// The index is beyond the last page.
    #[inline]
    pub fn rest(&mut self, index: u32) -> T {
        let start = self.table[(index >> BITS) as usize] as usize;
        std::mem::replace(&mut self.pool[start + Self::within(index)], self.rest)
    }

    #[cold]
    fn take(&mut self, page: usize) -> usize {
        if self.free.is_empty() && self.is_full() {
            self.look_through(self.pages.len());
        }
        let start = match self.free.pop() {
            Some(start) => start as usize,
            None => self.add_page(NONE),
        };
        self.pages[start >> BITS] = page as u32;
        self.table[page] = start as u32;
        start
    }

    /// Looks through a few pages, and frees those which are at rest as a whole.
    pub fn sweep(&mut self) {
        self.look_through(self.pages.len().div_ceil(ROUND));
    }

    fn look_through(&mut self, pages: usize) {
        for _ in 0..pages {
            self.swept = (self.swept + 1) % self.pages.len();
            let (at, number) = (self.swept * Self::SIZE, self.pages[self.swept]);
            if number != NONE && self.pool[at..at + Self::SIZE].iter().all(|value| *value == self.rest) {
                self.pages[self.swept] = NONE;
                self.table[number as usize] = 0;
                self.free.push(at as u32);
            }
        }
    }

    /// Gives back the memory of free pages, if they are most.
    pub fn trim(&mut self) {
        self.look_through(self.pages.len());
        if self.free.len() > SPARE + self.pages.len() / 2 {
            self.pack();
        }
    }

    /// Leaves free pages out of the pool.
    fn pack(&mut self) {
        let mut kept = 1;
        for at in 1..self.pages.len() {
            let number = self.pages[at];
            if number != NONE {
                self.pool.copy_within(at * Self::SIZE..(at + 1) * Self::SIZE, kept * Self::SIZE);
                self.pages[kept] = number;
                self.table[number as usize] = (kept * Self::SIZE) as u32;
                kept += 1;
            }
        }
        self.pool.truncate(kept * Self::SIZE);
        self.pages.truncate(kept);
        self.free.clear();
        self.swept = 0;
        self.pool.shrink_to_fit();
        self.pages.shrink_to_fit();
        self.free.shrink_to(self.pages.len());
    }

    /// Replaces every element not at rest by what `change` makes of it: not at rest either. In ascending order. O(pages).
    pub fn update_others(&mut self, mut change: impl FnMut(T) -> T) {
        for &start in self.table.iter().filter(|start| **start != 0) {
            let elements = self.pool[start as usize..][..Self::SIZE].iter_mut();
            elements.filter(|value| **value != self.rest).for_each(|value| *value = change(*value));
        }
    }

    /// Returns the elements not at rest, with their indices: in ascending order. O(pages).
    pub fn others(&self) -> impl Iterator<Item = (u32, T)> + '_ {
        let used = self.table.iter().enumerate().filter(|(_, start)| **start != 0);
        used.flat_map(move |(page, &start)| {
            let elements = self.pool[start as usize..][..Self::SIZE].iter().enumerate();
            let others = elements.filter(|(_, value)| **value != self.rest);
            others.map(move |(at, &value)| ((page << BITS | at) as u32, value))
        })
    }

    /// Bytes of the arrays.
    pub fn memory(&self) -> usize {
        size_of_val(&self.table[..])
            + self.pool.capacity() * size_of::<T>()
            + self.pages.capacity() * size_of::<u32>()
            + self.free.capacity() * size_of::<u32>()
    }
}

/// Gives back the memory of an array if it uses less than a quarter of it.
#[inline]
pub(crate) fn trim<T>(array: &mut Vec<T>) {
    trim_to(array, array.len());
}

/// Gives back the memory of an array if `length` elements, which it may have any time again, are less than a quarter of it.
#[inline]
pub(crate) fn trim_to<T>(array: &mut Vec<T>, length: usize) {
    if array.capacity() > 4 * length + 128 {
        array.shrink_to(2 * length);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elements_are_those_of_an_array_and_memory_follows_them() {
        let mut state = 3_u64;
        let mut random = |n: usize| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 33) as usize % n
        };
        let mut paged = Paged::<u16, 3>::of(1_000, 7);
        let mut array = vec![7_u16; 1_000];
        for round in 0..40 {
            let (count, rests) = (random(600), random(4) > round % 3);
            for _ in 0..count {
                paged.sweep();
                let (at, value) = (random(1_000), if rests { 7 } else { random(9) as u16 });
                let before = std::mem::replace(&mut array[at], value);
                match value {
                    7 => assert_eq!(paged.rest(at as u32), before),
                    _ => assert_eq!(std::mem::replace(paged.entry(at as u32), value), before),
                }
            }
            assert!((0..1_000).all(|at| paged.at(at) == array[at as usize] && paged.get(at) == paged.at(at)));
            let others = (0..).zip(&array).filter(|(_, value)| **value != 7).map(|(at, value)| (at, *value));
            assert!(paged.others().eq(others));
            paged.trim();
            let used = array.chunks(8).filter(|page| page.iter().any(|&value| value != 7)).count();
            assert!(paged.pages.len() <= 2 * (used + SPARE) + 2, "{} pages for {used}", paged.pages.len());
        }
        (0..1_000).for_each(|at| *paged.entry(at) = 7);
        assert_eq!(paged.others().count(), 0);
        paged.trim();
        assert!(paged.pages.len() <= 2 * SPARE + 2);
        assert_eq!(paged.get(5_000), 7);
        paged.reach(5_001);
        *paged.entry(5_000) = 1;
        assert_eq!(paged.at(5_000), 1);
    }
}
