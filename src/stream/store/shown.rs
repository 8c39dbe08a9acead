//! The mesh of the splits in the cut, over pages in memory.
//!
//! Pages come from outside, so that a split may make no sense where it comes: it touches a vertex that another split than its
//! parents touched last, or a triangle of it is none. Such a split stays without effect.

use std::collections::BTreeSet;
use std::ops::Range;

use crate::adapt::{RefinementSink, Refinements, Weights};
use crate::hierarchy::{CutSurface, SplitSource};
use crate::mesh::NONE;

use super::super::starts::Starts;
use super::super::values::Arrived;
use super::cache::Pages;
use super::page::PAGE;

/// A vertex with a number.
#[derive(Debug, Clone, Copy)]
struct Vertex {
    /// The last split that brought it or parted it.
    top: u32,
    /// The vertex that it parted from.
    to: u32,
    /// The split to touch `to` before.
    below: u32,
}

/// Drawn vertices, and which splits touched them.
#[derive(Debug, Clone)]
pub(super) struct Drawn {
    /// Drawn vertices by their first leaves.
    runs: Starts,
    vertices: Vec<Vertex>,
    /// Splits without effect.
    void: BTreeSet<u32>,
    /// Per page, its splits in the mesh.
    pub used: Vec<u32>,
    /// Pages of which the last split has left the mesh.
    pub left: Vec<u32>,
    splits: usize,
}

/// Drawn vertices, and the pages that they are of.
struct Source<'a> {
    pages: &'a Pages,
    drawn: &'a Drawn,
}

impl SplitSource for Source<'_> {
    fn brought(&self, split: u32) -> impl DoubleEndedIterator<Item = [u32; 3]> {
        let brings = self.pages.brings(split).rev();
        brings.map(|[vertex, first]| [vertex, self.drawn.vertices[vertex as usize].to, first])
    }

    fn owned(&self, split: u32) -> Range<u32> {
        self.pages.owned(split)
    }

    fn leaves(&self, triangle: u32) -> [u32; 3] {
        self.pages.leaves(triangle)
    }

    fn group_of(&self, triangle: u32) -> usize {
        self.pages.group_of(triangle)
    }

    fn active(&self, leaf: u32, _: impl Fn(u32) -> bool) -> u32 {
        self.drawn.of(leaf)
    }
}

impl Drawn {
    /// Starts with the coarsest mesh. Returns `None` if a triangle of it is none.
    pub fn new(pages: &Pages, surface: &mut CutSurface) -> Self {
        let store = pages.store();
        let vertex = Vertex { top: NONE, to: NONE, below: NONE };
        let mut drawn = Self {
            runs: Starts::new(store.header.leaves as usize),
            vertices: vec![vertex; store.first_leaf.len()],
            void: BTreeSet::new(),
            used: vec![0; store.page_sizes.len()],
            left: Vec::new(),
            splits: 0,
        };
        for (&first, vertex) in store.first_leaf.iter().zip(0..) {
            drawn.runs.insert(first, vertex);
        }
        surface.reach(store.first_leaf.len(), store.triangles.len());
        for (leaves, triangle) in store.triangles.iter().zip(0..) {
            if drawn.is_triangle(*leaves) {
                surface.show(&Source { pages, drawn: &drawn }, triangle, |_| true);
            }
        }
        drawn
    }

    /// Makes room for the numbers of the pages in memory.
    pub fn reach(&mut self, [vertices, _]: [usize; 2]) {
        if self.vertices.len() < vertices {
            self.vertices.resize(vertices, Vertex { top: NONE, to: NONE, below: NONE });
        }
    }

    /// Returns the number of splits in the mesh.
    pub fn splits(&self) -> usize {
        self.splits
    }

    /// Returns the number of splits without effect, since they made no sense where they came.
    pub fn void(&self) -> usize {
        self.void.len()
    }

    /// Returns the drawn vertex of a leaf.
    fn of(&self, leaf: u32) -> u32 {
        self.runs.up_to(leaf).unwrap_or(NONE)
    }

    /// Whether the corners of a triangle are three drawn vertices.
    fn is_triangle(&self, leaves: [u32; 3]) -> bool {
        let [a, b, c] = leaves.map(|leaf| self.of(leaf));
        a != b && b != c && c != a && ![a, b, c].contains(&NONE)
    }

    /// Brings the vertices of a split. Changes nothing, and returns false, if the split makes no sense here.
    fn bring(&mut self, pages: &Pages, split: u32) -> bool {
        if pages.owned(split).any(|triangle| self.is_triangle(pages.leaves(triangle))) {
            return false;
        }
        let mut brought = 0;
        let mut fits = true;
        for [vertex, first] in pages.brings(split) {
            let to = self.of(first);
            let below = self.vertices.get(to as usize).map_or(split, |to| to.top);
            fits = to != NONE
                && to != vertex
                && (below == NONE || below == split || pages.parents(split).any(|parent| parent == below));
            if !fits {
                break;
            }
            self.vertices[vertex as usize] = Vertex { top: split, to, below };
            self.vertices[to as usize].top = split;
            self.runs.insert(first, vertex);
            brought += 1;
        }
        if fits && pages.owned(split).all(|triangle| self.is_triangle(pages.leaves(triangle))) {
            return true;
        }
        self.take(pages, split, brought);
        false
    }

    /// Takes back the first vertices of a split.
    fn take(&mut self, pages: &Pages, split: u32, brought: usize) {
        let all = pages.brings(split).count();
        for [vertex, first] in pages.brings(split).rev().skip(all - brought) {
            let Vertex { to, below, .. } = self.vertices[vertex as usize];
            self.runs.remove(first);
            self.vertices[to as usize].top = below;
            self.runs.insert(pages.first_leaf(to), to);
        }
    }

    pub fn memory(&self) -> usize {
        self.runs.memory() + size_of_val(&self.vertices[..]) + size_of_val(&self.used[..])
    }
}

/// Applies splits and collapses to the mesh.
pub(super) struct Sink<'a> {
    pub pages: &'a Pages,
    pub drawn: &'a mut Drawn,
    pub surface: &'a mut CutSurface,
}

impl RefinementSink for Sink<'_> {
    fn triangles(&self) -> usize {
        self.surface.triangle_count()
    }

    fn cost(&self, split: u32) -> usize {
        self.pages.owned(split).len()
    }

    fn advance(&mut self, _: &Weights) {}

    fn refine(&mut self, split: u32, _: bool, _: impl Fn(u32) -> bool + Copy) {
        let Self { pages, drawn, surface } = self;
        drawn.used[(split / PAGE) as usize] += 1;
        drawn.splits += 1;
        if drawn.bring(pages, split) {
            surface.split(&Source { pages, drawn }, split, |_| true);
        } else {
            drawn.void.insert(split);
        }
    }

    fn coarsen(&mut self, split: u32) {
        let Self { pages, drawn, surface } = self;
        let used = &mut drawn.used[(split / PAGE) as usize];
        *used -= 1;
        if *used == 0 {
            drawn.left.push(split / PAGE);
        }
        drawn.splits -= 1;
        if !drawn.void.remove(&split) {
            surface.collapse(&Source { pages, drawn }, split);
            drawn.take(pages, split, pages.brings(split).count());
        }
    }

    fn turn(&mut self, _: u32) {}
}
