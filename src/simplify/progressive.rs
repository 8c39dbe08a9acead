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
//! Hoppe, *Progressive Meshes* (1996); Southern, section 3.3. Where the paper finds the fan of `l` by its first and last
//! face, which needs a manifold, the corners that move are listed, so any mesh will do. Positions are stored, not
//! differences, so that nothing is lost to rounding. Placement may be any; a step may split several wedges at once.
//!
//! Slots are in order of refinement: a level is a prefix of the vertices and of the triangles. What lies beyond waits in
//! the state in which it comes back, so a split writes the corners that move, and nothing else.

use std::borrow::Cow;
use std::ops::Range;

use crate::mesh::{Mesh, NONE};

use super::collapse_forest::CollapseForest;
use super::{CollapseSequence, Origin, SequenceError};

/// A base mesh with the vertex splits that refine it to the input, and the level it is at.
///
/// Holds everything it needs: positions of every level, but no attributes; carry those along by
/// [`ProgressiveMesh::vertex_order`]. Levels are counted as in the sequence: after 0 steps it is the input.
/// Serde keeps the level, and validates ([`ProgressiveMesh::validate`]).
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "super::progressive_check::Parts"))]
pub struct ProgressiveMesh {
    pub(super) positions: Vec<[f32; 3]>,
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) vertex_order: Vec<u32>,
    pub(super) triangle_order: Vec<u32>,
    /// Vertices, triangles and places after so many steps; one more than steps. Those of a step lie between the counts
    /// after it and before it.
    pub(super) vertices_after: Vec<u32>,
    pub(super) triangles_after: Vec<u32>,
    pub(super) places_after: Vec<u32>,
    /// `[k, l]` of all steps, `l` counting up from the base.
    pub(super) parted: Vec<[u32; 2]>,
    /// Per `[k, l]` where its corners start; one more than those.
    pub(super) corner_start: Vec<u32>,
    pub(super) corners: Vec<u32>,
    pub(super) places: Vec<Place>,
    pub(super) batches: Vec<u32>,
    pub(super) steps: usize,
}

/// A slot that lies elsewhere before a step than after it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Place {
    pub slot: u32,
    pub fine: [f32; 3],
    pub coarse: [f32; 3],
}

/// One vertex split (Southern 3.3), the inverse of one step.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct VertexSplit<'a> {
    /// The slots that part, `[k, l]`: `k` stays and `l` comes. One pair per wedge; none where only positions change. `l`
    /// counts up from the vertices before the split. A vertex that nothing uses comes from itself, `[l, l]`.
    pub parted: &'a [[u32; 2]],
    /// The first triangle that comes (the start face).
    pub first_triangle: u32,
    /// How many triangles come, two on a closed manifold.
    pub triangles: u32,
}

impl ProgressiveMesh {
    /// Builds the splits from a mesh and any simplification of it; at the base mesh afterwards.
    /// O((vertices + triangles) log vertices + corners that move).
    ///
    /// # Errors
    /// The sequence belongs to another mesh or does not hold together.
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

    /// Whether the input is the base mesh.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Steps away from the input: 0 at full resolution.
    pub fn steps(&self) -> usize {
        self.steps
    }

    /// Positions at the current level, object units, one per slot.
    pub fn positions(&self) -> &[[f32; 3]] {
        &self.positions[..self.vertices_after[self.steps] as usize]
    }

    /// Triangles at the current level, indices of slots.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles[..self.triangles_after[self.steps] as usize]
    }

    /// The input vertex in every slot at full resolution, a permutation: all input vertices, bit for bit.
    pub fn vertex_order(&self) -> &[u32] {
        &self.vertex_order
    }

    /// The input triangle at every place, a permutation.
    pub fn triangle_order(&self) -> &[u32] {
        &self.triangle_order
    }

    /// Steps done at the end of each batch, as in [`CollapseSequence::batches`]: going finer, a batch ends where the
    /// steps left reach the number before it.
    pub fn batches(&self) -> &[u32] {
        &self.batches
    }

    /// The split that undoes a step; `None` where there is no such step.
    pub fn split(&self, step: usize) -> Option<VertexSplit<'_>> {
        (step < self.len()).then(|| VertexSplit {
            parted: &self.parted[self.parted_range(step)],
            first_triangle: self.triangles_after[step + 1],
            triangles: self.triangles_after[step] - self.triangles_after[step + 1],
        })
    }

    /// Corners (three times the triangle and 0 to 2) that go from `k` to `l` in the split that undoes a step, for one of
    /// its `parted` pairs; empty where there is no such pair.
    pub fn moved_corners(&self, step: usize, pair: usize) -> &[u32] {
        let pairs = if step < self.len() { self.parted_range(step) } else { 0..0 };
        if pair < pairs.len() { &self.corners[self.corner_range(pairs.start + pair)] } else { &[] }
    }

    /// Where slots lie before and after a step that moved them: `(slot, finer, coarser)`. Empty with endpoint placement.
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

    /// Undoes one step; false at full resolution. O(corners that move).
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

    /// Does one step again; false at the base mesh. O(corners that move).
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

    /// Goes to the level after `steps` steps, or to the base mesh if there are fewer. O(corners that move between).
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

    /// Follows every corner from the input down to the level at which its triangle vanishes: lists it with the pairs
    /// that move it, and leaves it in the slot that it holds last.
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
                // The triangle is still there after the step that joins this slot to another.
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
        for i in 1..count.len() {
            count[i] += count[i - 1];
        }
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

/// Slots given out from the base up, one step at a time.
struct Slots<'a> {
    mesh: &'a Mesh,
    sequence: &'a CollapseSequence,
    /// Positions of the input's vertices as snapped, and whether that is undone.
    placed: Cow<'a, [[f32; 3]]>,
    unsnapped: bool,
    /// The step that makes each new vertex.
    birth: Vec<u32>,
    /// Vertices of the input that nothing uses: they come with the last split.
    unused: &'a [u32],
    /// Per vertex of the sequence the slot it is in, or would be in.
    slot: Vec<u32>,
    /// Per slot the vertex in it.
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

    /// Undoes a step: of the vertices that it made one, the first takes the slot, unless the kept one has it, and the
    /// others get slots of their own.
    fn refine(&mut self, step: usize) {
        let sequence = self.sequence;
        let folds = if step == 0 { sequence.aliases() } else { &[] };
        // Undoing the first step undoes snapping too.
        let snapped: Vec<u32> = if step == 0 { self.snapped() } else { Vec::new() };
        self.unsnapped = step == 0;
        let substitutions = sequence.substitutions(step);
        // First, since they may have duplicates, which part from them.
        if step == 0 {
            for &v in self.unused.iter().filter(|&&v| (v as usize) < sequence.input_vertices()) {
                self.parted.push([self.holder.len() as u32; 2]);
                self.add(v);
            }
        }
        // Last first: the slot of each target is then known, even if the same step does away with it.
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

    /// The snapped vertices that are in slots.
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

/// Per triangle the steps after which it is gone, the triangles last vanishing first, and how many are left after each
/// number of steps. Here a degenerate triangle of the input is there until the first step.
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
