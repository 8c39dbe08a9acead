//! A priority queue of points keyed by cost, in constant time and in the order of memory.
//!
//! Costs are classed by the leading bits of their float representation: 16 classes per octave, so two costs of equal
//! class differ by at most 6.25 %. Inside a class the queue is first in, first out. Two reasons against a binary heap:
//! it costs a logarithm, and it visits points of equal cost in random order, so on a large mesh each collapse is a
//! cache miss. A point may be [put behind](ClassQueue::put_behind) all others of its class.
//!
//! ```text
//!             tile 0        tile 1        tile 2          points by number, a few thousand waiting ones a tile
//!   band 0    1  2  3       4  5  6       7  8  9         costs by class, some octaves a band
//!   band 1   10 11 12      13 14 15      16 17 18
//! ```
//!
//! Where points do not fit the cache, a band of costs is served tile by tile, and each tile class by class. Costs are
//! then served in nearly ascending order: [`rank`](ClassQueue::rank) tells the class of each point, by which
//! `reorder.rs` sorts the sequence afterwards. Once a single tile is left, a single band holds all classes.
//!
//! Entries are never searched for. A point moved to another class leaves its old entry behind, recognised when it comes
//! up. Points waiting for a later tile or band are found by scanning the classes of all points.

use crate::mesh::NONE;

/// Bits dropped from the cost to get its class: 8 exponent bits and 4 of the mantissa remain (the sign is always 0).
const CLASS_SHIFT: u32 = 19;
/// Classes of an octave of cost.
pub(super) const CLASSES_PER_OCTAVE: u32 = 1 << (f32::MANTISSA_DIGITS - 1 - CLASS_SHIFT);
const CLASSES: u32 = (f32::INFINITY.to_bits() >> CLASS_SHIFT) + 1;
/// Set in the class of a point whose next entry does not count: a later entry does.
const BEHIND: u32 = 1 << 16;
/// Most waiting points served as a single tile: their neighbourhoods fit a last-level cache.
const WHOLE: usize = 65_536;
/// Waiting points per tile where more than `WHOLE` wait: their neighbourhoods fit a second-level cache.
const TILE: usize = 8192;

/// A queue of points by cost class. Costs must not be negative or NaN.
#[derive(Debug, Clone)]
pub(super) struct ClassQueue {
    /// Class in which each point waits; [`NONE`] while it does not wait.
    class_of: Vec<u32>,
    /// A queue per class of the current band.
    classes: Vec<Fifo>,
    /// Current band: its first class, and the first class beyond.
    band: [u32; 2],
    /// The current class.
    current: u32,
    /// Points of the current tile. `stride`: points per tile.
    tile: std::ops::Range<usize>,
    stride: usize,
    /// Least class seen beyond the band or before the tile: the next band starts there.
    least_beyond: u32,
    waiting: usize,
    /// Number of classes per tiled band. `bands`: number of bands begun.
    band_width: u32,
    bands: u32,
}

#[derive(Debug, Clone, Default)]
struct Fifo {
    entries: Vec<u32>,
    head: usize,
}

impl ClassQueue {
    /// Creates an empty queue for `points` points. A wide band streams a large mesh through the cache less often; a
    /// narrow band keeps closer to the order of cost.
    pub fn new(points: usize, band_width: u32) -> Self {
        Self {
            class_of: vec![NONE; points],
            classes: Vec::new(),
            band: [0, 0],
            current: 0,
            tile: 0..0,
            stride: points,
            least_beyond: 0,
            waiting: 0,
            band_width,
            bands: 0,
        }
    }

    fn class(cost: f32) -> u32 {
        (cost.to_bits() >> CLASS_SHIFT).min(CLASSES - 1)
    }

    /// Inserts a point, or moves it to its new class.
    #[inline]
    pub fn insert(&mut self, point: u32, cost: f32) {
        debug_assert!(cost >= 0.0, "cost {cost}");
        let class = Self::class(cost);
        let waits = &mut self.class_of[point as usize];
        if *waits & !BEHIND == class {
            return;
        }
        self.waiting += usize::from(*waits == NONE);
        *waits = class;
        if class < self.band[1] && self.tile.contains(&(point as usize)) {
            // A cost below the current class joins the current class.
            let class = class.max(self.current);
            self.class_of[point as usize] = class;
            self.classes[(class - self.band[0]) as usize].entries.push(point);
        }
        if class >= self.band[1] || (point as usize) < self.tile.start {
            self.least_beyond = self.least_beyond.min(class);
        }
    }

    /// Moves a point that is due behind all others that are. Any other point stays where it waits.
    pub fn put_behind(&mut self, point: u32) {
        let waits = &mut self.class_of[point as usize];
        if *waits == self.current && self.tile.contains(&(point as usize)) {
            *waits |= BEHIND;
            self.classes[(self.current - self.band[0]) as usize].entries.push(point);
        }
    }

    /// Removes a point, wherever it waits.
    #[inline]
    pub fn remove(&mut self, point: u32) {
        let waits = &mut self.class_of[point as usize];
        self.waiting -= usize::from(*waits != NONE);
        *waits = NONE;
    }

    /// Returns true if a cost is due: its class is at most the current class.
    #[inline]
    pub fn is_due(&self, cost: f32) -> bool {
        Self::class(cost) <= self.current
    }

    /// The current class: the class of the point popped last.
    #[inline]
    pub fn rank(&self) -> u32 {
        self.current
    }

    /// Returns true if bands are served tile by tile. Ranks may then descend.
    #[inline]
    pub fn is_tiled(&self) -> bool {
        self.stride < self.class_of.len()
    }

    /// Bands begun so far.
    #[inline]
    pub fn bands(&self) -> u32 {
        self.bands
    }

    /// Removes and returns the next point.
    pub fn pop(&mut self) -> Option<u32> {
        loop {
            while self.current < self.band[1] {
                let fifo = &mut self.classes[(self.current - self.band[0]) as usize];
                while let Some(&point) = fifo.entries.get(fifo.head) {
                    fifo.head += 1;
                    let waits = &mut self.class_of[point as usize];
                    if *waits == self.current {
                        *waits = NONE;
                        self.waiting -= 1;
                        return Some(point);
                    }
                    if *waits == self.current | BEHIND {
                        *waits = self.current;
                    }
                }
                fifo.entries.clear();
                fifo.head = 0;
                self.current += 1;
            }
            if !self.next_tile() {
                return None;
            }
        }
    }

    /// Moves on to the next tile, or to the first tile of the next band. Returns false if no tile is left and nothing
    /// waits.
    fn next_tile(&mut self) -> bool {
        let points = self.class_of.len();
        if self.tile.end >= points {
            if self.waiting == 0 {
                self.band = [0, 0];
                self.current = 0;
                return false;
            }
            // Fewer points wait than at first: tiles widen, with about `TILE` waiting points each.
            let tiles = if self.waiting <= WHOLE { 1 } else { self.waiting.div_ceil(TILE) };
            self.bands += 1;
            self.stride = points.div_ceil(tiles);
            let start = self.least_beyond;
            self.band = [start, if tiles == 1 { CLASSES } else { (start + self.band_width).min(CLASSES) }];
            self.least_beyond = CLASSES - 1;
            self.classes.resize((self.band[1] - start) as usize, Fifo::default());
            self.tile = 0..0;
        }
        self.tile = self.tile.end..(self.tile.end + self.stride).min(points);
        self.current = self.band[0];
        for point in self.tile.clone() {
            let class = self.class_of[point];
            if class == NONE {
                continue;
            }
            if class < self.band[1] {
                let class = class.max(self.current);
                self.class_of[point] = class;
                self.classes[(class - self.band[0]) as usize].entries.push(point as u32);
            } else {
                self.least_beyond = self.least_beyond.min(class);
            }
        }
        true
    }

    /// Empties the queue and starts again at the cheapest class.
    pub fn restart(&mut self) {
        let points = self.class_of.len();
        *self = Self { class_of: std::mem::take(&mut self.class_of), ..Self::new(0, self.band_width) };
        self.class_of.fill(NONE);
        self.stride = points;
        // Before the first tile: everything waits beyond an empty band.
        self.tile = points..points;
        self.least_beyond = CLASSES - 1;
    }
}
