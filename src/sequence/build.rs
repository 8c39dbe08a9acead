//! Builds a [`CollapseSequence`] from another simplifier's substitutions. All tables are derived and checked.
//!
//! ```text
//!     step 0: 7 -> 3          step 1: 4 -> 2, 9 -> 8 (both wedges of a seam)          step 2: ...
//! ```

use crate::mesh::{MAX_ELEMENTS, Mesh, NONE, Topology};

use super::collapse_forest::CollapseForest;
use super::report::{SimplifyReport, StopReason};
use super::validate::check_new_vertices;
use super::{CollapseSequence, NewVertex, SequenceError};

impl CollapseSequence {
    /// Builds a sequence with endpoint placement from your own simplifier. Each step holds substitutions `[from, to]`
    /// of input vertices and an error bound in object units (finite, not negative; a bound for the changed region, see
    /// [`CollapseSequence::step_error`]).
    ///
    /// A step at a seam lists a substitution per wedge, so no structure shows half a step. Vertices equal in position
    /// and all attributes are first folded into the lowest of them ([`CollapseSequence::aliases`]). A substitution may
    /// name any of them; repeated substitutions are dropped. Within a step substitutions take effect in order. Any
    /// vertex may replace any other.
    ///
    /// The report says [`StopReason::NothingLegal`] without refusals. O((vertices + triangles) log vertices).
    ///
    /// # Errors
    /// The first substitution naming a vertex not in the mesh at the time or replacing a vertex by itself, or the first
    /// bad error bound; too many steps or substitutions.
    pub fn from_substitutions<S: AsRef<[[u32; 2]]>>(
        mesh: &Mesh,
        steps: impl IntoIterator<Item = (S, f32)>,
    ) -> Result<Self, SequenceError> {
        Self::from_collapses(mesh, &[], steps)
    }

    /// Builds a sequence with any placement, as [`CollapseSequence::from_substitutions`] does. `new_vertices[i]` has
    /// the number `mesh.positions().len() + i` and is made by the first substitution naming it as a target.
    ///
    /// # Errors
    /// As [`CollapseSequence::from_substitutions`], or the first bad new vertex.
    pub fn from_collapses<S: AsRef<[[u32; 2]]>>(
        mesh: &Mesh,
        new_vertices: &[NewVertex],
        steps: impl IntoIterator<Item = (S, f32)>,
    ) -> Result<Self, SequenceError> {
        let inputs = mesh.positions().len();
        check_new_vertices(inputs, new_vertices)?;
        let topology = Topology::new(mesh);
        let wedge_of = topology.wedge_of();
        let mut sequence = Self {
            input_vertices: inputs as u32,
            new_vertices: new_vertices.to_vec(),
            solved: Vec::new(),
            aliases: (0..inputs as u32).map(|v| [v, wedge_of[v as usize]]).filter(|[v, w]| v != w).collect(),
            snaps: Vec::new(),
            substitutions: Vec::new(),
            step_start: vec![0],
            step_error: Vec::new(),
            max_error: Vec::new(),
            surface_error: Vec::new(),
            curve_error: Vec::new(),
            triangles_after: Vec::new(),
            triangle_end: vec![0; mesh.triangles().len()],
            batch_end: Vec::new(),
            report: SimplifyReport::new(StopReason::NothingLegal),
        };
        let mut place = vec![NONE; inputs];
        for (substitutions, error) in steps {
            sequence.push_step(substitutions.as_ref(), error, wedge_of, &mut place)?;
        }
        sequence.finish(mesh)
    }

    /// Appends a step. `place`: index of each input vertex's last substitution.
    fn push_step(
        &mut self,
        given: &[[u32; 2]],
        error: f32,
        wedge_of: &[u32],
        place: &mut [u32],
    ) -> Result<(), SequenceError> {
        let step = self.step_error.len();
        if !(error >= 0.0 && error.is_finite()) {
            return Err(SequenceError::BadError { step, error });
        }
        let start = *self.step_start.last().unwrap_or(&0);
        for &[from, to] in given {
            if from == to {
                return Err(SequenceError::SelfSubstitution { step, vertex: from });
            }
            // New vertices have no duplicates in the input. Numbers out of range are refused by the final check.
            let [a, b] = [from, to].map(|v| wedge_of.get(v as usize).copied().unwrap_or(v));
            let before = place.get(a as usize).copied().filter(|&at| at != NONE && at >= start);
            let said = before.is_some_and(|at| self.substitutions[at as usize] == [a, b]);
            if a != b && !said {
                if let Some(place) = place.get_mut(a as usize) {
                    *place = self.substitutions.len() as u32;
                }
                self.substitutions.push([a, b]);
            }
        }
        if self.substitutions.len() > 2 * MAX_ELEMENTS || step >= MAX_ELEMENTS {
            return Err(SequenceError::TooMany { limit: MAX_ELEMENTS });
        }
        self.step_start.push(self.substitutions.len() as u32);
        self.step_error.push(error);
        self.max_error.push(self.max_error.last().map_or(error, |&before| before.max(error)));
        Ok(())
    }

    /// Computes the end of each triangle, and the report.
    fn finish(mut self, mesh: &Mesh) -> Result<Self, SequenceError> {
        let collapse_forest = CollapseForest::new(mesh, &self)?;
        self.triangle_end = mesh.triangles().iter().map(|&t| collapse_forest.end(t)).collect();

        let steps = self.step_error.len();
        let mut left = vec![0u32; steps + 1];
        let mut base = 0;
        for &end in &self.triangle_end {
            match end {
                0 => {}
                NONE => base += 1,
                // Alive after 0 to end - 1 steps.
                end => left[end as usize - 1] += 1,
            }
        }
        let mut alive = base;
        for count in left.iter_mut().rev() {
            alive += *count;
            *count = alive;
        }
        self.triangles_after = left;
        self.batch_end = vec![steps as u32];

        let to = self.representatives(steps);
        let mut used = vec![false; to.len()];
        for (corners, _) in mesh.triangles().iter().zip(&self.triangle_end).filter(|&(_, &end)| end == NONE) {
            corners.iter().for_each(|&v| used[to[v as usize] as usize] = true);
        }
        self.report.steps = steps;
        self.report.triangles = base as usize;
        self.report.vertices = used.iter().filter(|&&u| u).count();
        self.report.error = self.error_after(steps);
        self.report.surface_error = self.report.error;
        Ok(self)
    }
}
