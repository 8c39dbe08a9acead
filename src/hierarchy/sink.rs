//! Applies splits and collapses to the drawn mesh: to its surface, and to its moving vertices.

use crate::adapt::{RefinementSink, Weights};
use crate::lod::Vertex;

use super::vertices::Vertices;
use super::{CutSurface, VertexHierarchy};

/// The drawn mesh: surface and vertices.
pub(super) struct Sink<'a, V> {
    pub hierarchy: &'a VertexHierarchy,
    pub surface: &'a mut CutSurface,
    pub vertices: &'a mut Vertices<V>,
}

impl<V: Vertex> RefinementSink for Sink<'_, V> {
    fn triangles(&self) -> usize {
        self.surface.triangle_count()
    }

    fn cost(&self, split: u32) -> usize {
        self.hierarchy.owned(split).len()
    }

    fn advance(&mut self, weights: &Weights) {
        self.vertices.advance(self.hierarchy, weights);
    }

    fn look_ahead(&self, changes: &[(u32, bool)]) {
        self.surface.look_ahead(self.hierarchy, changes);
    }

    #[inline]
    fn refine(&mut self, split: u32, smoothly: bool, there: impl Fn(u32) -> bool + Copy) {
        self.surface.split(self.hierarchy, split, there);
        self.vertices.open(self.hierarchy, split, smoothly);
    }

    #[inline]
    fn coarsen(&mut self, split: u32) {
        self.surface.collapse(self.hierarchy, split);
        self.vertices.end(self.hierarchy, split);
    }

    fn turn(&mut self, split: u32) {
        self.vertices.turn(self.hierarchy, split);
    }
}
