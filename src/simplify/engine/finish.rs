//! End of a simplification: counts refusals among the remaining candidates; builds the sequence with its report.

use crate::mesh::Mesh;
use crate::sequence::{CollapseSequence, Refusal, SimplifyReport, StopReason};
use crate::simplify::metric::ErrorMetric;

use super::attempt::Legal;
use super::candidates::Candidate;
use super::driver::{Engine, state};
use super::reorder;

impl<M: ErrorMetric> Engine<'_, M> {
    /// Counts, per oracle, the candidates of the final mesh first refused by it; and the candidates which would leave
    /// nothing of a part.
    fn standing_refusals(&mut self) -> (Vec<u64>, u64) {
        let whole = self.vanishing.whole;
        let asked = std::mem::replace(&mut self.refusals, vec![0; self.oracles.len()]);
        let mut others = Vec::new();
        for point in 0..self.state.len() as u32 {
            self.state[point as usize] &= state::GONE;
            if self.state[point as usize] == 0 {
                others.clear();
                self.for_candidates(point, |option| others.push(option.other));
                others.sort_unstable();
                others.dedup();
                for &other in &others {
                    if let Some(Legal { candidate: Candidate { pair, x, .. }, .. }) = self.legal(point, other)
                    {
                        let guard = self.guard_limit();
                        if self.may_exceed(guard, pair, x)
                            && self.errors.measure(&self.surface, &self.patch, pair, x).surface > guard
                        {
                            self.watch.standing += 1;
                        }
                    }
                }
            }
        }
        let mut standing = std::mem::replace(&mut self.refusals, asked);
        // A rule with a surcharge only defers candidates: it refuses none for good.
        for (oracle, count) in self.oracles.iter().zip(&mut standing) {
            *count = if oracle.surcharge().is_some() { 0 } else { *count };
        }
        (standing, std::mem::replace(&mut self.vanishing.whole, whole) - whole)
    }

    /// Returns the sequence, in order and cut at its targets.
    pub(super) fn finish(mut self, mesh: &Mesh, stop: StopReason) -> CollapseSequence {
        let (standing, whole) =
            if matches!(stop, StopReason::NothingLegal | StopReason::Error | StopReason::Guard) {
                self.standing_refusals()
            } else {
                (vec![0; self.oracles.len()], 0)
            };
        let counts = self.oracles.iter().zip(self.refusals.iter().zip(&standing));
        let mut refusals: Vec<Refusal> = counts
            .map(|(oracle, (&count, &standing))| Refusal {
                oracle: oracle.name().to_owned(),
                count,
                standing,
            })
            .collect();
        let count = self.vanishing.rags + self.vanishing.whole;
        if count > 0 {
            // Parts about to become rags can vanish as a whole: count none of them as standing.
            refusals.push(Refusal { oracle: "parts".to_owned(), count, standing: whole });
        }
        if self.limits.error.is_finite() {
            refusals.push(Refusal { oracle: "error".to_owned(), count: self.too_far, standing: 0 });
        }
        if self.watch.refused > 0 {
            let (count, standing) = (self.watch.refused, self.watch.standing);
            refusals.push(Refusal { oracle: "guard".to_owned(), count, standing });
        }
        let report = SimplifyReport { refusals, ..SimplifyReport::new(stop) };
        let (mut sequence, mut parts) = self.recorder.finish(report);
        if !sequence.new_vertices.is_empty() {
            sequence.solved = self.metric.properties().attributes.unwrap_or_default().to_vec();
        }
        if self.tiled {
            let order = reorder::sort_by_rank(&mut sequence, &self.ranks, &mut parts);
            reorder::cut(&mut sequence, &self.limits, self.input_vertices);
            // Nothing is noted before the first step giving something up.
            let given = order[..sequence.len()].iter().filter_map(|&step| self.given.get(step as usize));
            given.for_each(|&given| sequence.report.given_up.add(given));
        } else {
            self.given.iter().for_each(|&given| sequence.report.given_up.add(given));
        }
        sequence.tell_apart(&parts);
        sequence.fill_report(mesh);
        if let Some(parts) = &self.parts {
            sequence.report.parts_removed = parts.removed(&sequence.triangle_end, sequence.len());
        }
        sequence
    }
}
