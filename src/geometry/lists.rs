//! Lists of varying length in two flat arrays.
//!
//! ```text
//!     start    0     2        5  6           items of list i: items[start[i]..start[i + 1]]
//!     items    0 7 | 1 3 8 | 2 | ...
//! ```
//!
//! Built by counting, prefix sum and filling.

use std::borrow::Cow;

use super::array::Array;

/// Marks "none" in every index array of this crate.
pub(crate) const NONE: u32 = u32::MAX;

/// Turns counts into starts, in place. Count `i` is stored at `i + 1`.
#[inline]
pub(crate) fn prefix_sum(start: &mut [u32]) {
    let mut sum = 0;
    for entry in start {
        sum += *entry;
        *entry = sum;
    }
}

/// Lists in a single array: entries of list `i` are `items[start[i]..start[i + 1]]`. If all lists are empty, `start` may be
/// empty.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct Lists {
    /// Start of every list, and the end of the last.
    pub start: Array<u32>,
    /// Items of all lists.
    pub items: Array<u32>,
}

impl Lists {
    /// Creates lists from pairs of list and item. Keeps the order of items in a list. Pairs must be in range.
    pub fn from_pairs(lists: usize, pairs: impl Iterator<Item = (u32, u32)> + Clone) -> Self {
        let mut start = vec![0_u32; lists + 1];
        pairs.clone().for_each(|(list, _)| start[list as usize + 1] += 1);
        prefix_sum(&mut start);
        let mut items = vec![0; start[lists] as usize];
        let mut next = start.clone();
        for (list, item) in pairs {
            let slot = &mut next[list as usize];
            items[*slot as usize] = item;
            *slot += 1;
        }
        Self { start: start.into(), items: items.into() }
    }

    /// Makes lists of items and starts. Drops the starts if there are no items.
    pub fn of(start: Vec<u32>, items: Vec<u32>) -> Self {
        if items.is_empty() { Self::default() } else { Self { start: start.into(), items: items.into() } }
    }

    /// Returns the starts of `lists` lists and the end of the last.
    pub fn starts(&self, lists: usize) -> Cow<'_, [u32]> {
        if self.start.is_empty() { vec![0; lists + 1].into() } else { Cow::Borrowed(&self.start) }
    }

    /// Returns the lists from item to list: list `i` names, ascending, the lists that name `i`. O(lists + items).
    pub fn transposed(&self, lists: usize) -> Self {
        let pairs = self.start.windows(2).zip(0_u32..).flat_map(|(ends, list)| {
            self.items[ends[0] as usize..ends[1] as usize].iter().map(move |&item| (item, list))
        });
        Self::from_pairs(lists, pairs)
    }

    /// Returns the items of a list; none for a list that does not exist.
    #[inline]
    pub fn get(&self, list: u32) -> &[u32] {
        match self.start.get(list as usize..list as usize + 2) {
            Some(ends) => &self.items[ends[0] as usize..ends[1] as usize],
            None => &[],
        }
    }

    /// Bytes of the arrays.
    pub fn memory(&self) -> usize {
        size_of_val(&self.start[..]) + size_of_val(&self.items[..])
    }
}

#[cfg(test)]
mod tests {
    use super::Lists;

    #[test]
    fn items_stay_in_order() {
        let lists = Lists::from_pairs(3, [(2, 7), (0, 1), (2, 5)].into_iter());
        assert_eq!([0, 1, 2, 3].map(|list| lists.get(list).to_vec()), [vec![1], vec![], vec![7, 5], vec![]]);
        assert_eq!(lists.memory(), 4 * (4 + 3));
    }
}
