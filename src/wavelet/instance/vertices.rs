//! Positions (or other values) of vertices as drawn for a set of wavelets.
//!
//! ```text
//!     in the set        its own place, if all that it builds on is at its own; on its way (Azuma et al., equation 6)
//!                       the middle of its ends + weight x coefficient
//!     in use alone      the middle of its ends: on the surface, as if it were not there
//! ```
//!
//! Ends are of coarser levels, so going through levels in order places every vertex after its ends. Visited are only vertices
//! which came, went or move, and vertices whose ends did. At each finer level, a vertex is an end of an edge in every direction
//! (an *incident edge* and its inner halves).

use crate::adapt::{Dirty, DirtyRanges, Transition, Weights};
use crate::geometry::paged::Paged;
use crate::lod::{Mix, Values, Vertex};
use crate::mesh::NONE;
use crate::wavelet::subdivision::Subdivision;

use super::surface::WaveletSurface;

/// The wavelet is in the set.
const SET: u8 = 1;
/// The wavelet's vertices are at their own places.
const AT_REST: u8 = 2;
const QUEUED: u8 = 4;

/// Slots of the vertices in use. Freed slots are reused, so some slots may be unused.
#[derive(Debug, Clone)]
struct Slots {
    slot_of: Paged<u32, 8>,
    vertices: Vec<u32>,
    free: Vec<u32>,
}

#[derive(Debug, Clone)]
pub(crate) struct Vertices<V> {
    /// Values of all vertices at their own places.
    values: Values<V>,
    /// Blending of values; `None` if vertices are drawn only at their own places.
    mix: Option<Mix<V>>,
    /// Values as drawn, per vertex or per slot.
    drawn: Vec<V>,
    dirty: Dirty,
    slots: Option<Slots>,
    state: Paged<u8, 8>,
    /// Wavelets to visit, by level.
    queue: Vec<Vec<u32>>,
}

impl<V: Vertex> Vertices<V> {
    /// Starts with the base mesh.
    pub fn new(of: &Subdivision, values: Values<V>, packed: bool) -> Self {
        let base = of.base_vertex_count();
        let slots = packed.then(|| {
            let mut slot_of = Paged::of(of.vertex_count(), NONE);
            (0..base as u32).for_each(|v| *slot_of.entry(v) = v);
            Slots { slot_of, vertices: (0..base as u32).collect(), free: Vec::new() }
        });
        let drawn = if packed { values[..base].to_vec() } else { values.to_vec() };
        let mut dirty = Dirty::default();
        dirty.mark_all(drawn.len());
        Self {
            mix: values.mix(),
            values,
            drawn,
            dirty,
            slots,
            state: Paged::of(of.wavelet_count(), 0),
            queue: vec![Vec::new(); of.depth()],
        }
    }

    /// Returns the index of a vertex in use as drawn: the vertex or its slot.
    #[inline]
    pub fn name(&self, vertex: u32) -> u32 {
        self.slots.as_ref().map_or(vertex, |slots| slots.slot_of.at(vertex))
    }

    /// Adds a wavelet to the set or removes it.
    pub fn set(&mut self, wavelet: u32, comes: bool) {
        let state = self.state.entry(wavelet);
        *state = if comes { *state | SET } else { *state & !SET };
    }

    /// Visits all wavelets in transition.
    pub fn advance(&mut self, of: &Subdivision, weights: &Weights) {
        weights.all().iter().for_each(|transition| self.enqueue(of, transition.refinement));
    }

    fn weight(&self, weights: &Weights, wavelet: u32) -> f32 {
        let at_rest = || f32::from(self.state.at(wavelet) & SET != 0);
        weights.of(wavelet).map_or_else(at_rest, Transition::weight)
    }

    fn enqueue(&mut self, of: &Subdivision, wavelet: u32) {
        let state = self.state.entry(wavelet);
        if *state & QUEUED == 0 {
            *state |= QUEUED;
            self.queue[of.level_of(wavelet) - 1].push(wavelet);
        }
    }

    /// Updates all changed vertices to where they are drawn. Must run before the surface is written.
    pub fn update(&mut self, of: &Subdivision, surface: &WaveletSurface, weights: &Weights) {
        for &wavelet in surface.changed() {
            if surface.uses().is_used(wavelet) {
                self.enqueue(of, wavelet);
            } else {
                *self.state.entry(wavelet) &= !AT_REST;
                self.release(of.vertex_of(wavelet));
                of.seam_vertices_of(wavelet).for_each(|vertex| self.release(vertex));
            }
        }
        for level in 0..self.queue.len() {
            let mut at = 0;
            while let Some(&wavelet) = self.queue[level].get(at) {
                at += 1;
                *self.state.entry(wavelet) &= !QUEUED;
                if surface.uses().is_used(wavelet) && self.place(of, weights, wavelet) {
                    self.wake_dependents(of, surface, wavelet);
                }
            }
            self.queue[level].clear();
        }
        self.state.sweep();
        if let Some(slots) = &mut self.slots {
            slots.slot_of.sweep();
        }
    }

    /// Places a wavelet's vertices; returns whether they may have moved.
    fn place(&mut self, of: &Subdivision, weights: &Weights, wavelet: u32) -> bool {
        let weight = self.weight(weights, wavelet);
        let was_at_rest = self.state.at(wavelet) & AT_REST != 0;
        let mut at_rest = weight == 1.0;
        let own = of.vertex_of(wavelet);
        for vertex in std::iter::once(own).chain(of.seam_vertices_of(wavelet)) {
            let Some(ends) = of.ends(vertex) else { continue };
            at_rest &= ends.iter().all(|&end| self.is_at_rest(of, end));
        }
        for vertex in std::iter::once(own).chain(of.seam_vertices_of(wavelet)) {
            let Some(ends) = of.ends(vertex) else { continue };
            let own = self.values[vertex as usize];
            let value = match self.mix.filter(|_| !at_rest) {
                None => own,
                Some(Mix { blend, moved }) => {
                    let [a, b] = ends.map(|end| self.drawn[self.name(end) as usize]);
                    let middle = blend(&a, &b, 0.5);
                    if weight > 0.0 {
                        let [a, b] = ends.map(|end| self.values[end as usize]);
                        moved(&middle, &blend(&a, &b, 0.5), &own, weight)
                    } else {
                        middle
                    }
                }
            };
            self.draw(vertex, value, at_rest && was_at_rest);
        }
        let state = self.state.entry(wavelet);
        *state = if at_rest { *state | AT_REST } else { *state & !AT_REST };
        !(at_rest && was_at_rest)
    }

    fn is_at_rest(&self, of: &Subdivision, vertex: u32) -> bool {
        of.wavelet_of(vertex).is_none_or(|wavelet| self.state.at(wavelet) & AT_REST != 0)
    }

    fn draw(&mut self, vertex: u32, value: V, is_there: bool) {
        let slot = match &mut self.slots {
            None => vertex,
            Some(slots) => match slots.slot_of.at(vertex) {
                NONE => {
                    let slot = slots.free.pop().unwrap_or(slots.vertices.len() as u32);
                    *slots.slot_of.entry(vertex) = slot;
                    match slots.vertices.get_mut(slot as usize) {
                        Some(there) => *there = vertex,
                        None => {
                            slots.vertices.push(vertex);
                            self.drawn.push(value);
                            self.dirty.mark(slot);
                        }
                    }
                    slot
                }
                slot => slot,
            },
        };
        // A vertex at rest before and now is not written again.
        let drawn = &mut self.drawn[slot as usize];
        if !is_there && bytemuck::bytes_of(drawn) != bytemuck::bytes_of(&value) {
            *drawn = value;
            self.dirty.mark(slot);
        }
    }

    fn release(&mut self, vertex: u32) {
        if let Some(slots) = &mut self.slots {
            let slot = slots.slot_of.rest(vertex);
            if slot != NONE {
                slots.free.push(slot);
            }
        }
    }

    fn wake_dependents(&mut self, of: &Subdivision, surface: &WaveletSurface, wavelet: u32) {
        for (incident, starts) in of.incident_edges(wavelet) {
            let mut incident = incident;
            while incident != NONE && surface.uses().is_used(incident) {
                self.enqueue(of, incident);
                incident = of.halves(incident)[usize::from(!starts)];
            }
        }
    }

    /// Values at their own places, to be changed, or replaced by as many values; call [`Vertices::revalue`] afterwards.
    pub fn own_values(&mut self) -> &mut Values<V> {
        &mut self.values
    }

    /// Values at their own places.
    pub fn values_at_rest(&self) -> &Values<V> {
        &self.values
    }

    /// Marks all values as changed.
    pub fn invalidate(&mut self) {
        self.dirty.mark_all(self.drawn.len());
    }

    /// Handles new values of vertices at their own places: redraws the vertices and all vertices depending on them.
    pub fn revalue(&mut self, of: &Subdivision, surface: &WaveletSurface, changed: &[u32]) {
        let mut corners: Vec<u32> = Vec::new();
        for &vertex in changed {
            let Some(wavelet) = of.wavelet_of(vertex) else {
                corners.push(vertex);
                continue;
            };
            if surface.uses().is_used(wavelet) {
                // Otherwise the vertex would count as drawn already.
                *self.state.entry(wavelet) &= !AT_REST;
                self.enqueue(of, wavelet);
            }
            // Dependent vertices in transition use a vertex's own place even where it is drawn elsewhere.
            self.wake_dependents(of, surface, wavelet);
        }
        corners.sort_unstable();
        corners.dedup();
        for &vertex in &corners {
            self.draw(vertex, self.values[vertex as usize], false);
        }
        if corners.is_empty() {
            return;
        }
        let is_changed = |vertex: u32| corners.binary_search(&vertex).is_ok();
        for face in 0..of.base_face_count() as u32 {
            let ends = of.corners(face).map(is_changed);
            for k in (0..3).filter(|&k| ends[k] || ends[(k + 1) % 3]) {
                let (wavelet, against) = of.side(face, k);
                let ends = [ends[k], ends[(k + 1) % 3]];
                for end in (0..2).filter(|&end| ends[end]) {
                    let mut incident = wavelet;
                    while incident != NONE && surface.uses().is_used(incident) {
                        self.enqueue(of, incident);
                        incident = of.halves(incident)[end ^ usize::from(against)];
                    }
                }
            }
        }
    }

    /// Values as drawn.
    pub fn drawn(&self) -> &[V] {
        &self.drawn
    }

    /// Returns the value of a vertex as drawn; at its own place if it is not drawn.
    pub fn value(&self, surface: &WaveletSurface, of: &Subdivision, vertex: u32) -> V {
        match of.wavelet_of(vertex) {
            Some(wavelet) if !surface.uses().is_used(wavelet) => self.values[vertex as usize],
            _ => self.drawn[self.name(vertex) as usize],
        }
    }

    /// Whether a wavelet is in the set.
    #[inline]
    pub fn is_set(&self, wavelet: u32) -> bool {
        self.state.at(wavelet) & SET != 0
    }

    /// The vertex in every slot; `None` if vertices are not packed.
    pub fn vertices(&self) -> Option<&[u32]> {
        self.slots.as_ref().map(|slots| &slots.vertices[..])
    }

    pub fn dirty(&self, gap: usize) -> DirtyRanges<'_> {
        self.dirty.ranges(self.drawn.len(), gap)
    }

    pub fn clean(&mut self) {
        self.dirty.clear();
    }

    /// Gives back memory if most of it is not in use.
    pub fn trim(&mut self) {
        self.state.trim();
        if let Some(slots) = &mut self.slots {
            slots.slot_of.trim();
        }
    }

    /// Bytes of its arrays, without the values at their own places.
    pub fn memory(&self) -> usize {
        let slots = self.slots.as_ref().map_or(0, |slots| {
            slots.slot_of.memory() + (slots.vertices.capacity() + slots.free.capacity()) * size_of::<u32>()
        });
        self.drawn.capacity() * size_of::<V>() + self.dirty.memory() + self.state.memory() + slots
    }
}
