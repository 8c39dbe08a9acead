//! 16-bit indices where they fit: half the memory, checked.

use super::Lod;

/// Highest index: one less than 16 bits hold, which many graphics interfaces take for the end of a strip.
const HIGHEST: u32 = u16::MAX as u32 - 1;

/// The triangles of one group with 16-bit indices, kept up to date by dirty ranges.
///
/// ```text
///     adapt(views)  ->  match short.update(&lod, group)  ->  upload what is dirty  ->  clean()
///                         Some: 16 bits        None: 32 bits
/// ```
#[derive(Debug, Clone, Default)]
pub struct ShortIndices {
    triangles: Vec<[u16; 3]>,
    /// Whether they were all right before.
    fits: bool,
}

impl ShortIndices {
    /// Takes in what was written since the last [`clean`](Lod::clean); call it before that, every time, and always for
    /// the same group of the same level of detail.
    ///
    /// `None` where an index is above 65,534, as can only be with more than 65,535 vertices in use (packed) or in all.
    /// Dirty ranges then are those of the 32-bit indices; the first time that it fits again all must be uploaded
    /// ([`ShortIndices::is_new`] says so before the call). O(what was written); O(triangles) where it did not fit before.
    pub fn update(&mut self, lod: &(impl Lod + ?Sized), group: usize) -> Option<&[[u16; 3]]> {
        let triangles = lod.triangles(group);
        let fits = self.take(triangles, lod, group);
        self.fits = fits;
        fits.then_some(&self.triangles)
    }

    /// Whether the next [`ShortIndices::update`] writes all, since none before did or the last did not fit.
    pub fn is_new(&self) -> bool {
        !self.fits
    }

    fn take(&mut self, triangles: &[[u32; 3]], lod: &(impl Lod + ?Sized), group: usize) -> bool {
        self.triangles.resize(triangles.len(), [0; 3]);
        if self.fits {
            lod.dirty_triangles(group, 0)
                .all(|range| narrow(&triangles[range.clone()], &mut self.triangles[range]))
        } else {
            narrow(triangles, &mut self.triangles)
        }
    }
}

/// Copies indices of equally many triangles; whether all fit.
fn narrow(from: &[[u32; 3]], to: &mut [[u16; 3]]) -> bool {
    from.iter().zip(to).all(|(from, to)| {
        *to = from.map(|index| index as u16);
        from.iter().all(|&index| index <= HIGHEST)
    })
}
