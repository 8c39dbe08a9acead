//! The vertex buffer of an instance, and the current values of moving vertices.
//!
//! ```text
//!     opening   from where it was to its own place
//!     closing   from where it was to where its substitute is, which may be on its way itself
//! ```
//!
//! The value of a moving vertex is a blend of a start and a goal. To turn round, a vertex starts anew from its current
//! value, so nothing jumps. A closing vertex has reached its substitute before it is removed, so its removal is not
//! visible. A substitute which is a new vertex counts as drawn at its current or future place.
//!
//! Only moving vertices cost anything: entries are a list, with the entry's place per vertex.

use crate::adapt::{Dirty, DirtyRanges, Transition, Weights};
use crate::geometry::paged::{Paged, trim, trim_to};
use crate::lod::{Mix, Values, Vertex};
use crate::mesh::NONE;

use super::{CutSurface, VertexHierarchy};

#[derive(Debug, Clone)]
struct Entry<V> {
    vertex: u32,
    /// The split which brings the vertex. Its transition is the vertex's.
    split: u32,
    start: V,
    /// Current value.
    shown: V,
    /// Whether `shown` is up to date in this frame.
    done: bool,
}

/// Moving vertices.
#[derive(Debug, Clone)]
struct Moving<V> {
    mix: Mix<V>,
    /// Per vertex, its entry, or `NONE`.
    entry_of: Paged<u32, 6>,
    entries: Vec<Entry<V>>,
    /// Entries which wait for their substitutes.
    chain: Vec<u32>,
    /// Vertices which came to rest in this frame, after moving or at once.
    rested: Vec<u32>,
}

#[derive(Debug, Clone)]
pub(super) struct Vertices<V> {
    /// Values of all vertices at rest.
    values: Values<V>,
    /// Drawn values, per slot, or per vertex if vertices may move; `None` if `values` are drawn directly.
    drawn: Option<Vec<V>>,
    dirty: Dirty,
    /// Moving vertices; `None` if vertices jump.
    moving: Option<Moving<V>>,
    /// Whether `values`, if drawn directly, lie in a buffer for all instances.
    shared: bool,
}

impl<V: Vertex> Vertices<V> {
    /// Starts with all vertices at rest and to be uploaded. There must be as many `values` as vertices. `mix`: needed if
    /// vertices may move.
    pub fn new(values: Values<V>, surface: &CutSurface, mix: Option<Mix<V>>, shared: bool) -> Self {
        let count = values.len();
        let drawn = match (surface.vertices(), mix) {
            (Some(vertices), _) => Some(vertices.iter().map(|&vertex| values[vertex as usize]).collect()),
            (None, Some(_)) => Some(values.to_vec()),
            (None, None) => None,
        };
        let moving = mix.map(|mix| Moving {
            mix,
            entry_of: Paged::of(count, NONE),
            entries: Vec::new(),
            chain: Vec::new(),
            rested: Vec::new(),
        });
        let mut vertices = Self { values, drawn, dirty: Dirty::default(), moving, shared };
        vertices.invalidate();
        vertices
    }

    /// Returns the values of all vertices at rest.
    pub fn values(&self) -> &Values<V> {
        &self.values
    }

    /// Returns the contents of the buffer.
    pub fn drawn(&self) -> &[V] {
        self.drawn.as_deref().unwrap_or(&self.values)
    }

    /// Whether the buffer is the shared buffer of values.
    pub fn is_shared(&self) -> bool {
        self.shared && self.drawn.is_none()
    }

    /// Returns the current value of a vertex.
    pub fn shown(&self, vertex: u32) -> V {
        let entry = self.moving.as_ref().and_then(|moving| moving.entry(vertex));
        entry.map_or(self.values[vertex as usize], |entry| entry.shown)
    }

    /// Number of moving vertices.
    pub fn moving(&self) -> usize {
        self.moving.as_ref().map_or(0, |moving| moving.entries.len())
    }

    /// Moves all moving vertices to where the weights of their splits place them.
    pub fn advance(&mut self, hierarchy: &VertexHierarchy, weights: &Weights) {
        if let Some(moving) = &mut self.moving {
            moving.advance(hierarchy, &self.values, weights);
        }
    }

    /// Starts the vertices of a new split: at their substitutes if `smoothly`, else at their own places.
    #[inline]
    pub fn open(&mut self, hierarchy: &VertexHierarchy, split: u32, smoothly: bool) {
        if let Self { moving: Some(moving), values, .. } = self {
            moving.open(hierarchy, values, split, smoothly);
        }
    }

    /// Starts the vertices of a split anew from where they are, as their split's transition does.
    pub fn turn(&mut self, hierarchy: &VertexHierarchy, split: u32) {
        if let Self { moving: Some(moving), values, .. } = self {
            moving.turn(hierarchy, values, split);
        }
    }

    /// Forgets the motion of a removed split's vertices.
    #[inline]
    pub fn end(&mut self, hierarchy: &VertexHierarchy, split: u32) {
        if let Some(moving) = &mut self.moving {
            moving.end(hierarchy, split);
        }
    }

    /// Writes drawn values of vertices which moved, and of slots with another vertex.
    pub fn write(&mut self, surface: &mut CutSurface) {
        let Self { values, drawn: Some(drawn), dirty, moving, .. } = self else { return };
        if let Some(vertices) = surface.vertices() {
            drawn.truncate(vertices.len());
            for range in surface.dirty_vertices(0) {
                for slot in range {
                    let vertex = vertices[slot];
                    let value = moving
                        .as_ref()
                        .map_or(values[vertex as usize], |moving| moving.shown(values, vertex));
                    match drawn.get_mut(slot) {
                        Some(drawn) => *drawn = value,
                        None => drawn.push(value),
                    }
                    dirty.mark(slot as u32);
                }
            }
        }
        if let Some(moving) = moving {
            let on_their_way = moving.entries.iter().map(|entry| entry.vertex);
            for vertex in moving.rested.iter().copied().chain(on_their_way) {
                // Without slots, also write vertices not in use: they may come into use without notice.
                let slot = if surface.vertices().is_none() { Some(vertex) } else { surface.slot(vertex) };
                if let Some((slot, drawn)) = slot.and_then(|slot| Some((slot, drawn.get_mut(slot as usize)?)))
                {
                    *drawn = moving.shown(values, vertex);
                    dirty.mark(slot);
                }
            }
            moving.rested.clear();
            moving.entry_of.sweep();
        }
        surface.clean_vertices();
    }

    /// Gives back memory if most of it is not in use.
    pub fn trim(&mut self, surface: &CutSurface) {
        if let Some(drawn) = &mut self.drawn {
            trim(drawn);
            self.dirty.trim(drawn.len());
        }
        if let Some(moving) = &mut self.moving {
            trim_to(&mut moving.entries, surface.triangle_count());
            moving.entry_of.trim();
        }
    }

    pub fn dirty(&self, gap: usize) -> DirtyRanges<'_> {
        self.dirty.ranges(self.drawn().len(), gap)
    }

    pub fn clean(&mut self) {
        self.dirty.clear();
    }

    /// Marks the whole buffer as written, unless it is shared.
    pub fn invalidate(&mut self) {
        self.dirty.clear();
        if !self.is_shared() {
            self.dirty.mark_all(self.drawn().len());
        }
    }

    /// Bytes of the arrays, except the values at rest.
    pub fn memory(&self) -> usize {
        let moving = self
            .moving
            .as_ref()
            .map_or(0, |moving| moving.entry_of.memory() + moving.entries.capacity() * size_of::<Entry<V>>());
        self.drawn.as_ref().map_or(0, |drawn| drawn.capacity() * size_of::<V>())
            + self.dirty.memory()
            + moving
    }
}

impl<V: Vertex> Moving<V> {
    fn entry(&self, vertex: u32) -> Option<&Entry<V>> {
        self.entries.get(self.entry_of.at(vertex) as usize)
    }

    fn shown(&self, values: &[V], vertex: u32) -> V {
        self.entry(vertex).map_or(values[vertex as usize], |entry| entry.shown)
    }

    fn start(&mut self, split: u32, vertex: u32, from: V) {
        let entry = Entry { vertex, split, start: from, shown: from, done: true };
        match self.entry_of.at(vertex) {
            NONE => {
                *self.entry_of.entry(vertex) = self.entries.len() as u32;
                self.entries.push(entry);
            }
            at => self.entries[at as usize] = entry,
        }
    }

    fn remove(&mut self, vertex: u32) {
        let at = self.entry_of.rest(vertex);
        if at != NONE {
            self.entries.swap_remove(at as usize);
            if let Some(moved) = self.entries.get(at as usize) {
                *self.entry_of.entry(moved.vertex) = at;
            }
        }
    }

    fn open(&mut self, hierarchy: &VertexHierarchy, values: &[V], split: u32, smoothly: bool) {
        // In reverse, because a vertex taken later may be the substitute at which an earlier vertex starts.
        for &vertex in hierarchy.brings.get(split).iter().rev() {
            if smoothly {
                let from = self.shown(values, hierarchy.substitute[vertex as usize]);
                self.start(split, vertex, from);
            } else {
                self.remove(vertex);
                self.rested.push(vertex);
            }
        }
    }

    fn turn(&mut self, hierarchy: &VertexHierarchy, values: &[V], split: u32) {
        for &vertex in hierarchy.brings.get(split) {
            let from = self.shown(values, vertex);
            self.start(split, vertex, from);
        }
    }

    fn end(&mut self, hierarchy: &VertexHierarchy, split: u32) {
        hierarchy.brings.get(split).iter().for_each(|&vertex| self.remove(vertex));
    }

    /// Computes the current value of an entry. If the entry moves to its substitute, computes the substitute's value
    /// first.
    fn find(&mut self, hierarchy: &VertexHierarchy, values: &[V], weights: &Weights, mut at: u32) {
        loop {
            let Entry { vertex, split, .. } = self.entries[at as usize];
            let transition = weights.of(split);
            let mut goal = values[vertex as usize];
            if transition.is_some_and(Transition::is_closing) {
                let substitute = hierarchy.substitute[vertex as usize];
                let next = self.entry_of.at(substitute);
                goal = match self.entries.get(next as usize) {
                    Some(entry) if !entry.done => {
                        self.chain.push(at);
                        at = next;
                        continue;
                    }
                    Some(entry) => entry.shown,
                    None => values[substitute as usize],
                };
            }
            let share = transition.map_or(1.0, |transition| transition.share);
            let entry = &mut self.entries[at as usize];
            entry.shown = (self.mix.blend)(&entry.start, &goal, share);
            entry.done = true;
            let Some(waiting) = self.chain.pop() else { return };
            at = waiting;
        }
    }

    fn advance(&mut self, hierarchy: &VertexHierarchy, values: &[V], weights: &Weights) {
        self.entries.iter_mut().for_each(|entry| entry.done = false);
        for at in 0..self.entries.len() {
            if !self.entries[at].done {
                self.find(hierarchy, values, weights, at as u32);
            }
        }
        let there =
            weights.all().iter().filter(|transition| transition.is_over() && !transition.is_closing());
        for &vertex in there.flat_map(|transition| hierarchy.brings.get(transition.refinement)) {
            self.remove(vertex);
            self.rested.push(vertex);
        }
    }
}
