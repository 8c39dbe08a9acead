//! The simplifier's output: all collapses in order, enough for an exact replay in both directions.
//!
//! ```text
//!   step 1      2      3  ...   n          a step moves every wedge of one point onto a wedge of another
//!   |------|------|------|--...--|         (endpoint placement), or the wedges of two points onto new vertices
//!   input                        base      (other placements): `from -> to` substitutions
//! ```
//!
//! After `k` steps the mesh is *the image of the input triangles under the first k steps' substitutions, less triangles
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

/// A vertex made by a collapse: a blend of two vertices.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct NewVertex {
    /// The two vertices replaced (input or earlier new vertices). Equal where a single wedge came along.
    pub from: [u32; 2],
    /// Share of `from[1]` in the attributes, 0 to 1.
    pub weight: f32,
    /// Position, object units.
    pub position: [f32; 3],
}

/// Source of an output vertex, to carry any vertex type along.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Origin {
    /// An input vertex, unchanged.
    Input(u32),
    /// A blend `(1 - weight) * a + weight * b` of two vertices with lower numbers, at its own position.
    Blend(NewVertex),
}

/// Every collapse of a simplification, in order.
///
/// Vertices are numbered as in the input, followed by new vertices in order of creation. Endpoint placement makes no
/// new vertices. Steps count from 0; after 0 steps the mesh is the input.
///
/// A number of steps or a step beyond the last counts as all steps, or as a step without effect, as documented at each
/// method. Serde validates ([`CollapseSequence::validate`]).
///
/// ```
/// use multires::{Simplifier, mesh::shapes};
///
/// let mesh = shapes::icosphere(3);
/// let sequence = Simplifier::new().run(&mesh)?;
/// let steps = sequence.steps_for_triangles(200);
/// let level = sequence.extract(&mesh, steps);
/// assert!(level.triangles().len() <= 200);
/// println!("{} triangles, at most {} off", level.triangles().len(), sequence.error_after(steps));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "super::validate::Parts"))]
pub struct CollapseSequence {
    pub(crate) input_vertices: u32,
    pub(crate) new_vertices: Vec<NewVertex>,
    /// Attributes fitted at new vertices to the surface merged into each, instead of blended.
    pub(crate) solved: Vec<String>,
    /// `[duplicate, kept]`: vertices folded into an equal wedge before the first step.
    pub(crate) aliases: Vec<[u32; 2]>,
    /// `[vertex, to]`: `vertex` takes the position of `to` before the first step.
    pub(crate) snaps: Vec<[u32; 2]>,
    pub(crate) substitutions: Vec<[u32; 2]>,
    /// Start of each step's substitutions; length steps + 1.
    pub(crate) step_start: Vec<u32>,
    /// Per step, an error bound for the changed region.
    pub(crate) step_error: Vec<f32>,
    /// Per step, the largest `step_error` so far.
    pub(crate) max_error: Vec<f32>,
    /// Per step, the largest errors of the surface and of curves so far. Empty without curves: the surface error is
    /// then `max_error`, the curve error 0.
    pub(crate) surface_error: Vec<f32>,
    pub(crate) curve_error: Vec<f32>,
    /// Triangles left after k steps; length steps + 1.
    pub(crate) triangles_after: Vec<u32>,
    /// Per input triangle the number of steps after which it is gone; 0: degenerate in the input; MAX: never.
    pub(crate) triangle_end: Vec<u32>,
    /// Steps done at the end of each batch (a single batch in linear order).
    pub(crate) batch_end: Vec<u32>,
    pub(crate) report: SimplifyReport,
}

impl CollapseSequence {
    /// Number of collapses.
    pub fn len(&self) -> usize {
        self.step_error.len()
    }

    /// Returns true if there are no collapses.
    pub fn is_empty(&self) -> bool {
        self.step_error.is_empty()
    }

    /// Returns true if `mesh` has as many vertices and triangles as the input. Other meshes get nothing from
    /// [`CollapseSequence::triangles_at`] and [`CollapseSequence::extract`]. O(1).
    pub fn fits(&self, mesh: &Mesh) -> bool {
        mesh.positions().len() == self.input_vertices() && mesh.triangles().len() == self.input_triangles()
    }

    /// Results of the simplification, and the reason for stopping.
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

    /// Duplicate vertices as `[duplicate, kept]`, folded before the first step. Both are equal in position and all
    /// attributes, or within the [`Tolerances`](crate::mesh::Tolerances) of the simplification.
    pub fn aliases(&self) -> &[[u32; 2]] {
        &self.aliases
    }

    /// Duplicates indistinguishable in the mesh from the vertex kept, both used by triangles. O(n).
    pub(crate) fn folded(&self, mesh: &Mesh) -> Vec<[u32; 2]> {
        folded(mesh, self.aliases.iter().copied())
    }

    /// Vertices snapped before the first step, as `[vertex, to]`, ascending. `vertex` takes the nearly coincident
    /// position of `to` ([`Tolerances::position`](crate::mesh::Tolerances::position)), and keeps its attributes. Empty
    /// where the input has no cracks of this width.
    pub fn snaps(&self) -> &[[u32; 2]] {
        &self.snaps
    }

    /// Returns the positions of the input's vertices from the first step on. O(1) where nothing is snapped.
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

    /// Returns the substitutions `[from, to]` of a step; empty where there is no such step.
    pub fn substitutions(&self, step: usize) -> &[[u32; 2]] {
        if step < self.len() {
            &self.substitutions[self.step_start[step] as usize..self.step_start[step + 1] as usize]
        } else {
            &[]
        }
    }

    /// Returns the error bound of the region changed by `step`, object units; 0 where there is no such step.
    /// Definition: see [`Simplifier`](crate::simplify::Simplifier).
    pub fn step_error(&self, step: usize) -> f32 {
        self.step_error.get(step).copied().unwrap_or(0.0)
    }

    /// Returns the error of the whole mesh after `steps` steps (all, if there are fewer), object units: the larger of
    /// [`surface_error_after`](CollapseSequence::surface_error_after) and
    /// [`curve_error_after`](CollapseSequence::curve_error_after). Never decreases with `steps`.
    pub fn error_after(&self, steps: usize) -> f32 {
        steps.min(self.len()).checked_sub(1).map_or(0.0, |last| self.max_error[last])
    }

    /// Returns the surface's part of [`error_after`](CollapseSequence::error_after), object units.
    pub fn surface_error_after(&self, steps: usize) -> f32 {
        let last = steps.min(self.len()).checked_sub(1);
        let known = last.and_then(|last| self.surface_error.get(last).copied());
        known.unwrap_or_else(|| self.error_after(steps))
    }

    /// Returns the curves' part of [`error_after`](CollapseSequence::error_after), object units. Curves are borders,
    /// non-manifold edges, seams, borders between materials, and creases; see
    /// [`Simplifier`](crate::simplify::Simplifier). 0 for a sequence not made by a simplifier.
    pub fn curve_error_after(&self, steps: usize) -> f32 {
        let last = steps.min(self.len()).checked_sub(1);
        last.and_then(|last| self.curve_error.get(last).copied()).unwrap_or(0.0)
    }

    /// Number of triangles left after `steps` steps (all, if there are fewer); degenerate input triangles do not count.
    pub fn triangles_after(&self, steps: usize) -> usize {
        self.triangles_after[steps.min(self.len())] as usize
    }

    /// Steps done at the end of each batch; linear order has a single batch.
    pub fn batches(&self) -> &[u32] {
        &self.batch_end
    }

    /// Per input triangle the number of steps after which it is gone: 0 for degenerate input triangles, `u32::MAX` for
    /// triangles of the base mesh.
    pub fn triangle_ends(&self) -> &[u32] {
        &self.triangle_end
    }

    /// Returns the fewest steps leaving at most `triangles` triangles, or all steps. O(log n).
    pub fn steps_for_triangles(&self, triangles: usize) -> usize {
        self.triangles_after.partition_point(|&left| left as usize > triangles).min(self.len())
    }

    /// Returns the most steps with an error of at most `error` object units. O(log n).
    pub fn steps_for_error(&self, error: f32) -> usize {
        self.max_error.partition_point(|&e| e <= error)
    }

    /// Returns the source of a vertex. A number beyond the last vertex is returned as an input vertex.
    pub fn origin(&self, vertex: u32) -> Origin {
        let new = vertex.checked_sub(self.input_vertices).and_then(|new| self.new_vertices.get(new as usize));
        new.map_or(Origin::Input(vertex), |&new| Origin::Blend(new))
    }

    /// Returns the image of each vertex (input and new) after `steps` steps (all, if there are fewer). O(vertices).
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

    /// Returns the triangles left after `steps` steps (all, if there are fewer), in input order, and the input triangle
    /// of each. 0 steps return the input's triangles verbatim, degenerate triangles included. Empty for a mesh not
    /// fitting the sequence ([`CollapseSequence::fits`]).
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

    /// Returns the level of detail after `steps` steps (all, if there are fewer) as a mesh with attributes, materials
    /// and locks. Keeps only vertices used by triangles, in order of first use. 0 steps return the input, with all its
    /// vertices. Normals are kept, dropped or, after 1 step or more, recomputed as the report says; recomputing splits
    /// vertices between smoothing groups. Returns an empty mesh for a mesh not fitting the sequence
    /// ([`CollapseSequence::fits`]). O(input).
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

    /// Returns a level before normals are recomputed: no vertex of the sequence is split. `mesh` must fit.
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

    /// Returns a level as [`extract`](CollapseSequence::extract) does, with attributes fitted to the input: least
    /// squares over its whole surface, not only at the kept vertices. Positions, triangles, labels, skin weights and
    /// locked vertices stay as they are, normals have unit length, and each value stays within the range of the values
    /// around it. 0 steps return the input. O(input).
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

    /// Returns the deviations of a level's attributes from the input, each in its own unit. `level` is the result of
    /// [`extract`](CollapseSequence::extract) or [`extract_fitted`](CollapseSequence::extract_fitted) for the same mesh
    /// and number of steps. Returns nothing for a level with other triangles. O(input).
    pub fn attribute_deviations(&self, mesh: &Mesh, steps: usize, level: &Mesh) -> Vec<AttributeDeviation> {
        if !self.fits(mesh) {
            return Vec::new();
        }
        if steps == 0 || self.report.normals == NormalsDone::Kept {
            return deviations(mesh, level, &self.places(mesh, steps, level));
        }
        // The level's vertices may be split, but its triangles are unchanged.
        let places = self.places(mesh, steps, &self.level(mesh, steps));
        if places.is_empty() || level.triangles().len() != self.triangles_after(steps) {
            return Vec::new();
        }
        deviations(mesh, level, &places)
    }

    /// Returns the place of each input triangle on a level; empty for a level of another sequence.
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

    /// Fills the report with the state after the last step. O(input).
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

    /// Sets `max_error` to the running maximum of the step errors.
    pub(crate) fn accumulate_errors(&mut self) {
        let mut largest: f32 = 0.0;
        let so_far = self.step_error.iter().map(|&error| {
            largest = largest.max(error);
            largest
        });
        self.max_error = so_far.collect();
    }

    /// Sets `surface_error` and `curve_error` to the running maxima of `parts`, `[surface, curve]` per step. `parts`
    /// may be longer than steps, or empty where there are no curves.
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

    /// Builds a mesh of the given vertices of this sequence.
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

    /// Returns the attributes of the given vertices. New vertices are blended in order of creation: each may be a
    /// source of later vertices.
    fn attributes(&self, mesh: &Mesh, vertices: &[u32]) -> Vec<Attribute> {
        if self.new_vertices.is_empty() {
            return mesh.attributes().iter().map(|attribute| attribute.gather(vertices)).collect();
        }
        let mut blender = Blender::new(mesh.attributes(), self.new_vertices.len());
        self.new_vertices.iter().for_each(|new| blender.push(new.from, new.weight));
        blender.finish().iter().map(|attribute| attribute.gather(vertices)).collect()
    }
}
