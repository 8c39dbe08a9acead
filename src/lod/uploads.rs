//! Writes and draws of a frame, in the terms of graphics interfaces: buffers, offsets, bytes and ranges of indices.

use std::ops::Range;

use crate::adapt::DirtyRanges;

use super::Lod;

/// Most bytes between two written ranges to upload along with them: cheaper than another write.
const GAP: usize = 48;
/// Bytes of a triangle's indices.
const TRIANGLE: usize = size_of::<[u32; 3]>();

/// A write into a buffer: with wgpu, `queue.write_buffer(&buffers[upload.buffer], upload.offset, upload.bytes)`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct Upload<'a> {
    /// 0: vertices; `1 + group`: indices of a group.
    pub buffer: usize,
    /// Offset in the buffer, bytes. Offset and length are multiples of 4 if the size of a vertex is.
    pub offset: u64,
    /// Bytes to write.
    pub bytes: &'a [u8],
    /// Bytes in the buffer from now on. The buffer must be at least this large.
    pub size: u64,
}

/// All writes of a frame; see [`Lod::uploads`].
#[derive(Clone)]
pub struct Uploads<'a> {
    lod: &'a dyn Lod,
    buffer: usize,
    ranges: DirtyRanges<'a>,
}

impl<'a> Uploads<'a> {
    /// Makes the writes of an instance: [`Lod::uploads`].
    pub fn new(lod: &'a dyn Lod) -> Self {
        let gap = GAP / lod.vertex_size().max(1);
        let ranges = if lod.shares_vertices() { DirtyRanges::none() } else { lod.dirty_vertices(gap) };
        Self { lod, buffer: 0, ranges }
    }
}

impl<'a> Iterator for Uploads<'a> {
    type Item = Upload<'a>;

    fn next(&mut self) -> Option<Upload<'a>> {
        loop {
            if let Some(range) = self.ranges.next() {
                let (all, each) = match self.buffer.checked_sub(1) {
                    None => (self.lod.vertex_bytes(), self.lod.vertex_size()),
                    Some(group) => (bytemuck::cast_slice(self.lod.buffered_triangles(group)), TRIANGLE),
                };
                // Vertices without values have no bytes.
                let Some(bytes) = all.get(range.start * each..range.end * each).filter(|b| !b.is_empty())
                else {
                    continue;
                };
                let (offset, size) = ((range.start * each) as u64, all.len() as u64);
                return Some(Upload { buffer: self.buffer, offset, bytes, size });
            }
            if self.buffer >= self.lod.groups() {
                return None;
            }
            self.buffer += 1;
            self.ranges = self.lod.dirty_triangles(self.buffer - 1, GAP / TRIANGLE);
        }
    }
}

/// An indexed draw: with wgpu, `pass.draw_indexed(draw.indices, draw.base_vertex, 0..1)` with the index buffer `draw.buffer`.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct Draw {
    /// The buffer of the indices, as in [`Upload::buffer`].
    pub buffer: usize,
    /// Range of indices in the buffer.
    pub indices: Range<u32>,
    /// Added to every index.
    pub base_vertex: i32,
    /// The material id; `u32::MAX` where the mesh has no materials.
    pub material: u32,
}

/// All draws of a frame; see [`Lod::draws`].
#[derive(Clone)]
pub struct Draws<'a> {
    lod: &'a dyn Lod,
    groups: Range<usize>,
}

impl<'a> Draws<'a> {
    /// Makes the draws of an instance: [`Lod::draws`].
    #[inline]
    pub fn new(lod: &'a dyn Lod) -> Self {
        Self { lod, groups: 0..lod.groups() }
    }
}

impl Iterator for Draws<'_> {
    type Item = Draw;

    #[inline]
    fn next(&mut self) -> Option<Draw> {
        for group in self.groups.by_ref() {
            let drawn = self.lod.drawn_range(group);
            if !drawn.is_empty() {
                return Some(Draw {
                    buffer: 1 + group,
                    indices: 3 * drawn.start as u32..3 * drawn.end as u32,
                    base_vertex: 0,
                    material: self.lod.material(group),
                });
            }
        }
        None
    }
}
