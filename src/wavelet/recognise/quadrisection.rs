//! A mesh taken apart into base faces and their four-to-one subdivisions: a forest of faces in level order.
//!
//! ```text
//!                 c2
//!                 /\                 face      [c0, c1, c2]; side k runs from c_k to c_k+1, its midpoint is m_k
//!                /2 \                child i   [c_i, m_i, m_i+2], at corner i = 0, 1, 2 (indices modulo 3)
//!            m2 /____\ m1            child 3   [m0, m1, m2], the centre
//!              /\ 3  /\
//!             /0 \  /1 \             children turn the way of their parent
//!            /____\/____\
//!          c0     m0     c1
//!
//!     faces    | base faces | four children of every split base face | four of every split one of those | ...
//!     level    |     0      |                   1                    |                2                 |
//! ```
//!
//! Faces are numbered in this order. A parent comes before its children, the four children of a face are consecutive, and a
//! pass from either end visits parents first or children first.

use std::ops::Range;

use crate::mesh::NONE;

/// A mesh taken apart into base faces and their four-to-one subdivisions: a forest of faces in level order.
///
/// Made by [`recognise`](crate::wavelet::recognise()). Every triangle of the mesh is exactly 1 leaf. Here and below, triangles are
/// those of [`Recognition::leaves`](crate::wavelet::Recognition::leaves): the triangles of the mesh, except where a leaf is several
/// of them. For a face with
/// corners c0, c1, c2 and midpoints m_k on the sides from c_k to c_k+1, child i is `[c_i, m_i, m_i+2]` for i = 0, 1, 2,
/// and child 3 is the centre `[m0, m1, m2]`. 5 bytes a face.
///
/// Two different edges of a face above the leaves may join the same two vertices. Such edges are told apart by the mesh's edges
/// along them, and a midpoint belongs to its edge.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Quadrisection {
    base_faces: u32,
    /// Per face: whether it is split.
    split: Vec<bool>,
    /// Per face: `NONE` if split, else 3 * triangle + r, where the triangle's corner r is the face's corner 0.
    leaves: Vec<u32>,
    /// Start of each level, and the end of the last level.
    level_start: Vec<u32>,
}

impl Quadrisection {
    /// Makes a forest from matching parts: as many leaves as flags, and after the base faces four faces for every split face.
    /// O(n).
    pub(crate) fn new(base_faces: u32, split: Vec<bool>, leaves: Vec<u32>) -> Self {
        let mut level_start = vec![0];
        let mut level = 0..base_faces as usize;
        while !level.is_empty() {
            level_start.push(level.end as u32);
            let splits = split[level.clone()].iter().filter(|&&split| split).count();
            level = level.end..level.end + 4 * splits;
        }
        Self { base_faces, split, leaves, level_start }
    }

    /// Number of base faces, which are faces `0..base_faces`.
    pub fn base_faces(&self) -> usize {
        self.base_faces as usize
    }

    /// Number of faces of all levels.
    pub fn len(&self) -> usize {
        self.split.len()
    }

    /// Whether there are no faces.
    pub fn is_empty(&self) -> bool {
        self.split.is_empty()
    }

    /// Number of leaves: unsplit faces.
    pub fn triangles(&self) -> usize {
        self.base_faces() + (self.len() - self.base_faces()) / 4 * 3
    }

    /// Per face, whether it has four children.
    pub fn split(&self) -> &[bool] {
        &self.split
    }

    /// Per face `u32::MAX` if it is split, else `3 * t + r`: the face is triangle `t` of the mesh, and corner `r` of `t` is
    /// corner 0 of the face.
    pub fn leaves(&self) -> &[u32] {
        &self.leaves
    }

    /// Depth of the most often split base face; 0 if no face is split.
    pub fn levels(&self) -> usize {
        self.level_start.len().saturating_sub(2)
    }

    /// Faces of a level, 0 for the base faces; empty beyond [`Quadrisection::levels`].
    pub fn level(&self, level: usize) -> Range<usize> {
        match self.level_start.get(level..).and_then(|rest| rest.get(..2)) {
            Some(ends) => ends[0] as usize..ends[1] as usize,
            None => self.len()..self.len(),
        }
    }

    /// Iterates over split faces with their first children, ascending in both. The other three children follow the first.
    pub fn splits(&self) -> impl Iterator<Item = (usize, usize)> {
        let split = self.split.iter().enumerate().filter(|&(_, &split)| split);
        split.enumerate().map(|(rank, (face, _))| (face, self.base_faces() + 4 * rank))
    }

    /// Returns the three corners of every face, in the face's order. `triangles` has a value for each corner of each triangle
    /// of the mesh: a vertex, point or other number. `u32::MAX` where the triangle is missing. O(n).
    pub fn corners(&self, triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
        let of_leaf = |leaf: u32| {
            let turn = leaf % 3;
            let corners = triangles.get((leaf / 3) as usize).copied().unwrap_or([NONE; 3]);
            [0, 1, 2].map(|k| corners[((k + turn) % 3) as usize])
        };
        let mut corners: Vec<[u32; 3]> =
            self.leaves.iter().map(|&leaf| if leaf == NONE { [NONE; 3] } else { of_leaf(leaf) }).collect();
        // Children first: from the last face to the first.
        let mut first_child = self.len();
        for face in (0..self.len()).rev().filter(|&face| self.split[face]) {
            first_child -= 4;
            corners[face] = [0, 1, 2].map(|child| corners[first_child + child][0]);
        }
        corners
    }

    /// Iterates over the faces of the surface cut off at `level`: faces of `level`, and leaves of coarser levels. O(n).
    pub fn faces_at(&self, level: usize) -> impl Iterator<Item = usize> {
        let last = self.level(level);
        (0..last.end).filter(move |&face| face >= last.start || !self.split[face])
    }
}
