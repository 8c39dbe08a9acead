//! 16-bit indices where they fit: half the memory, checked.

use crate::adapt::{Dirty, DirtyRanges};

use super::Lod;

/// Highest index: `u16::MAX - 1`, since many graphics interfaces take `u16::MAX` for the end of a strip.
const HIGHEST: u32 = u16::MAX as u32 - 1;

/// The triangles of a group with 16-bit indices, kept up to date with an instance's writes.
///
/// ```text
///     adapt(views)  ->  match short.update(&lod, group)  ->  upload short.dirty(gap)  ->  short.clean(), lod.clean()
///                         Some: 16 bits        None: 32 bits
/// ```
#[derive(Debug, Clone, Default)]
pub struct ShortIndices {
    triangles: Vec<[u16; 3]>,
    /// Triangles in the buffer.
    buffered: usize,
    dirty: Dirty,
    /// Set if all indices fitted at the last update.
    fits: bool,
}

impl ShortIndices {
    /// Copies the triangles written since the instance's last [`clean`](Lod::clean). Call it before every `clean`, and always
    /// for the same group of the same instance.
    ///
    /// Returns `None` if an index is above 65,534, possible only with more than 65,535 vertices in use (packed) or in all. Draw
    /// the 32-bit indices then. O(written triangles); O(triangles) if the last update did not fit.
    pub fn update(&mut self, lod: &(impl Lod + ?Sized), group: usize) -> Option<&[[u16; 3]]> {
        let triangles = lod.buffered_triangles(group);
        self.buffered = triangles.len();
        self.fits =
            if self.fits { self.take_written(triangles, lod, group) } else { self.take_all(triangles) };
        self.fits.then(|| &self.triangles[..triangles.len()])
    }

    /// Returns the triangles written since the last [`ShortIndices::clean`], as ascending ranges. Ranges with at most `gap`
    /// unwritten triangles between them are merged. Returns all triangles if the update before the last did not fit.
    pub fn dirty(&self, gap: usize) -> DirtyRanges<'_> {
        self.dirty.ranges(self.buffered, gap)
    }

    /// Forgets what was written. Call it after the upload.
    pub fn clean(&mut self) {
        self.dirty.clear_range(0..self.buffered);
    }

    fn take_all(&mut self, triangles: &[[u32; 3]]) -> bool {
        // Triangles behind the drawn ones are copied again when they come back.
        self.triangles.clear();
        self.dirty.clear();
        self.dirty.mark_all(triangles.len());
        self.triangles.resize(triangles.len(), [0; 3]);
        narrow(triangles, &mut self.triangles)
    }

    fn take_written(&mut self, triangles: &[[u32; 3]], lod: &(impl Lod + ?Sized), group: usize) -> bool {
        // Triangles behind the drawn ones stay as they were, as in the instance.
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

/// Copies the indices of equally many triangles. Returns true if all fit.
fn narrow(from: &[[u32; 3]], to: &mut [[u16; 3]]) -> bool {
    let mut fits = true;
    for (from, to) in from.iter().zip(to) {
        *to = from.map(|index| index as u16);
        fits &= from.iter().all(|&index| index <= HIGHEST);
    }
    fits
}
