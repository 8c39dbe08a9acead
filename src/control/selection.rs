//! The entry at which a sum of weights is reached, in order, without a full sort.

use std::cmp::Ordering;

/// Entries left to be sorted when halving ends.
const FEW: usize = 32;

/// Moves the first entries, in order, to the front: as few as have weights whose sum is at least `needed`. Returns their number;
/// `None` if all weights together are less. The last of these entries is the last in order; the others are in any order.
///
/// `order` must be total, no two entries equal. O(n) expected: halves the entries until the sum is found.
pub(super) fn reach<E>(
    entries: &mut [E],
    needed: u64,
    order: impl Fn(&E, &E) -> Ordering,
    weight: impl Fn(&E) -> u64,
) -> Option<usize> {
    let sum = |entries: &[E]| entries.iter().fold(0_u64, |sum, entry| sum.saturating_add(weight(entry)));
    let (mut low, mut high, mut before) = (0, entries.len(), 0_u64);
    while high - low > FEW {
        let middle = (high - low) / 2;
        entries[low..high].select_nth_unstable_by(middle, &order);
        let half = sum(&entries[low..low + middle]);
        if before.saturating_add(half) >= needed {
            high = low + middle;
        } else {
            before = before.saturating_add(half);
            low += middle;
        }
    }
    entries[low..high].sort_unstable_by(&order);
    for (at, entry) in entries.iter().enumerate().take(high).skip(low) {
        before = before.saturating_add(weight(entry));
        if before >= needed {
            return Some(at + 1);
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::reach;

    #[test]
    fn sums_are_reached_where_a_full_sort_reaches_them() {
        let mut state = 1_u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            state >> 8
        };
        for count in [0, 1, 5, 33, 64, 1000] {
            let entries: Vec<(u32, usize, u64)> =
                (0..count).map(|i| (random() % 50, i, u64::from(random() % 9))).collect();
            let mut sorted = entries.clone();
            sorted.sort_unstable();
            for needed in [0, 1, 17, 300, 2_000, 100_000] {
                let mut sum = 0;
                let expected = sorted.iter().position(|entry| {
                    sum += entry.2;
                    sum >= needed
                });
                let mut entries = entries.clone();
                let found = reach(&mut entries, needed, Ord::cmp, |entry| entry.2);
                assert_eq!(found, expected.map(|at| at + 1));
                if let Some(found) = found {
                    assert_eq!(entries[found - 1], sorted[found - 1]);
                    entries[..found].sort_unstable();
                    assert_eq!(entries[..found], sorted[..found]);
                }
            }
        }
    }
}
