//! Progressive mesh: a base mesh and vertex splits, which replay a simplification exactly in both directions.
//!
//! ```text
//!            k  l                       k
//!         \ | /\ | /      collapse     \|/       split i:  k, l      the slots that part
//!         - *----* -      ------>     - * -                faces     the triangles that come (f_s, f_e)
//!         / | \/ | \      <------      /|\                 corners   those that move from k to l
//!                          split                           places    of k, where the collapse moved it
//! ```
//!
//! Hoppe, *Progressive Meshes* (1996); Southern, section 3.3. The paper finds the fan of `l` by its first and last
//! face, which needs a manifold. Here the moving corners are listed, so any mesh works. Positions are stored, not
//! differences: nothing is lost to rounding. Any placement is supported. A step may split several wedges at once.
//!
//! Slots are in order of refinement: a level is a prefix of the vertices and of the triangles. Elements beyond the
//! prefix wait in the state in which they come back, so a split writes the moving corners and the moved positions only.

use std::borrow::Cow;
use std::ops::Range;

use crate::geometry::lists::prefix_sum;
use crate::mesh::{Mesh, NONE};
use crate::sequence::collapse_forest::CollapseForest;
use crate::sequence::{CollapseSequence, Origin, SequenceError};

/// A base mesh, the vertex splits refining it to the input, and the current level.
///
/// Holds the positions of every level, but no attributes: carry attributes along by [`ProgressiveMesh::vertex_order`].
/// Levels are counted as in the sequence: after 0 steps the mesh is the input. Serde keeps the level, and validates
/// ([`ProgressiveMesh::validate`]).
///
/// ```
/// use multires::{Simplifier, mesh::shapes, progressive::ProgressiveMesh};
///
/// let mesh = shapes::icosphere(3);
/// let mut progressive = ProgressiveMesh::new(&mesh, &Simplifier::new().run(&mesh)?)?;
/// progressive.seek(progressive.len()); // the base mesh
/// let base = progressive.triangles().len();
/// progressive.refine(); // a vertex split
/// assert!(progressive.triangles().len() > base);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "super::validate::Parts"))]
pub struct ProgressiveMesh {
    pub(super) positions: Vec<[f32; 3]>,
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) vertex_order: Vec<u32>,
    pub(super) triangle_order: Vec<u32>,
    /// `x_after[k]`: number of vertices, triangles or places after `k` steps; length steps + 1. Step `k` owns the
    /// elements `x_after[k + 1]..x_after[k]`.
    pub(super) vertices_after: Vec<u32>,
    pub(super) triangles_after: Vec<u32>,
    pub(super) places_after: Vec<u32>,
    /// `[k, l]` of all steps, `l` counting up from the base.
    pub(super) parted: Vec<[u32; 2]>,
    /// Start of each pair's corners; length pairs + 1.
    pub(super) corner_start: Vec<u32>,
    pub(super) corners: Vec<u32>,
    pub(super) places: Vec<Place>,
    pub(super) batches: Vec<u32>,
    pub(super) steps: usize,
}

/// A slot moved by a step: its position before (`fine`) and after (`coarse`).
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Place {
    pub slot: u32,
    pub fine: [f32; 3],
    pub coarse: [f32; 3],
}

/// A vertex split (Southern 3.3): the inverse of a step.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct VertexSplit<'a> {
    /// Pairs `[k, l]` of slots: `k` stays, `l` is added. A pair per split wedge; empty where only positions change. `l`
    /// counts up from the number of vertices before the split. `[l, l]` adds a vertex used by no triangle.
    pub parted: &'a [[u32; 2]],
    /// First triangle added (the start face).
    pub first_triangle: u32,
    /// Number of triangles added; 2 on a closed manifold.
    pub triangles: u32,
}

impl ProgressiveMesh {
    /// Builds the splits from a mesh and any simplification of it. The result is at the base mesh.
    /// O((vertices + triangles) log vertices + moved corners).
    ///
    /// # Errors
    /// The sequence belongs to another mesh or is inconsistent, or more than `u32::MAX` corners move.
    pub fn new(mesh: &Mesh, sequence: &CollapseSequence) -> Result<Self, SequenceError> {
        let collapse_forest = CollapseForest::new(mesh, sequence)?;
        let mut slots = Slots::base(mesh, sequence, &collapse_forest);
        for step in (0..sequence.len()).rev() {
            slots.refine(step);
        }
        let Slots { slot, holder, positions, parted, places, mut vertices_after, mut places_after, .. } =
            slots;
        vertices_after.reverse();
        places_after.reverse();

        let (ends, triangle_order, triangles_after) = order_triangles(mesh, &collapse_forest, sequence.len());
        let mut pm = Self {
            positions,
            triangles: Vec::new(),
            vertex_order: holder,
            triangle_order,
            vertices_after,
            triangles_after,
            places_after,
            parted,
            corner_start: Vec::new(),
            corners: Vec::new(),
            places,
            batches: sequence.batches().to_vec(),
            steps: sequence.len(),
        };
        pm.find_corners(mesh, &slot, &ends)?;
        Ok(pm)
    }

    /// Number of steps from the input to the base mesh.
    pub fn len(&self) -> usize {
        self.vertices_after.len() - 1
    }

    /// Returns true if the input is the base mesh.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Steps away from the input: 0 at full resolution.
    pub fn steps(&self) -> usize {
        self.steps
    }

    /// Positions at the current level, object units, per slot.
    pub fn positions(&self) -> &[[f32; 3]] {
        &self.positions[..self.vertices_after[self.steps] as usize]
    }

    /// Triangles at the current level, as slots.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles[..self.triangles_after[self.steps] as usize]
    }

    /// Input vertex in each slot at full resolution: a permutation of the input vertices, bit for bit.
    pub fn vertex_order(&self) -> &[u32] {
        &self.vertex_order
    }

    /// Input triangle at each place: a permutation.
    pub fn triangle_order(&self) -> &[u32] {
        &self.triangle_order
    }

    /// Steps done at the end of each batch, as in [`CollapseSequence::batches`]. Refining has undone batch `i` once
    /// [`steps`](ProgressiveMesh::steps) is down to `batches[i - 1]` (0 for the first batch).
    pub fn batches(&self) -> &[u32] {
        &self.batches
    }

    /// Returns the split undoing `step`; `None` where there is no such step.
    pub fn split(&self, step: usize) -> Option<VertexSplit<'_>> {
        (step < self.len()).then(|| VertexSplit {
            parted: &self.parted[self.parted_range(step)],
            first_triangle: self.triangles_after[step + 1],
            triangles: self.triangles_after[step] - self.triangles_after[step + 1],
        })
    }

    /// Corners moved from `k` to `l` by the split undoing `step`, for a pair of its `parted`. A corner is
    /// `3 * triangle + i`, `i` from 0 to 2. Empty where there is no such pair.
    pub fn moved_corners(&self, step: usize, pair: usize) -> &[u32] {
        let pairs = if step < self.len() { self.parted_range(step) } else { 0..0 };
        if pair < pairs.len() { &self.corners[self.corner_range(pairs.start + pair)] } else { &[] }
    }

    /// Slots moved by a step: `(slot, finer, coarser)`, the positions before and after the step. With endpoint
    /// placement only the first step moves slots: snapped vertices ([`CollapseSequence::snaps`]).
    pub fn moved_slots(&self, step: usize) -> impl Iterator<Item = (u32, [f32; 3], [f32; 3])> + '_ {
        let range = if step < self.len() { self.place_range(step) } else { 0..0 };
        self.places[range].iter().map(|p| (p.slot, p.fine, p.coarse))
    }

    /// Bytes held by this structure's arrays.
    pub fn memory(&self) -> usize {
        size_of_val(&self.positions[..])
            + size_of_val(&self.triangles[..])
            + size_of_val(&self.parted[..])
            + size_of_val(&self.places[..])
            + [&self.vertex_order, &self.triangle_order, &self.vertices_after, &self.triangles_after]
                .into_iter()
                .chain([&self.places_after, &self.corner_start, &self.corners, &self.batches])
                .map(|v| size_of_val(&v[..]))
                .sum::<usize>()
    }

    /// Undoes a step; returns false at full resolution. O(moved corners).
    pub fn refine(&mut self) -> bool {
        let Some(step) = self.steps.checked_sub(1) else { return false };
        for pair in self.parted_range(step) {
            let [_, l] = self.parted[pair];
            for i in self.corner_range(pair) {
                let corner = self.corners[i];
                self.triangles[(corner / 3) as usize][(corner % 3) as usize] = l;
            }
        }
        for i in self.place_range(step) {
            let Place { slot, fine, .. } = self.places[i];
            self.positions[slot as usize] = fine;
        }
        self.steps = step;
        true
    }

    /// Redoes a step; returns false at the base mesh. O(moved corners).
    pub fn coarsen(&mut self) -> bool {
        let step = self.steps;
        if step >= self.len() {
            return false;
        }
        for pair in self.parted_range(step) {
            let [k, _] = self.parted[pair];
            for i in self.corner_range(pair) {
                let corner = self.corners[i];
                self.triangles[(corner / 3) as usize][(corner % 3) as usize] = k;
            }
        }
        for i in self.place_range(step) {
            let Place { slot, coarse, .. } = self.places[i];
            self.positions[slot as usize] = coarse;
        }
        self.steps = step + 1;
        true
    }

    /// Goes to the level after `steps` steps, or to the base mesh if there are fewer. O(moved corners in between).
    pub fn seek(&mut self, steps: usize) {
        let steps = steps.min(self.len());
        while self.steps > steps {
            self.refine();
        }
        while self.steps < steps {
            self.coarsen();
        }
    }

    pub(super) fn parted_range(&self, step: usize) -> Range<usize> {
        let base = self.vertices_after[self.len()] as usize;
        self.vertices_after[step + 1] as usize - base..self.vertices_after[step] as usize - base
    }

    pub(super) fn place_range(&self, step: usize) -> Range<usize> {
        self.places_after[step + 1] as usize..self.places_after[step] as usize
    }

    pub(super) fn corner_range(&self, pair: usize) -> Range<usize> {
        self.corner_start[pair] as usize..self.corner_start[pair + 1] as usize
    }

    /// Follows each corner from the input down to the level where its triangle vanishes. Lists the corner at each pair
    /// moving it, and leaves it in its last slot.
    fn find_corners(&mut self, mesh: &Mesh, slot: &[u32], ends: &[u32]) -> Result<(), SequenceError> {
        let base = self.vertices_after[self.len()];
        let step_of_pair: Vec<u32> = (0..self.len())
            .rev()
            .flat_map(|step| self.parted_range(step).map(move |_| step as u32))
            .collect();
        let mut count = vec![0u32; self.parted.len() + 1];
        let mut total = 0u64;
        self.triangles.reserve_exact(ends.len());
        for &t in &self.triangle_order {
            let end = ends[t as usize];
            let corners = mesh.triangles()[t as usize].map(|v| {
                let mut at = slot[v as usize];
                // The triangle survives the step joining this slot to another.
                while at >= base && end > step_of_pair[(at - base) as usize] + 1 {
                    let pair = (at - base) as usize;
                    total += 1;
                    count[pair + 1] = count[pair + 1].saturating_add(1);
                    at = self.parted[pair][0];
                }
                at
            });
            self.triangles.push(corners);
            if total > u64::from(u32::MAX) {
                return Err(SequenceError::TooMany { limit: u32::MAX as usize });
            }
        }
        prefix_sum(&mut count);
        let mut next = count.clone();
        self.corners = vec![0; total as usize];
        for (place, &t) in self.triangle_order.iter().enumerate() {
            for (k, &v) in mesh.triangles()[t as usize].iter().enumerate() {
                let (mut at, last) = (slot[v as usize], self.triangles[place][k]);
                while at != last {
                    let pair = (at - base) as usize;
                    self.corners[next[pair] as usize] = (3 * place + k) as u32;
                    next[pair] += 1;
                    at = self.parted[pair][0];
                }
            }
        }
        self.corner_start = count;
        Ok(())
    }
}

/// Gives out slots from the base up, step by step.
struct Slots<'a> {
    mesh: &'a Mesh,
    sequence: &'a CollapseSequence,
    /// Input positions after snapping. `unsnapped`: true once snapping is undone.
    placed: Cow<'a, [[f32; 3]]>,
    unsnapped: bool,
    /// Step making each new vertex.
    birth: Vec<u32>,
    /// Input vertices used by no triangle: added by the last split.
    unused: &'a [u32],
    /// Slot of each vertex of the sequence, or the slot it would be in.
    slot: Vec<u32>,
    /// Vertex in each slot.
    holder: Vec<u32>,
    positions: Vec<[f32; 3]>,
    parted: Vec<[u32; 2]>,
    places: Vec<Place>,
    vertices_after: Vec<u32>,
    places_after: Vec<u32>,
}

impl<'a> Slots<'a> {
    fn base(mesh: &'a Mesh, sequence: &'a CollapseSequence, collapse_forest: &'a CollapseForest) -> Self {
        let inputs = sequence.input_vertices() as u32;
        let mut birth = vec![NONE; sequence.new_vertices().len()];
        for step in (0..sequence.len()).rev() {
            for &[_, to] in sequence.substitutions(step).iter().rev() {
                if let Some(new) = to.checked_sub(inputs) {
                    birth[new as usize] = step as u32;
                }
            }
        }
        let mut base = Self {
            mesh,
            sequence,
            placed: sequence.placed(mesh),
            unsnapped: sequence.is_empty(),
            birth,
            unused: &[],
            slot: vec![NONE; collapse_forest.order.len()],
            holder: Vec::with_capacity(mesh.positions().len()),
            positions: Vec::with_capacity(mesh.positions().len()),
            parted: Vec::new(),
            places: Vec::new(),
            vertices_after: Vec::new(),
            places_after: Vec::new(),
        };
        if sequence.is_empty() {
            (0..inputs).for_each(|v| base.add(v));
        } else {
            collapse_forest.order[..collapse_forest.roots as usize].iter().for_each(|&v| base.add(v));
            let tail = collapse_forest
                .removed
                .iter()
                .rposition(|&r| r != NONE)
                .map_or(collapse_forest.roots as usize, |i| i + 1);
            base.unused = &collapse_forest.order[tail.max(collapse_forest.roots as usize)..];
        }
        base.mark();
        base
    }

    /// Undoes a step. Of the vertices merged by the step, the first takes the slot, unless the kept vertex holds it.
    /// Each other vertex gets a new slot.
    fn refine(&mut self, step: usize) {
        let sequence = self.sequence;
        let folds = if step == 0 { sequence.aliases() } else { &[] };
        // Undoing the first step undoes snapping too.
        let snapped: Vec<u32> = if step == 0 { self.snapped() } else { Vec::new() };
        self.unsnapped = step == 0;
        let substitutions = sequence.substitutions(step);
        // Unused vertices first: they may have duplicates, which part from them.
        if step == 0 {
            for &v in self.unused.iter().filter(|&&v| (v as usize) < sequence.input_vertices()) {
                self.parted.push([self.holder.len() as u32; 2]);
                self.add(v);
            }
        }
        // Last substitution first: the slot of each target is then known, even if this step also removes the target.
        for &[from, to] in substitutions.iter().rev().chain(folds) {
            self.slot[from as usize] = self.slot[to as usize];
        }
        for &[from, _] in folds.iter().chain(substitutions) {
            if self.is_born(from, step) {
                continue;
            }
            let k = self.slot[from as usize];
            let kept = self.holder[k as usize];
            if self.is_born(kept, step) {
                let (fine, coarse) = (self.position(from), self.position(kept));
                if fine.map(f32::to_bits) != coarse.map(f32::to_bits) {
                    self.places.push(Place { slot: k, fine, coarse });
                }
                self.holder[k as usize] = from;
            } else {
                self.parted.push([k, self.holder.len() as u32]);
                self.add(from);
            }
        }
        for vertex in snapped {
            let (fine, coarse) = (self.position(vertex), self.placed[vertex as usize]);
            if fine.map(f32::to_bits) != coarse.map(f32::to_bits) {
                self.places.push(Place { slot: self.slot[vertex as usize], fine, coarse });
            }
        }
        self.mark();
    }

    /// Returns the snapped vertices held by slots.
    fn snapped(&self) -> Vec<u32> {
        let vertices = self.sequence.snaps().iter().map(|snap| snap[0]);
        let is_there = |&v: &u32| self.holder.get(self.slot[v as usize] as usize) == Some(&v);
        vertices.filter(is_there).collect()
    }

    fn add(&mut self, vertex: u32) {
        self.slot[vertex as usize] = self.holder.len() as u32;
        self.holder.push(vertex);
        self.positions.push(self.position(vertex));
    }

    fn mark(&mut self) {
        self.vertices_after.push(self.holder.len() as u32);
        self.places_after.push(self.places.len() as u32);
    }

    fn is_born(&self, vertex: u32, step: usize) -> bool {
        let new = vertex.checked_sub(self.sequence.input_vertices() as u32);
        new.is_some_and(|new| self.birth[new as usize] as usize == step)
    }

    fn position(&self, vertex: u32) -> [f32; 3] {
        match self.sequence.origin(vertex) {
            Origin::Input(v) if self.unsnapped => self.mesh.positions()[v as usize],
            Origin::Input(v) => self.placed[v as usize],
            Origin::Blend(new) => new.position,
        }
    }
}

/// Returns the number of steps after which each triangle is gone, the triangles sorted by it in descending order, and
/// the number of triangles left after each number of steps. Degenerate triangles of the input count until the first
/// step.
fn order_triangles(
    mesh: &Mesh,
    collapse_forest: &CollapseForest,
    steps: usize,
) -> (Vec<u32>, Vec<u32>, Vec<u32>) {
    let last = if steps == 0 { NONE } else { 1 };
    let ends: Vec<u32> = (mesh.triangles().iter())
        .map(|&t| match collapse_forest.end(t) {
            0 => last,
            end => end,
        })
        .collect();
    let mut order: Vec<u32> = (0..ends.len() as u32).collect();
    order.sort_by_key(|&t| std::cmp::Reverse(ends[t as usize]));
    let left = |k: usize| order.partition_point(|&t| ends[t as usize] as usize > k) as u32;
    let after = (0..=steps).map(left).collect();
    (ends, order, after)
}
