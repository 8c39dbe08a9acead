//! Vertices in use: each has a slot, and the last vertex takes the slot of a removed vertex.

use crate::adapt::{Dirty, DirtyRanges};
use crate::geometry::paged::{Paged, trim};
use crate::mesh::NONE;

/// Numbers of vertices in use lie together in parts, so pages are short.
#[derive(Debug, Clone)]
pub(super) struct Slots {
    slot_of: Paged<u32, 6>,
    vertices: Vec<u32>,
    dirty: Dirty,
}

impl Slots {
    pub fn new(vertices: usize) -> Self {
        Self { slot_of: Paged::of(vertices, NONE), vertices: Vec::new(), dirty: Dirty::default() }
    }

    /// Makes room for vertices of numbers below `vertices`.
    #[cfg(feature = "stream")]
    pub fn reach(&mut self, vertices: usize) {
        self.slot_of.reach(vertices);
    }

    /// Returns the vertex in every slot.
    pub fn vertices(&self) -> &[u32] {
        &self.vertices
    }

    /// Returns the slot of a vertex, or `NONE`.
    #[inline]
    pub fn slot(&self, vertex: u32) -> u32 {
        self.slot_of.get(vertex)
    }

    /// Returns the slot of a vertex, after assigning a slot if it has none.
    #[inline]
    pub fn take(&mut self, vertex: u32) -> u32 {
        let slot = self.slot_of.entry(vertex);
        if *slot == NONE {
            *slot = self.vertices.len() as u32;
            self.dirty.mark(*slot);
            self.vertices.push(vertex);
        }
        *slot
    }

    /// Frees a slot. The vertex of the last slot takes it. Returns the number of that slot.
    pub fn free(&mut self, slot: u32) -> u32 {
        let vertex = self.vertices.swap_remove(slot as usize);
        self.slot_of.rest(vertex);
        if let Some(&moved) = self.vertices.get(slot as usize) {
            *self.slot_of.entry(moved) = slot;
            self.dirty.mark(slot);
        }
        self.vertices.len() as u32
    }

    pub fn dirty(&self, gap: usize) -> DirtyRanges<'_> {
        self.dirty.ranges(self.vertices.len(), gap)
    }

    /// Marks all slots as written.
    #[cfg(feature = "stream")]
    pub fn invalidate(&mut self) {
        self.dirty.mark_all(self.vertices.len());
    }

    pub fn clean(&mut self) {
        self.dirty.clear();
    }

    /// Looks for pages that are not in use.
    pub fn sweep(&mut self) {
        self.slot_of.sweep();
    }

    /// Gives back memory if most of it is not in use.
    pub fn trim(&mut self) {
        self.slot_of.trim();
        trim(&mut self.vertices);
        self.dirty.trim(self.vertices.len());
    }

    pub fn memory(&self) -> usize {
        self.slot_of.memory() + self.vertices.capacity() * size_of::<u32>() + self.dirty.memory()
    }
}
