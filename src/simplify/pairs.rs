//! Vertex pairs that no edge joins: points of different parts closer than a distance, so that separate parts may grow
//! together (TOM 4.1).
//!
//! Every point keeps the nearest few points of other parts. A merge looks anew for what lies near the merged point, and hands
//! on the pairs of both, so pairs come up as parts draw near, go with the points that they were found for, and none is left of
//! parts that have become one. Where points lay in the input decides what is near.

use crate::mesh::NONE;

use super::parts::Parts;
use super::surface::WorkingSurface;

/// Pairs kept per point, the nearest.
const MOST: usize = 8;

/// The points that each point may be joined with.
#[derive(Debug, Clone, Default)]
pub(super) struct Partners {
    /// Inner units.
    distance: f32,
    /// Per point, nearest first; empty where nothing may be joined.
    nearest: Vec<[u32; MOST]>,
    found: Vec<(f32, u32)>,
}

impl Partners {
    /// Of points at most `distance` (inner units) apart; none where it is 0. O(n log n) expected, whatever the distance.
    pub fn new(surface: &WorkingSurface, parts: Option<&mut Parts>, distance: f32) -> Self {
        let Some(parts) = parts.filter(|_| distance > 0.0) else { return Self::default() };
        let nearest = vec![[NONE; MOST]; surface.point_count()];
        let mut partners = Self { distance, nearest, found: Vec::new() };
        partners.look_all(surface, parts);
        partners
    }

    /// Whether no point has a partner.
    pub fn is_empty(&self) -> bool {
        self.nearest.is_empty()
    }

    /// Looks for the partners of a point anew: what lies near it now, and then those that it had, and those of a point that
    /// was merged into it.
    pub fn look(&mut self, surface: &WorkingSurface, parts: &mut Parts, point: u32, merged: Option<u32>) {
        let own = parts.of(point);
        // Several may have become one point since.
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

    /// Looks for the partners of all points anew.
    pub fn look_all(&mut self, surface: &WorkingSurface, parts: &mut Parts) {
        for point in (0..surface.point_count() as u32).filter(|&p| surface.valence(p) > 0) {
            self.look(surface, parts, point, None);
        }
    }

    /// Calls `visit` with what the partners of a point have become, where these are of other parts.
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
