//! Checks all invariants of a vertex hierarchy. A valid hierarchy never panics, never loops without end, and shows only
//! the image of its triangles.
//!
//! ```text
//!     replay all collapses, fine to coarse:
//!       who is taken, and by whom?      both are still there: so substitutes form a forest
//!       what does it stand for?         runs of leaves that touch: so one comparison a corner tells both sides of a split
//!       which splits touched them?      the children of a split
//!     every triangle comes back with the split at which the last two of its corners part
//! ```
//!
//! All splits at a vertex are nested in one another by construction: children of a split are the last splits before it
//! to touch its vertices. Stored children are compared as they are found; stored parents are their transpose.
//!
//! **When corners part.** At any cut every leaf is in the run of the vertex that represents it. A split parts runs: of the
//! usual split, the run of a vertex into two. So a triangle belongs to it if one corner is in either part. Splits that
//! bring several vertices part several runs (`Parted`). No walk through the forest is needed, and triangles of a split lie
//! together.

use crate::geometry::lists::Lists;
use crate::geometry::parallel;
use crate::mesh::{MAX_ELEMENTS, NONE};
use crate::view::Bounds;

use super::build::{MOST_MATERIALS, MOST_TRIANGLES};
use super::{Dependencies, HierarchyError, VertexHierarchy};

/// Upper bound of the diagonal of a box of finite single-precision numbers (`LONGEST`), and a length below the shortest.
const LONGEST: f64 = 1.2e39;
const SHORTEST: f64 = 1e-45;

impl VertexHierarchy {
    /// Checks the structure: every index is in range; substitutes form a forest in which the leaves represented by a
    /// vertex are a run; all splits at a vertex are nested in one another; parents and dependencies have no cycle;
    /// bounds are nested; every triangle comes back with the last split to part two of its corners.
    ///
    /// Holds for every result of [`VertexHierarchy::build`]. Parts and files are accepted only if valid. O(n log n) on
    /// any input, O(n) in practice.
    ///
    /// # Errors
    /// The first broken invariant, and its place.
    pub fn validate(&self) -> Result<(), HierarchyError> {
        self.check_arrays()?;
        if !self.fit_derived() {
            return Err(self.difference());
        }
        let Self { split_of, children, .. } = self;
        let (replayed, (are_parents, promises)) = parallel::join(
            || self.replay(split_of, |split, below| children.get(split) == below),
            || (self.has_parents_of_children(), self.check_promises()),
        );
        let (Ok(wrong), true) = (replayed, are_parents) else { return Err(self.difference()) };
        promises?;
        check_owners(wrong)?;
        same("the jump of vertex", &self.jump, &self.jumps())
    }

    /// Whether the derived arrays have the right lengths, and indices in range.
    fn fit_derived(&self) -> bool {
        let (vertices, count) = (self.substitute.len(), self.bounds.len());
        let fits = |lists: &Lists| {
            lists.start.len() == count + 1
                && check_starts("", &lists.start, lists.items.len()).is_ok()
                && in_range("", &lists.items, count).is_ok()
        };
        self.split_of.len() == vertices && fits(&self.parents) && fits(&self.children)
    }

    /// Whether parents are the transpose of children, given that children of every split ascend, and roots are the splits
    /// without parents.
    fn has_parents_of_children(&self) -> bool {
        let Self { parents, children, .. } = self;
        let mut next = children.start.to_vec();
        let mut roots = self.roots.iter();
        for split in 0..self.bounds.len() as u32 {
            let own = parents.get(split);
            if own.is_empty() && roots.next() != Some(&split) || own.windows(2).any(|pair| pair[0] >= pair[1])
            {
                return false;
            }
            for &parent in own {
                let slot = &mut next[parent as usize];
                if *slot >= children.start[parent as usize + 1] || children.items[*slot as usize] != split {
                    return false;
                }
                *slot += 1;
            }
        }
        parents.items.len() == children.items.len() && roots.next().is_none()
    }

    /// Names the broken collapse, or the first derived array to differ from what is derived.
    fn difference(&self) -> HierarchyError {
        let compared = self.derived().and_then(|derived| {
            for (what, known, found) in [
                ("the split of vertex", &self.split_of[..], &derived.split_of[..]),
                ("the start of parents of split", &self.parents.start, &derived.parents.start),
                ("entry of parents", &self.parents.items, &derived.parents.items),
                ("the start of children of split", &self.children.start, &derived.children.start),
                ("entry of children", &self.children.items, &derived.children.items),
                ("entry of roots", &self.roots, &derived.roots),
            ] {
                same(what, known, found)?;
            }
            broken::<()>("what is derived of split", 0)
        });
        compared.err().unwrap_or(HierarchyError::Broken { what: "what is derived of split", at: 0 })
    }

    /// Checks dependencies and bounds. Needs only [`Self::check_arrays`] and parents and children in range.
    pub(super) fn check_promises(&self) -> Result<(), HierarchyError> {
        self.check_cycles()?;
        self.check_bounds()
    }

    /// Checks the lengths of all arrays, derived ones included: what a trusted file must have.
    #[cfg(feature = "io")]
    pub(super) fn check_lengths(&self) -> Result<(), HierarchyError> {
        let (vertices, splits) = (self.substitute.len(), self.bounds.len());
        for (what, lists) in [
            ("starts of brings", &self.brings),
            ("starts of parents", &self.parents),
            ("starts of children", &self.children),
            ("starts of dependencies", &self.dependencies),
        ] {
            let last = lists.start.last().map_or(0, |&end| end as usize);
            expect(what, last, lists.items.len())?;
            if !(lists.start.is_empty() && lists.items.is_empty() && what == "starts of dependencies") {
                expect(what, lists.start.len(), splits + 1)?;
            }
        }
        expect("starts of splits' triangles", self.first_triangle.len(), splits + 1)?;
        let last = self.first_triangle.last().map_or(0, |&end| end as usize);
        expect("triangles of splits", last, self.triangles.len())?;
        expect("splits of vertices", self.split_of.len(), vertices)?;
        let grouped = if self.materials.len() > 1 { self.triangles.len() } else { 0 };
        expect("groups of triangles", self.group_of.len(), grouped)?;
        let jumps = if self.jump.is_empty() { 0 } else { vertices };
        expect("jumps", self.jump.len(), jumps)
    }

    /// Checks lengths and ranges of the arrays.
    pub(super) fn check_arrays(&self) -> Result<(), HierarchyError> {
        let (vertices, splits, triangles) = (self.substitute.len(), self.bounds.len(), self.triangles.len());
        let leaves = self.leaves as usize;
        at_most("vertices", vertices, 2 * MAX_ELEMENTS)?;
        at_most("splits", splits, vertices)?;
        at_most("triangles", triangles, MOST_TRIANGLES)?;
        at_most("materials", self.materials.len(), MOST_MATERIALS)?;
        let lists = [
            (["brings", "starts of brings", "the start of brings of split"], &self.brings, vertices),
            (
                ["dependencies", "starts of dependencies", "the start of dependencies of split"],
                &self.dependencies,
                splits,
            ),
        ];
        for ([items, starts, start], lists, limit) in lists {
            if lists.start.is_empty() && lists.items.is_empty() && items == "dependencies" {
                continue;
            }
            expect(starts, lists.start.len(), splits + 1)?;
            check_starts(start, &lists.start, lists.items.len())?;
            in_range(items, &lists.items, limit)?;
        }
        expect("starts of splits' triangles", self.first_triangle.len(), splits + 1)?;
        if let Some(at) = first_descent(&self.first_triangle) {
            return broken("the first triangle of split", at);
        }
        if self.first_triangle[splits] as usize != triangles {
            return broken("the first triangle of split", splits);
        }
        in_range("substitutes", &self.substitute, vertices)?;
        in_range("first leaves", &self.first_leaf, leaves)?;
        in_range("corners of triangles", self.triangles.as_flattened(), leaves)?;
        let grouped = if self.materials.len() > 1 { triangles } else { 0 };
        expect("groups of triangles", self.group_of.len(), grouped)?;
        if let Some(triangle) = self.group_of.iter().position(|&g| usize::from(g) >= self.materials.len()) {
            return broken("the group of triangle", triangle);
        }
        if let Some(at) = self.materials.windows(2).position(|w| w[0] >= w[1]) {
            return broken("the order of materials at", at + 1);
        }
        if self.dependency_kind == Dependencies::None && !self.dependencies.items.is_empty() {
            return expect("dependencies", self.dependencies.items.len(), 0);
        }
        let is_length = self.diagonal == 0.0 || (SHORTEST..LONGEST).contains(&self.diagonal);
        if is_length { Ok(()) } else { broken("the diagonal", 0) }
    }

    /// Replays all collapses, from fine to coarse, and checks them. Calls `nest` with every split and its children,
    /// ascending, until it returns false. Returns the first triangle that does not belong to its split. Every index must be
    /// in range. O(n).
    ///
    /// # Errors
    /// The collapse that is broken, or whose children `nest` does not take.
    pub(super) fn replay(
        &self,
        split_of: &[u32],
        mut nest: impl FnMut(u32, &[u32]) -> bool,
    ) -> Result<Option<u32>, HierarchyError> {
        /// Marks a vertex that is taken.
        const GONE: u32 = NONE - 1;
        /// The end of a vertex's run, and the last split to touch the vertex.
        #[derive(Clone, Copy)]
        struct State {
            end: u32,
            last: u32,
        }
        for (vertex, (&to, &split)) in self.substitute.iter().zip(split_of).enumerate() {
            if (to as usize == vertex) != (split == NONE) {
                return broken("the substitute of vertex", vertex);
            }
        }
        let ends = (1..=self.leaves).chain(self.first_leaf.iter().copied());
        let mut states: Vec<State> = ends.map(|end| State { end, last: NONE }).collect();
        let (mut below, mut parted, mut wrong) = (Vec::new(), Parted::default(), None);
        for split in (0..self.bounds.len() as u32).rev() {
            let brings = self.brings.get(split);
            if brings.is_empty() {
                return broken("what is brought by split", split as usize);
            }
            below.clear();
            parted.clear();
            for &vertex in brings {
                let (v, to) = (vertex as usize, self.substitute[vertex as usize] as usize);
                let [own, other] = [states[v], states[to]];
                if split_of[v] != split || own.last == GONE || other.last == GONE {
                    return broken("the collapse of vertex", v);
                }
                let first = self.first_leaf(vertex);
                if first == own.end || first != other.end {
                    return broken("the run of leaves of vertex", v);
                }
                if own.last != split {
                    parted.parts.push([first, own.end]);
                }
                if other.last != split {
                    parted.parts.push([self.first_leaf(to as u32), other.end]);
                }
                states[v].last = GONE;
                states[to] = State { end: own.end, last: split };
                below.extend([own.last, other.last].iter().filter(|&&last| last != NONE && last != split));
            }
            if brings.len() > 1 {
                let left = brings.iter().map(|&vertex| self.substitute[vertex as usize]);
                let left = left.filter(|&to| states[to as usize].last == split);
                parted.wholes.extend(left.map(|to| [self.first_leaf(to), states[to as usize].end]));
                parted.sort();
            }
            let range = self.first_triangle[split as usize] as usize
                ..self.first_triangle[split as usize + 1] as usize;
            if let Some(at) = self.triangles[range.clone()].iter().position(|&corners| !parted.owns(corners))
            {
                wrong = Some((range.start + at) as u32);
            }
            below.sort_unstable();
            below.dedup();
            if !nest(split, &below) {
                return broken("the children of split", split as usize);
            }
        }
        // What is left are the runs of vertices never removed.
        let left = states.iter().enumerate().filter(|(_, state)| state.last != GONE);
        let mut starts: Vec<u32> = left
            .map(|(vertex, state)| [self.first_leaf(vertex as u32), state.end])
            .filter(|run| run[0] < run[1])
            .map(|run| run[0])
            .collect();
        starts.sort_unstable();
        let base = &self.triangles[..self.first_triangle[0] as usize];
        let is_wrong = |corners: &[u32; 3]| {
            let runs = corners.map(|leaf| starts.partition_point(|&start| start <= leaf));
            runs[0] == runs[1] || runs[1] == runs[2] || runs[2] == runs[0]
        };
        Ok(base.iter().position(is_wrong).map(|at| at as u32).or(wrong))
    }

    /// Checks dependencies and parents together for cycles: removes splits needed by no remaining split until none are
    /// left.
    fn check_cycles(&self) -> Result<(), HierarchyError> {
        let count = self.bounds.len();
        // Parents come before their children.
        let ascends = |split: u32| self.dependencies.get(split).iter().all(|&need| need < split);
        if self.dependencies.items.is_empty() || (0..count as u32).all(ascends) {
            return Ok(());
        }
        let all = |split: u32| self.parents.get(split).iter().chain(self.dependencies.get(split));
        let mut held = vec![0_u32; count];
        (0..count as u32).for_each(|split| all(split).for_each(|&other| held[other as usize] += 1));
        let mut free: Vec<u32> = (0..count as u32).filter(|&split| held[split as usize] == 0).collect();
        while let Some(split) = free.pop() {
            for &other in all(split) {
                held[other as usize] -= 1;
                if held[other as usize] == 0 {
                    free.push(other);
                }
            }
        }
        match held.iter().position(|&held| held > 0) {
            Some(split) => broken("a cycle of dependencies that holds split", split),
            None => Ok(()),
        }
    }

    fn check_bounds(&self) -> Result<(), HierarchyError> {
        let count = self.bounds.len() as u32;
        // NaN is not within.
        let is_length = |x: f32| (0.0..=f32::MAX).contains(&x);
        let is_sound = |bounds: &Bounds| {
            let Bounds { centre: [x, y, z], radius, error, parametric, .. } = *bounds;
            is_length(radius) & is_length(error) & is_length(parametric)
                && is_length(x.abs()) & is_length(y.abs()) & is_length(z.abs())
        };
        if let Some(split) = self.bounds.iter().position(|bounds| !is_sound(bounds)) {
            return broken("the bounds of split", split);
        }
        let sticks_out = |split: u32| {
            let bounds = &self.bounds[split as usize];
            self.children.get(split).iter().find(|&&child| !bounds.contains(&self.bounds[child as usize]))
        };
        match parallel::first(count, |split| sticks_out(split).is_some()).and_then(sticks_out) {
            Some(&child) => broken("within those of its parents, the bounds of split", child as usize),
            None => Ok(()),
        }
    }
}

/// The runs of leaves parted by a split: start and end.
#[derive(Default)]
struct Parted {
    /// Runs after the split: two if it brings one vertex, else sorted.
    parts: Vec<[u32; 2]>,
    /// Runs before the split, each made of several of `parts`; none if it brings one vertex.
    wholes: Vec<[u32; 2]>,
}

impl Parted {
    fn clear(&mut self) {
        self.parts.clear();
        self.wholes.clear();
    }

    /// Sorts the runs of a split that brings several vertices. They do not overlap.
    fn sort(&mut self) {
        self.parts.retain(|run| run[0] < run[1]);
        self.parts.sort_unstable();
        self.wholes.sort_unstable();
        self.wholes.dedup();
    }

    /// Whether a triangle's corners are all apart after the split, and were not before.
    #[inline]
    fn owns(&self, corners: [u32; 3]) -> bool {
        if let ([first, second], []) = (&self.parts[..], &self.wholes[..]) {
            let within = |run: &[u32; 2], leaf: u32| u8::from((run[0] <= leaf) & (leaf < run[1]));
            let [a, b, c] = corners;
            let count = |run| within(run, a) + within(run, b) + within(run, c);
            return count(first) == 1 && count(second) == 1;
        }
        // Corners outside of all runs are apart from all others, if there is but one of them.
        let place = |runs: &[[u32; 2]], leaf: u32| {
            let at = runs.partition_point(|run| run[0] <= leaf).checked_sub(1)?;
            (leaf < runs[at][1]).then_some(at)
        };
        let [a, b, c] = corners.map(|leaf| (place(&self.parts, leaf), place(&self.wholes, leaf)));
        let meet = |a: (Option<usize>, Option<usize>), b: (_, _)| a.1.is_some() && a.1 == b.1;
        let part = |a: (Option<usize>, _), b: (Option<usize>, _)| a.0 != b.0;
        (meet(a, b) || meet(b, c) || meet(c, a)) && part(a, b) && part(b, c) && part(c, a)
    }
}

/// Fails if there is a triangle that does not belong to its split.
pub(super) fn check_owners(wrong: Option<u32>) -> Result<(), HierarchyError> {
    match wrong {
        Some(triangle) => broken("the split that brings back triangle", triangle as usize),
        None => Ok(()),
    }
}

/// Checks starts of lists: at least one start, ascending from 0 to `items`.
fn check_starts(what: &'static str, start: &[u32], items: usize) -> Result<(), HierarchyError> {
    let last = start.len() - 1;
    if start[0] != 0 {
        return broken(what, 0);
    }
    match first_descent(start) {
        Some(at) => broken(what, at),
        None if start[last] as usize != items => broken(what, last),
        None => Ok(()),
    }
}

fn first_descent(values: &[u32]) -> Option<usize> {
    values.windows(2).position(|w| w[0] > w[1]).map(|at| at + 1)
}

fn same(what: &'static str, known: &[u32], derived: &[u32]) -> Result<(), HierarchyError> {
    match known.iter().zip(derived).position(|(a, b)| a != b) {
        Some(at) => broken(what, at),
        None if known.len() != derived.len() => broken(what, known.len().min(derived.len())),
        None => Ok(()),
    }
}

fn expect(what: &'static str, found: usize, expected: usize) -> Result<(), HierarchyError> {
    if found == expected { Ok(()) } else { Err(HierarchyError::Length { what, found, expected }) }
}

fn at_most(what: &'static str, count: usize, limit: usize) -> Result<(), HierarchyError> {
    if count <= limit { Ok(()) } else { Err(HierarchyError::TooMany { what, count, limit }) }
}

fn in_range(what: &'static str, items: &[u32], limit: usize) -> Result<(), HierarchyError> {
    // Without an early end, so that several are compared at once.
    let limit_32 = u32::try_from(limit).unwrap_or(u32::MAX);
    let beyond = |items: &[u32]| items.iter().fold(false, |beyond, &item| beyond | (item >= limit_32));
    if !items.chunks(4096).any(beyond) {
        return Ok(());
    }
    match items.iter().position(|&item| item as usize >= limit) {
        Some(at) => Err(HierarchyError::OutOfRange { what, at, found: items[at], limit }),
        None => Ok(()),
    }
}

fn broken<T>(what: &'static str, at: usize) -> Result<T, HierarchyError> {
    Err(HierarchyError::Broken { what, at })
}

#[cfg(test)]
mod tests {
    use super::super::HierarchyBuilder;
    use super::*;
    use crate::mesh::shapes;

    /// Damage to derived arrays, which parts cannot have.
    #[test]
    fn what_is_derived_is_checked() {
        let mesh = HierarchyBuilder::new().bake(&shapes::rock(300, 1)).expect("a rock");
        let good = (**mesh.structure()).clone();
        assert_eq!(good.validate(), Ok(()));
        type Break = fn(&mut VertexHierarchy);
        let breaks: [(&str, Break); 8] = [
            ("the split of vertex", |h| h.split_of.edit(|a| a[0] ^= 1)),
            ("the start of parents", |h| h.parents.start.edit(|a| a[3] += 1)),
            ("entry of parents", |h| h.parents.items.edit(|a| a[2] += 1)),
            ("the start of children", |h| h.children.start.edit(|a| a[3] += 1)),
            ("entry of children", |h| h.children.items.edit(|a| a[2] += 1)),
            ("entry of roots", |h| h.roots.edit(|a| a.push(1))),
            ("entry of roots", |h| h.roots.edit(Vec::clear)),
            ("the jump of vertex", |h| h.jump.edit(|a| a.push(0))),
        ];
        for (why, damage) in breaks {
            let mut bad = good.clone();
            damage(&mut bad);
            let said = bad.validate().expect_err(why).to_string();
            assert!(said.starts_with(why), "{why}: {said}");
        }
    }
}
