//! The corners around every active vertex. Each star is a run in a pool.
//!
//! A run has room for a power of two. Freed runs wait in a list for their size. So a star is read in memory order, and
//! nothing allocates once the pool has reached its largest size.

use std::ops::Range;

use crate::mesh::NONE;

/// A corner of a drawn triangle: `3 * triangle + k`, and its leaf at full resolution.
pub(super) type Entry = [u32; 2];

/// Room of the smallest run, as a shift.
const SMALLEST: u32 = 3;
const SIZES: usize = 30;

#[derive(Debug, Clone, Copy)]
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

    fn len(self) -> usize {
        (self.len_class & LEN) as usize
    }

    fn class(self) -> usize {
        (self.len_class >> 27) as usize
    }
}

#[derive(Debug, Clone)]
pub(super) struct CornerStars {
    runs: Vec<Run>,
    pool: Vec<Entry>,
    /// First free run of every size. The first entry of a free run names the next.
    free: [u32; SIZES],
}

fn room(class: usize) -> usize {
    1 << (class as u32 + SMALLEST)
}

impl CornerStars {
    pub fn new(vertices: usize) -> Self {
        Self { runs: vec![Run::EMPTY; vertices], pool: Vec::new(), free: [NONE; SIZES] }
    }

    /// Makes room for vertices of numbers below `vertices`.
    #[cfg(feature = "stream")]
    pub fn reach(&mut self, vertices: usize) {
        if self.runs.len() < vertices {
            self.runs.resize(vertices, Run::EMPTY);
        }
    }

    #[inline]
    pub fn of(&self, vertex: u32) -> &[Entry] {
        let run = self.runs[vertex as usize];
        if run.start == NONE {
            return &[];
        }
        &self.pool[run.start as usize..run.start as usize + run.len()]
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
    pub fn push(&mut self, vertex: u32, entry: Entry) {
        let run = self.runs[vertex as usize];
        let len = run.len();
        if run.start == NONE {
            let start = self.take(0);
            self.pool[start as usize] = entry;
            self.runs[vertex as usize] = Run { start, len_class: 1 };
            return;
        }
        if len == room(run.class()) {
            self.grow(vertex, run.class() + 1);
        }
        let run = &mut self.runs[vertex as usize];
        self.pool[run.start as usize + len] = entry;
        run.len_class += 1;
    }

    fn grow(&mut self, vertex: u32, class: usize) {
        let run = self.runs[vertex as usize];
        let start = self.take(class);
        self.pool.copy_within(run.start as usize..run.start as usize + run.len(), start as usize);
        self.give(run.start, run.class());
        self.runs[vertex as usize] = Run { start, len_class: run.len() as u32 | (class as u32) << 27 };
    }

    /// Removes the corners of a range from a star.
    pub fn remove(&mut self, vertex: u32, corners: &Range<u32>) {
        let run = self.runs[vertex as usize];
        let left = self.retain(run, corners);
        if left < run.len() {
            self.shorten(vertex, left);
        }
    }

    /// Moves the entries of a run outside a range of corners to its front. Returns their number.
    #[inline]
    fn retain(&mut self, run: Run, without: &Range<u32>) -> usize {
        let mut left = 0;
        if run.start != NONE {
            let entries = &mut self.pool[run.start as usize..run.start as usize + run.len()];
            for at in 0..entries.len() {
                let entry = entries[at];
                entries[left] = entry;
                left += usize::from(!without.contains(&entry[0]));
            }
        }
        left
    }

    /// Shortens a run to its first `len` entries.
    fn shorten(&mut self, vertex: u32, len: usize) {
        let run = self.runs[vertex as usize];
        if len == 0 {
            self.give(run.start, run.class());
            self.runs[vertex as usize] = Run::EMPTY;
        } else {
            self.runs[vertex as usize].len_class = len as u32 | (run.class() as u32) << 27;
        }
    }

    /// Moves the corners with leaf `from` or higher to another star, which must be empty. Calls `moved` with each corner.
    pub fn part(&mut self, vertex: u32, to: u32, from: u32, mut moved: impl FnMut(u32)) {
        let run = self.runs[vertex as usize];
        if run.start == NONE {
            return;
        }
        let (start, len) = (run.start as usize, run.len());
        let goes = self.pool[start..start + len].iter().filter(|entry| entry[1] >= from).count();
        if goes == 0 {
            return;
        }
        if goes == len {
            self.pool[start..start + len].iter().for_each(|entry| moved(entry[0]));
            self.runs[to as usize] = run;
            self.runs[vertex as usize] = Run::EMPTY;
            return;
        }
        let mut class = 0;
        while room(class) < goes {
            class += 1;
        }
        let target = self.take(class) as usize;
        let (mut stay, mut go) = (start, target);
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
        self.runs[to as usize] = Run { start: target as u32, len_class: goes as u32 | (class as u32) << 27 };
        self.shorten(vertex, len - goes);
    }

    /// Moves all corners of a star to another star, except a range, which is dropped. Calls `moved` with each moved
    /// corner.
    pub fn join(&mut self, from: u32, to: u32, without: &Range<u32>, mut moved: impl FnMut(u32)) {
        let len = self.retain(self.runs[from as usize], without);
        if len < self.runs[from as usize].len() {
            self.shorten(from, len);
        }
        if len == 0 {
            return;
        }
        let run = self.runs[from as usize];
        let start = run.start as usize;
        self.pool[start..start + len].iter().for_each(|entry| moved(entry[0]));
        let other = self.runs[to as usize];
        if other.start == NONE {
            self.runs[to as usize] = run;
            self.runs[from as usize] = Run::EMPTY;
            return;
        }
        let all = other.len() + len;
        let mut class = other.class();
        while room(class) < all {
            class += 1;
        }
        if class != other.class() {
            self.grow(to, class);
        }
        let run = &mut self.runs[to as usize];
        let end = run.start as usize + run.len();
        run.len_class += len as u32;
        self.pool.copy_within(start..start + len, end);
        self.shorten(from, 0);
    }

    pub fn memory(&self) -> usize {
        size_of_val(&self.runs[..]) + size_of_val(&self.pool[..])
    }
}
