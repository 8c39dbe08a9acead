//! What is asked for of all meshes of a document together, and what that means for each.

use multires::mesh::Mesh;
use multires::simplify::Target;

use super::Simplify;
use super::common_error::{Share, steps_for_triangles};
use super::document::Part;
use crate::extract::round_down;
use crate::rules;

/// What is asked for of all meshes together.
pub struct Asked {
    /// Largest error, scene units.
    error: f32,
    /// Sizes that suffice, the first reached.
    sizes: Vec<Target>,
    /// Triangles of several levels.
    levels: Vec<usize>,
}

impl Asked {
    pub fn new(command: &Simplify, meshes: &[(usize, Mesh)], triangles: usize, diagonal: f64) -> Self {
        let targets = &command.targets;
        let absolute = targets.error_percent.map(|p| round_down(p / 100.0 * diagonal));
        let errors = targets.error.map(round_down).into_iter().chain(absolute);
        let per_vertex = meshes.iter().map(|(_, mesh)| rules::bytes_per_vertex(mesh)).max().unwrap_or(12);
        let sizes = [
            targets.triangles.map(Target::Triangles),
            targets.ratio.map(|ratio| Target::Triangles((ratio * triangles as f64) as usize)),
            targets.vertices.map(Target::Vertices),
            targets.bytes.map(|bytes| Target::Bytes { bytes, per_vertex }),
        ];
        let sizes: Vec<Target> = sizes.into_iter().flatten().collect();
        let levels = targets.levels.iter().map(|share| (share * triangles as f64) as usize).collect();
        Self { error: errors.fold(f32::MAX, f32::min), sizes, levels }
    }

    /// Returns the targets of a mesh: alone it is simplified as far as asked; among others as far as they might need.
    pub fn targets(&self, scale: f64, is_alone: bool) -> Vec<Target> {
        let mut targets = Vec::new();
        let least = self.levels.iter().copied().min().unwrap_or(0);
        if self.error < f32::MAX {
            targets.push(Target::Error(round_down(f64::from(self.error) / scale)));
        }
        match (is_alone, self.sizes.is_empty()) {
            (true, false) => targets.extend(&self.sizes),
            (true, true) if self.error == f32::MAX => targets.push(Target::Triangles(least)),
            (false, _) if self.error == f32::MAX || !self.sizes.is_empty() => {
                targets.push(Target::Triangles(1))
            }
            _ => {}
        }
        targets
    }

    /// Whether a number of anything is asked for, beside an error.
    pub fn is_sized(&self) -> bool {
        !self.sizes.is_empty() || !self.levels.is_empty()
    }

    /// Returns the triangles of each level to make; `None` for the only level, of the sizes and error asked for.
    pub fn levels(&self) -> Vec<Option<usize>> {
        if self.levels.is_empty() { vec![None] } else { self.levels.iter().copied().map(Some).collect() }
    }

    /// Returns the steps of each mesh for a level. `factors`: of errors, by poses.
    pub fn steps(&self, parts: &[Part], factors: &[f64], level: Option<usize>) -> Vec<usize> {
        let share = |(part, factor): (&Part, &f64)| part.scale * factor;
        let scales = parts.iter().zip(factors).map(share);
        let shares = parts.iter().zip(scales).map(|(part, scale)| Share { sequence: &part.sequence, scale });
        let shares: Vec<Share> = shares.collect();
        if let Some(most) = level {
            return steps_for_triangles(&shares, most);
        }
        let all = shares.iter().map(|share| share.steps(self.error));
        if parts.len() < 2 || self.sizes.is_empty() {
            return all.collect();
        }
        let triangles = |steps: &[usize]| -> usize {
            parts.iter().zip(steps).map(|(part, &steps)| part.sequence.triangles_after(steps)).sum()
        };
        // Vertices are counted, since no formula gives them.
        let vertices = |steps: &[usize]| -> usize {
            let each = parts.iter().zip(steps).map(|(part, &steps)| part.sequence.extract(&part.mesh, steps));
            each.map(|level| level.positions().len()).sum()
        };
        let fits = |steps: &[usize]| {
            self.sizes.iter().any(|size| match *size {
                Target::Triangles(most) => triangles(steps) <= most,
                Target::Vertices(most) => vertices(steps) <= most,
                Target::Bytes { bytes, per_vertex } => {
                    12 * triangles(steps) + per_vertex * vertices(steps) <= bytes
                }
                _ => false,
            })
        };
        if let [Target::Triangles(most)] = self.sizes[..] {
            return steps_for_triangles(&shares, most);
        }
        let whole = triangles(&vec![0; parts.len()]);
        let (mut low, mut high) = (0, whole);
        while low < high {
            let middle = (low + high).div_ceil(2);
            if fits(&steps_for_triangles(&shares, middle)) { low = middle } else { high = middle - 1 }
        }
        steps_for_triangles(&shares, low)
    }
}
