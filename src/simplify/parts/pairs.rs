//! Vertex pairs not joined by an edge: points of different parts closer than a distance, so that separate parts may grow
//! together (TOM 4.1).
//!
//! Every point keeps the nearest few points of other parts. A merge searches again around the merged point and hands on
//! the pairs of both points. So pairs appear as parts draw near, follow the points they were found for, and disappear
//! once their parts are joined. Distances are measured to the points' positions in the input.

use crate::mesh::NONE;
use crate::simplify::surface::WorkingSurface;

use super::Parts;

/// Most pairs kept per point; the nearest are kept.
const MOST: usize = 8;

/// The possible partners of each point.
#[derive(Debug, Clone, Default)]
pub(crate) struct Partners {
    /// Inner units.
    distance: f32,
    /// Per point, nearest first; empty if nothing may be joined.
    nearest: Vec<[u32; MOST]>,
    found: Vec<(f32, u32)>,
}

impl Partners {
    /// Finds pairs of points at most `distance` (inner units) apart; no pairs if `distance` is 0. O(n log n) expected,
    /// for any distance.
    pub fn new(surface: &WorkingSurface, parts: Option<&mut Parts>, distance: f32) -> Self {
        let Some(parts) = parts.filter(|_| distance > 0.0) else { return Self::default() };
        let nearest = vec![[NONE; MOST]; surface.point_count()];
        let mut partners = Self { distance, nearest, found: Vec::new() };
        partners.look_all(surface, parts);
        partners
    }

    /// Whether pairs are switched off.
    pub fn is_empty(&self) -> bool {
        self.nearest.is_empty()
    }

    /// Updates the partners of a point: first the points near it now, then its former partners and the partners of a
    /// point `merged` into it.
    pub fn look(&mut self, surface: &WorkingSurface, parts: &mut Parts, point: u32, merged: Option<u32>) {
        let own = parts.of(point);
        // Several of the found points may have been merged since.
        parts.nearest(surface.at(point), own, (2 * MOST, self.distance), &mut self.found);
        let had = [Some(point), merged].into_iter().flatten().flat_map(|p| self.nearest[p as usize]);
        let mut nearest = [NONE; MOST];
        let mut count = 0;
        for other in self.found.iter().map(|found| found.1).chain(had.filter(|&other| other != NONE)) {
            let other = parts.current(other);
            let is_other = surface.valence(other) > 0 && parts.of(other) != own;
            if count < MOST && is_other && !nearest[..count].contains(&other) {
                nearest[count] = other;
                count += 1;
            }
        }
        self.nearest[point as usize] = nearest;
    }

    /// Updates the partners of all points.
    pub fn look_all(&mut self, surface: &WorkingSurface, parts: &mut Parts) {
        for point in (0..surface.point_count() as u32).filter(|&p| surface.valence(p) > 0) {
            self.look(surface, parts, point, None);
        }
    }

    /// Calls `visit` with the current points of a point's partners, as far as they are of other parts.
    #[inline]
    pub fn for_each(
        &self,
        surface: &WorkingSurface,
        parts: Option<&Parts>,
        point: u32,
        mut visit: impl FnMut(u32),
    ) {
        let (Some(nearest), Some(parts)) = (self.nearest.get(point as usize), parts) else { return };
        for &other in nearest.iter().take_while(|&&other| other != NONE) {
            let other = parts.now(other);
            if surface.valence(other) > 0 && parts.of(other) != parts.of(point) {
                visit(other);
            }
        }
    }
}
