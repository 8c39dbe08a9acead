//! A drawn instance: an index buffer moved between resolutions at the cost of the difference.

use std::ops::Range;
use std::sync::Arc;

use super::indices::Indices;
use super::{MaterialRange, Resolution, TomSteps};

/// Indices per bit of the dirty map, as a shift: 64 indices, 256 bytes.
const DIRTY_SHIFT: u32 = 6;
/// Most dirty ranges handed out at once.
const MOST_RANGES: usize = 32;

/// Report on a move of a cursor.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct Change {
    /// Resolution before the move.
    pub from: Resolution,
    /// Resolution after the move.
    pub to: Resolution,
    /// Indices written; an index written twice counts twice.
    pub written: usize,
}

/// A drawn instance of a totally ordered mesh; owns its index buffer.
///
/// 12 bytes a triangle of the full resolution, plus 1 bit per 64 indices. Allocates when it is made, never after.
///
/// ```text
///     buffer   | drawn: indices() ............ | not drawn: waits for finer resolutions |
/// ```
///
/// Keep a copy of [`TomCursor::buffer`] on the GPU: write the ranges named by [`TomCursor::take_dirty`], draw
/// [`TomCursor::ranges`]. Triangles coming back need no upload: the copy still holds them.
#[derive(Debug, Clone)]
pub struct TomCursor {
    indices: Indices,
    dirty_map: Vec<u64>,
    dirty: Vec<Range<usize>>,
}

impl TomCursor {
    /// Makes a cursor at full resolution, all of it dirty.
    pub fn new(steps: Arc<TomSteps>) -> Self {
        let indices = Indices::new(steps);
        let bits = indices.buffer().len().div_ceil(1 << DIRTY_SHIFT);
        let mut dirty_map = vec![u64::MAX; bits.div_ceil(64)];
        if let (Some(last), used @ 1..) = (dirty_map.last_mut(), bits % 64) {
            *last = (1 << used) - 1;
        }
        Self { indices, dirty_map, dirty: Vec::with_capacity(MOST_RANGES + 1) }
    }

    /// Returns the mesh with its table of steps.
    pub fn steps(&self) -> &Arc<TomSteps> {
        self.indices.steps()
    }

    /// Returns the current resolution.
    pub fn resolution(&self) -> Resolution {
        self.indices.resolution()
    }

    /// Returns the indices to draw, equal to the output of [`fill_indices`](super::TotallyOrderedMesh::fill_indices).
    /// With [`TomSteps::by_material`] the slice has gaps between materials: draw [`TomCursor::ranges`] instead.
    pub fn indices(&self) -> &[u32] {
        let end = self.ranges().iter().map(|r| r.start + r.count).max().unwrap_or(0);
        &self.buffer()[..end as usize]
    }

    /// Returns the whole buffer, undrawn triangles included: the content of the GPU's copy.
    pub fn buffer(&self) -> &[u32] {
        self.indices.buffer()
    }

    /// Returns the ranges of [`TomCursor::buffer`] to draw: 1 per material, or a single range. Includes empty ranges.
    pub fn ranges(&self) -> &[MaterialRange] {
        self.indices.ranges()
    }

    /// Returns the bytes of this cursor's own arrays.
    pub fn memory(&self) -> usize {
        self.indices.memory()
            + size_of_val(&self.dirty_map[..])
            + self.dirty.capacity() * size_of::<Range<usize>>()
    }

    /// Moves to a resolution of this mesh. O(corners rewritten by the steps between), about 4 per vertex between, plus
    /// a walk as in [`at`](super::TotallyOrderedMesh::at).
    pub fn seek(&mut self, resolution: Resolution) -> Change {
        let Self { indices, dirty_map, .. } = self;
        indices.seek(indices.rounded(resolution), |place| {
            let bit = place >> DIRTY_SHIFT;
            dirty_map[(bit / 64) as usize] |= 1 << (bit % 64);
        })
    }

    /// Returns the ranges of [`TomCursor::buffer`] written since the last call: ascending, disjoint, at most 32.
    /// Nearby ranges are merged and so cover some unchanged indices. After [`TomCursor::new`], returns all of the
    /// buffer.
    pub fn take_dirty(&mut self) -> &[Range<usize>] {
        let bits = self.dirty_map.len() * 64;
        // Merge over larger and larger gaps until the ranges are few.
        let mut gap = 4;
        loop {
            self.dirty.clear();
            let mut run: Option<Range<usize>> = None;
            for bit in set_bits(&self.dirty_map) {
                match &mut run {
                    Some(run) if bit <= run.end + gap => run.end = bit + 1,
                    _ => self.dirty.extend(run.replace(bit..bit + 1)),
                }
                if self.dirty.len() >= MOST_RANGES {
                    break;
                }
            }
            self.dirty.extend(run);
            if self.dirty.len() <= MOST_RANGES || gap >= bits {
                break;
            }
            gap *= 2;
        }
        for range in &mut self.dirty {
            *range = range.start << DIRTY_SHIFT..(range.end << DIRTY_SHIFT).min(self.indices.buffer().len());
        }
        self.dirty_map.fill(0);
        &self.dirty
    }
}

/// Returns the positions of the set bits, ascending.
fn set_bits(words: &[u64]) -> impl Iterator<Item = usize> {
    words.iter().enumerate().filter(|&(_, &word)| word != 0).flat_map(|(i, &word)| {
        let mut rest = word;
        std::iter::from_fn(move || {
            let bit = rest.trailing_zeros() as usize;
            rest &= rest.wrapping_sub(1);
            (bit < 64).then_some(64 * i + bit)
        })
    })
}
