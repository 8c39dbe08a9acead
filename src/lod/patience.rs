//! When an instance gives memory back: once it has drawn little for long. A flight that returns finds its buffers warm.

/// Frames until memory is given back.
const FRAMES: u32 = 512;

/// Waits until what was drawn has not become less for a while.
#[derive(Debug, Clone, Default)]
pub(crate) struct Patience {
    frames: u32,
    /// Most triangles drawn since.
    most: usize,
    /// Whether anything has changed since memory was given back.
    changed: bool,
}

impl Patience {
    /// Counts a frame. Returns whether to give back memory.
    #[inline]
    pub fn frame(&mut self, triangles: usize, changed: bool) -> bool {
        self.frames += 1;
        self.most = self.most.max(triangles);
        self.changed |= changed;
        if self.frames < FRAMES {
            return false;
        }
        let gives = self.changed && self.most <= 2 * triangles + 64;
        *self = Self { changed: self.changed && !gives, ..Self::default() };
        gives
    }
}
