//! When a batch of a matching is full.
//!
//! A matching goes on until nothing is left to match, at 0.54 of the triangles, and then holds the dearest collapses of the whole
//! mesh beside the cheapest. So a batch ends before: on scans the largest error of the first level is then 1.4 to 3 times the
//! error of linear order instead of 2 to 10 times, and its mean within 1.1 of it from the second level on.

use super::queue::CLASSES_PER_OCTAVE;

/// Share of the triangles at which a batch is full.
const FULL: f64 = 0.59;
/// Share of the triangles after which the cost is taken as the batch's cheap cost.
const BEGUN: f64 = 0.95;
/// A batch is full when costs are this many octaves above the cheap cost: of flat faces and curves, for example, the flat faces
/// are thinned out again by the next batch before the curves are. On scans the share comes first.
const LEAP: u32 = 10;

/// How full a batch is.
pub(super) struct Filling {
    begun_at: usize,
    full_at: usize,
    /// Class of cost when the batch had begun.
    cheap: Option<u32>,
}

impl Filling {
    /// Starts a batch with this many triangles.
    pub fn new(triangles: usize) -> Self {
        let [begun_at, full_at] = [BEGUN, FULL].map(|share| (share * triangles as f64) as usize);
        Self { begun_at, full_at, cheap: None }
    }

    /// Holds if the batch has enough, with this many triangles left, and this class of cost next.
    pub fn is_full(&mut self, triangles: usize, class: u32) -> bool {
        if triangles > self.begun_at {
            return false;
        }
        let cheap = *self.cheap.get_or_insert(class);
        triangles <= self.full_at || class > cheap + LEAP * CLASSES_PER_OCTAVE
    }
}
