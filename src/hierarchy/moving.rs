//! Where vertices are that are not at rest.
//!
//! ```text
//!     opening   from where it was to its own place
//!     closing   from where it was to where its substitute is, which may be on its way itself
//! ```
//!
//! A vertex is the blend of a start and a goal. To turn round is to start anew from where it is, so nothing jumps; and a
//! closing vertex has come to its substitute when it gives way to it, so that does not show. A substitute that is a new
//! vertex counts as drawn where it is or will be.
//!
//! Only what moves costs anything: entries are a list, with its place per vertex.

use std::sync::Arc;

use crate::adapt::{Blend, Dirty, DirtyRanges};
use crate::mesh::NONE;

use super::drawn::Movement;
use super::{Surface, VertexHierarchy};

#[derive(Debug, Clone)]
struct Entry<V> {
    vertex: u32,
    start: V,
    /// Where it is.
    shown: V,
    /// Share of the way gone.
    weight: f32,
    closing: bool,
    /// Whether `shown` is that of this frame.
    done: bool,
}

#[derive(Debug, Clone)]
pub(super) struct Moving<V> {
    /// Every vertex at rest.
    values: Arc<[V]>,
    /// Per vertex its entry, or `NONE`.
    entry_of: Vec<u32>,
    entries: Vec<Entry<V>>,
    chain: Vec<u32>,
    /// Vertices that came to rest, or came there at once, in this frame.
    rested: Vec<u32>,
    /// Per vertex, or per slot, what is drawn.
    drawn: Vec<V>,
    dirty: Dirty,
}

impl<V: Blend + Copy> Moving<V> {
    /// All at rest. `values` must be as many as vertices. Without slots all are drawn from the start.
    pub fn new(values: Arc<[V]>, surface: &Surface) -> Self {
        let drawn: Vec<V> = match surface.vertices() {
            Some(vertices) => vertices.iter().map(|&vertex| values[vertex as usize]).collect(),
            None => values.to_vec(),
        };
        let mut dirty = Dirty::default();
        dirty.mark_all(drawn.len());
        Self {
            entry_of: vec![NONE; values.len()],
            entries: Vec::new(),
            chain: Vec::new(),
            rested: Vec::new(),
            values,
            drawn,
            dirty,
        }
    }

    fn entry(&self, vertex: u32) -> Option<&Entry<V>> {
        self.entries.get(self.entry_of[vertex as usize] as usize)
    }

    /// Where a vertex is.
    pub fn shown(&self, vertex: u32) -> V {
        self.entry(vertex).map_or(self.values[vertex as usize], |entry| entry.shown)
    }

    fn start(&mut self, vertex: u32, from: V, closing: bool) {
        let entry = Entry { vertex, start: from, shown: from, weight: 0.0, closing, done: true };
        match self.entry_of[vertex as usize] {
            NONE => {
                self.entry_of[vertex as usize] = self.entries.len() as u32;
                self.entries.push(entry);
            }
            at => self.entries[at as usize] = entry,
        }
    }

    fn remove(&mut self, vertex: u32) {
        let at = std::mem::replace(&mut self.entry_of[vertex as usize], NONE);
        if at != NONE {
            self.entries.swap_remove(at as usize);
            if let Some(moved) = self.entries.get(at as usize) {
                self.entry_of[moved.vertex as usize] = at;
            }
        }
    }

    /// Finds where an entry is, and first its substitute if it goes there.
    fn find(&mut self, hierarchy: &VertexHierarchy, at: usize) {
        self.chain.clear();
        let mut next = at as u32;
        while let Some(entry) = self.entries.get(next as usize).filter(|entry| !entry.done) {
            self.chain.push(next);
            if !entry.closing {
                break;
            }
            next = self.entry_of[hierarchy.substitute[entry.vertex as usize] as usize];
        }
        while let Some(at) = self.chain.pop() {
            let Entry { vertex, start, weight, closing, .. } = self.entries[at as usize];
            let goal = if closing {
                self.shown(hierarchy.substitute[vertex as usize])
            } else {
                self.values[vertex as usize]
            };
            let entry = &mut self.entries[at as usize];
            entry.shown = start.blend(&goal, weight);
            entry.done = true;
        }
    }

    /// Writes what is drawn where something moved, or where a slot got another vertex.
    pub fn write(&mut self, surface: &mut Surface) {
        if let Some(vertices) = surface.vertices() {
            self.drawn.truncate(vertices.len());
            for range in surface.dirty_vertices(0) {
                for slot in range {
                    let value = self.shown(vertices[slot]);
                    match self.drawn.get_mut(slot) {
                        Some(drawn) => *drawn = value,
                        None => self.drawn.push(value),
                    }
                    self.dirty.mark(slot as u32);
                }
            }
        }
        for i in 0..self.rested.len() + self.entries.len() {
            let vertex = match self.rested.get(i) {
                Some(&vertex) => vertex,
                None => self.entries[i - self.rested.len()].vertex,
            };
            // Without slots also what is not in use: it may come into use without a word.
            let slot = if surface.vertices().is_none() { Some(vertex) } else { surface.slot(vertex) };
            if let Some(slot) = slot {
                let value = self.shown(vertex);
                if let Some(drawn) = self.drawn.get_mut(slot as usize) {
                    *drawn = value;
                    self.dirty.mark(slot);
                }
            }
        }
        self.rested.clear();
        surface.clean_vertices();
    }

    /// Per vertex, or per slot, what is drawn.
    pub fn drawn(&self) -> &[V] {
        &self.drawn
    }

    pub fn dirty(&self, gap: usize) -> DirtyRanges<'_> {
        self.dirty.ranges(self.drawn.len(), gap)
    }

    pub fn clean(&mut self) {
        self.dirty.clear();
    }

    /// Vertices that move.
    pub fn len(&self) -> usize {
        self.entries.len()
    }

    /// Bytes of its arrays, the values at rest not counted.
    pub fn memory(&self) -> usize {
        size_of_val(&self.entry_of[..])
            + size_of_val(&self.entries[..])
            + size_of_val(&self.drawn[..])
            + self.dirty.memory()
    }
}

impl<V: Blend + Copy> Movement for Moving<V> {
    fn advance(&mut self, hierarchy: &VertexHierarchy, progress: f32) {
        for entry in &mut self.entries {
            entry.weight = (entry.weight + progress).min(1.0);
            entry.done = false;
        }
        for at in 0..self.entries.len() {
            self.find(hierarchy, at);
        }
        let mut at = 0;
        while at < self.entries.len() {
            let Entry { vertex, weight, closing, .. } = self.entries[at];
            if !closing && weight >= 1.0 {
                self.remove(vertex);
                self.rested.push(vertex);
            } else {
                at += 1;
            }
        }
    }

    fn open(&mut self, hierarchy: &VertexHierarchy, split: u32, smoothly: bool) {
        // The last one taken is the first that another may start at.
        for &vertex in hierarchy.brings.get(split).iter().rev() {
            if smoothly {
                let from = self.shown(hierarchy.substitute[vertex as usize]);
                self.start(vertex, from, false);
            } else {
                self.remove(vertex);
                self.rested.push(vertex);
            }
        }
    }

    fn turn(&mut self, hierarchy: &VertexHierarchy, split: u32, closing: bool) {
        for &vertex in hierarchy.brings.get(split) {
            let from = self.shown(vertex);
            self.start(vertex, from, closing);
        }
    }

    fn end(&mut self, hierarchy: &VertexHierarchy, split: u32) {
        hierarchy.brings.get(split).iter().for_each(|&vertex| self.remove(vertex));
    }
}
