//! Does a collapse: records it, merges the points, and tells all who keep count.

use crate::geometry::segment::blend_weight;
use crate::simplify::metric::{ErrorMetric, MetricEvent};
use crate::simplify::permissive::gives;
use crate::simplify::surface::classify::kind;

use super::candidates::Candidate;
use super::driver::{Engine, state};

impl<M: ErrorMetric> Engine<'_, M> {
    /// Notifies the watching rules of a step.
    pub(super) fn tell(&mut self, kept: Option<u32>) {
        for &watcher in &self.watchers {
            self.oracles[watcher].changed(&self.surface, kept, &self.dead);
        }
    }

    /// Does a collapse whose patch is in `self.patch`.
    pub(super) fn commit(&mut self, candidate: Candidate) {
        let Candidate { pair, x, object } = candidate;
        let share = blend_weight(self.surface.at(pair.lost), self.surface.at(pair.kept), x);
        let mark = self.recorder.mark();
        if self.may_give_up() {
            let topology = if self.breaks_topology { gives::TOPOLOGY } else { 0 };
            self.given.push(self.surface.gives_up(pair, object.is_none()) | topology);
        }
        let error = self.errors.hand_over(&self.surface, &self.patch, pair, x);
        let takes_turns = self.errors.is_heavy(&self.surface);
        self.watch.reached(error.surface);
        self.recorder.substitute(&self.surface, pair, object.map(|object| (object, share)));
        let substitutions = self.recorder.last();
        let event = MetricEvent::Collapsing { pair, position: x.into(), substitutions };
        self.metric.update(&self.surface, event);
        for new in substitutions.new_vertices {
            self.surface.add_vertex(new.from, new.weight);
        }
        let shifts_features =
            self.surface.kind(pair.lost) & !self.surface.kind(pair.kept) & kind::FEATURE != 0;
        self.surface.collapse(pair.lost, pair.kept, x, &mut self.dead);
        let recorder = &self.recorder;
        self.surface.replace_vertices(pair.kept, recorder.kept_stay(), |v| recorder.image(v, mark));
        let is_broken = self.breaks_topology || self.patch.opposite().is_empty();
        if shifts_features || is_broken {
            self.surface.reclassify_around(pair.kept, pair.lost, &self.patch, is_broken);
        }
        self.metric.update(&self.surface, MetricEvent::Collapsed { pair });
        self.tell(Some(pair.kept));
        let error = [error.surface, error.curve].map(|error| self.surface.frame().object_length(error));
        self.recorder.finish_step(error, &self.dead, self.surface.live_triangles());
        // Ranks matter from the first tile on; without tiles they ascend by themselves.
        self.tiled |= self.queue.is_tiled();
        let rank = if self.tiled {
            let needed = self.touched[pair.lost as usize].max(self.touched[pair.kept as usize]);
            (self.first_rank + self.queue.rank()).max(needed).max(self.vanishing.floor)
        } else {
            self.first_rank + self.queue.rank()
        };
        self.ranks.push(rank);
        self.state[pair.lost as usize] = state::GONE;
        self.queue.remove(pair.lost);
        if let Some(parts) = &mut self.parts {
            parts.merge(pair.lost, pair.kept, self.dead.len());
            if !self.partners.is_empty() && self.surface.valence(pair.kept) > 0 {
                self.partners.look(&self.surface, parts, pair.kept, Some(pair.lost));
            }
        }
        self.update_around(pair, rank);
        if takes_turns {
            self.put_behind(pair.kept);
        }
    }
}
