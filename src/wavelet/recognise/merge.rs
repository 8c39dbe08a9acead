//! Merges: the ways in which faces are taken for one face of the next coarser level.
//!
//! ```text
//!        c2                    c2                   c2                   c2                   c2
//!       /  \                  /|\                  /|\                  /|\                  /|\
//!     m2----m1               / | \                / | m1             m2 | \               m2 | m1
//!     / \  / \              /  |  \              /  |/ \              / \|  \             / \|/ \
//!   c0---m0---c1          c0---m0--c1          c0---m0--c1          c0---m0--c1          c0---m0--c1
//!
//!       split                 one                  left                 right               three
//! ```
//!
//! A split face becomes four. An unsplit face beside deeper faces is drawn cut from the first midpoint on its sides to the
//! opposite corner, then each part the same way (`instance/surface.rs`): `one`, `left`, `right` and `three`, where `m0` lies on
//! the first side cut. So all but `one` tell which corner of the face is its corner 0.
//!
//! Each merge is described by the fan around `m0` inside the face: half-edges into `m0`, from `c0` on.

use crate::mesh::NONE;

use super::complex::Complex;

/// Corners that may be corner 0 of a face with two midpoints, the first on the side before the other: sides 0 and 1, or 1 and 2.
const LEFT_TURNS: u8 = 0b101;
/// Two midpoints, on sides 0 and 2.
const RIGHT_TURNS: u8 = 0b001;
const ALL_TURNS: u8 = 0b111;

/// Faces taken for one. Corners are named by a corner of a face: `3 * face + corner`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Merge {
    pub is_split: bool,
    /// Split: children 0 to 3, each as `3 * face + turn`. Otherwise the pieces, then `NONE`.
    pub faces: [u32; 4],
    pub corners: [u32; 3],
    /// The midpoint of each side, or `NONE`.
    pub midpoints: [u32; 3],
    /// Per side the edges of its halves; without a midpoint the edge and `NONE`.
    pub sides: [[u32; 2]; 3],
    /// Half-edges along the edges inside, then `NONE`.
    pub inner: [u32; 3],
    /// Bit `k`: corner `k` may be corner 0 of the face.
    pub turns: u8,
}

/// Returns the half-edge `k` places further around the face.
pub(super) fn turned(half_edge: u32, k: u32) -> u32 {
    half_edge - half_edge % 3 + (half_edge % 3 + k) % 3
}

/// Makes merges of the faces of a complex, by half-edges `h` into `m0` in the order of the fan. Faces need not fit together.
impl Merge {
    fn edge(complex: &Complex, half_edge: u32) -> u32 {
        complex.edges.as_flattened()[half_edge as usize]
    }

    /// Returns the halves of the side with `m0`: from the first half-edge to the last.
    fn first_side(complex: &Complex, first: u32, last: u32) -> [u32; 2] {
        [Self::edge(complex, first), Self::edge(complex, turned(last, 1))]
    }

    pub fn one(complex: &Complex, [a, b]: [u32; 2]) -> Self {
        let edge = |half_edge| Self::edge(complex, half_edge);
        Self {
            is_split: false,
            faces: [a / 3 * 3, b / 3 * 3, NONE, NONE],
            corners: [a, turned(b, 2), b],
            midpoints: [turned(a, 1), NONE, NONE],
            sides: [Self::first_side(complex, a, b), [edge(turned(b, 2)), NONE], [edge(turned(a, 2)), NONE]],
            inner: [turned(a, 1), NONE, NONE],
            turns: ALL_TURNS,
        }
    }

    pub fn left(complex: &Complex, [a, b, c]: [u32; 3]) -> Self {
        let edge = |half_edge| Self::edge(complex, half_edge);
        Self {
            is_split: false,
            faces: [a / 3 * 3, b / 3 * 3, c / 3 * 3, NONE],
            corners: [a, turned(c, 2), b],
            midpoints: [turned(a, 1), c, NONE],
            sides: [
                Self::first_side(complex, a, c),
                [edge(turned(c, 2)), edge(turned(b, 2))],
                [edge(turned(a, 2)), NONE],
            ],
            inner: [turned(a, 1), turned(b, 1), NONE],
            turns: LEFT_TURNS,
        }
    }

    pub fn right(complex: &Complex, [a, b, c]: [u32; 3]) -> Self {
        let edge = |half_edge| Self::edge(complex, half_edge);
        Self {
            is_split: false,
            faces: [a / 3 * 3, b / 3 * 3, c / 3 * 3, NONE],
            corners: [a, turned(c, 2), c],
            midpoints: [turned(a, 1), NONE, b],
            sides: [
                Self::first_side(complex, a, c),
                [edge(turned(c, 2)), NONE],
                [edge(turned(b, 2)), edge(turned(a, 2))],
            ],
            inner: [turned(a, 1), turned(b, 1), NONE],
            turns: RIGHT_TURNS,
        }
    }

    pub fn three(complex: &Complex, [a, b, c, d]: [u32; 4]) -> Self {
        let edge = |half_edge| Self::edge(complex, half_edge);
        Self {
            is_split: false,
            faces: [a, b, c, d].map(|half_edge| half_edge / 3 * 3),
            corners: [a, turned(d, 2), c],
            midpoints: [turned(a, 1), d, b],
            sides: [
                Self::first_side(complex, a, d),
                [edge(turned(d, 2)), edge(turned(c, 2))],
                [edge(turned(b, 2)), edge(turned(a, 2))],
            ],
            inner: [turned(a, 1), turned(b, 1), turned(c, 1)],
            turns: RIGHT_TURNS,
        }
    }

    /// `outer`: the half-edge from `m2` to `m1` in the child at `c2`.
    pub fn split(complex: &Complex, [a, b, c]: [u32; 3], outer: u32) -> Self {
        let edge = |half_edge| Self::edge(complex, half_edge);
        let centre = turned(b, 1);
        let may_start = |k: u32| u8::from(complex.may_start(turned(centre, k))) << k;
        Self {
            is_split: true,
            faces: [a, turned(c, 2), turned(outer, 2), centre],
            corners: [a, turned(c, 2), turned(outer, 2)],
            midpoints: [turned(a, 1), c, b],
            sides: [
                Self::first_side(complex, a, c),
                [edge(turned(c, 2)), edge(turned(outer, 1))],
                [edge(turned(outer, 2)), edge(turned(a, 2))],
            ],
            inner: [turned(a, 1), turned(b, 1), outer],
            turns: may_start(0) | may_start(1) | may_start(2),
        }
    }

    /// Iterates over the faces merged.
    pub fn each_face(&self) -> impl Iterator<Item = u32> + use<> {
        self.faces.into_iter().filter(|&face| face != NONE).map(|face| face / 3)
    }
}
