//! What the simplifier hands over: every collapse in order, enough to replay it exactly in both directions.
//!
//! ```text
//!   step 1      2      3  ...   n          a step moves every wedge of one point onto a wedge of another
//!   |------|------|------|--...--|         (endpoint placement), or the wedges of two points onto new vertices
//!   input                        base      (other placements): `from -> to` substitutions
//! ```
//!
//! After `k` steps the mesh is *the image of the input triangles under the first k steps' substitutions, less those
//! with two equal corners*. Nothing else is needed: no connectivity can be lost, on any input.

use std::borrow::Cow;

use crate::mesh::{Attribute, Blender, Mesh, NONE, folded};

use super::NormalsDone;
use super::attribute_deviation::{AttributeDeviation, deviations};
use super::footprint::{self, Place};
use super::keep_sides::keep_sides;
use super::refit::refit;
use super::report::SimplifyReport;
use super::solved::solve_new;

/// A vertex that a collapse made: a blend of two others.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct NewVertex {
    /// The two vertices it replaces (input vertices or earlier new ones). Equal where only one wedge came along.
    pub from: [u32; 2],
    /// Share of the second in its attributes, 0 to 1.
    pub weight: f32,
    /// Where it lies, object units.
    pub position: [f32; 3],
}

/// Where an output vertex comes from, to carry any vertex type along.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Origin {
    /// This vertex of the input, unchanged.
    Input(u32),
    /// `(1 - weight) * a + weight * b` of two vertices with lower numbers, at a position of its own.
    Blend(NewVertex),
}

/// Every collapse of a simplification, in order.
///
/// Vertices are numbered as in the input, then new ones in order of creation. With endpoint placement there are no new
/// ones. Steps count from 0 (`after 0 steps` is the input).
///
/// Counts of steps and numbers of steps beyond the last are taken for the last or for a step that does nothing, as each
/// method says; serde validates ([`CollapseSequence::validate`]).
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "super::sequence_check::Parts"))]
pub struct CollapseSequence {
    pub(crate) input_vertices: u32,
    pub(crate) new_vertices: Vec<NewVertex>,
    /// Attributes whose values at new vertices fit the surface that each stands for, instead of blends.
    pub(crate) solved: Vec<String>,
    /// Duplicate vertices and the wedge each is folded into before the first step.
    pub(crate) aliases: Vec<[u32; 2]>,
    /// Vertices and the one whose position each takes before the first step.
    pub(crate) snaps: Vec<[u32; 2]>,
    pub(crate) substitutions: Vec<[u32; 2]>,
    /// Start of each step's substitutions; one more than steps.
    pub(crate) step_start: Vec<u32>,
    /// Per step, a bound for the region that it changed.
    pub(crate) step_error: Vec<f32>,
    /// Per step, the largest `step_error` so far.
    pub(crate) max_error: Vec<f32>,
    /// Per step, the largest errors of the surface and of curves so far. Empty where there are no curves: then the
    /// surface's are `max_error`, and those of curves 0.
    pub(crate) surface_error: Vec<f32>,
    pub(crate) curve_error: Vec<f32>,
    /// Triangles left after k steps; one more than steps.
    pub(crate) triangles_after: Vec<u32>,
    /// Per input triangle the number of steps after which it is gone; 0: degenerate in the input; MAX: never.
    pub(crate) triangle_end: Vec<u32>,
    /// Steps done at the end of each batch (one batch in linear order).
    pub(crate) batch_end: Vec<u32>,
    pub(crate) report: SimplifyReport,
}

impl CollapseSequence {
    /// Number of collapses.
    pub fn len(&self) -> usize {
        self.step_error.len()
    }

    /// Whether nothing was collapsed.
    pub fn is_empty(&self) -> bool {
        self.step_error.is_empty()
    }

    /// Whether a mesh has as many vertices and triangles as the input. Others show nothing:
    /// [`CollapseSequence::triangles_at`] and [`CollapseSequence::extract`] give none. O(1).
    pub fn fits(&self, mesh: &Mesh) -> bool {
        mesh.positions().len() == self.input_vertices() && mesh.triangles().len() == self.input_triangles()
    }

    /// What was reached and why it stopped.
    pub fn report(&self) -> &SimplifyReport {
        &self.report
    }

    /// Number of vertices of the input.
    pub fn input_vertices(&self) -> usize {
        self.input_vertices as usize
    }

    /// Number of vertices, input and new.
    pub(crate) fn vertex_count(&self) -> usize {
        self.input_vertices as usize + self.new_vertices.len()
    }

    /// Number of triangles of the input, degenerate ones included.
    pub fn input_triangles(&self) -> usize {
        self.triangle_end.len()
    }

    /// Vertices made by collapses, in order of creation. Empty with endpoint placement.
    pub fn new_vertices(&self) -> &[NewVertex] {
        &self.new_vertices
    }

    /// Duplicate vertices as `[duplicate, kept]`, folded together before the first step: equal in position and all
    /// attributes, or within the [`Tolerances`](crate::mesh::Tolerances) of the simplification.
    pub fn aliases(&self) -> &[[u32; 2]] {
        &self.aliases
    }

    /// Those of the duplicates that nothing in the mesh tells apart from the vertex kept, both used by triangles. O(n).
    pub(crate) fn folded(&self, mesh: &Mesh) -> Vec<[u32; 2]> {
        folded(mesh, self.aliases.iter().copied())
    }

    /// Vertices that are snapped before the first step, as `[vertex, to]`, ascending: the vertex takes the position of the
    /// other, which nearly coincides with its own ([`Tolerances::position`](crate::mesh::Tolerances::position)), and keeps
    /// its attributes. None where the input has no cracks of that width.
    pub fn snaps(&self) -> &[[u32; 2]] {
        &self.snaps
    }

    /// The positions of the input's vertices from the first step on. O(1) where nothing is snapped.
    pub(crate) fn placed<'a>(&self, mesh: &'a Mesh) -> Cow<'a, [[f32; 3]]> {
        if self.snaps.is_empty() {
            return Cow::Borrowed(mesh.positions());
        }
        let mut positions = mesh.positions().to_vec();
        for &[vertex, to] in &self.snaps {
            positions[vertex as usize] = mesh.positions()[to as usize];
        }
        Cow::Owned(positions)
    }

    /// The substitutions `[from, to]` of one step; none where there is no such step.
    pub fn substitutions(&self, step: usize) -> &[[u32; 2]] {
        if step < self.len() {
            &self.substitutions[self.step_start[step] as usize..self.step_start[step + 1] as usize]
        } else {
            &[]
        }
    }

    /// The error bound of the region that `step` changed, object units; 0 where there is no such step. What
    /// it bounds: see [`Simplifier`](super::Simplifier).
    pub fn step_error(&self, step: usize) -> f32 {
        self.step_error.get(step).copied().unwrap_or(0.0)
    }

    /// The error of the whole mesh after `steps` steps (all, if there are fewer), object units: the larger of the next
    /// two. Never decreases with `steps`.
    pub fn error_after(&self, steps: usize) -> f32 {
        steps.min(self.len()).checked_sub(1).map_or(0.0, |last| self.max_error[last])
    }

    /// The part of [`error_after`](CollapseSequence::error_after) that is the surface's, object units.
    pub fn surface_error_after(&self, steps: usize) -> f32 {
        let last = steps.min(self.len()).checked_sub(1);
        let known = last.and_then(|last| self.surface_error.get(last).copied());
        known.unwrap_or_else(|| self.error_after(steps))
    }

    /// The part of [`error_after`](CollapseSequence::error_after) that is that of curves, object units: borders,
    /// non-manifold edges, seams, borders between materials, and creases. See [`Simplifier`](super::Simplifier). 0 for
    /// a sequence that was not made by one.
    pub fn curve_error_after(&self, steps: usize) -> f32 {
        let last = steps.min(self.len()).checked_sub(1);
        last.and_then(|last| self.curve_error.get(last).copied()).unwrap_or(0.0)
    }

    /// Triangles left after `steps` steps (all, if there are fewer); degenerate input triangles do not count.
    pub fn triangles_after(&self, steps: usize) -> usize {
        self.triangles_after[steps.min(self.len())] as usize
    }

    /// Steps done at the end of each batch; linear order has one batch.
    pub fn batches(&self) -> &[u32] {
        &self.batch_end
    }

    /// Per input triangle the number of steps after which it is gone: 0 where it is degenerate in the input,
    /// `u32::MAX` where it stays in the base mesh.
    pub fn triangle_ends(&self) -> &[u32] {
        &self.triangle_end
    }

    /// Fewest steps after which at most `triangles` are left, or all steps. O(log n).
    pub fn steps_for_triangles(&self, triangles: usize) -> usize {
        self.triangles_after.partition_point(|&left| left as usize > triangles).min(self.len())
    }

    /// Most steps whose error bound is at most `error` object units. O(log n).
    pub fn steps_for_error(&self, error: f32) -> usize {
        self.max_error.partition_point(|&e| e <= error)
    }

    /// Where a vertex comes from. A number beyond the last vertex is given back as if it were the input's.
    pub fn origin(&self, vertex: u32) -> Origin {
        let new = vertex.checked_sub(self.input_vertices).and_then(|new| self.new_vertices.get(new as usize));
        new.map_or(Origin::Input(vertex), |&new| Origin::Blend(new))
    }

    /// The vertex that stands for each vertex (input and new) after `steps` steps (all, if there are fewer).
    /// O(vertices).
    pub fn representatives(&self, steps: usize) -> Vec<u32> {
        let mut to: Vec<u32> = (0..self.vertex_count() as u32).collect();
        if steps > 0 {
            let done = self.step_start[steps.min(self.len())] as usize;
            // Later substitutions first: each target is then already resolved.
            for &[from, target] in self.substitutions[..done].iter().rev() {
                to[from as usize] = to[target as usize];
            }
            for &[duplicate, kept] in &self.aliases {
                to[duplicate as usize] = to[kept as usize];
            }
        }
        to
    }

    /// The triangles left after `steps` steps (all, if there are fewer), in input order, and the input triangle each is
    /// the image of. After 0 steps, the input's own triangles verbatim (degenerate ones included). None of a mesh that
    /// does not fit ([`CollapseSequence::fits`]).
    pub fn triangles_at(&self, mesh: &Mesh, steps: usize) -> (Vec<[u32; 3]>, Vec<u32>) {
        if !self.fits(mesh) {
            return (Vec::new(), Vec::new());
        }
        let to = self.representatives(steps);
        let last = steps.min(self.len());
        let alive = |t: usize| steps == 0 || self.triangle_end[t] as usize > last;
        let origin: Vec<u32> = (0..self.triangle_end.len()).filter(|&t| alive(t)).map(|t| t as u32).collect();
        let image = origin.iter().map(|&t| mesh.triangles()[t as usize].map(|v| to[v as usize])).collect();
        (image, origin)
    }

    /// The level of detail after `steps` steps (all, if there are fewer) as a mesh of its own, with attributes,
    /// materials and locks. Only vertices that a triangle uses are kept, in order of first use; after 0 steps the input
    /// itself. Normals are recomputed or dropped as the report says; vertices between two smoothing groups are split then.
    /// Of a mesh that does not fit ([`CollapseSequence::fits`]), an empty mesh. O(input).
    pub fn extract(&self, mesh: &Mesh, steps: usize) -> Mesh {
        if !self.fits(mesh) {
            return Mesh::default();
        }
        if steps == 0 {
            return match self.report.normals {
                NormalsDone::Dropped => mesh.without_normals(),
                _ => mesh.clone(),
            };
        }
        self.report.normals.finish(self.level(mesh, steps))
    }

    /// A level with one vertex for each of the sequence's: before normals are recomputed. The mesh fits.
    fn level(&self, mesh: &Mesh, steps: usize) -> Mesh {
        let (mut triangles, origin) = self.triangles_at(mesh, steps);
        let mut number = vec![NONE; self.vertex_count()];
        let mut used = Vec::new();
        for corner in triangles.as_flattened_mut() {
            let n = &mut number[*corner as usize];
            if *n == NONE {
                *n = used.len() as u32;
                used.push(*corner);
            }
            *corner = *n;
        }
        let materials: Vec<u32> = if mesh.materials().is_empty() {
            Vec::new()
        } else {
            origin.iter().map(|&t| mesh.materials()[t as usize]).collect()
        };
        self.assemble(mesh, &used, triangles, materials)
    }

    /// A level as [`extract`](CollapseSequence::extract) gives it, but with attributes that are fitted to the input: the
    /// values that are closest to it over its whole surface, not only at the vertices that are kept. Positions and
    /// triangles, labels, skin weights and locked vertices stay as they are, normals have unit length, and no value
    /// leaves the range of those around it. The input itself after 0 steps. O(input).
    ///
    /// ```
    /// use multires::{Simplifier, mesh::shapes};
    /// let mesh = shapes::demo();
    /// let sequence = Simplifier::new().run(&mesh)?;
    /// let steps = sequence.steps_for_triangles(3_000);
    /// let off = |level: &_| sequence.attribute_deviations(&mesh, steps, level)[0].clone();
    /// let (kept, fitted) = (sequence.extract(&mesh, steps), sequence.extract_fitted(&mesh, steps));
    /// assert_eq!(off(&kept).name, "normal");
    /// assert!(off(&fitted).mean < off(&kept).mean);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn extract_fitted(&self, mesh: &Mesh, steps: usize) -> Mesh {
        if steps == 0 || !self.fits(mesh) {
            return self.extract(mesh, steps);
        }
        let level = self.level(mesh, steps);
        let mut attributes = refit(mesh, &level, &self.places(mesh, steps, &level));
        keep_sides(level.positions(), level.triangles(), level.attributes(), &mut attributes);
        self.report.normals.finish(level.with_attributes(attributes))
    }

    /// What the attributes of a level are off by, each in its own unit. `level` is what
    /// [`extract`](CollapseSequence::extract) or [`extract_fitted`](CollapseSequence::extract_fitted) gave for the same
    /// mesh and number of steps; nothing is said of one that has other triangles. O(input).
    pub fn attribute_deviations(&self, mesh: &Mesh, steps: usize, level: &Mesh) -> Vec<AttributeDeviation> {
        if !self.fits(mesh) {
            return Vec::new();
        }
        if steps == 0 || self.report.normals == NormalsDone::Kept {
            return deviations(mesh, level, &self.places(mesh, steps, level));
        }
        // Its vertices may be split, but its triangles are the same.
        let places = self.places(mesh, steps, &self.level(mesh, steps));
        if places.is_empty() || level.triangles().len() != self.triangles_after(steps) {
            return Vec::new();
        }
        deviations(mesh, level, &places)
    }

    /// Where the triangles of the input lie on a level; nowhere, if it is none of this sequence.
    fn places(&self, mesh: &Mesh, steps: usize, level: &Mesh) -> Vec<Place> {
        let (triangles, origin) = self.triangles_at(mesh, steps);
        if triangles.len() != level.triangles().len() {
            return Vec::new();
        }
        let mut stands_for = vec![NONE; self.vertex_count()];
        for (&v, &number) in triangles.as_flattened().iter().zip(level.indices()) {
            stands_for[v as usize] = number;
        }
        let to = self.representatives(steps);
        let number: Vec<u32> = to[..mesh.positions().len()].iter().map(|&v| stands_for[v as usize]).collect();
        let mut places = footprint::places(mesh, level, &number);
        if self.report.parts_removed > 0 {
            footprint::keep_parts_apart(mesh, &origin, &mut places);
        }
        places
    }

    /// Says in the report what the last step reached. O(input).
    pub(crate) fn fill_report(&mut self, mesh: &Mesh) {
        let steps = self.len();
        let to = self.representatives(steps);
        let mut used = vec![false; to.len()];
        for (triangle, &end) in mesh.triangles().iter().zip(&self.triangle_end) {
            if end as usize > steps {
                triangle.iter().for_each(|&v| used[to[v as usize] as usize] = true);
            }
        }
        self.report.steps = steps;
        self.report.triangles = self.triangles_after(steps);
        self.report.vertices = used.iter().filter(|&&used| used).count();
        self.report.error = self.error_after(steps);
        self.report.surface_error = self.surface_error_after(steps);
        self.report.curve_error = self.curve_error_after(steps);
    }

    /// Takes the largest error so far from the errors of the steps.
    pub(crate) fn accumulate_errors(&mut self) {
        let mut largest: f32 = 0.0;
        let so_far = self.step_error.iter().map(|&error| {
            largest = largest.max(error);
            largest
        });
        self.max_error = so_far.collect();
    }

    /// Tells errors of surface and curves apart, from those of each step (as many as steps, or more); `parts` may be
    /// empty where there are no curves.
    pub(crate) fn tell_apart(&mut self, parts: &[[f32; 2]]) {
        let steps = self.len();
        let largest = |part: usize| -> Vec<f32> {
            let mut largest: f32 = 0.0;
            let so_far = parts.iter().take(steps).map(|step| {
                largest = largest.max(step[part]);
                largest
            });
            so_far.collect()
        };
        self.surface_error = largest(0);
        self.curve_error = largest(1);
    }

    /// A mesh of the given vertices of this sequence.
    pub(crate) fn assemble(
        &self,
        mesh: &Mesh,
        vertices: &[u32],
        triangles: Vec<[u32; 3]>,
        materials: Vec<u32>,
    ) -> Mesh {
        let placed = self.placed(mesh);
        let position = |v: u32| match self.origin(v) {
            Origin::Input(v) => placed[v as usize],
            Origin::Blend(new) => new.position,
        };
        let positions: Vec<[f32; 3]> = vertices.iter().map(|&v| position(v)).collect();
        let locks: Vec<bool> = if mesh.locks().is_empty() {
            Vec::new()
        } else {
            vertices.iter().map(|&v| mesh.locks().get(v as usize).copied().unwrap_or(false)).collect()
        };
        let mut attributes = self.attributes(mesh, vertices);
        if !self.solved.is_empty() && !self.new_vertices.is_empty() {
            let blended = attributes.clone();
            solve_new(self, mesh, vertices, &mut attributes);
            keep_sides(&positions, &triangles, &blended, &mut attributes);
        }
        let names = mesh.material_names().to_vec();
        Mesh::from_trusted(positions, triangles, attributes, materials, names, locks).at_origin_of(mesh)
    }

    /// The attributes of the given vertices. New ones are blended in order of creation: each may be a source of later ones.
    fn attributes(&self, mesh: &Mesh, vertices: &[u32]) -> Vec<Attribute> {
        if self.new_vertices.is_empty() {
            return mesh.attributes().iter().map(|attribute| attribute.gather(vertices)).collect();
        }
        let mut blender = Blender::new(mesh.attributes(), self.new_vertices.len());
        self.new_vertices.iter().for_each(|new| blender.push(new.from, new.weight));
        blender.finish().iter().map(|attribute| attribute.gather(vertices)).collect()
    }
}
