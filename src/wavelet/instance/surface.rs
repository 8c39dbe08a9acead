//! The triangles of a set of wavelets: stored densely, rewritten only after changes.
//!
//! ```text
//!           /\                 a face that is drawn is cut wherever a vertex in use lies on its sides:
//!          /  \                at the midpoint of a side, then each part the same way (Azuma et al., section 3.6).
//!         /----.  <- in use    So there are no T-vertices, however deep the neighbours are split.
//!        /   / |
//!       /__/___|
//! ```
//!
//! The triangles of a face depend only on the split faces and the vertices in use. Equal sets give equal triangles, independent
//! of earlier sets; only the order in the buffer may differ.

use crate::adapt::{Dirty, DirtyRanges};
use crate::geometry::paged::{Paged, trim};
use crate::mesh::NONE;
use crate::wavelet::Triangulation;
use crate::wavelet::subdivision::Subdivision;

use super::use_counts::{UseCounts, UseSink};

/// A side of a part of a face: the wavelet on it, and where the side is.
#[derive(Debug, Clone, Copy)]
struct Edge {
    wavelet: u32,
    against: bool,
    /// The face and side containing this edge. For a split face, the edge is the whole side. `NONE` inside the face.
    face: u32,
    side: usize,
}

impl Edge {
    /// An edge without wavelets.
    const BARE: Self = Self { wavelet: NONE, against: false, face: NONE, side: 0 };

    fn new(of: &Subdivision, face: u32, side: usize) -> Self {
        let (wavelet, against) = of.side(face, side);
        Self { wavelet, against, face, side }
    }
}

/// Polygons still to be cut, each a triangle with the wavelets on its sides.
type Stack = Vec<([u32; 3], [Edge; 3])>;

/// Per triangle in the buffer: its face, and its neighbours in the list of the face's triangles.
#[derive(Debug, Clone, Copy)]
struct Link {
    face: u32,
    next: u32,
    previous: u32,
}

#[derive(Debug, Clone, Default)]
struct Group {
    triangles: Vec<[u32; 3]>,
    links: Vec<Link>,
    dirty: Dirty,
}

/// Changes since the triangles were last written.
#[derive(Debug, Clone)]
struct Changes {
    faces: Vec<u32>,
    face_is_in: Paged<bool, 8>,
    wavelets: Vec<u32>,
    wavelet_is_in: Paged<bool, 8>,
}

impl Changes {
    fn face(&mut self, face: u32) {
        if !std::mem::replace(self.face_is_in.entry(face), true) {
            self.faces.push(face);
        }
    }

    fn wavelet(&mut self, wavelet: u32) {
        if !std::mem::replace(self.wavelet_is_in.entry(wavelet), true) {
            self.wavelets.push(wavelet);
        }
    }
}

impl UseSink for Changes {
    fn used(&mut self, wavelet: u32) {
        self.wavelet(wavelet);
    }

    fn turned(&mut self, face: u32) {
        self.face(face);
    }
}

/// The triangles of a set of wavelets closed under parents.
#[derive(Debug, Clone)]
pub(crate) struct WaveletSurface {
    uses: UseCounts,
    /// Per face its first triangle, or `NONE`.
    first: Paged<u32, 8>,
    /// A group per material.
    groups: Vec<Group>,
    changes: Changes,
    stack: Stack,
    cut: Vec<[u32; 3]>,
}

impl WaveletSurface {
    /// Makes the surface of the base mesh.
    pub fn new(of: &Subdivision, triangulation: Triangulation, groups: usize) -> Self {
        let mut surface = Self {
            uses: UseCounts::new(of, triangulation),
            first: Paged::of(of.face_count(), NONE),
            groups: vec![Group::default(); groups.max(1)],
            changes: Changes {
                faces: Vec::new(),
                face_is_in: Paged::of(of.face_count(), false),
                wavelets: Vec::new(),
                wavelet_is_in: Paged::of(of.wavelet_count(), false),
            },
            stack: Vec::new(),
            cut: Vec::new(),
        };
        (0..of.base_face_count() as u32).for_each(|face| surface.changes.face(face));
        surface
    }

    pub fn uses(&self) -> &UseCounts {
        &self.uses
    }

    /// Adds a wavelet to the set or removes it; drawn by [`WaveletSurface::write`].
    pub fn change(&mut self, of: &Subdivision, wavelet: u32, comes: bool) {
        // The wavelet's vertex moves even if it stays in use.
        self.changes.wavelet(wavelet);
        self.uses.change(of, wavelet, comes, &mut self.changes);
    }

    /// Returns a superset of the wavelets changed since the last [`WaveletSurface::write`]: added to the set or removed, or
    /// with a vertex added to use or removed.
    pub fn changed(&self) -> &[u32] {
        &self.changes.wavelets
    }

    /// Rewrites the triangles of changed faces. `vertex` renames vertices; `group` returns the group of a base face.
    /// O(changes).
    pub fn write(&mut self, of: &Subdivision, vertex: impl Fn(u32) -> u32, group: impl Fn(u32) -> usize) {
        for at in 0..self.changes.faces.len() {
            let face = self.changes.faces[at];
            if of.is_split(face) {
                (0..4).for_each(|child| self.changes.face(of.child(face, child)));
            }
        }
        for at in 0..self.changes.wavelets.len() {
            let wavelet = self.changes.wavelets[at];
            self.changes.wavelet_is_in.rest(wavelet);
            for along in of.faces_along(wavelet) {
                let mut face = along.face();
                while !self.uses.is_there(of, face) {
                    let Some((parent, ..)) = of.parent(face) else { break };
                    face = parent;
                }
                if !self.uses.splits(of, face) {
                    self.changes.face(face);
                }
            }
        }
        self.changes.wavelets.clear();
        let alone = self.groups.len() == 1;
        for at in 0..self.changes.faces.len() {
            let face = self.changes.faces[at];
            self.changes.face_is_in.rest(face);
            self.cut(of, face);
            self.cut.iter_mut().for_each(|t| *t = t.map(&vertex));
            self.replace(face, if alone { 0 } else { group(of.base_face_of(face)) });
        }
        self.changes.faces.clear();
        self.uses.sweep();
        self.first.sweep();
        self.changes.face_is_in.sweep();
        self.changes.wavelet_is_in.sweep();
    }

    /// Gives back memory if most of it is not in use.
    pub fn trim(&mut self) {
        let Self { uses, first, groups, changes, .. } = self;
        uses.trim();
        first.trim();
        changes.face_is_in.trim();
        changes.wavelet_is_in.trim();
        for group in groups {
            trim(&mut group.triangles);
            trim(&mut group.links);
            group.dirty.trim(group.links.len());
        }
    }

    /// Finds the triangles of a face.
    fn cut(&mut self, of: &Subdivision, face: u32) {
        let Self { uses, stack, cut, .. } = self;
        cut.clear();
        if !uses.is_there(of, face) || uses.splits(of, face) {
            return;
        }
        let edge = |face: u32, side: usize| Edge::new(of, face, side);
        let corners = of.corners(face);
        match uses.cut_corner(of, face) {
            None => stack.push((corners, [0, 1, 2].map(|side| edge(face, side)))),
            Some(i) => {
                // The quadrilateral m_i, c_(i+1), c_(i+2), m_(i+2).
                let [j, k] = [(i + 1) % 3, (i + 2) % 3];
                let at = |side: usize| of.vertices_at(of.side_of_split(face, side), face, side);
                let (near, far) = (at(i)[1], at(k)[0]);
                let start = edge(of.child(face, j), 2);
                let end = edge(of.child(face, k), 0);
                let inside = edge(of.child(face, 3), k);
                // The diagonal from m_i to c_(i+2).
                stack.push(([near, corners[j], corners[k]], [start, edge(face, j), Edge::BARE]));
                stack.push(([near, corners[k], far], [Edge::BARE, end, inside]));
            }
        }
        cut_all(of, stack, |wavelet| uses.is_used(wavelet), |triangle| cut.push(triangle));
    }

    /// Replaces the triangles of a face by the triangles found.
    fn replace(&mut self, face: u32, group: usize) {
        let Self { first, groups, cut, .. } = self;
        let group = &mut groups[group];
        let mut at = first.at(face);
        let mut last = NONE;
        let mut kept = 0;
        while at != NONE && kept < cut.len() {
            if group.triangles[at as usize] != cut[kept] {
                group.triangles[at as usize] = cut[kept];
                group.dirty.mark(at);
            }
            kept += 1;
            last = at;
            at = group.links[at as usize].next;
        }
        while at != NONE {
            // The next triangle may be moved into this place.
            let next = group.links[at as usize].next;
            let moved = group.remove(at, first);
            at = if next != NONE && moved == next { at } else { next };
        }
        for &triangle in &cut[kept..] {
            let new = group.triangles.len() as u32;
            group.triangles.push(triangle);
            group.links.push(Link { face, next: NONE, previous: last });
            group.dirty.mark(new);
            match last {
                NONE => *first.entry(face) = new,
                last => group.links[last as usize].next = new,
            }
            last = new;
        }
    }

    pub fn groups(&self) -> usize {
        self.groups.len()
    }

    pub fn triangles(&self, group: usize) -> &[[u32; 3]] {
        self.groups.get(group).map_or(&[], |group| &group.triangles)
    }

    /// Per triangle of a group its face.
    pub fn faces(&self, group: usize) -> impl Iterator<Item = u32> + '_ {
        self.groups.get(group).into_iter().flat_map(|group| group.links.iter().map(|link| link.face))
    }

    pub fn triangle_count(&self) -> usize {
        self.groups.iter().map(|group| group.triangles.len()).sum()
    }

    pub fn dirty(&self, group: usize, gap: usize) -> DirtyRanges<'_> {
        let group = self.groups.get(group);
        group.map_or_else(DirtyRanges::none, |group| group.dirty.ranges(group.triangles.len(), gap))
    }

    pub fn clean(&mut self) {
        self.groups.iter_mut().for_each(|group| group.dirty.clear());
    }

    /// Marks all triangles as changed.
    pub fn invalidate(&mut self) {
        self.groups.iter_mut().for_each(|group| group.dirty.mark_all(group.triangles.len()));
    }

    /// Bytes of its arrays.
    pub fn memory(&self) -> usize {
        let groups = self.groups.iter().map(|group| {
            group.triangles.capacity() * size_of::<[u32; 3]>()
                + group.links.capacity() * size_of::<Link>()
                + group.dirty.memory()
        });
        self.uses.memory()
            + self.first.memory()
            + self.changes.face_is_in.memory()
            + self.changes.wavelet_is_in.memory()
            + groups.sum::<usize>()
    }
}

impl Group {
    /// Removes a triangle; the last triangle takes its place. Returns where the last triangle was, or `NONE` if the last was
    /// removed.
    fn remove(&mut self, at: u32, first: &mut Paged<u32, 8>) -> u32 {
        let Link { face, next, previous } = self.links[at as usize];
        match previous {
            NONE => *first.entry(face) = next,
            previous => self.links[previous as usize].next = next,
        }
        if next != NONE {
            self.links[next as usize].previous = previous;
        }
        let last = self.triangles.len() as u32 - 1;
        self.triangles.swap_remove(at as usize);
        self.links.swap_remove(at as usize);
        if at == last {
            return NONE;
        }
        self.dirty.mark(at);
        let Link { face, next, previous } = self.links[at as usize];
        match previous {
            NONE => *first.entry(face) = at,
            previous => self.links[previous as usize].next = at,
        }
        if next != NONE {
            self.links[next as usize].previous = at;
        }
        last
    }
}

/// Cuts triangles wherever a vertex in use lies on their sides.
fn cut_all(
    of: &Subdivision,
    stack: &mut Stack,
    is_used: impl Fn(u32) -> bool,
    mut visit: impl FnMut([u32; 3]),
) {
    while let Some((corners, edges)) = stack.pop() {
        let used = |edge: &Edge| edge.wavelet != NONE && is_used(edge.wavelet);
        let Some(k) = edges.iter().position(used) else {
            visit(corners);
            continue;
        };
        let [a, b, c] = [0, 1, 2].map(|i| corners[(k + i) % 3]);
        let [edge, next, last] = [0, 1, 2].map(|i| edges[(k + i) % 3]);
        let middle = of.vertices_at(edge.wavelet, edge.face, edge.side);
        let [first, second] = halves(of, &edge);
        stack.push(([a, middle[0], c], [first, Edge::BARE, last]));
        stack.push(([middle[1], b, c], [second, next, Edge::BARE]));
    }
}

/// Visits the triangles of an unsplit face at full resolution: several where neighbours are split deeper. The order does not
/// depend on the numbering of vertices.
pub(crate) fn finest_triangles(of: &Subdivision, face: u32, visit: impl FnMut([u32; 3])) {
    let mut stack = vec![(of.corners(face), [0, 1, 2].map(|side| Edge::new(of, face, side)))];
    cut_all(of, &mut stack, |_| true, visit);
}

/// Returns the halves of a side, in the side's direction.
fn halves(of: &Subdivision, edge: &Edge) -> [Edge; 2] {
    if of.is_split(edge.face) {
        return [(edge.side, 0), ((edge.side + 1) % 3, 2)]
            .map(|(child, side)| Edge::new(of, of.child(edge.face, child), side));
    }
    let mut halves = of.halves(edge.wavelet);
    if edge.against {
        halves.reverse();
    }
    halves.map(|wavelet| Edge { wavelet, ..*edge })
}
