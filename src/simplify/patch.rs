//! The triangles that a collapse would change, gathered once and shared by oracles and error measurement.
//!
//! ```text
//!          w2                         w2
//!        /  | \                     /  \            facets:  the triangles that survive, as they would become
//!      w3 - u - v          ->     w3 --- v          thirds:  w1 and w2, the third corners of those that die
//!        \  | /                     \  /
//!          w1                         w1
//! ```

use glam::Vec3;

use super::metric::Pair;
use super::surface::{Corner, WorkingSurface};

/// A surviving triangle of a patch. Corners are relative to the merged point's new position, which is its first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Facet {
    /// The triangle's number.
    pub triangle: u32,
    /// Its two other corners.
    pub others: [u32; 2],
    pub(crate) a: Vec3,
    pub(crate) b: Vec3,
    /// Normal of twice the area's length, before and after.
    pub(crate) before: Vec3,
    pub(crate) after: Vec3,
    /// From the new position to the old one.
    pub(crate) back: Vec3,
}

impl Facet {
    /// A triangle as it is, seen from a point at `x`.
    pub(crate) fn around(surface: &WorkingSurface, corner: Corner, x: Vec3) -> Self {
        let [a, b] = corner.others.map(|p| surface.at(p) - x);
        let normal = a.cross(b);
        let Corner { triangle, others, .. } = corner;
        Self { triangle, others, a, b, before: normal, after: normal, back: Vec3::ZERO }
    }

    /// A triangle whose first corner moves to `x`, from `back` relative to it.
    #[inline]
    fn moved(surface: &WorkingSurface, corner: Corner, x: Vec3, back: Vec3) -> Self {
        let Corner { triangle, others, .. } = corner;
        let [a, b] = others.map(|p| surface.at(p) - x);
        Self { triangle, others, a, b, before: (a - back).cross(b - back), after: a.cross(b), back }
    }

    /// Normals of twice the area's length, before and after the collapse.
    pub fn normals(&self) -> [[f32; 3]; 2] {
        [self.before.into(), self.after.into()]
    }

    /// `4 sqrt(3) area / (sum of squared sides)` after the collapse: 1 for an equilateral triangle, 0 without area.
    #[inline]
    pub fn quality_after(&self) -> f32 {
        quality(self.after, self.a, self.b)
    }

    /// The same before the collapse.
    #[inline]
    pub fn quality_before(&self) -> f32 {
        quality(self.before, self.a - self.back, self.b - self.back)
    }
}

/// Of a triangle with one corner at the origin.
#[inline]
pub(super) fn quality(cross: Vec3, a: Vec3, b: Vec3) -> f32 {
    let sides = a.length_squared() + b.length_squared() + (b - a).length_squared();
    if sides > 0.0 { 2.0 * 3f32.sqrt() * cross.length() / sides } else { 0.0 }
}

/// The patch of one candidate.
#[derive(Debug, Clone, Default)]
pub struct Patch {
    facets: Vec<Facet>,
    /// How many of the facets come from the lost point's star; the others are the kept point's.
    of_lost: usize,
    opposite: Vec<u32>,
    /// The thirds in order where they are many, else empty.
    sorted_opposite: Vec<u32>,
}

/// Up to so many thirds are searched one by one.
const FEW_OPPOSITE: usize = 8;

impl Patch {
    /// Gathers the patch of merging `pair` at `x`. The kept point's triangles are part of it only where it moves.
    pub(crate) fn gather(&mut self, surface: &WorkingSurface, pair: Pair, x: Vec3) {
        self.facets.clear();
        self.opposite.clear();
        self.add_star(surface, pair.lost, pair.kept, x, true);
        self.of_lost = self.facets.len();
        if surface.at(pair.kept) != x {
            self.add_star(surface, pair.kept, pair.lost, x, false);
        }
        self.sorted_opposite.clear();
        if self.opposite.len() > FEW_OPPOSITE {
            self.sorted_opposite.extend_from_slice(&self.opposite);
            self.sorted_opposite.sort_unstable();
        }
    }

    /// Gathers at most so many facets of the lost point's star, spread over it, to ask whether any of them is refused.
    pub(crate) fn sample(&mut self, surface: &WorkingSurface, pair: Pair, x: Vec3, most: usize) {
        self.facets.clear();
        self.opposite.clear();
        self.sorted_opposite.clear();
        let back = surface.at(pair.lost) - x;
        let stride = surface.valence(pair.lost).div_ceil(most).max(1);
        for corner in surface.star(pair.lost).step_by(stride) {
            if !corner.others.contains(&pair.kept) {
                self.facets.push(Facet::moved(surface, corner, x, back));
            }
        }
        self.of_lost = self.facets.len();
    }

    #[inline]
    fn add_star(&mut self, surface: &WorkingSurface, point: u32, other: u32, x: Vec3, opposite: bool) {
        let back = surface.at(point) - x;
        for corner in surface.star(point) {
            let [p, q] = corner.others;
            if p == other || q == other {
                if opposite {
                    self.opposite.push(if p == other { q } else { p });
                }
                continue;
            }
            self.facets.push(Facet::moved(surface, corner, x, back));
        }
    }

    /// All surviving triangles that change.
    #[inline]
    pub fn facets(&self) -> &[Facet] {
        &self.facets
    }

    /// Those around the lost point.
    #[inline]
    pub fn facets_of_lost(&self) -> &[Facet] {
        &self.facets[..self.of_lost]
    }

    /// The third corners of the triangles that die: one per triangle on the edge, none where there is no edge.
    #[inline]
    pub fn opposite(&self) -> &[u32] {
        &self.opposite
    }

    /// Whether a point is one of [`Patch::opposite`]. O(log opposite vertices).
    #[inline]
    pub(crate) fn has_third(&self, point: u32) -> bool {
        match self.opposite[..] {
            [a, b] => (a == point) | (b == point),
            _ if self.sorted_opposite.is_empty() => self.opposite.contains(&point),
            _ => self.sorted_opposite.binary_search(&point).is_ok(),
        }
    }

    /// Whether no point is a third twice. O(opposite vertices).
    #[inline]
    pub(crate) fn thirds_differ(&self) -> bool {
        match self.opposite[..] {
            [] | [_] => true,
            [a, b] => a != b,
            _ if self.sorted_opposite.is_empty() => {
                self.opposite.iter().enumerate().all(|(i, third)| !self.opposite[..i].contains(third))
            }
            _ => self.sorted_opposite.windows(2).all(|pair| pair[0] != pair[1]),
        }
    }
}
