//! Checks all invariants of a collapse sequence. Files are let in through here only.
//!
//! ```text
//!     vertex   7: 3->7  7->2               its last mention may take it away, and none but the last
//!     new      9: 4->9  5->9  9->1         its first mention makes it
//!              \ mentions in order of time
//! ```
//!
//! Mentions are sorted by vertex and time, not looked up by vertex. Memory is then proportional to the entries of the
//! sequence, not to the number of vertices it claims.

use crate::mesh::{MAX_ELEMENTS, NONE};

use super::{CollapseSequence, NewVertex, SequenceError};

impl CollapseSequence {
    /// Checks the invariants used by every other call: tables fit together, vertices are named only while present,
    /// error bounds are finite and accumulate, and triangle counts match the vanished triangles. O(n log n), n all
    /// entries.
    ///
    /// Succeeds for every sequence made by a [`Simplifier`](crate::simplify::Simplifier) or
    /// [`CollapseSequence::from_collapses`]. Files are let in through it only. Not checked, since it takes the mesh:
    /// triangles vanish at the steps given.
    ///
    /// # Errors
    /// An element violating an invariant.
    pub fn validate(&self) -> Result<(), SequenceError> {
        self.check_tables()?;
        self.check_mentions()?;
        self.check_triangles()?;
        let steps = self.len();
        expect("batched steps", self.batch_end.last().map_or(0, |&end| end as usize), steps)?;
        expect("reported steps", self.report.steps, steps)?;
        expect("reported triangles", self.report.triangles, self.triangles_after(steps))?;
        expect_most("reported vertices", self.report.vertices, self.vertex_count())?;
        if !self.report.normals.is_valid() {
            return Err(SequenceError::BadCreases);
        }
        let reported = [
            (self.report.error, self.error_after(steps)),
            (self.report.surface_error, self.surface_error_after(steps)),
            (self.report.curve_error, self.curve_error_after(steps)),
        ];
        match reported.into_iter().find(|(found, expected)| found != expected) {
            Some((error, _)) => Err(SequenceError::BadError { step: steps, error }),
            None => Ok(()),
        }
    }

    /// Checks the requirements of indexing: lengths, and the order of starts, errors and batches.
    pub(super) fn check_tables(&self) -> Result<(), SequenceError> {
        let steps = self.step_error.len();
        expect_most("input vertices", self.input_vertices as usize, MAX_ELEMENTS)?;
        expect_most("input triangles", self.triangle_end.len(), MAX_ELEMENTS)?;
        expect_most("steps", steps, MAX_ELEMENTS)?;
        expect_most("vertices", self.vertex_count(), 2 * MAX_ELEMENTS)?;
        expect("step starts", self.step_start.len(), steps + 1)?;
        expect("accumulated errors", self.max_error.len(), steps)?;
        expect("first step start", self.step_start[0] as usize, 0)?;
        expect("last step start", self.step_start[steps] as usize, self.substitutions.len())?;
        if let Some(step) = self.step_start.windows(2).position(|w| w[0] > w[1]) {
            return Err(SequenceError::StepOrder { step });
        }
        let mut largest: f32 = 0.0;
        for (step, (&error, &bound)) in self.step_error.iter().zip(&self.max_error).enumerate() {
            if !(error >= 0.0 && error.is_finite()) {
                return Err(SequenceError::BadError { step, error });
            }
            largest = largest.max(error);
            if bound != largest {
                return Err(SequenceError::BadError { step, error: bound });
            }
        }
        let told_apart = self.surface_error.len().max(self.curve_error.len());
        if told_apart > 0 {
            expect("surface errors", self.surface_error.len(), steps)?;
            expect("curve errors", self.curve_error.len(), steps)?;
            let (mut before, errors) = ([0.0; 2], self.surface_error.iter().zip(&self.curve_error));
            for (step, (now, &largest)) in errors.map(|(&s, &c)| [s, c]).zip(&self.max_error).enumerate() {
                // Also refuses NaN.
                if !(now[0] >= before[0] && now[1] >= before[1] && now[0].max(now[1]) == largest) {
                    let wrong = usize::from(now[0] >= before[0] && now[0] <= largest);
                    return Err(SequenceError::BadError { step, error: now[wrong] });
                }
                before = now;
            }
        }
        check_new_vertices(self.input_vertices as usize, &self.new_vertices)?;
        self.check_snaps()?;
        let mut earlier = 0;
        for (batch, &end) in self.batch_end.iter().enumerate() {
            if end < earlier || end as usize > steps {
                return Err(SequenceError::BatchOrder { batch });
            }
            earlier = end;
        }
        Ok(())
    }

    /// Checks snapped vertices: input vertices, ascending, with targets not snapped themselves.
    fn check_snaps(&self) -> Result<(), SequenceError> {
        let vertices = self.input_vertices as usize;
        let mut before = None;
        for &[vertex, to] in &self.snaps {
            if let Some(&vertex) = [vertex, to].iter().find(|&&v| v as usize >= vertices) {
                return Err(SequenceError::VertexOutOfRange { step: 0, vertex, vertices });
            }
            let moves = self.snaps.binary_search_by_key(&to, |snap| snap[0]).is_ok();
            if moves || before.is_some_and(|before| before >= vertex) {
                return Err(SequenceError::Snap { vertex });
            }
            before = Some(vertex);
        }
        Ok(())
    }

    /// Checks each mention of a vertex: the vertex must be present at the time. See the top of this file.
    fn check_mentions(&self) -> Result<(), SequenceError> {
        let inputs = self.input_vertices as usize;
        let vertices = self.vertex_count();
        let aliases = self.aliases.len();
        // Each entry takes a vertex away, so an index into both lists fits 31 bits. The last bit of 32 tells the kind
        // of mention.
        expect_most("vertices taken away", aliases + self.substitutions.len(), vertices)?;
        let step_of = |place: usize| match place.checked_sub(aliases) {
            Some(at) => self.step_start.partition_point(|&start| start as usize <= at) - 1,
            None => 0,
        };

        let mut mentions = Vec::with_capacity(2 * (aliases + self.substitutions.len()));
        for (place, &[from, to]) in self.aliases.iter().chain(&self.substitutions).enumerate() {
            let vertices = if place < aliases { inputs } else { vertices };
            for (vertex, leaves) in [(from, 1), (to, 0)] {
                if vertex as usize >= vertices {
                    return Err(SequenceError::VertexOutOfRange { step: step_of(place), vertex, vertices });
                }
                mentions.push(u64::from(vertex) << 32 | (place as u64) << 1 | leaves);
            }
            if from == to {
                return Err(SequenceError::SelfSubstitution { step: step_of(place), vertex: from });
            }
        }
        mentions.sort_unstable();

        let mut before: Option<(u32, bool)> = None;
        for mention in mentions {
            let (vertex, place) = ((mention >> 32) as u32, (mention as u32 >> 1) as usize);
            let leaves = mention & 1 != 0;
            let live = match before {
                Some((same, left)) if same == vertex => !(left || leaves && place < aliases),
                _ => (vertex as usize) < inputs || !leaves,
            };
            if !live {
                return Err(SequenceError::NotLive { step: step_of(place), vertex });
            }
            before = Some((vertex, leaves));
        }
        Ok(())
    }

    /// Checks the numbers of triangles left against the triangles not vanished yet.
    fn check_triangles(&self) -> Result<(), SequenceError> {
        let steps = self.len();
        expect("triangle counts", self.triangles_after.len(), steps + 1)?;
        let mut vanish = vec![0u32; steps + 1];
        let mut left = 0u32;
        for (triangle, &end) in self.triangle_end.iter().enumerate() {
            match vanish.get_mut(end as usize) {
                Some(count) => *count += 1,
                None if end != NONE => return Err(SequenceError::TriangleEnd { triangle, end }),
                None => {}
            }
            left += u32::from(end != 0);
        }
        // Triangles gone before the first step (degenerate) were never counted.
        vanish[0] = 0;
        for (steps, (&count, &gone)) in self.triangles_after.iter().zip(&vanish).enumerate() {
            left -= gone;
            if count != left {
                let (found, expected) = (count as usize, left as usize);
                return Err(SequenceError::TriangleCount { steps, found, expected });
            }
        }
        Ok(())
    }
}

/// Checks new vertices: finite positions, weights 0 to 1, and sources with lower numbers.
pub(super) fn check_new_vertices(inputs: usize, vertices: &[NewVertex]) -> Result<(), SequenceError> {
    for (new, vertex) in vertices.iter().enumerate() {
        let blends = vertex.from.iter().all(|&v| (v as usize) < inputs + new);
        let finite = vertex.position.iter().all(|x| x.is_finite());
        if !(blends && finite && (0.0..=1.0).contains(&vertex.weight)) {
            return Err(SequenceError::BadNewVertex { new });
        }
    }
    Ok(())
}

pub(super) fn expect(what: &'static str, found: usize, expected: usize) -> Result<(), SequenceError> {
    if found == expected { Ok(()) } else { Err(SequenceError::Mismatch { what, found, expected }) }
}

fn expect_most(what: &'static str, found: usize, most: usize) -> Result<(), SequenceError> {
    expect(what, found, found.min(most))
}

/// Deserialised fields, not validated yet.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
pub(super) struct Parts {
    input_vertices: u32,
    new_vertices: Vec<NewVertex>,
    solved: Vec<String>,
    aliases: Vec<[u32; 2]>,
    snaps: Vec<[u32; 2]>,
    substitutions: Vec<[u32; 2]>,
    step_start: Vec<u32>,
    step_error: Vec<f32>,
    max_error: Vec<f32>,
    surface_error: Vec<f32>,
    curve_error: Vec<f32>,
    triangles_after: Vec<u32>,
    triangle_end: Vec<u32>,
    batch_end: Vec<u32>,
    report: super::SimplifyReport,
}

#[cfg(feature = "serde")]
impl TryFrom<Parts> for CollapseSequence {
    type Error = SequenceError;

    fn try_from(parts: Parts) -> Result<Self, SequenceError> {
        let sequence = Self {
            input_vertices: parts.input_vertices,
            new_vertices: parts.new_vertices,
            solved: parts.solved,
            aliases: parts.aliases,
            snaps: parts.snaps,
            substitutions: parts.substitutions,
            step_start: parts.step_start,
            step_error: parts.step_error,
            max_error: parts.max_error,
            surface_error: parts.surface_error,
            curve_error: parts.curve_error,
            triangles_after: parts.triangles_after,
            triangle_end: parts.triangle_end,
            batch_end: parts.batch_end,
            report: parts.report,
        };
        sequence.validate()?;
        Ok(sequence)
    }
}
