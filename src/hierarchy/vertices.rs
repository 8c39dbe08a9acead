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
//! A vertex of the same point as its substitute (a wedge that was joined to another) has no way of its own: it goes the way of its
//! substitute, with its own values, and only the share of these grows. So all vertices of a point are at one place at every moment.
//!
//! Only moving vertices cost anything: entries are a list, with the entry's place per vertex.

use crate::adapt::{Dirty, DirtyRanges, Transition, Weights};
use crate::geometry::paged::{Paged, trim, trim_to};
use crate::lod::{Mix, Values, Vertex};
use crate::mesh::{Mesh, NONE};

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
    /// Number of the motion: another one whenever it starts anew. A joined vertex has that of its substitute.
    motion: u32,
    /// End of the way: `None` for the vertex's own place.
    goal: Option<V>,
    /// Share of the way travelled.
    share: f32,
    joined: Option<Joined<V>>,
}

/// A moving vertex of the same point as its substitute.
#[derive(Debug, Clone, Copy)]
struct Joined<V> {
    /// Start of the way that it would go by its substitute's motion, and where it is on this way.
    start: V,
    shown: V,
    /// Motion of the substitute that `start` is the start of; `NONE` at rest.
    motion: u32,
}

impl<V: Vertex> Entry<V> {
    /// Returns the start of the way, at the place where the ways of all vertices of the point start.
    fn way_start(&self) -> V {
        self.joined.map_or(self.start, |joined| joined.start)
    }
}

/// Moving vertices.
#[derive(Debug, Clone)]
struct Moving<V> {
    mix: Mix<V>,
    /// Per vertex, its entry, or `NONE`.
    entry_of: Paged<u32, 6>,
    entries: Vec<Entry<V>>,
    /// Number of motions so far.
    motions: u32,
    /// The structure's own vertices: they tell which vertices share a point.
    places: Option<Mesh>,
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
    /// vertices may move. `places`: the structure's own vertices.
    pub fn new(
        values: Values<V>,
        places: Option<&Mesh>,
        surface: &CutSurface,
        mix: Option<Mix<V>>,
        shared: bool,
    ) -> Self {
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
            motions: 0,
            places: places.cloned(),
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

    /// Starts a vertex of a split from a value. `opens`: it comes in, else it turns round or goes out.
    fn start(
        &mut self,
        (hierarchy, values): (&VertexHierarchy, &[V]),
        (split, vertex): (u32, u32),
        from: V,
        opens: bool,
    ) {
        self.motions = self.motions.wrapping_add(1) % NONE;
        let at = self.entry_of.at(vertex);
        let known = self.entries.get(at as usize).and_then(|entry| entry.joined);
        let own = values[vertex as usize];
        let joined = known.or_else(|| {
            let substitute = hierarchy.substitute[vertex as usize];
            let on_its_way = self.entry(substitute).filter(|_| opens);
            self.shares_point(vertex, substitute).then(|| match on_its_way {
                Some(entry) => Joined { start: entry.way_start(), shown: entry.shown, motion: entry.motion },
                None => Joined { start: own, shown: own, motion: NONE },
            })
        });
        let motion = self.motions;
        let entry = Entry {
            vertex,
            split,
            start: from,
            shown: from,
            done: true,
            motion,
            goal: None,
            share: 0.0,
            joined,
        };
        if at == NONE {
            *self.entry_of.entry(vertex) = self.entries.len() as u32;
            self.entries.push(entry);
        } else {
            self.entries[at as usize] = entry;
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

    /// Whether a vertex has the point of its substitute.
    fn shares_point(&self, vertex: u32, substitute: u32) -> bool {
        let places = self.places.as_ref().map(Mesh::positions);
        let [a, b] = [vertex, substitute].map(|v| places.and_then(|places| places.get(v as usize)));
        a.is_some() && a == b
    }

    fn open(&mut self, hierarchy: &VertexHierarchy, values: &[V], split: u32, smoothly: bool) {
        // In reverse, because a vertex taken later may be the substitute at which an earlier vertex starts.
        for &vertex in hierarchy.brings.get(split).iter().rev() {
            let substitute = hierarchy.substitute[vertex as usize];
            // Its point may be on its way, seen or not.
            let goes_along = self.entry(substitute).is_some() && self.shares_point(vertex, substitute);
            if smoothly || goes_along {
                let from = self.shown(values, substitute);
                self.start((hierarchy, values), (split, vertex), from, true);
            } else {
                self.remove(vertex);
                self.rested.push(vertex);
            }
        }
    }

    fn turn(&mut self, hierarchy: &VertexHierarchy, values: &[V], split: u32) {
        for &vertex in hierarchy.brings.get(split) {
            let from = self.shown(values, vertex);
            self.start((hierarchy, values), (split, vertex), from, false);
        }
    }

    fn end(&mut self, hierarchy: &VertexHierarchy, split: u32) {
        hierarchy.brings.get(split).iter().for_each(|&vertex| self.remove(vertex));
    }

    /// Computes the current value of an entry. If the entry moves to its substitute or with it, computes the substitute's
    /// value first.
    fn find(&mut self, hierarchy: &VertexHierarchy, values: &[V], weights: &Weights, mut at: u32) {
        loop {
            let Entry { vertex, split, joined, .. } = self.entries[at as usize];
            let transition = weights.of(split);
            let substitute = hierarchy.substitute[vertex as usize];
            let closes = transition.is_some_and(Transition::is_closing);
            let next = if closes || joined.is_some() { self.entry_of.at(substitute) } else { NONE };
            let of_substitute = self.entries.get(next as usize);
            if of_substitute.is_some_and(|entry| !entry.done) {
                self.chain.push(at);
                at = next;
                continue;
            }
            if let Some(joined) = joined {
                let (own, other) = (values[vertex as usize], values[substitute as usize]);
                let weight = transition.map_or(1.0, Transition::weight);
                self.go_along(at, joined, (own, other), next, weight);
            } else {
                let there = || of_substitute.map_or(values[substitute as usize], |entry| entry.shown);
                let goal = closes.then(there);
                let share = transition.map_or(1.0, |transition| transition.share);
                let entry = &mut self.entries[at as usize];
                let to = goal.unwrap_or(values[vertex as usize]);
                entry.shown = (self.mix.blend)(&entry.start, &to, share);
                (entry.goal, entry.share, entry.done) = (goal, share, true);
            }
            let Some(waiting) = self.chain.pop() else { return };
            at = waiting;
        }
    }

    /// Computes the value of a joined vertex, of weight `weight`. `next`: its substitute's entry; `own`, `other`: values of both at
    /// rest.
    fn go_along(&mut self, at: u32, mut joined: Joined<V>, (own, other): (V, V), next: u32, weight: f32) {
        let blend = self.mix.blend;
        let (shown, goal, share) = match self.entries.get(next as usize) {
            Some(substitute) => {
                if joined.motion != substitute.motion {
                    (joined.start, joined.motion) = (joined.shown, substitute.motion);
                }
                joined.shown = blend(&joined.start, &substitute.goal.unwrap_or(own), substitute.share);
                (substitute.shown, substitute.goal, substitute.share)
            }
            None => {
                (joined.shown, joined.motion) = (own, NONE);
                (other, None, 1.0)
            }
        };
        let entry = &mut self.entries[at as usize];
        entry.shown = blend(&shown, &joined.shown, weight);
        (entry.goal, entry.share, entry.done) = (goal, share, true);
        (entry.motion, entry.joined) = (joined.motion, Some(joined));
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
            if self.entry(vertex).is_none_or(|entry| entry.joined.is_none()) {
                self.remove(vertex);
                self.rested.push(vertex);
            }
        }
        self.rest_joined(hierarchy, weights);
    }

    /// Forgets the motion of joined vertices which have come in and whose substitutes are at rest.
    fn rest_joined(&mut self, hierarchy: &VertexHierarchy, weights: &Weights) {
        loop {
            let before = self.entries.len();
            for at in (0..before).rev() {
                let Some(&Entry { vertex, split, joined: Some(_), .. }) = self.entries.get(at) else {
                    continue;
                };
                let is_in = weights.of(split).is_none_or(|own| own.is_over() && !own.is_closing());
                if is_in && self.entry(hierarchy.substitute[vertex as usize]).is_none() {
                    self.remove(vertex);
                    self.rested.push(vertex);
                }
            }
            if self.entries.len() == before {
                return;
            }
        }
    }
}
