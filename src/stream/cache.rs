//! The cache of collapsed splits that both sides keep alike: a split in it travels without its content.
//!
//! ```text
//!     key of a split -> hash -> a set of 4 places, newest first; the oldest falls out
//! ```
//!
//! Sets make it cheap for a server to know what a client still has: 4 bytes a place, and no order over all of them.

use crate::geometry::hash::mix;

const WAYS: usize = 4;
/// Marks a free place.
const FREE: u32 = u32::MAX;

/// Keys of splits, with something of each.
#[derive(Debug, Clone)]
pub(super) struct Cache<T> {
    keys: Vec<[u32; WAYS]>,
    items: Vec<[T; WAYS]>,
}

impl<T: Default> Cache<T> {
    /// Creates an empty cache of at least so many places; 0 for none.
    pub fn new(places: usize) -> Self {
        let sets = places.div_ceil(WAYS);
        Self { keys: vec![[FREE; WAYS]; sets], items: (0..sets).map(|_| Default::default()).collect() }
    }

    fn set(&self, key: u32) -> Option<usize> {
        let sets = self.keys.len() as u64;
        mix(key.into()).checked_rem(sets).map(|set| set as usize)
    }

    /// Puts an item in. The oldest of its set falls out.
    pub fn put(&mut self, key: u32, item: T) {
        if let Some(set) = self.set(key) {
            self.keys[set].rotate_right(1);
            self.items[set].rotate_right(1);
            self.keys[set][0] = key;
            self.items[set][0] = item;
        }
    }

    /// Takes an item out.
    pub fn take(&mut self, key: u32) -> Option<T> {
        let set = self.set(key)?;
        let at = self.keys[set].iter().position(|&found| found == key)?;
        self.keys[set][at..].rotate_left(1);
        self.items[set][at..].rotate_left(1);
        self.keys[set][WAYS - 1] = FREE;
        Some(std::mem::take(&mut self.items[set][WAYS - 1]))
    }

    /// Bytes of the places, without what items hold.
    pub fn memory(&self) -> usize {
        size_of_val(&self.keys[..]) + size_of_val(&self.items[..])
    }
}
