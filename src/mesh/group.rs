//! Groups of equal items, by a table of hashes that nobody can foresee.
//!
//! Whoever knows the hash can make a file of values that all fall into one place of the table: 1 MB takes minutes. So each
//! table has a key of its own, at random. What comes out does not depend on it: the lowest of equal items always leads.

use std::hash::{BuildHasher, RandomState};

use super::NONE;

/// The key of a table.
#[derive(Clone, Copy)]
pub(super) struct Key {
    addend: u64,
    factor: u64,
}

impl Key {
    fn new() -> Self {
        let random = RandomState::new();
        Self { addend: random.hash_one(0), factor: random.hash_one(1) | 1 }
    }

    /// Multiplies and folds the halves: every bit reaches every bit.
    #[inline]
    pub fn mix(self, x: u64) -> u64 {
        let product = u128::from(x ^ self.addend) * u128::from(self.factor);
        (product as u64) ^ (product >> 64) as u64
    }
}

/// Returns, for each item, the lowest item equal to it. `hash`: of an item, all of it mixed by the key. Open addressing
/// over a table of at least twice as many slots. O(count) expected, whatever the items.
pub(super) fn group(
    count: usize,
    hash: impl Fn(Key, usize) -> u64,
    same: impl Fn(usize, usize) -> bool,
) -> Vec<u32> {
    let key = Key::new();
    let mask = (count * 2).next_power_of_two().max(2) - 1;
    let mut table = vec![NONE; mask + 1];
    (0..count)
        .map(|item| {
            let mut slot = hash(key, item) as usize & mask;
            loop {
                let entry = table[slot];
                if entry == NONE {
                    table[slot] = item as u32;
                    return item as u32;
                }
                if same(entry as usize, item) {
                    return entry;
                }
                slot = (slot + 1) & mask;
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use super::*;

    /// A hash without a key.
    fn known(x: u64) -> u64 {
        let product = u128::from(x ^ 0x9e37_79b9_7f4a_7c15) * 0xd6e8_feb8_6659_fd93_u128;
        (product as u64) ^ (product >> 64) as u64
    }

    /// Returns the groups of items by a hash, and how many times two items were compared.
    fn grouped(items: &[u64], hash: impl Fn(Key, u64) -> u64) -> (Vec<u32>, usize) {
        let compared = Cell::new(0);
        let groups = group(
            items.len(),
            |key, i| hash(key, items[i]),
            |a, b| {
                compared.set(compared.get() + 1);
                items[a] == items[b]
            },
        );
        (groups, compared.get())
    }

    #[test]
    fn values_made_to_collide_are_told_apart_as_quickly_as_others() {
        // In the table for 2,048 of them, all would begin within 8 places.
        let colliding = (0u64..).filter(|&x| known(x) % 4096 < 8);
        let items: Vec<u64> = colliding.take(1024).flat_map(|x| [x, x]).collect();
        let (groups, compared) = grouped(&items, Key::mix);
        assert!(compared < 4 * items.len(), "{compared}");
        let (same, before) = grouped(&items, |_, x| known(x));
        assert!(before > 100 * items.len(), "{before}");
        assert_eq!(groups, same);
        assert!(groups.iter().zip(0..).all(|(&lowest, item): (_, u32)| lowest == item & !1));
    }
}
