//! A priority queue of points keyed by cost, in constant time and in the order of memory.
//!
//! Costs are sorted into classes by the leading bits of their float representation: 16 classes an octave, so that two
//! costs of one class differ by at most 6.25 %. Inside a class it is first in, first out. Two reasons against a binary
//! heap: it costs a logarithm, and it visits points of equal worth in random order, which on a large mesh makes every
//! collapse a cache miss. Points that enter in index order leave in index order, class by class.
//!
//! An entry is never searched for: a point that moves to another class leaves its old entry behind, which is recognised
//! when it comes up.

use crate::mesh::NONE;

/// Bits of the cost that make its class: 8 exponent bits and 4 of the mantissa (the sign is always 0).
const CLASS_SHIFT: u32 = 19;
const CLASSES: usize = (f32::INFINITY.to_bits() >> CLASS_SHIFT) as usize + 1;

/// A queue of points by cost class. Costs must not be negative or NaN.
#[derive(Debug, Clone)]
pub(super) struct ClassQueue {
    classes: Vec<Fifo>,
    /// The class that each point waits in; [`NONE`] while it does not wait.
    class_of: Vec<u32>,
    current: usize,
}

#[derive(Debug, Clone, Default)]
struct Fifo {
    entries: Vec<u32>,
    head: usize,
}

impl ClassQueue {
    pub fn new(points: usize) -> Self {
        Self { classes: vec![Fifo::default(); CLASSES], class_of: vec![NONE; points], current: 0 }
    }

    /// Puts a point in, or moves it to its new class. A cost below the class being served joins that class.
    #[inline]
    pub fn insert(&mut self, point: u32, cost: f32) {
        debug_assert!(cost >= 0.0, "cost {cost}");
        let class = ((cost.to_bits() >> CLASS_SHIFT) as usize).clamp(self.current, CLASSES - 1);
        if self.class_of[point as usize] != class as u32 {
            self.class_of[point as usize] = class as u32;
            self.classes[class].entries.push(point);
        }
    }

    /// Takes a point out, wherever it waits.
    #[inline]
    pub fn remove(&mut self, point: u32) {
        self.class_of[point as usize] = NONE;
    }

    /// Whether a cost is due: no dearer than the class being served.
    #[inline]
    pub fn is_due(&self, cost: f32) -> bool {
        (cost.to_bits() >> CLASS_SHIFT) as usize <= self.current
    }

    /// The next point, taken out.
    pub fn pop(&mut self) -> Option<u32> {
        while self.current < CLASSES {
            let fifo = &mut self.classes[self.current];
            while let Some(&point) = fifo.entries.get(fifo.head) {
                fifo.head += 1;
                if self.class_of[point as usize] == self.current as u32 {
                    self.class_of[point as usize] = NONE;
                    return Some(point);
                }
            }
            *fifo = Fifo::default();
            self.current += 1;
        }
        self.current = CLASSES - 1;
        None
    }

    /// Empties the queue and starts again at the cheapest class.
    pub fn restart(&mut self) {
        self.classes.iter_mut().for_each(|fifo| *fifo = Fifo::default());
        self.class_of.fill(NONE);
        self.current = 0;
    }
}
