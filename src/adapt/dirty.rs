//! Tracks the elements of a buffer written since the last clear.

use std::ops::Range;

/// A set of written elements, one bit an element.
///
/// ```
/// use multires::adapt::Dirty;
///
/// let mut dirty = Dirty::default();
/// [3, 4, 9].into_iter().for_each(|element| dirty.mark(element));
/// let ranges: Vec<_> = dirty.ranges(10, 0).collect();
/// assert_eq!(ranges, [3..5, 9..10]);
/// let ranges: Vec<_> = dirty.ranges(10, 4).collect(); // gaps of up to 4 are written along
/// assert_eq!(ranges, [3..10]);
/// ```
#[derive(Debug, Clone, Default)]
pub struct Dirty {
    words: Vec<u64>,
    /// Words that may hold marks: all others are 0. Empty where `start >= end`.
    used: Range<usize>,
}

impl Dirty {
    /// Marks an element. Grows the set if needed.
    #[inline]
    pub fn mark(&mut self, element: u32) {
        let word = element as usize / 64;
        if word >= self.words.len() {
            self.words.resize((word + 1).next_power_of_two(), 0);
        }
        self.words[word] |= 1 << (element % 64);
        if !self.used.contains(&word) {
            let used = if self.used.is_empty() { word..word } else { self.used.clone() };
            self.used = used.start.min(word)..used.end.max(word + 1);
        }
    }

    /// Marks all elements of `0..count`.
    pub fn mark_all(&mut self, count: usize) {
        self.words.resize(count.div_ceil(64).max(self.words.len()), 0);
        self.words[..count / 64].fill(u64::MAX);
        if !count.is_multiple_of(64) {
            self.words[count / 64] |= (1 << (count % 64)) - 1;
        }
        self.used = 0..self.used.end.max(count.div_ceil(64));
    }

    /// Forgets all marks.
    pub fn clear(&mut self) {
        self.clear_range(0..64 * self.words.len());
    }

    /// Returns the marked elements below `count` as ascending ranges. Ranges at most `gap` unmarked elements apart are
    /// joined. O(words between the first and the last mark + ranges).
    pub fn ranges(&self, count: usize, gap: usize) -> DirtyRanges<'_> {
        self.ranges_of(0..count, gap)
    }

    /// Returns the marked elements of a range as ascending ranges, as [`Dirty::ranges`] does, with indices relative to
    /// its start.
    pub(crate) fn ranges_of(&self, of: Range<usize>, gap: usize) -> DirtyRanges<'_> {
        let (at, count) = (of.start.max(64 * self.used.start), of.end.min(64 * self.used.end));
        DirtyRanges { words: &self.words, at, start: of.start, count, gap, whole: 0..0 }
    }

    /// Forgets the marks of a range. O(words of the range between the first and the last mark).
    #[inline]
    pub(crate) fn clear_range(&mut self, of: Range<usize>) {
        if of.start < 64 * self.used.end && 64 * self.used.start < of.end {
            self.clear_used(of);
        }
    }

    /// Forgets the marks of a range that meets the words with marks.
    fn clear_used(&mut self, of: Range<usize>) {
        let (mut at, end) = (of.start.max(64 * self.used.start), of.end.min(64 * self.used.end));
        while at < end {
            let next = ((at / 64 + 1) * 64).min(end);
            let upper = if next.is_multiple_of(64) { u64::MAX } else { (1 << (next % 64)) - 1 };
            self.words[at / 64] &= !(upper & (u64::MAX << (at % 64)));
            at = next;
        }
        // Words cleared at either end hold no marks any more.
        if of.start <= 64 * self.used.start {
            self.used.start = self.used.start.max(of.end / 64);
        } else if of.end >= 64 * self.used.end {
            self.used.end = of.start.div_ceil(64);
        }
        if self.used.is_empty() {
            self.used = 0..0;
        }
    }

    /// Gives back memory, if `count` elements are a small part of those there was room for.
    pub(crate) fn trim(&mut self, count: usize) {
        let used = count.div_ceil(64).max(self.used.end);
        if self.words.len() > 4 * used + 32 {
            self.words.truncate(used);
            self.words.shrink_to_fit();
        }
    }

    /// Bytes held by the marks.
    pub fn memory(&self) -> usize {
        self.words.capacity() * size_of::<u64>()
    }
}

/// Iterates over ranges of marked elements, ascending and disjoint; see [`Dirty::ranges`].
#[derive(Debug, Clone)]
pub struct DirtyRanges<'a> {
    words: &'a [u64],
    at: usize,
    /// Origin of the returned indices.
    start: usize,
    /// End of the range searched.
    count: usize,
    gap: usize,
    /// A range to return first.
    whole: Range<usize>,
}

impl DirtyRanges<'_> {
    /// Creates an iterator without ranges.
    pub(crate) fn none() -> Self {
        Self::whole(0)
    }

    /// Creates an iterator with a single range from 0 on.
    pub(crate) fn whole(count: usize) -> Self {
        Self { words: &[], at: 0, start: 0, count: 0, gap: 0, whole: 0..count }
    }

    /// Returns the first element from `from` on with the given mark, or `count`.
    fn seek(&self, from: usize, marked: bool) -> usize {
        let word = |index: usize| {
            let w = self.words.get(index).copied().unwrap_or(0);
            if marked { w } else { !w }
        };
        let mut index = from / 64;
        let mut bits = word(index) & (u64::MAX << (from % 64));
        while bits == 0 {
            index += 1;
            if index * 64 >= self.count || (marked && index >= self.words.len()) {
                return self.count;
            }
            bits = word(index);
        }
        (index * 64 + bits.trailing_zeros() as usize).min(self.count)
    }
}

impl Iterator for DirtyRanges<'_> {
    type Item = Range<usize>;

    fn next(&mut self) -> Option<Range<usize>> {
        if !self.whole.is_empty() {
            return Some(std::mem::take(&mut self.whole));
        }
        if self.at >= self.count {
            return None;
        }
        let start = self.seek(self.at, true);
        if start >= self.count {
            self.at = self.count;
            return None;
        }
        let mut end = self.seek(start, false);
        loop {
            let next = if end < self.count { self.seek(end, true) } else { self.count };
            if next >= self.count || next - end > self.gap {
                break;
            }
            end = self.seek(next, false);
        }
        self.at = end;
        Some(start - self.start..end - self.start)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_hold_the_marks_and_nothing_beyond_the_gaps() {
        let mut state = 5u64;
        let mut random = |n: usize| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 40) as usize % n
        };
        for _ in 0..300 {
            let (count, gap) = (1 + random(400), random(6));
            let mut dirty = Dirty::default();
            let marks: Vec<usize> = (0..random(60)).map(|_| random(count + 20)).collect();
            marks.iter().for_each(|&m| dirty.mark(m as u32));
            let ranges: Vec<_> = dirty.ranges(count, gap).collect();
            for m in 0..count {
                let inside = ranges.iter().any(|r| r.contains(&m));
                assert!(!marks.contains(&m) || inside);
            }
            assert!(ranges.iter().all(|r| marks.contains(&r.start) && marks.contains(&(r.end - 1))));
            assert!(ranges.windows(2).all(|w| w[1].start - w[0].end > gap));
            let part = random(count)..count;
            let whole = dirty.ranges(count, 0).flatten().filter(|m| part.contains(m));
            let shifted = dirty.ranges_of(part.clone(), 0).flatten().map(|m| m + part.start);
            assert!(whole.eq(shifted));
            let kept: Vec<usize> = dirty.ranges(count, 0).flatten().filter(|m| !part.contains(m)).collect();
            dirty.clear_range(part);
            assert!(dirty.ranges(count, 0).flatten().eq(kept));
            dirty.clear();
            dirty.mark_all(count);
            assert!(dirty.ranges(count, 0).eq(std::iter::once(0..count)));
        }
    }

    #[test]
    fn marks_follow_a_set_through_marking_and_clearing() {
        let mut state = 9u64;
        let mut random = |n: usize| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 40) as usize % n
        };
        let (mut dirty, mut expected) = (Dirty::default(), vec![false; 1_000]);
        for _ in 0..5_000 {
            let (at, length) = (random(900), [1, 20, 900][random(3)]);
            if random(2) == 0 {
                let end = (at + length).min(expected.len());
                dirty.clear_range(at..end);
                expected[at..end].fill(false);
            } else {
                dirty.mark(at as u32);
                expected[at] = true;
            }
            if random(9) == 0 {
                dirty.trim(random(900));
            }
            let marked = (0..expected.len()).filter(|&element| expected[element]);
            assert!(dirty.ranges(expected.len(), 0).flatten().eq(marked));
        }
    }
}
