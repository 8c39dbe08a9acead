//! 16-bit indices where they fit: half the memory, checked.

use crate::adapt::{Dirty, DirtyRanges};

use super::Lod;

/// Highest index: one less than 16 bits hold, which many graphics interfaces take for the end of a strip.
const HIGHEST: u32 = u16::MAX as u32 - 1;

/// The triangles of one group with 16-bit indices, kept up to date by what an instance writes.
///
/// ```text
///     adapt(views)  ->  match short.update(&lod, group)  ->  upload short.dirty(gap)  ->  short.clean(), lod.clean()
///                         Some: 16 bits        None: 32 bits
/// ```
#[derive(Debug, Clone, Default)]
pub struct ShortIndices {
    triangles: Vec<[u16; 3]>,
    /// Triangles drawn.
    drawn: usize,
    dirty: Dirty,
    /// Whether they were all right before.
    fits: bool,
}

impl ShortIndices {
    /// Takes in what was written since the last [`clean`](Lod::clean) of the instance; call it before that, every time, and
    /// always for the same group of the same instance.
    ///
    /// `None` where an index is above 65,534, as can only be with more than 65,535 vertices in use (packed) or in all: then draw
    /// the 32-bit indices. O(what was written); O(triangles) where it did not fit before.
    pub fn update(&mut self, lod: &(impl Lod + ?Sized), group: usize) -> Option<&[[u16; 3]]> {
        let triangles = lod.triangles(group);
        self.drawn = triangles.len();
        self.fits =
            if self.fits { self.take_written(triangles, lod, group) } else { self.take_all(triangles) };
        self.fits.then(|| &self.triangles[..triangles.len()])
    }

    /// Triangles written since the last [`ShortIndices::clean`], as ascending ranges; those that at most `gap` unwritten ones part
    /// are one. All of them where the last update but one did not fit.
    pub fn dirty(&self, gap: usize) -> DirtyRanges<'_> {
        self.dirty.ranges(self.drawn, gap)
    }

    /// Forgets what was written: call it when it is uploaded.
    pub fn clean(&mut self) {
        self.dirty.clear_range(0..self.drawn);
    }

    fn take_all(&mut self, triangles: &[[u32; 3]]) -> bool {
        // What lies behind is taken in again when it comes back.
        self.triangles.clear();
        self.dirty.clear();
        self.dirty.mark_all(triangles.len());
        self.triangles.resize(triangles.len(), [0; 3]);
        narrow(triangles, &mut self.triangles)
    }

    fn take_written(&mut self, triangles: &[[u32; 3]], lod: &(impl Lod + ?Sized), group: usize) -> bool {
        // Those behind what is drawn stay as they were, as they do in the instance.
        let known = self.triangles.len();
        if known < triangles.len() {
            self.triangles.resize(triangles.len(), [0; 3]);
            (known..triangles.len()).for_each(|triangle| self.dirty.mark(triangle as u32));
        }
        let new = known.min(triangles.len())..triangles.len();
        let mut fits = narrow(&triangles[new.clone()], &mut self.triangles[new]);
        for range in lod.dirty_triangles(group, 0) {
            range.clone().for_each(|triangle| self.dirty.mark(triangle as u32));
            fits &= narrow(&triangles[range.clone()], &mut self.triangles[range]);
        }
        fits
    }
}

/// Copies indices of equally many triangles; whether all fit.
fn narrow(from: &[[u32; 3]], to: &mut [[u16; 3]]) -> bool {
    let mut fits = true;
    for (from, to) in from.iter().zip(to) {
        *to = from.map(|index| index as u16);
        fits &= from.iter().all(|&index| index <= HIGHEST);
    }
    fits
}
