//! The mesh at a cut: triangles in a dense buffer, updated by splits and collapses.
//!
//! ```text
//!     split     some corners of a star go to the vertex that comes back (one comparison each), and the triangles that
//!               vanished with its collapse come back
//!     collapse  the other way round; a triangle's place in the buffer is taken by the last one
//! ```
//!
//! Source: the image of the input's triangles under a cut (Kim and Lee 2001 for the freedom of the cut). Leaves are
//! numbered depth first, so a vertex takes exactly the leaves from its own number on.

use crate::adapt::{Dirty, DirtyRanges};
use crate::geometry::paged::{Paged, trim};
use crate::mesh::NONE;

use super::VertexHierarchy;
use super::slots::Slots;
use super::stars::{CornerStars, Entry};

/// The splits and triangles that a surface is made of: of a hierarchy, or of the part of it that has arrived.
pub(crate) trait SplitSource {
    /// Returns the vertices brought by a split, in the order of the collapse: vertex, substitute and first leaf.
    fn brought(&self, split: u32) -> impl DoubleEndedIterator<Item = [u32; 3]>;
    /// Returns the triangles brought back by a split.
    fn owned(&self, split: u32) -> std::ops::Range<u32>;
    /// Returns a triangle's corners at full resolution.
    fn leaves(&self, triangle: u32) -> [u32; 3];
    /// Returns the group of a triangle.
    fn group_of(&self, triangle: u32) -> usize;
    /// Returns the vertex representing a leaf, for the closed set of splits given by `there`.
    fn active(&self, leaf: u32, there: impl Fn(u32) -> bool) -> u32;
}

impl SplitSource for VertexHierarchy {
    #[inline]
    fn brought(&self, split: u32) -> impl DoubleEndedIterator<Item = [u32; 3]> {
        let brings = self.brings.get(split).iter();
        brings.map(|&vertex| [vertex, self.substitute[vertex as usize], self.first_leaf(vertex)])
    }

    #[inline]
    fn owned(&self, split: u32) -> std::ops::Range<u32> {
        self.owned(split)
    }

    #[inline]
    fn leaves(&self, triangle: u32) -> [u32; 3] {
        self.triangles[triangle as usize]
    }

    #[inline]
    fn group_of(&self, triangle: u32) -> usize {
        self.group_of(triangle)
    }

    #[inline]
    fn active(&self, leaf: u32, there: impl Fn(u32) -> bool) -> u32 {
        self.active(leaf, there)
    }
}

/// The triangles at a cut, and if vertices are packed, the vertices in use. Splits and collapses cost O(moved corners),
/// and allocate only when buffers grow.
#[derive(Debug, Clone)]
pub struct CutSurface {
    pub(super) stars: CornerStars,
    pub(super) output: Output,
    /// During a collapse, vertices which may have lost their last corner, and the vertices that go and their substitutes, with
    /// their slots.
    loose: Vec<u32>,
    moves: Vec<[[u32; 2]; 2]>,
}

/// The buffers to draw.
#[derive(Debug, Clone)]
pub(super) struct Output {
    /// Per triangle, its place in its group, or `NONE`.
    pub place: Paged<u32, 9>,
    /// A group per material.
    pub groups: Vec<Group>,
    /// Slots of vertices in use, by which corners name them; `None` if corners name vertices themselves.
    pub slots: Option<Slots>,
}

#[derive(Debug, Clone, Default)]
pub(super) struct Group {
    pub indices: Vec<[u32; 3]>,
    /// Per place, its triangle.
    drawn: Vec<u32>,
    dirty: Dirty,
}

impl Output {
    /// Sets the name (slot or vertex) of a drawn triangle's corner.
    #[inline]
    fn write(&mut self, source: &impl SplitSource, corner: u32, name: u32) {
        let triangle = corner / 3;
        let group = &mut self.groups[source.group_of(triangle)];
        let at = self.place.at(triangle);
        group.indices[at as usize][(corner % 3) as usize] = name;
        group.dirty.mark(at);
    }

    /// Removes a triangle from its group. Returns the names of its corners.
    fn hide(&mut self, source: &impl SplitSource, triangle: u32) -> [u32; 3] {
        let group = &mut self.groups[source.group_of(triangle)];
        let at = self.place.rest(triangle);
        let names = group.indices.swap_remove(at as usize);
        group.drawn.swap_remove(at as usize);
        if let Some(&last) = group.drawn.get(at as usize) {
            *self.place.entry(last) = at;
            group.dirty.mark(at);
        }
        names
    }

    /// Returns the name of a vertex: its slot, or `NONE` if it has no slot, or the vertex itself.
    #[inline]
    pub fn name(&self, vertex: u32) -> u32 {
        self.slots.as_ref().map_or(vertex, |slots| slots.slot(vertex))
    }

    /// Returns the name of a vertex, after assigning a slot if it has none.
    #[inline]
    fn take(&mut self, vertex: u32) -> u32 {
        self.slots.as_mut().map_or(vertex, |slots| slots.take(vertex))
    }
}

impl CutSurface {
    /// Creates the coarsest mesh. With `packed`, corners name slots of [`CutSurface::vertices`]; without, vertices of the
    /// hierarchy.
    pub fn new(hierarchy: &VertexHierarchy, packed: bool) -> Self {
        let output = Output {
            place: Paged::of(hierarchy.triangle_count(), NONE),
            groups: vec![Group::default(); hierarchy.materials().len().max(1)],
            slots: packed.then(|| Slots::new(hierarchy.vertex_count())),
        };
        let stars = CornerStars::new(if packed { 0 } else { hierarchy.vertex_count() });
        let mut surface = Self { stars, output, loose: Vec::new(), moves: Vec::new() };
        for triangle in 0..hierarchy.first_triangle[0] {
            surface.show(hierarchy, triangle, |_| false);
        }
        surface
    }

    /// Creates an empty mesh, with packed vertices.
    #[cfg(feature = "stream")]
    pub(crate) fn empty(groups: usize) -> Self {
        let output = Output {
            place: Paged::new(NONE),
            groups: vec![Group::default(); groups.max(1)],
            slots: Some(Slots::new(0)),
        };
        Self { stars: CornerStars::new(0), output, loose: Vec::new(), moves: Vec::new() }
    }

    /// Makes room for vertices and triangles of numbers up to these.
    #[cfg(feature = "stream")]
    pub(crate) fn reach(&mut self, vertices: usize, triangles: usize) {
        if let Some(slots) = &mut self.output.slots {
            slots.reach(vertices);
        }
        self.output.place.reach(triangles);
    }

    /// Creates the mesh of a set of splits, closed under parents.
    pub(super) fn at(hierarchy: &VertexHierarchy, packed: bool, shows: impl Fn(u32) -> bool) -> Self {
        let mut surface = Self::new(hierarchy, packed);
        // Parents come first.
        for split in (0..hierarchy.split_count() as u32).filter(|&split| shows(split)) {
            surface.split(hierarchy, split, |other| other <= split && shows(other));
        }
        surface
    }

    /// Returns the corners of a group's drawn triangles. A group has all triangles of a material (in the order of
    /// [`VertexHierarchy::materials`]), or all triangles if there are no materials. Empty if there is no such group.
    pub fn triangles(&self, group: usize) -> &[[u32; 3]] {
        self.output.groups.get(group).map_or(&[], |group| &group.indices)
    }

    /// Returns, per drawn triangle of a group, its number in the hierarchy.
    pub fn drawn(&self, group: usize) -> &[u32] {
        self.output.groups.get(group).map_or(&[], |group| &group.drawn)
    }

    /// Number of groups, at least 1.
    pub fn groups(&self) -> usize {
        self.output.groups.len()
    }

    /// Number of drawn triangles of all groups.
    pub fn triangle_count(&self) -> usize {
        self.output.groups.iter().map(|group| group.drawn.len()).sum()
    }

    /// Returns the vertex in every slot; `None` if vertices are not packed.
    pub fn vertices(&self) -> Option<&[u32]> {
        self.output.slots.as_ref().map(Slots::vertices)
    }

    /// Returns the slot of a vertex, or the vertex itself if vertices are not packed; `None` if it is not in use.
    pub fn slot(&self, vertex: u32) -> Option<u32> {
        let name = self.output.name(vertex);
        (!self.stars.of(name).is_empty()).then_some(name)
    }

    /// Returns the triangles of a group written since [`CutSurface::clean`], as ranges; see [`Dirty::ranges`].
    pub fn dirty_triangles(&self, group: usize, gap: usize) -> DirtyRanges<'_> {
        let group = self.output.groups.get(group);
        group.map_or_else(DirtyRanges::none, |group| group.dirty.ranges(group.drawn.len(), gap))
    }

    /// Returns the slots written since [`CutSurface::clean`], as ranges; none if vertices are not packed.
    pub fn dirty_vertices(&self, gap: usize) -> DirtyRanges<'_> {
        self.output.slots.as_ref().map_or_else(DirtyRanges::none, |slots| slots.dirty(gap))
    }

    /// Forgets all written triangles and slots.
    pub fn clean(&mut self) {
        self.output.groups.iter_mut().for_each(|group| group.dirty.clear());
        self.clean_vertices();
    }

    /// Marks all drawn triangles as written.
    pub(crate) fn invalidate(&mut self) {
        self.output.groups.iter_mut().for_each(|group| group.dirty.mark_all(group.drawn.len()));
    }

    /// Marks all slots as written.
    #[cfg(feature = "stream")]
    pub(crate) fn invalidate_vertices(&mut self) {
        if let Some(slots) = &mut self.output.slots {
            slots.invalidate();
        }
    }

    /// Forgets all written slots.
    pub(super) fn clean_vertices(&mut self) {
        if let Some(slots) = &mut self.output.slots {
            slots.clean();
        }
    }

    /// Adds a split to the mesh. `there` tells the splits in the mesh, including this split. All splits it needs must be
    /// present.
    pub(crate) fn split(
        &mut self,
        source: &impl SplitSource,
        split: u32,
        there: impl Fn(u32) -> bool + Copy,
    ) {
        let Self { stars, output, .. } = self;
        let mut emptied = false;
        for [vertex, to, first_leaf] in source.brought(split).rev() {
            let from = output.name(to);
            let goes = stars.count(from, first_leaf);
            if goes > 0 {
                let name = output.take(vertex);
                stars.reach(name);
                stars.part(from, name, (first_leaf, goes), |corner| output.write(source, corner, name));
                emptied |= stars.of(from).is_empty();
            }
        }
        for triangle in source.owned(split) {
            self.show(source, triangle, there);
        }
        if emptied {
            source.brought(split).for_each(|[_, to, _]| self.release(source, to));
        }
    }

    /// Removes a split from the mesh. No split in the mesh may need it.
    pub(crate) fn collapse(&mut self, source: &impl SplitSource, split: u32) {
        let Self { stars, output, loose, moves } = self;
        moves.clear();
        moves.extend(source.brought(split).map(|[vertex, to, _]| [vertex, to].map(|v| [v, output.name(v)])));
        let owned = source.owned(split);
        let gone = 3 * owned.start..3 * owned.end;
        let mut remove = |output: &Output, name: u32| {
            let left = stars.remove(name, &gone);
            if let (0, Some(slots)) = (left, &output.slots) {
                loose.push(slots.vertices()[name as usize]);
            }
        };
        for triangle in owned {
            for name in output.hide(source, triangle) {
                // Vertices of the split lose their stars as a whole, and substitutes are in several of these triangles.
                if moves.iter().flatten().all(|[_, other]| *other != name) {
                    remove(output, name);
                }
            }
        }
        moves.iter().flatten().filter(|[_, name]| *name != NONE).for_each(|[_, name]| remove(output, *name));
        for &[[vertex, _], [to, _]] in &*moves {
            // A substitute may be a vertex of the split itself, with a slot since a line ago.
            let from = output.name(vertex);
            if !stars.of(from).is_empty() {
                let name = output.take(to);
                stars.reach(name);
                stars.join(from, name, |corner| output.write(source, corner, name));
                if output.slots.is_some() {
                    loose.push(vertex);
                }
            }
        }
        while let Some(vertex) = self.loose.pop() {
            self.release(source, vertex);
        }
    }

    /// Adds a triangle to the mesh. `there` tells the splits in the mesh.
    pub(crate) fn show(&mut self, source: &impl SplitSource, triangle: u32, there: impl Fn(u32) -> bool) {
        let leaves = source.leaves(triangle);
        let corners = leaves.map(|leaf| source.active(leaf, &there));
        let names = corners.map(|vertex| self.output.take(vertex));
        let group = &mut self.output.groups[source.group_of(triangle)];
        let at = group.drawn.len() as u32;
        *self.output.place.entry(triangle) = at;
        group.drawn.push(triangle);
        group.indices.push(names);
        group.dirty.mark(at);
        for k in 0..3 {
            self.stars.reach(names[k]);
            self.stars.push(names[k], [3 * triangle + k as u32, leaves[k]]);
        }
    }

    /// Frees the slot of a vertex named by no corner.
    fn release(&mut self, source: &impl SplitSource, vertex: u32) {
        let Self { stars, output, .. } = self;
        let Some(slots) = &mut output.slots else { return };
        let slot = slots.slot(vertex);
        if slot == NONE || !stars.of(slot).is_empty() {
            return;
        }
        let last = slots.free(slot);
        if last != slot {
            stars.rename(last, slot);
            stars.of(slot).iter().for_each(|entry| output.write(source, entry[0], slot));
        }
    }

    /// Returns the corners around a vertex that are a leaf's: `3 * triangle + k`.
    #[cfg(feature = "stream")]
    pub(crate) fn star_of_leaf(&self, vertex: u32, leaf: u32) -> impl Iterator<Item = u32> {
        self.corners_around(vertex).iter().filter(move |entry| entry[1] == leaf).map(|entry| entry[0])
    }

    fn corners_around(&self, vertex: u32) -> &[Entry] {
        self.stars.of(self.output.name(vertex))
    }

    /// Returns the corners around a vertex: `3 * triangle + k`.
    pub(crate) fn star(&self, vertex: u32) -> impl Iterator<Item = u32> {
        self.corners_around(vertex).iter().map(|entry| entry[0])
    }

    /// Returns the names of a triangle's corners, if it is drawn.
    pub(crate) fn corners(&self, hierarchy: &VertexHierarchy, triangle: u32) -> Option<[u32; 3]> {
        let at = self.output.place.get(triangle);
        self.output.groups[hierarchy.group_of(triangle)].indices.get(at as usize).copied()
    }

    /// Looks for pages that are not in use.
    pub(crate) fn sweep(&mut self) {
        let Self { stars, output, .. } = self;
        stars.sweep();
        output.place.sweep();
        if let Some(slots) = &mut output.slots {
            slots.sweep();
        }
    }

    /// Gives back memory if most of it is not in use.
    pub(crate) fn trim(&mut self) {
        let Self { stars, output, .. } = self;
        stars.trim();
        output.place.trim();
        if let Some(slots) = &mut output.slots {
            slots.trim();
        }
        for group in &mut output.groups {
            trim(&mut group.indices);
            trim(&mut group.drawn);
            group.dirty.trim(group.drawn.len());
        }
    }

    /// Bytes of its arrays.
    pub fn memory(&self) -> usize {
        let groups = self.output.groups.iter().map(|group| {
            group.indices.capacity() * size_of::<[u32; 3]>()
                + group.drawn.capacity() * size_of::<u32>()
                + group.dirty.memory()
        });
        self.stars.memory()
            + self.output.place.memory()
            + self.output.slots.as_ref().map_or(0, Slots::memory)
            + groups.sum::<usize>()
    }
}
