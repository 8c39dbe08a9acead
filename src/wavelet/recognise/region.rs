//! Regions: faces split last, all that are joined by common sides, and the unsplit faces beside them.
//!
//! ```text
//!              x1 ___ x2             A side from a to b with midpoint m is known. The face across it is one of:
//!             / \     / \
//!            /   \   /   \           2 faces at m       an unsplit face cut at m first, or at x1 and then at m
//!           /     \ /     \          3 faces            a split face, or an unsplit one with a midpoint at x1 or x2
//!          a ----- m ----- b         4 faces            an unsplit face with three midpoints
//!           ///////////////          other numbers      none: the supposition is wrong
//! ```
//!
//! Vertices are *old* (corners of merged faces) or *new* (midpoints), edges are inside merged faces, halves of sides or whole
//! sides. Each may be only one, a midpoint has a split face on one side at least, and all new vertices come after all old ones.
//! This leaves one choice in most places, and each choice made gives new sides. Where several are left, each is followed for a
//! while, and all but one mostly lead to a contradiction. Where they do not, the choice with the earliest midpoint is made: a
//! midpoint taken for an old vertex is hardly ever contradicted nearby, an old vertex taken for a midpoint is.

use crate::mesh::NONE;

use super::complex::{Complex, FaceComplex};
use super::fans::Around;
use super::merge::{Merge, turned};

/// States of edges; any other value is the other half of the edge's side.
const UNKNOWN: u32 = NONE;
const WHOLE: u32 = NONE - 1;
const INNER: u32 = NONE - 2;

/// States of vertices.
const UNSEEN: u8 = 0;
const OLD: u8 = 1;
const NEW: u8 = 2;

/// Most sides crossed to tell choices apart.
const LOOK_AHEAD: usize = 256;

/// Most sides crossed in a layer: some in all, and some for each face. Keeps the search of irregular meshes linear.
const FREE_CROSSINGS: usize = 100_000;
const CROSSINGS: usize = 32;

/// Most choices across a side.
const MOST: usize = 5;

/// The choices across a side.
#[derive(Default)]
struct Choices {
    merges: [Option<Merge>; MOST],
    count: usize,
}

impl Choices {
    fn push(&mut self, merge: Merge) {
        self.merges[self.count] = Some(merge);
        self.count += 1;
    }

    fn iter(&self) -> impl Iterator<Item = &Merge> {
        self.merges.iter().flatten()
    }
}

/// A change to be taken back.
enum Change {
    Vertex(u32, u8),
    Edge(u32, u32),
    Face(u32),
}

/// A state to go back to.
struct Mark {
    trail: usize,
    merges: usize,
    tasks: usize,
    done: usize,
    open: usize,
    decided: usize,
    order: [u32; 2],
}

/// A search for the regions of a complex.
pub(super) struct Search<'a, P> {
    pub complex: &'a Complex,
    surface: &'a FaceComplex<'a>,
    /// Per face the fans at its corners: the vertices.
    pub fans: &'a [[u32; 3]],
    lowest_wedge: &'a [u32],
    /// Whether a face is a triangle of the input: only such are pieces of unsplit faces.
    is_triangle: P,
    /// Per vertex the number of its faces, and how they lie.
    pub around: Vec<(u32, Around)>,
    pub merges: Vec<Merge>,
    /// Per face its merge, or `NONE`.
    merge_of: Vec<u32>,
    edges: Vec<u32>,
    vertices: Vec<u8>,
    trail: Vec<Change>,
    /// Half-edges along known sides, to be crossed from `done` on.
    tasks: Vec<u32>,
    done: usize,
    /// Half-edges with several choices, to be decided from `decided` on.
    open: Vec<u32>,
    decided: usize,
    /// Highest number of an old vertex of the region and lowest number of a new one.
    order: [u32; 2],
    /// The first merge of the last region.
    first_merge: usize,
    /// Sides that may still be crossed.
    left: usize,
}

impl<'a, P: Fn(u32) -> bool> Search<'a, P> {
    pub fn new(
        complex: &'a Complex,
        surface: &'a FaceComplex<'a>,
        fans: &'a [[u32; 3]],
        lowest_wedge: &'a [u32],
        is_triangle: P,
    ) -> Self {
        Self {
            complex,
            surface,
            fans,
            lowest_wedge,
            is_triangle,
            around: Vec::new(),
            merges: Vec::new(),
            merge_of: vec![NONE; complex.face_count()],
            edges: vec![UNKNOWN; complex.edge_count],
            vertices: vec![UNSEEN; lowest_wedge.len()],
            trail: Vec::new(),
            tasks: Vec::new(),
            done: 0,
            open: Vec::new(),
            decided: 0,
            order: [0, NONE],
            first_merge: 0,
            left: FREE_CROSSINGS + CROSSINGS * complex.face_count(),
        }
    }

    /// Whether a vertex has five faces all around.
    pub fn is_seed(&self, fan: u32) -> bool {
        self.around[fan as usize] == (5, Around::Closed)
    }

    /// Returns the number of a vertex in the input.
    pub fn number(&self, fan: u32) -> u32 {
        self.lowest_wedge[fan as usize]
    }

    /// Returns the merges of all regions, per face its merge or `NONE`, and per edge the other half of its side or itself.
    pub fn finish(self) -> (Vec<Merge>, Vec<u32>, Vec<u32>) {
        let mate = |(edge, &state): (usize, &u32)| if state < INNER { state } else { edge as u32 };
        let mates = self.edges.iter().enumerate().map(mate).collect();
        (self.merges, self.merge_of, mates)
    }

    /// Finds the region in which two half-edges into the same vertex are those of two pieces: a midpoint between the start of
    /// the first and the end of the second. `false`: there is none.
    pub fn region(&mut self, [a, b]: [u32; 2]) -> bool {
        if self.merge_of[(a / 3) as usize] != NONE || self.merge_of[(b / 3) as usize] != NONE {
            return false;
        }
        self.trail.clear();
        self.tasks.clear();
        self.open.clear();
        (self.done, self.decided, self.order) = (0, 0, [0, NONE]);
        let start = self.mark();
        self.first_merge = self.merges.len();
        let found = self.suppose([a, b]) && self.spread() && self.is_whole(start.merges);
        if !found {
            self.back(&start);
        }
        found
    }

    /// Whether the face at a corner is in no region.
    pub fn is_free(&self, corner: u32) -> bool {
        self.merge_of[(corner / 3) as usize] == NONE
    }

    /// Returns the lowest number of a midpoint of the last region.
    pub fn first_midpoint(&self) -> u32 {
        self.order[1]
    }

    /// Number of merges of the last region.
    pub fn size(&self) -> usize {
        self.merges.len() - self.first_merge
    }

    /// Takes the last region back.
    pub fn forget(&mut self) {
        let start = Mark {
            trail: 0,
            merges: self.first_merge,
            tasks: 0,
            done: 0,
            open: 0,
            decided: 0,
            order: [0, NONE],
        };
        self.back(&start);
    }

    /// Supposes a side with a midpoint.
    fn suppose(&mut self, [a, b]: [u32; 2]) -> bool {
        let ends = [(a, OLD), (turned(a, 1), NEW), (turned(b, 2), OLD)];
        let halves = [a, turned(b, 1)].map(|half_edge| self.edge(half_edge));
        ends.into_iter().all(|(corner, state)| self.set_vertex(corner, state)) && self.set_halves(halves)
    }

    /// Crosses all sides, and decides between choices where there are several.
    fn spread(&mut self) -> bool {
        loop {
            if !self.cross(usize::MAX) {
                return false;
            }
            let Some(&half_edge) = self.open.get(self.decided) else { return true };
            self.decided += 1;
            if self.merge_of[(half_edge / 3) as usize] == NONE && !self.decide(half_edge) {
                return false;
            }
        }
    }

    /// Crosses sides that leave one choice, at most `most`. `false`: a side leaves none.
    fn cross(&mut self, most: usize) -> bool {
        let end = self.done.saturating_add(most);
        while self.done < self.tasks.len().min(end) {
            let half_edge = self.tasks[self.done];
            self.done += 1;
            if self.left == 0 {
                return false;
            }
            self.left -= 1;
            if self.merge_of[(half_edge / 3) as usize] != NONE {
                continue;
            }
            let choices = self.choices(half_edge);
            match (choices.count, choices.merges[0]) {
                (1, Some(merge)) if self.apply(&merge) => {}
                (0 | 1, _) => return false,
                _ => self.open.push(half_edge),
            }
        }
        true
    }

    /// Decides between the choices across a side.
    fn decide(&mut self, half_edge: u32) -> bool {
        let choices = self.choices(half_edge);
        let mut left = Choices::default();
        for merge in choices.iter() {
            let here = self.mark();
            if choices.count == 1 || (self.apply(merge) && self.cross(LOOK_AHEAD)) {
                left.push(*merge);
            }
            self.back(&here);
        }
        let first_midpoint = |merge: &&Merge| self.order_with(merge)[1];
        let chosen = left.iter().min_by_key(first_midpoint).copied();
        chosen.is_some_and(|merge| self.apply(&merge))
    }

    /// Returns the highest number of old vertices and the lowest of new ones, with those of a merge.
    fn order_with(&self, merge: &Merge) -> [u32; 2] {
        let [mut high, mut low] = self.order;
        merge.corners.iter().for_each(|&corner| high = high.max(self.number(self.fan(corner))));
        let midpoints = merge.midpoints.iter().filter(|&&corner| corner != NONE);
        midpoints.for_each(|&corner| low = low.min(self.number(self.fan(corner))));
        [high, low]
    }

    /// Returns the choices across a side with a midpoint, split faces first, then by the number of midpoints.
    fn choices(&self, half_edge: u32) -> Choices {
        let complex = self.complex;
        let mut choices = Choices::default();
        let mut consider = |merge: Merge| {
            if self.fits(&merge) {
                choices.push(merge);
            }
        };
        let Some((fan, count)) = self.around_midpoint(half_edge) else { return choices };
        let [a, b, c, d] = fan;
        match count {
            2 => {
                consider(Merge::one(complex, [a, b]));
                if let Some(outer) = self.across(turned(b, 2)) {
                    consider(Merge::left(complex, [turned(outer, 2), turned(b, 2), turned(a, 1)]));
                    if let Some(further) = self.across(turned(outer, 2)) {
                        let first = turned(further, 2);
                        consider(Merge::three(
                            complex,
                            [first, turned(outer, 2), turned(b, 2), turned(a, 1)],
                        ));
                    }
                }
                if let Some(outer) = self.across(turned(a, 2)) {
                    consider(Merge::right(complex, [turned(b, 2), turned(a, 1), outer]));
                    if let Some(further) = self.across(turned(outer, 1)) {
                        consider(Merge::three(complex, [turned(b, 2), turned(a, 1), outer, further]));
                    }
                }
            }
            3 => {
                if let Some(outer) = self.across(turned(b, 2)) {
                    consider(Merge::split(complex, [a, b, c], outer));
                }
                consider(Merge::left(complex, [a, b, c]));
                consider(Merge::right(complex, [a, b, c]));
            }
            _ => consider(Merge::three(complex, [a, b, c, d])),
        }
        choices
    }

    /// Returns the half-edges into a midpoint in a face, of at most four, and their number. `half_edge`: of the face, along a
    /// half of the side. `None` if there are too many, or something is between.
    fn around_midpoint(&self, half_edge: u32) -> Option<([u32; 4], usize)> {
        let edge = self.edge(half_edge);
        let mate = self.edges[edge as usize];
        let [start, end] = [half_edge, turned(half_edge, 1)];
        let is_into = self.vertices[self.fan(end) as usize] == NEW;
        if !is_into && self.vertices[self.fan(start) as usize] != NEW {
            return None;
        }
        let mut fan = [NONE; 4];
        // Into the midpoint; backwards if the half-edge runs out of it.
        let mut into = if is_into { half_edge } else { turned(half_edge, 2) };
        for count in 1..=4 {
            fan[count - 1] = into;
            let out = if is_into { turned(into, 1) } else { into };
            if self.edge(out) == mate {
                if !is_into {
                    fan[..count].reverse();
                }
                return (count > 1).then_some((fan, count));
            }
            let other = self.across(out)?;
            into = if is_into { other } else { turned(other, 2) };
        }
        None
    }

    /// Returns the other half-edge along an edge inside a merged face: two unmerged faces of the same orientation, and an edge
    /// not known to be anything else.
    fn across(&self, half_edge: u32) -> Option<u32> {
        let other = self.complex.next(half_edge);
        let is_inside = other != half_edge
            && !self.complex.is_non_manifold(half_edge)
            && self.edges[self.edge(half_edge) as usize] == UNKNOWN
            && self.merge_of[(other / 3) as usize] == NONE
            && self.fan(other) == self.fan(turned(half_edge, 1));
        is_inside.then_some(other)
    }

    /// Whether a merge fits what is known.
    fn fits(&self, merge: &Merge) -> bool {
        let [a, b, c] = merge.corners.map(|corner| self.fan(corner));
        let points = merge.corners.map(|corner| self.surface.point(self.wedge(corner)));
        let are_old = [a, b, c].iter().all(|&fan| self.vertices[fan as usize] != NEW);
        let are_apart = points[0] != points[1] && points[1] != points[2] && points[2] != points[0];
        are_old
            && are_apart
            && self.sides_fit(merge)
            && self.faces_fit(merge)
            && self.midpoints_fit(merge)
            && self.seams_fit(merge)
            && self.is_in_order(merge)
            && (!merge.is_split || merge.faces[..3].iter().all(|&child| self.complex.may_start(child)))
    }

    /// Whether all midpoints come after all corners, with those of a merge.
    fn is_in_order(&self, merge: &Merge) -> bool {
        let [high, low] = self.order_with(merge);
        high < low
    }

    fn sides_fit(&self, merge: &Merge) -> bool {
        let state = |edge: u32| self.edges[edge as usize];
        let side_fits = |&[one, two]: &[u32; 2]| match two {
            NONE => matches!(state(one), UNKNOWN | WHOLE),
            _ => match [state(one), state(two)] {
                [UNKNOWN, UNKNOWN] => one != two,
                states => states == [two, one],
            },
        };
        let mut inner = merge.inner.iter().filter(|&&half_edge| half_edge != NONE);
        merge.sides.iter().all(side_fits) && inner.all(|&half_edge| state(self.edge(half_edge)) == UNKNOWN)
    }

    fn faces_fit(&self, merge: &Merge) -> bool {
        let material = |face: u32| self.surface.material(self.complex.lowest[face as usize]);
        let first = material(merge.faces[0] / 3);
        let fits = |(at, face): (usize, u32)| {
            self.merge_of[face as usize] == NONE
                && material(face) == first
                && (merge.is_split || (self.is_triangle)(face))
                && merge.each_face().take(at).all(|other| other != face)
        };
        merge.each_face().enumerate().all(fits)
    }

    /// Whether midpoints may be midpoints, and have as many faces as a midpoint here may have.
    fn midpoints_fit(&self, merge: &Merge) -> bool {
        merge.midpoints.iter().enumerate().filter(|(_, corner)| **corner != NONE).all(|(side, &corner)| {
            let fan = self.fan(corner) as usize;
            let (count, around) = self.around[fan];
            let own = match (merge.is_split, side) {
                (true, _) => 3,
                (_, 0) => merge.each_face().count() as u32,
                _ => 2,
            };
            let may_be = match around {
                Around::Closed if merge.is_split => (5..=7).contains(&count),
                // Beside an unsplit face with a midpoint is a split face.
                Around::Closed => count == own + 3,
                Around::Open => merge.is_split && count == 3,
                Around::NonManifold => true,
            };
            self.vertices[fan] != OLD && may_be
        })
    }

    /// Whether no seam runs inside: never in an unsplit face, and in a split face only if seams may.
    fn seams_fit(&self, merge: &Merge) -> bool {
        if merge.is_split && self.surface.across_seams {
            return true;
        }
        // All corners at the same vertex are the same wedge; those at the corners of a split face are of one child.
        let named = merge.corners.iter().chain(&merge.midpoints).filter(|&&corner| corner != NONE);
        named.into_iter().all(|&corner| {
            let [fan, wedge] = [self.fan(corner), self.wedge(corner)];
            let own = merge.each_face().flat_map(|face| [0, 1, 2].map(|k| 3 * face + k));
            own.into_iter().all(|other| self.fan(other) != fan || self.wedge(other) == wedge)
        })
    }

    /// Makes a merge. `false`: it contradicts what is known.
    fn apply(&mut self, merge: &Merge) -> bool {
        let number = self.merges.len() as u32;
        self.order = self.order_with(merge);
        self.merges.push(*merge);
        for face in merge.each_face() {
            self.trail.push(Change::Face(face));
            self.merge_of[face as usize] = number;
        }
        let old = merge.corners.iter().all(|&corner| self.set_vertex(corner, OLD));
        let mut midpoints = merge.midpoints.into_iter().filter(|&corner| corner != NONE);
        let new = midpoints.all(|corner| self.set_vertex(corner, NEW));
        let mut inner = merge.inner.into_iter().filter(|&half_edge| half_edge != NONE);
        let inside = inner.all(|half_edge| self.set_edge(self.edge(half_edge), INNER));
        old && new
            && inside
            && merge.sides.iter().all(|&halves| match halves {
                [edge, NONE] => self.set_edge(edge, WHOLE),
                halves => self.set_halves(halves),
            })
    }

    fn set_vertex(&mut self, corner: u32, state: u8) -> bool {
        let fan = self.fan(corner);
        let before = std::mem::replace(&mut self.vertices[fan as usize], state);
        if before != state {
            self.trail.push(Change::Vertex(fan, before));
        }
        before == UNSEEN || before == state
    }

    fn set_edge(&mut self, edge: u32, state: u32) -> bool {
        let before = std::mem::replace(&mut self.edges[edge as usize], state);
        if before != state {
            self.trail.push(Change::Edge(edge, before));
        }
        before == UNKNOWN || (before == state && state != INNER)
    }

    /// Makes two edges the halves of a side, and lists the faces along it.
    fn set_halves(&mut self, [one, two]: [u32; 2]) -> bool {
        let is_known = self.edges[one as usize] == two;
        if !(self.set_edge(one, two) && self.set_edge(two, one)) {
            return false;
        }
        if !is_known {
            for edge in [one, two] {
                let first = self.complex.first(edge);
                let mut half_edge = first;
                loop {
                    self.tasks.push(half_edge);
                    half_edge = self.complex.next(half_edge);
                    if half_edge == first {
                        break;
                    }
                }
            }
        }
        true
    }

    /// Whether every midpoint of the merges from `first` on has a split face beside it.
    fn is_whole(&self, first: usize) -> bool {
        let split = self.merges[first..].iter().filter(|merge| merge.is_split);
        let mut beside: Vec<u32> =
            split.flat_map(|merge| merge.midpoints.map(|corner| self.fan(corner))).collect();
        beside.sort_unstable();
        let others = self.merges[first..].iter().filter(|merge| !merge.is_split);
        others
            .flat_map(|merge| merge.midpoints)
            .filter(|&corner| corner != NONE)
            .all(|corner| beside.binary_search(&self.fan(corner)).is_ok())
    }

    fn mark(&self) -> Mark {
        Mark {
            trail: self.trail.len(),
            merges: self.merges.len(),
            tasks: self.tasks.len(),
            done: self.done,
            open: self.open.len(),
            decided: self.decided,
            order: self.order,
        }
    }

    fn back(&mut self, mark: &Mark) {
        for change in self.trail.drain(mark.trail..).rev() {
            match change {
                Change::Vertex(fan, before) => self.vertices[fan as usize] = before,
                Change::Edge(edge, before) => self.edges[edge as usize] = before,
                Change::Face(face) => self.merge_of[face as usize] = NONE,
            }
        }
        self.merges.truncate(mark.merges);
        self.tasks.truncate(mark.tasks);
        self.open.truncate(mark.open);
        (self.done, self.decided, self.order) = (mark.done, mark.decided, mark.order);
    }

    fn fan(&self, corner: u32) -> u32 {
        self.fans.as_flattened()[corner as usize]
    }

    fn wedge(&self, corner: u32) -> u32 {
        self.complex.corners.as_flattened()[corner as usize]
    }

    fn edge(&self, half_edge: u32) -> u32 {
        self.complex.edges.as_flattened()[half_edge as usize]
    }
}
