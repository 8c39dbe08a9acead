//! How a simplification ends: what the rules refuse of what is left, and the sequence with its report.

use crate::mesh::Mesh;

use super::super::metric::ErrorMetric;
use super::super::reorder;
use super::super::report::{Refusal, SimplifyReport, StopReason};
use super::super::sequence::CollapseSequence;
use super::{Engine, state};

impl<M: ErrorMetric> Engine<'_, M> {
    /// Per oracle the candidates of the final mesh that it is the first to refuse.
    fn standing_refusals(&mut self) -> Vec<u64> {
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
                    self.legal(point, other);
                }
            }
        }
        std::mem::replace(&mut self.refusals, asked)
    }

    /// The sequence, in order and cut at its targets.
    pub(super) fn finish(mut self, mesh: &Mesh, stop: StopReason) -> CollapseSequence {
        let standing = if matches!(stop, StopReason::NothingLegal | StopReason::Error) {
            self.standing_refusals()
        } else {
            vec![0; self.oracles.len()]
        };
        let counts = self.oracles.iter().zip(self.refusals.iter().zip(&standing));
        let mut refusals: Vec<Refusal> = counts
            .map(|(oracle, (&count, &standing))| Refusal {
                oracle: oracle.name().to_owned(),
                count,
                standing,
            })
            .collect();
        if self.limits.error.is_finite() {
            refusals.push(Refusal { oracle: "error".to_owned(), count: self.too_far, standing: 0 });
        }
        let report = SimplifyReport { refusals, ..SimplifyReport::new(stop) };
        let (mut sequence, mut parts) = self.recorder.finish(report);
        if !sequence.new_vertices.is_empty() {
            sequence.solved = self.metric.attribute_names().to_vec();
        }
        if self.tiled {
            reorder::sort_by_rank(&mut sequence, &self.ranks, &mut parts);
            reorder::cut(&mut sequence, &self.limits, self.input_vertices);
        }
        sequence.tell_apart(&parts);
        sequence.fill_report(mesh);
        sequence
    }
}
