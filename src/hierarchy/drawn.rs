//! What is drawn, as the cut moves it: splits and collapses of the surface, and vertices that move with them.

use crate::adapt::{Change, Cut, Picture, is_done};
use crate::view::{Criterion, Motion};

use super::{Surface, VertexHierarchy};

/// Who moves the vertices that splits bring.
pub(super) trait Movement {
    /// All go on by a share of their way.
    fn advance(&mut self, hierarchy: &VertexHierarchy, progress: f32);
    /// The vertices of a split start at their substitutes, or at their own places.
    fn open(&mut self, hierarchy: &VertexHierarchy, split: u32, smoothly: bool);
    /// They turn to their substitutes, or to their own places.
    fn turn(&mut self, hierarchy: &VertexHierarchy, split: u32, closing: bool);
    /// They are gone.
    fn end(&mut self, hierarchy: &VertexHierarchy, split: u32);
}

/// Nobody.
impl Movement for () {
    fn advance(&mut self, _: &VertexHierarchy, _: f32) {}
    fn open(&mut self, _: &VertexHierarchy, _: u32, _: bool) {}
    fn turn(&mut self, _: &VertexHierarchy, _: u32, _: bool) {}
    fn end(&mut self, _: &VertexHierarchy, _: u32) {}
}

/// What is drawn, and where.
pub(super) struct Drawn<'a, M> {
    pub hierarchy: &'a VertexHierarchy,
    pub surface: &'a mut Surface,
    pub movement: &'a mut M,
}

impl<M: Movement> Picture for Drawn<'_, M> {
    fn cost(&self, split: u32) -> usize {
        self.hierarchy.owned(split).len()
    }

    fn advance(&mut self, progress: f32) {
        self.movement.advance(self.hierarchy, progress);
    }

    fn refine(&mut self, split: u32, smoothly: bool, there: impl Fn(u32) -> bool + Copy) {
        self.surface.split(self.hierarchy, split, there);
        self.movement.open(self.hierarchy, split, smoothly);
    }

    fn coarsen(&mut self, split: u32) {
        self.surface.collapse(self.hierarchy, split);
        self.movement.end(self.hierarchy, split);
    }

    fn close(&mut self, split: u32) {
        self.movement.turn(self.hierarchy, split, true);
    }

    fn reopen(&mut self, split: u32) {
        self.movement.turn(self.hierarchy, split, false);
    }
}

/// The fast way: what is asked for is drawn at once.
pub(super) fn direct<C: Criterion + ?Sized>(
    (hierarchy, cut, surface): (&VertexHierarchy, &mut Cut, &mut Surface),
    criterion: &C,
    motion: Motion,
) -> Change {
    let cut = cut.update(hierarchy, criterion, motion, |state, split, comes| {
        if comes {
            surface.split(hierarchy, split, |other| is_done(state, other));
        } else {
            surface.collapse(hierarchy, split);
        }
    });
    Change { cut, triangles: surface.triangle_count(), ..Change::default() }
}
