//! Features held at first which give where a target would be missed: seams, then borders between materials, then the
//! topology.
//!
//! A kind gives when nothing else is left, or from a given number of triangles on. If it should have begun earlier, the
//! simplification starts over with its number of triangles ([`Schedule`]).

use crate::simplify::metric::ErrorMetric;
use crate::simplify::permissive::{Giving, Permissive, Schedule};
use crate::simplify::surface::classify::kind;

use super::Engine;

impl<M: ErrorMetric> Engine<'_, M> {
    /// Returns the next kind allowed to give, and the number of triangles at which it gives by itself.
    pub(super) fn next_to_give(&self) -> Option<(Giving, usize)> {
        let may = match self.permissive {
            Permissive::Off => false,
            Permissive::Auto => self.limits.is_sized() && self.too_far == 0,
            Permissive::On => true,
        };
        let Schedule { seams, materials, topology } = self.schedule;
        let stands_in_the_way = || {
            let mut rules = self.oracles.iter().zip(&self.refusals);
            topology > 0 || rules.any(|(oracle, &count)| oracle.keeps_topology() && count > 0)
        };
        if !may {
            None
        } else if self.surface.has_seams() && self.surface.holds(kind::SEAM) {
            Some((Giving::Seams, seams))
        } else if self.surface.has_materials() && self.surface.holds(kind::MATERIAL) {
            Some((Giving::Materials, materials))
        } else if self.keeps_topology && self.limits.is_sized() && stands_in_the_way() {
            Some((Giving::Topology, topology))
        } else {
            None
        }
    }

    /// Whether the next kind gives now, even with other candidates left.
    #[inline]
    pub(super) fn gives_now(&self) -> bool {
        self.gives_at > 0 && self.surface.live_triangles() <= self.gives_at
    }

    /// Returns the schedule to start over with, if nothing legal is left and the next kind was to hold until now.
    pub(super) fn should_start_over(&self) -> Option<Schedule> {
        let (giving, at) = self.next_to_give()?;
        let early = self.permissive == Permissive::Auto && at == 0;
        early.then(|| self.schedule.with(giving, self.surface.live_triangles()))
    }

    /// Lets the next kind give. Returns whether there was a kind allowed to give.
    pub(super) fn give(&mut self) -> bool {
        let next = self.next_to_give();
        if let Some((giving, _)) = next {
            self.release(giving);
            self.gives_at = self.next_to_give().map_or(0, |(_, at)| at);
        }
        next.is_some()
    }

    pub(super) fn release(&mut self, giving: Giving) {
        match giving {
            Giving::Seams => self.surface.release(kind::SEAM),
            Giving::Materials => self.surface.release(kind::MATERIAL),
            Giving::Topology => self.keeps_topology = false,
        }
        self.vanishing.is_last = false;
        self.given.resize(self.recorder.steps(), 0);
        // Later steps stay behind earlier steps, though costs start again.
        self.first_rank = self.ranks.iter().max().map_or(0, |&last| last + 1);
    }

    /// Whether a feature held at first gives now.
    pub(super) fn may_give_up(&self) -> bool {
        !(self.surface.holds(kind::SEAM) && self.surface.holds(kind::MATERIAL) && self.keeps_topology)
    }
}
