//! What a client has of a hierarchy: the vertices, splits and triangles that arrived, under numbers of its own, and the mesh that
//! they make.

use std::collections::BTreeMap;
use std::ops::Range;

use crate::hierarchy::{CutSurface, SplitSource};
use crate::mesh::{Mesh, NONE};

use super::error::{Damage, StreamError};
use super::header::Header;
use super::record::{DrawnMesh, Record, Run};
use super::starts::Starts;
use super::values::{Arrived, drawn_mesh};

/// A vertex that arrived: drawn, or replaced by finer vertices.
#[derive(Debug, Clone, Copy)]
struct Vertex {
    start: u32,
    end: u32,
    /// The last split that brought it or parted it.
    top: u32,
}

/// A vertex brought by a split.
#[derive(Debug, Clone, Copy)]
struct Brought {
    vertex: u32,
    to: u32,
    /// The split before this one to touch `to`.
    below: u32,
}

/// A split in the mesh.
#[derive(Debug, Clone, Default)]
struct Split {
    /// In the order of the collapse.
    brought: Vec<Brought>,
    triangles: Range<u32>,
    /// Whether it parts a run at its key.
    keyed: bool,
    /// An earlier split of the same key.
    under: u32,
    firsts: Vec<u32>,
}

/// Vertices, splits and triangles. Numbers that become free are used again.
#[derive(Debug, Clone, Default)]
struct Parts {
    channels: usize,
    leaves: u32,
    vertices: Vec<Vertex>,
    numbers: Vec<u32>,
    free_vertices: Vec<u32>,
    /// Drawn vertices by their first leaves.
    runs: Starts,
    /// The vertex of the coarsest mesh that was added last.
    last: Option<u32>,
    splits: Vec<Split>,
    free_splits: Vec<u32>,
    /// The last split of every key.
    by_key: BTreeMap<u32, u32>,
    triangles: Vec<[u32; 3]>,
    groups: Vec<u16>,
    /// First triangles of free ranges, by length.
    free_triangles: BTreeMap<u32, Vec<u32>>,
}

/// The mesh that arrived.
#[derive(Debug, Clone)]
pub(super) struct Received {
    parts: Parts,
    pub surface: CutSurface,
    splits: usize,
}

impl SplitSource for Parts {
    fn brought(&self, split: u32) -> impl DoubleEndedIterator<Item = [u32; 3]> {
        let brought = self.splits[split as usize].brought.iter();
        brought.map(|b| [b.vertex, b.to, self.vertices[b.vertex as usize].start])
    }

    fn owned(&self, split: u32) -> Range<u32> {
        self.splits[split as usize].triangles.clone()
    }

    fn leaves(&self, triangle: u32) -> [u32; 3] {
        self.triangles[triangle as usize]
    }

    fn group_of(&self, triangle: u32) -> usize {
        self.groups[triangle as usize].into()
    }

    fn active(&self, leaf: u32, _: impl Fn(u32) -> bool) -> u32 {
        self.drawn(leaf)
    }
}

impl Parts {
    /// Returns the drawn vertex of a leaf. The base mesh must be complete.
    fn drawn(&self, leaf: u32) -> u32 {
        self.runs.up_to(leaf).unwrap_or(NONE)
    }

    fn add_vertex(&mut self, vertex: Vertex, numbers: &[u32]) -> u32 {
        if let Some(free) = self.free_vertices.pop() {
            self.vertices[free as usize] = vertex;
            self.numbers[free as usize * self.channels..][..self.channels].copy_from_slice(numbers);
            return free;
        }
        self.vertices.push(vertex);
        self.numbers.extend_from_slice(numbers);
        self.vertices.len() as u32 - 1
    }

    fn add_triangles(&mut self, leaves: &[[u32; 3]], groups: &[u16]) -> Range<u32> {
        let count = leaves.len() as u32;
        let free = self.free_triangles.get_mut(&count).and_then(Vec::pop);
        let first = free.unwrap_or(self.triangles.len() as u32);
        if free.is_some() {
            let range = first as usize..(first + count) as usize;
            self.triangles[range.clone()].copy_from_slice(leaves);
            self.groups[range].copy_from_slice(groups);
        } else {
            self.triangles.extend_from_slice(leaves);
            self.groups.extend_from_slice(groups);
        }
        first..first + count
    }

    fn free(&mut self, triangles: Range<u32>) {
        if !triangles.is_empty() {
            self.free_triangles.entry(triangles.len() as u32).or_default().push(triangles.start);
        }
    }
}

/// Whether three vertices are different.
fn differ([a, b, c]: [u32; 3]) -> bool {
    a != b && b != c && c != a
}

impl Received {
    /// Starts with nothing, for so many leaves, groups of triangles and scalars a vertex.
    pub fn new(leaves: u32, groups: usize, channels: usize) -> Self {
        let runs = Starts::new(leaves as usize);
        let parts = Parts { channels, leaves, runs, ..Parts::default() };
        Self { parts, surface: CutSurface::empty(groups), splits: 0 }
    }

    /// Returns the number of splits in the mesh.
    pub fn splits(&self) -> usize {
        self.splits
    }

    /// Returns the number of vertices that arrived and are kept.
    pub fn vertices(&self) -> usize {
        self.parts.vertices.len() - self.parts.free_vertices.len()
    }

    /// Returns the numbers of a vertex's scalars.
    pub fn numbers(&self, vertex: u32) -> &[u32] {
        &self.parts.numbers[vertex as usize * self.parts.channels..][..self.parts.channels]
    }

    /// Adds a vertex of the coarsest mesh, after all with lower first leaves.
    pub fn add_base_vertex(&mut self, start: u32, numbers: &[u32]) {
        if let Some(last) = self.parts.last {
            self.parts.vertices[last as usize].end = start;
        }
        let vertex = Vertex { start, end: self.parts.leaves, top: NONE };
        let vertex = self.parts.add_vertex(vertex, numbers);
        self.parts.runs.insert(start, vertex);
        self.parts.last = Some(vertex);
        self.surface.reach(self.parts.vertices.len(), 0);
    }

    /// Adds a triangle of the coarsest mesh.
    pub fn add_base_triangle(&mut self, leaves: [u32; 3], group: u16) -> Result<(), Damage> {
        let corners = leaves.map(|leaf| self.parts.drawn(leaf));
        if corners.contains(&NONE) || !differ(corners) {
            return Err(Damage("a triangle of the coarsest mesh is no triangle"));
        }
        let at = self.parts.add_triangles(&[leaves], &[group]).start;
        self.surface.reach(0, self.parts.triangles.len());
        self.surface.show(&self.parts, at, |_| true);
        Ok(())
    }

    /// Makes a split. Nothing has changed if it makes no sense.
    pub fn split(&mut self, record: &Record) -> Result<(), Damage> {
        let Self { parts, surface, .. } = self;
        let number = parts.free_splits.last().copied().unwrap_or(parts.splits.len() as u32);
        let before = |parts: &Parts, leaves: [u32; 3]| differ(leaves.map(|leaf| parts.drawn(leaf)));
        if record.triangles.iter().any(|&leaves| before(parts, leaves)) {
            return Err(Damage("a triangle does not begin with its split"));
        }
        let mut split = Split { under: NONE, ..Split::default() };
        for (at, &first) in record.firsts.iter().enumerate() {
            let to = parts.drawn(first);
            let Vertex { start, end, top } = parts.vertices[to as usize];
            let numbers = &record.numbers[at * parts.channels..][..parts.channels];
            let vertex = parts.add_vertex(Vertex { start: first, end, top: number }, numbers);
            split.keyed |= at == 0 && first != start;
            split.brought.push(Brought { vertex, to, below: top });
            let old = &mut parts.vertices[to as usize];
            (old.end, old.top) = (first, number);
            parts.runs.insert(first, vertex);
        }
        split.brought.reverse();
        let wrong = record.triangles.iter().any(|&leaves| !before(parts, leaves));
        if wrong {
            parts.undo(&split);
            return Err(Damage("a triangle of a split is no triangle"));
        }
        split.firsts.clone_from(&record.firsts);
        split.triangles = parts.add_triangles(&record.triangles, &record.groups);
        split.under = parts.by_key.insert(record.key(), number).unwrap_or(NONE);
        match parts.free_splits.pop() {
            Some(free) => parts.splits[free as usize] = split,
            None => parts.splits.push(split),
        }
        surface.reach(parts.vertices.len(), parts.triangles.len());
        surface.split(&*parts, number, |_| true);
        self.splits += 1;
        Ok(())
    }

    /// Undoes the last split of a key. Fills its record, and returns whether the split may be cached. Nothing has changed if the
    /// split may not go.
    pub fn collapse(&mut self, key: u32, record: &mut Record) -> Result<bool, Damage> {
        let Self { parts, surface, .. } = self;
        let number = *parts.by_key.get(&key).ok_or(Damage("a split that is not there goes"))?;
        let split = &parts.splits[number as usize];
        let on_top = |vertex: u32| parts.vertices[vertex as usize].top == number;
        if !split.brought.iter().all(|b| on_top(b.vertex) && on_top(b.to)) {
            return Err(Damage("a split goes before others that need it"));
        }
        record.start(key);
        record.firsts.clone_from(&split.firsts);
        for brought in split.brought.iter().rev() {
            let numbers = &parts.numbers[brought.vertex as usize * parts.channels..][..parts.channels];
            record.numbers.extend_from_slice(numbers);
        }
        let triangles = split.triangles.start as usize..split.triangles.end as usize;
        record.triangles.extend_from_slice(&parts.triangles[triangles.clone()]);
        record.groups.extend_from_slice(&parts.groups[triangles]);
        surface.collapse(&*parts, number);
        let split = std::mem::take(&mut parts.splits[number as usize]);
        parts.undo(&split);
        parts.free(split.triangles);
        match split.under {
            NONE => parts.by_key.remove(&key),
            under => parts.by_key.insert(key, under),
        };
        parts.free_splits.push(number);
        self.splits -= 1;
        Ok(split.keyed)
    }

    /// Returns the drawn triangles with all attributes: vertices by their first leaves, triangles by their leaves.
    pub fn to_mesh(&self, header: &Header) -> Result<Mesh, StreamError> {
        drawn_mesh(&self.surface, header, &Named { received: self, header })
    }

    /// Bytes of its arrays; the nodes of its trees are estimated.
    pub fn memory(&self) -> usize {
        let parts = &self.parts;
        let splits = parts.splits.iter().map(|split| {
            size_of_val(&split.brought[..]) + size_of_val(&split.firsts[..]) + size_of::<Split>()
        });
        self.surface.memory()
            + size_of_val(&parts.vertices[..])
            + size_of_val(&parts.numbers[..])
            + size_of_val(&parts.triangles[..])
            + size_of_val(&parts.groups[..])
            + splits.sum::<usize>()
            + parts.runs.memory()
            + 16 * parts.by_key.len()
    }
}

impl Parts {
    /// Takes back the vertices of a split.
    fn undo(&mut self, split: &Split) {
        for &Brought { vertex, to, below } in &split.brought {
            let Vertex { start, end, .. } = self.vertices[vertex as usize];
            self.runs.remove(start);
            let old = &mut self.vertices[to as usize];
            (old.end, old.top) = (end, below);
            self.runs.insert(old.start, to);
            self.free_vertices.push(vertex);
        }
    }
}

/// Vertices and triangles that arrived, for a mesh of them.
struct Named<'a> {
    received: &'a Received,
    header: &'a Header,
}

impl Arrived for Named<'_> {
    fn leaves(&self, triangle: u32) -> [u32; 3] {
        self.received.parts.triangles[triangle as usize]
    }

    fn first_leaf(&self, vertex: u32) -> u32 {
        self.received.parts.vertices[vertex as usize].start
    }

    fn scalars(&self, vertex: u32, words: &mut Vec<u32>) {
        words.extend(self.header.layout.words(self.received.numbers(vertex)));
    }
}

impl DrawnMesh for Received {
    fn leaves(&self) -> u32 {
        self.parts.leaves
    }

    fn run(&self, leaf: u32) -> Run {
        let vertex = self.parts.drawn(leaf);
        let Vertex { start, end, .. } = self.parts.vertices[vertex as usize];
        Run { vertex, start, end }
    }

    fn vertex(&self, leaf: u32) -> [u32; 2] {
        let vertex = self.parts.drawn(leaf);
        [vertex, self.parts.vertices[vertex as usize].start]
    }

    fn numbers(&self, vertex: u32) -> &[u32] {
        self.numbers(vertex)
    }

    fn around(&self, leaf: u32, most: usize, mut each: impl FnMut([u32; 2])) {
        let star = || self.surface.star_of_leaf(self.parts.drawn(leaf), leaf);
        if star().nth(most).is_some() {
            return;
        }
        for corner in star() {
            let leaves = self.parts.triangles[corner as usize / 3];
            let at = corner as usize % 3;
            each([leaves[(at + 1) % 3], leaves[(at + 2) % 3]]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Eight leaves in three vertices, and a triangle.
    fn base() -> Received {
        let mut received = Received::new(8, 1, 3);
        [0, 3, 6].into_iter().for_each(|start| received.add_base_vertex(start, &[start, 0, 0]));
        received.add_base_triangle([0, 3, 6], 0).expect("a triangle");
        received
    }

    /// A split of one vertex.
    fn record(key: u32, triangles: &[[u32; 3]]) -> Record {
        let mut record = Record::default();
        record.start(key);
        record.numbers.extend([key, 1, 1]);
        record.triangles.extend(triangles);
        record.groups.resize(triangles.len(), 0);
        record
    }

    fn drawn(received: &Received) -> (Vec<[u32; 3]>, usize, usize) {
        let leaves = received.surface.drawn(0).iter().map(|&t| received.parts.triangles[t as usize]);
        (leaves.collect(), received.vertices(), received.splits())
    }

    #[test]
    fn splits_go_in_the_reverse_order_only() {
        let mut received = base();
        let before = drawn(&received);
        let [first, second] = [record(1, &[[1, 0, 3]]), record(2, &[[2, 1, 6]])];
        received.split(&first).expect("a split");
        received.split(&second).expect("a split of what it brought");
        let both = drawn(&received);
        let mut gone = Record::default();
        assert!(received.collapse(1, &mut gone).is_err(), "the second needs the first");
        assert!(received.collapse(5, &mut gone).is_err(), "there is no such split");
        assert_eq!(drawn(&received), both);
        for expected in [second, first] {
            assert_eq!(received.collapse(expected.key(), &mut gone), Ok(true));
            assert_eq!(gone, expected);
        }
        assert_eq!(drawn(&received), before);
    }

    #[test]
    fn triangles_begin_with_their_split() {
        let mut received = base();
        let before = drawn(&received);
        for (why, triangle) in [
            ("it is drawn before", [0, 3, 6]),
            ("two corners are one vertex after as before", [3, 4, 6]),
            ("two corners are one leaf", [1, 1, 6]),
        ] {
            assert!(received.split(&record(1, &[[1, 0, 3], triangle])).is_err(), "{why}");
            assert_eq!(drawn(&received), before, "{why}");
        }
        assert!(received.add_base_triangle([0, 1, 6], 0).is_err());
        assert_eq!(drawn(&received), before);
        received.split(&record(1, &[[1, 0, 3]])).expect("a split");
    }
}
