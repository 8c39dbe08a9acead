//! Packed vertices in use: each has a slot, and the last vertex takes the slot of a removed vertex.

use crate::adapt::{Dirty, DirtyRanges};
use crate::mesh::NONE;

#[derive(Debug, Clone, Default)]
pub(super) struct Packed {
    slot_of: Vec<u32>,
    vertices: Vec<u32>,
    dirty: Dirty,
}

impl Packed {
    pub fn new(vertices: usize) -> Self {
        Self { slot_of: vec![NONE; vertices], ..Self::default() }
    }

    /// Makes room for vertices of numbers below `vertices`.
    #[cfg(feature = "stream")]
    pub fn reach(&mut self, vertices: usize) {
        if self.slot_of.len() < vertices {
            self.slot_of.resize(vertices, NONE);
        }
    }

    /// Returns the vertex in every slot.
    pub fn vertices(&self) -> &[u32] {
        &self.vertices
    }

    #[inline]
    pub fn slot(&self, vertex: u32) -> u32 {
        self.slot_of[vertex as usize]
    }

    /// Returns the slot of a vertex, after assigning a slot if it has none.
    #[inline]
    pub fn take(&mut self, vertex: u32) -> u32 {
        let slot = &mut self.slot_of[vertex as usize];
        if *slot == NONE {
            *slot = self.vertices.len() as u32;
            self.dirty.mark(*slot);
            self.vertices.push(vertex);
        }
        *slot
    }

    /// Frees a vertex's slot. Returns the vertex moved into the slot, if any.
    pub fn free(&mut self, vertex: u32) -> Option<u32> {
        let slot = std::mem::replace(&mut self.slot_of[vertex as usize], NONE);
        if slot == NONE {
            return None;
        }
        self.vertices.swap_remove(slot as usize);
        let moved = *self.vertices.get(slot as usize)?;
        self.slot_of[moved as usize] = slot;
        self.dirty.mark(slot);
        Some(moved)
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

    pub fn memory(&self) -> usize {
        size_of_val(&self.slot_of[..]) + size_of_val(&self.vertices[..]) + self.dirty.memory()
    }
}
