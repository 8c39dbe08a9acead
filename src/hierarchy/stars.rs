//! The corners around every vertex in use, by the name of the vertex. Each star is a run in a pool.
//!
//! A run has room for a power of two. Freed runs wait in a list for their size. So a star is read in memory order, and
//! nothing allocates once the pool has reached its largest size. A pool that is mostly free is packed.

use std::ops::Range;

use crate::geometry::paged::Paged;
use crate::mesh::NONE;

/// A corner of a drawn triangle: `3 * triangle + k`, and its leaf at full resolution.
pub(super) type Entry = [u32; 2];

/// Room of the smallest run, as a shift.
const SMALLEST: u32 = 3;
const SIZES: usize = 30;

#[derive(Debug, Clone, Copy, PartialEq)]
struct Run {
    start: u32,
    /// Number of entries, and in the highest five bits the size class.
    len_class: u32,
}

const LEN: u32 = (1 << 27) - 1;

/// Maximum number of corners around a vertex.
pub(super) const MOST_CORNERS: usize = LEN as usize;

impl Run {
    const EMPTY: Self = Self { start: NONE, len_class: 0 };

    fn new(start: u32, len: usize, class: usize) -> Self {
        Self { start, len_class: len as u32 | (class as u32) << 27 }
    }

    /// Returns where the entries of a run lie, which must not be empty.
    fn range(self) -> Range<usize> {
        self.start as usize..self.start as usize + self.len()
    }

    fn len(self) -> usize {
        (self.len_class & LEN) as usize
    }

    fn class(self) -> usize {
        (self.len_class >> 27) as usize
    }
}

/// The star of every name.
#[derive(Debug, Clone)]
pub(super) struct CornerStars {
    runs: Paged<Run, 6>,
    pool: Vec<Entry>,
    /// First free run of every size. The first entry of a free run names the next.
    free: [u32; SIZES],
}

fn room(class: usize) -> usize {
    1 << (class as u32 + SMALLEST)
}

/// Returns the class of the smallest run with room for so many entries.
fn class_for(entries: usize) -> usize {
    (0..SIZES).find(|&class| room(class) >= entries).unwrap_or(SIZES - 1)
}

impl CornerStars {
    /// Starts without corners, with room for names below `names`.
    pub fn new(names: usize) -> Self {
        Self { runs: Paged::of(names, Run::EMPTY), pool: Vec::new(), free: [NONE; SIZES] }
    }

    /// Makes room for a name.
    #[inline]
    pub fn reach(&mut self, name: u32) {
        self.runs.reach(name as usize + 1);
    }

    /// Gives the star of a name to another name, which has none.
    pub fn rename(&mut self, from: u32, to: u32) {
        *self.runs.entry(to) = self.runs.rest(from);
    }

    /// Returns the corners of a star; none if there is no such name.
    #[inline]
    pub fn of(&self, name: u32) -> &[Entry] {
        let run = self.runs.get(name);
        if run.start == NONE { &[] } else { &self.pool[run.range()] }
    }

    fn take(&mut self, class: usize) -> u32 {
        let head = self.free[class];
        if head != NONE {
            self.free[class] = self.pool[head as usize][0];
            return head;
        }
        // Half of a larger free run.
        if let Some(larger) = (class + 1..SIZES).find(|&larger| self.free[larger] != NONE) {
            let start = self.free[larger];
            self.free[larger] = self.pool[start as usize][0];
            for smaller in class..larger {
                self.give(start + room(smaller) as u32, smaller);
            }
            return start;
        }
        let start = self.pool.len() as u32;
        self.pool.resize(self.pool.len() + room(class), [0; 2]);
        start
    }

    fn give(&mut self, start: u32, class: usize) {
        self.pool[start as usize][0] = self.free[class];
        self.free[class] = start;
    }

    #[inline]
    pub fn push(&mut self, name: u32, entry: Entry) {
        let mut run = self.runs.at(name);
        let len = run.len();
        if run.start == NONE {
            let start = self.take(0);
            self.pool[start as usize] = entry;
            *self.runs.entry(name) = Run::new(start, 1, 0);
            return;
        }
        if len == room(run.class()) {
            run = self.grow(run, run.class() + 1);
        }
        self.pool[run.start as usize + len] = entry;
        *self.runs.entry(name) = Run { len_class: run.len_class + 1, ..run };
    }

    /// Moves entries to a larger run.
    fn grow(&mut self, run: Run, class: usize) -> Run {
        let start = self.take(class);
        self.pool.copy_within(run.range(), start as usize);
        self.give(run.start, run.class());
        Run::new(start, run.len(), class)
    }

    /// Removes the corners of a range from a star. Returns the number left.
    pub fn remove(&mut self, name: u32, corners: &Range<u32>) -> usize {
        let run = self.runs.at(name);
        let left = self.retain(run, corners);
        if left < run.len() {
            self.shorten(name, run, left);
        }
        left
    }

    /// Moves the entries of a run outside a range of corners to its front. Returns their number.
    #[inline]
    fn retain(&mut self, run: Run, without: &Range<u32>) -> usize {
        let mut left = 0;
        if run.start != NONE {
            let entries = &mut self.pool[run.range()];
            for at in 0..entries.len() {
                let entry = entries[at];
                entries[left] = entry;
                left += usize::from(!without.contains(&entry[0]));
            }
        }
        left
    }

    /// Shortens a run to its first `len` entries.
    fn shorten(&mut self, name: u32, run: Run, len: usize) {
        let entry = self.runs.entry(name);
        if len == 0 {
            *entry = Run::EMPTY;
            self.give(run.start, run.class());
        } else {
            *entry = Run::new(run.start, len, run.class());
        }
    }

    /// Returns the number of corners with leaf `from` or higher.
    #[inline]
    pub fn count(&self, name: u32, from: u32) -> usize {
        self.of(name).iter().filter(|entry| entry[1] >= from).count()
    }

    /// Moves the `goes` corners with leaf `from` or higher to another star, which must be empty. Calls `moved` with each corner.
    pub fn part(&mut self, name: u32, to: u32, (from, goes): (u32, usize), mut moved: impl FnMut(u32)) {
        let run = self.runs.at(name);
        let (start, len) = (run.start as usize, run.len());
        if goes == len {
            self.pool[run.range()].iter().for_each(|entry| moved(entry[0]));
            *self.runs.entry(to) = run;
            self.runs.rest(name);
            return;
        }
        let class = class_for(goes);
        let target = self.take(class);
        let (mut stay, mut go) = (start, target as usize);
        for at in start..start + len {
            let entry = self.pool[at];
            if entry[1] >= from {
                moved(entry[0]);
                self.pool[go] = entry;
                go += 1;
            } else {
                self.pool[stay] = entry;
                stay += 1;
            }
        }
        *self.runs.entry(to) = Run::new(target, goes, class);
        self.shorten(name, run, len - goes);
    }

    /// Moves all corners of a star to another star. Calls `moved` with each corner.
    pub fn join(&mut self, name: u32, to: u32, mut moved: impl FnMut(u32)) {
        let run = self.runs.at(name);
        self.pool[run.range()].iter().for_each(|entry| moved(entry[0]));
        let other = self.runs.at(to);
        if other.start == NONE {
            *self.runs.entry(to) = run;
            self.runs.rest(name);
            return;
        }
        let class = class_for(other.len() + run.len()).max(other.class());
        let joined = if class == other.class() { other } else { self.grow(other, class) };
        self.pool.copy_within(run.range(), joined.range().end);
        *self.runs.entry(to) = Run { len_class: joined.len_class + run.len() as u32, ..joined };
        self.shorten(name, run, 0);
    }

    /// Looks for pages that are not in use.
    pub fn sweep(&mut self) {
        self.runs.sweep();
    }

    /// Gives back memory if most of it is not in use: stars are packed into a new pool.
    pub fn trim(&mut self) {
        self.runs.trim();
        // Runs of stars that were large once are shortened, too.
        let used: usize = self.runs.others().map(|(_, run)| room(class_for(run.len()))).sum();
        if self.pool.len() <= 4 * used + 512 {
            return;
        }
        let mut pool = Vec::with_capacity(2 * used);
        self.runs.update_others(|run| {
            let (start, class) = (pool.len(), class_for(run.len()));
            pool.extend_from_slice(&self.pool[run.range()]);
            pool.resize(start + room(class), [0; 2]);
            Run::new(start as u32, run.len(), class)
        });
        self.pool = pool;
        self.free = [NONE; SIZES];
    }

    pub fn memory(&self) -> usize {
        self.runs.memory() + self.pool.capacity() * size_of::<Entry>()
    }
}
