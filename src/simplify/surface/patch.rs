//! The triangles changed by a collapse, gathered once and shared by oracles and error measurement.
//!
//! ```text
//!          w2                         w2
//!        /  | \                     /  \            facets:  the triangles that survive, as they would become
//!      w3 - u - v          ->     w3 --- v          thirds:  w1 and w2, the third corners of those that die
//!        \  | /                     \  /
//!          w1                         w1
//! ```

use glam::Vec3;

use crate::simplify::metric::Pair;
use crate::simplify::surface::{Corner, WorkingSurface};

/// A surviving triangle of a patch. Its first corner is the merged point; corners are relative to the merged point's new
/// position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Facet {
    /// The triangle's number.
    pub triangle: u32,
    /// The two corners other than the merged point.
    pub others: [u32; 2],
    pub(crate) a: Vec3,
    pub(crate) b: Vec3,
    /// Normals before and after the collapse, as long as twice the area.
    pub(crate) before: Vec3,
    pub(crate) after: Vec3,
    /// Old position minus new position.
    pub(crate) back: Vec3,
}

impl Facet {
    /// Makes the facet of an unchanged triangle, seen from a point at `x`.
    pub(crate) fn around(surface: &WorkingSurface, corner: Corner, x: Vec3) -> Self {
        let [a, b] = corner.others.map(|p| surface.at(p) - x);
        let normal = a.cross(b);
        let Corner { triangle, others, .. } = corner;
        Self { triangle, others, a, b, before: normal, after: normal, back: Vec3::ZERO }
    }

    /// Makes the facet of a triangle whose first corner moves to `x`; its old position is `back` relative to `x`.
    #[inline]
    fn moved(surface: &WorkingSurface, corner: Corner, x: Vec3, back: Vec3) -> Self {
        let Corner { triangle, others, .. } = corner;
        let [a, b] = others.map(|p| surface.at(p) - x);
        Self { triangle, others, a, b, before: (a - back).cross(b - back), after: a.cross(b), back }
    }

    /// Normals before and after the collapse, as long as twice the area.
    pub fn normals(&self) -> [[f32; 3]; 2] {
        [self.before.into(), self.after.into()]
    }

    /// `4 sqrt(3) area / (sum of squared sides)` after the collapse: 1 for an equilateral triangle, 0 without area.
    #[inline]
    pub fn quality_after(&self) -> f32 {
        quality(self.after, self.a, self.b)
    }

    /// `4 sqrt(3) area / (sum of squared sides)` before the collapse: 1 for an equilateral triangle, 0 without area.
    #[inline]
    pub fn quality_before(&self) -> f32 {
        quality(self.before, self.a - self.back, self.b - self.back)
    }
}

/// `4 sqrt(3) area / (sum of squared sides)` of a triangle with corners 0, `a` and `b`; `cross = a x b`.
#[inline]
pub(crate) fn quality(cross: Vec3, a: Vec3, b: Vec3) -> f32 {
    let sides = a.length_squared() + b.length_squared() + (b - a).length_squared();
    if sides > 0.0 { 2.0 * 3f32.sqrt() * cross.length() / sides } else { 0.0 }
}

/// The patch of a candidate.
#[derive(Debug, Clone, Default)]
pub struct Patch {
    facets: Vec<Facet>,
    /// Number of facets from the lost point's star; the other facets belong to the kept point.
    of_lost: usize,
    opposite: Vec<u32>,
    /// The thirds in ascending order if there are many, otherwise empty.
    sorted_opposite: Vec<u32>,
}

/// Up to this many thirds are searched one by one.
const FEW_OPPOSITE: usize = 8;

impl Patch {
    /// Gathers the patch of merging `pair` at `x`. Includes the kept point's triangles only if it moves.
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

    /// Gathers at most `most` facets, spread over the lost point's star, to test whether any of them is refused.
    pub(crate) fn sample(&mut self, surface: &WorkingSurface, pair: Pair, x: Vec3, most: usize) {
        self.facets.clear();
        self.opposite.clear();
        self.sorted_opposite.clear();
        let back = surface.at(pair.lost) - x;
        let stride = surface.valence(pair.lost).div_ceil(most).max(1);
        for corner in surface.star_thinned(pair.lost, stride) {
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

    /// The surviving triangles around the lost point.
    #[inline]
    pub fn facets_of_lost(&self) -> &[Facet] {
        &self.facets[..self.of_lost]
    }

    /// The third corners of the removed triangles: one per triangle on the edge, none without an edge.
    #[inline]
    pub fn opposite(&self) -> &[u32] {
        &self.opposite
    }

    /// Whether a point is in [`Patch::opposite`]. O(log opposite vertices).
    #[inline]
    pub(crate) fn has_third(&self, point: u32) -> bool {
        match self.opposite[..] {
            [a, b] => (a == point) | (b == point),
            _ if self.sorted_opposite.is_empty() => self.opposite.contains(&point),
            _ => self.sorted_opposite.binary_search(&point).is_ok(),
        }
    }

    /// Whether all thirds are distinct. O(opposite vertices).
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
