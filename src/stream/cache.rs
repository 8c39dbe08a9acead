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

/// Keys of splits.
#[derive(Debug, Clone)]
pub(super) struct Cache {
    sets: Vec<[u32; WAYS]>,
}

impl Cache {
    /// Creates an empty cache of at least so many places; 0 for none.
    pub fn new(places: usize) -> Self {
        Self { sets: vec![[FREE; WAYS]; places.div_ceil(WAYS)] }
    }

    fn set(&mut self, key: u32) -> Option<&mut [u32; WAYS]> {
        let sets = self.sets.len() as u64;
        mix(key.into()).checked_rem(sets).map(|set| &mut self.sets[set as usize])
    }

    /// Puts a key in. Returns the key that falls out: the oldest of its set, or, without places, the key itself.
    pub fn put(&mut self, key: u32) -> Option<u32> {
        let Some(set) = self.set(key) else { return Some(key) };
        set.rotate_right(1);
        Some(std::mem::replace(&mut set[0], key)).filter(|&oldest| oldest != FREE)
    }

    /// Takes a key out. Returns whether it was in.
    pub fn take(&mut self, key: u32) -> bool {
        let Some(set) = self.set(key) else { return false };
        let Some(at) = set.iter().position(|&found| found == key) else { return false };
        set[at..].rotate_left(1);
        set[WAYS - 1] = FREE;
        true
    }

    /// Bytes of the places.
    pub fn memory(&self) -> usize {
        size_of_val(&self.sets[..])
    }
}
