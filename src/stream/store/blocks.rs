//! Ranges of numbers for vertices or triangles of pages, in blocks; a freed range is used again.

use crate::mesh::NONE;

/// Numbers of a block, as a shift.
const BLOCK: u32 = 8;

/// Which slot of the cache a number belongs to.
#[derive(Debug, Clone)]
pub(super) struct Blocks {
    /// Numbers before the first block.
    first: u32,
    /// Per block, its slot, or `NONE`.
    slots: Vec<u32>,
}

impl Blocks {
    /// Starts after numbers that are taken for good.
    pub fn new(first: u32) -> Self {
        Self { first: first.next_multiple_of(1 << BLOCK), slots: Vec::new() }
    }

    /// Takes a range of numbers for a slot: the first that is free and long enough. Returns its first number.
    pub fn take(&mut self, count: usize, slot: u32) -> u32 {
        let blocks = count.div_ceil(1 << BLOCK);
        let mut free = 0;
        let mut end = 0;
        while free < blocks && end < self.slots.len() {
            free = if self.slots[end] == NONE { free + 1 } else { 0 };
            end += 1;
        }
        let start = end - free;
        if free < blocks {
            self.slots.resize(start + blocks, NONE);
        }
        self.slots[start..start + blocks].fill(slot);
        self.first + ((start as u32) << BLOCK)
    }

    /// Frees a range.
    pub fn free(&mut self, first: u32, count: usize) {
        let start = ((first - self.first) >> BLOCK) as usize;
        self.slots[start..start + count.div_ceil(1 << BLOCK)].fill(NONE);
    }

    /// Returns the slot of a number that is taken by a slot.
    #[inline]
    pub fn slot(&self, number: u32) -> u32 {
        self.slots[((number - self.first) >> BLOCK) as usize]
    }

    /// Returns the number behind the last block.
    pub fn end(&self) -> usize {
        self.first as usize + (self.slots.len() << BLOCK)
    }

    pub fn memory(&self) -> usize {
        size_of_val(&self.slots[..])
    }
}

#[cfg(test)]
mod tests {
    use super::Blocks;

    #[test]
    fn ranges_are_used_again() {
        let mut blocks = Blocks::new(3);
        let ranges = [(300, 0), (1, 1), (256, 2)].map(|(count, slot)| blocks.take(count, slot));
        assert_eq!(ranges, [256, 768, 1024]);
        assert_eq!([256, 767, 768, 1279].map(|number| blocks.slot(number)), [0, 0, 1, 2]);
        blocks.free(256, 300);
        assert_eq!([blocks.take(600, 3), blocks.take(2, 4), blocks.take(200, 5)], [1280, 256, 512]);
        assert_eq!([256, 512, 1280, 2047].map(|number| blocks.slot(number)), [4, 5, 3, 3]);
        assert_eq!(blocks.end(), 2048);
    }
}
