//! The pages in memory, as the cut sees them.

use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};

use crate::adapt::Refinements;
use crate::mesh::NONE;
use crate::view::Bounds;

use super::super::values::Arrived;
use super::blocks::Blocks;
use super::header::Shared;
use super::page::{PAGE, Page};

/// The cut has come to a split of the page, or needs one for another that is asked for.
const COME_TO: u8 = 1;
const NEEDED: u8 = 2;

/// A page in memory.
#[derive(Debug, Clone)]
struct Slot {
    page: u32,
    content: Page,
    /// First numbers of its vertices and of its triangles.
    first_vertex: u32,
    first_triangle: u32,
    /// When its last split left the mesh.
    left: u64,
}

/// The pages in memory. Vertices and triangles have numbers while their page is in memory.
#[derive(Debug)]
pub(super) struct Pages {
    store: Arc<Shared>,
    slots: Vec<Option<Slot>>,
    free: Vec<u32>,
    /// Per page, its slot, or `NONE`.
    slot_of: Vec<u32>,
    vertices: Blocks,
    triangles: Blocks,
    /// Per page, whether the cut has come to a split of it since it was in memory last: `COME_TO`, or `NEEDED`.
    missed: Vec<AtomicU8>,
    /// Bytes of the pages.
    bytes: usize,
    /// Advances with every page that comes or is left.
    clock: u64,
}

impl Clone for Pages {
    fn clone(&self) -> Self {
        let missed = self.missed.iter().map(|missed| AtomicU8::new(missed.load(Ordering::Relaxed)));
        Self {
            store: Arc::clone(&self.store),
            slots: self.slots.clone(),
            free: self.free.clone(),
            slot_of: self.slot_of.clone(),
            vertices: self.vertices.clone(),
            triangles: self.triangles.clone(),
            missed: missed.collect(),
            bytes: self.bytes,
            clock: self.clock,
        }
    }
}

impl Pages {
    pub fn new(store: Arc<Shared>) -> Self {
        let pages = store.page_sizes.len();
        Self {
            slots: Vec::new(),
            free: Vec::new(),
            slot_of: vec![NONE; pages],
            vertices: Blocks::new(store.first_leaf.len() as u32),
            triangles: Blocks::new(store.triangles.len() as u32),
            missed: (0..pages).map(|_| AtomicU8::new(0)).collect(),
            bytes: 0,
            clock: 0,
            store,
        }
    }

    pub fn store(&self) -> &Shared {
        &self.store
    }

    /// Bytes of the pages in memory.
    pub fn bytes(&self) -> usize {
        self.bytes
    }

    /// Number of pages in memory.
    pub fn count(&self) -> usize {
        self.slots.len() - self.free.len()
    }

    /// Numbers of vertices and of triangles end before these.
    pub fn ends(&self) -> [usize; 2] {
        [self.vertices.end(), self.triangles.end()]
    }

    pub fn has(&self, page: u32) -> bool {
        self.slot_of.get(page as usize).is_some_and(|&slot| slot != NONE)
    }

    /// Returns the pages that the cut has come to and not found, and whether it needs them whatever their bounds.
    pub fn missed(&self) -> impl Iterator<Item = (u32, bool)> {
        let missed = (0..).zip(&self.missed).map(|(page, missed)| (page, missed.load(Ordering::Relaxed)));
        missed.filter(|(_, missed)| *missed != 0).map(|(page, missed)| (page, missed & NEEDED != 0))
    }

    /// Adds a page, which must not be in memory.
    pub fn insert(&mut self, page: u32, content: Page) {
        let number = self.free.pop().unwrap_or(self.slots.len() as u32);
        let [vertices, triangles, bytes] = content.sizes();
        self.clock += 1;
        let slot = Slot {
            page,
            first_vertex: self.vertices.take(vertices as usize, number),
            first_triangle: self.triangles.take(triangles as usize, number),
            content,
            left: self.clock,
        };
        match self.slots.get_mut(number as usize) {
            Some(place) => *place = Some(slot),
            None => self.slots.push(Some(slot)),
        }
        self.slot_of[page as usize] = number;
        self.missed[page as usize].store(0, Ordering::Relaxed);
        self.bytes += bytes as usize;
    }

    /// Takes a page out of memory.
    pub fn remove(&mut self, page: u32) {
        let number = std::mem::replace(&mut self.slot_of[page as usize], NONE);
        let Some(slot) = self.slots.get_mut(number as usize).and_then(Option::take) else { return };
        let [vertices, triangles, bytes] = slot.content.sizes();
        self.vertices.free(slot.first_vertex, vertices as usize);
        self.triangles.free(slot.first_triangle, triangles as usize);
        self.bytes -= bytes as usize;
        self.free.push(number);
    }

    /// Notes that the last split of a page has left the mesh.
    pub fn leave(&mut self, page: u32) {
        self.clock += 1;
        let clock = self.clock;
        if let Some(Some(slot)) = self.slots.get_mut(self.slot_of[page as usize] as usize) {
            slot.left = clock;
        }
    }

    /// Returns the pages in memory, and when they were left.
    pub fn ages(&self) -> impl Iterator<Item = (u64, u32)> {
        self.slots.iter().flatten().map(|slot| (slot.left, slot.page))
    }

    /// Returns the slot of a split in memory, and the split's number in its page.
    ///
    /// # Panics
    /// If the split is not available: the cut asks for bounds and relatives of those alone that are.
    #[inline]
    fn slot(&self, split: u32) -> (&Slot, u32) {
        let slot = self.slots.get(self.slot_of[(split / PAGE) as usize] as usize);
        match slot {
            Some(Some(slot)) => (slot, split % PAGE),
            _ => unreachable!("split {split} is not in memory"),
        }
    }

    /// Returns the vertices of a split in the order in which they come: numbers, and their first leaves.
    pub fn brings(&self, split: u32) -> impl DoubleEndedIterator<Item = [u32; 2]> {
        let (slot, at) = self.slot(split);
        slot.content
            .brings(at)
            .map(|vertex| [slot.first_vertex + vertex, slot.content.first_leaf[vertex as usize]])
    }

    /// Returns the triangles of a split.
    pub fn owned(&self, split: u32) -> std::ops::Range<u32> {
        let (slot, at) = self.slot(split);
        let owned = slot.content.owned(at);
        slot.first_triangle + owned.start..slot.first_triangle + owned.end
    }

    /// Returns the group of a triangle.
    pub fn group_of(&self, triangle: u32) -> usize {
        if (triangle as usize) < self.store.triangles.len() {
            return self.store.group_of.get(triangle as usize).map_or(0, |&group| group.into());
        }
        match &self.slots[self.triangles.slot(triangle) as usize] {
            Some(slot) => slot.content.group_of(triangle - slot.first_triangle),
            None => 0,
        }
    }

    pub fn memory(&self) -> usize {
        self.bytes
            + self.slots.capacity() * size_of::<Option<Slot>>()
            + self.slot_of.len() * (size_of::<u32>() + size_of::<AtomicU8>())
            + self.vertices.memory()
            + self.triangles.memory()
    }
}

impl Arrived for Pages {
    fn leaves(&self, triangle: u32) -> [u32; 3] {
        if let Some(leaves) = self.store.triangles.get(triangle as usize) {
            return *leaves;
        }
        match &self.slots[self.triangles.slot(triangle) as usize] {
            Some(slot) => slot.content.triangles[(triangle - slot.first_triangle) as usize],
            None => [0; 3],
        }
    }

    fn first_leaf(&self, vertex: u32) -> u32 {
        if let Some(leaf) = self.store.first_leaf.get(vertex as usize) {
            return *leaf;
        }
        match &self.slots[self.vertices.slot(vertex) as usize] {
            Some(slot) => slot.content.first_leaf[(vertex - slot.first_vertex) as usize],
            None => 0,
        }
    }

    fn scalars(&self, vertex: u32, words: &mut Vec<u32>) {
        if (vertex as usize) < self.store.first_leaf.len() {
            return self.store.words(vertex, words);
        }
        if let Some(slot) = &self.slots[self.vertices.slot(vertex) as usize] {
            slot.content.words(vertex - slot.first_vertex, words);
        }
    }
}

impl Refinements for Pages {
    type Bounds = Bounds;

    const PARTIAL: bool = true;

    fn len(&self) -> usize {
        self.store.header.splits as usize
    }

    fn roots(&self) -> impl Iterator<Item = u32> {
        self.store.roots.iter().copied()
    }

    #[inline]
    fn bounds(&self, split: u32) -> Bounds {
        let (slot, at) = self.slot(split);
        slot.content.bounds[at as usize]
    }

    #[inline]
    fn error(&self, split: u32) -> f32 {
        let (slot, at) = self.slot(split);
        slot.content.order(at)
    }

    #[inline]
    fn parents(&self, split: u32) -> impl Iterator<Item = u32> {
        let (slot, at) = self.slot(split);
        slot.content.parents.get(at).iter().copied()
    }

    #[inline]
    fn children(&self, split: u32) -> impl Iterator<Item = u32> {
        let (slot, at) = self.slot(split);
        slot.content.children.get(at).iter().copied()
    }

    #[inline]
    fn dependencies(&self, split: u32) -> impl Iterator<Item = u32> {
        let (slot, at) = self.slot(split);
        slot.content.dependencies.get(at).iter().copied()
    }

    #[inline]
    fn available(&self, split: u32) -> bool {
        self.slot_of[(split / PAGE) as usize] != NONE
    }

    fn miss(&self, split: u32, needed: bool) {
        let how = if needed { NEEDED } else { COME_TO };
        self.missed[(split / PAGE) as usize].fetch_or(how, Ordering::Relaxed);
    }
}
