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
//! **When two leaves part.** At any cut every leaf is in the run of the vertex that represents it. A split parts a run at
//! the first leaf of the vertex brought back, and this border stays: leaf `b` has one *birth*, the split at which a run
//! first begins at `b` (0: never merged; else split + 1). Leaves `x < y` are apart from the least birth in `x + 1 ..= y` on.
//! So a triangle of leaves `x < y < z` comes back with the larger of two least births: two range minima a triangle.

use crate::geometry::parallel;
use crate::geometry::range_minima::RangeMinima;
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
        let Some(births) = self.check_derived() else { return self.find_difference() };
        self.check_promises(&births)?;
        same("the jump of vertex", &self.jump, &self.jumps())
    }

    /// Checks the derived arrays except jumps, and all collapses. Returns the births, or `None` if a check fails. O(n).
    fn check_derived(&self) -> Option<Vec<u32>> {
        let (vertices, count) = (self.substitute.len(), self.bounds.len());
        let Self { split_of, parents, children, .. } = self;
        let fits = |start: &[u32], items: &[u32]| {
            start.len() == count + 1
                && check_starts("", start, items.len()).is_ok()
                && in_range("", items, count).is_ok()
        };
        if split_of.len() != vertices
            || !fits(&parents.start, &parents.items)
            || !fits(&children.start, &children.items)
            || parents.items.len() != children.items.len()
        {
            return None;
        }
        let births = self.replay(split_of, |split, below| children.get(split) == below).ok()?;
        // Parents are the transpose of children, whose lists ascend.
        let mut next = children.start.to_vec();
        let mut roots = self.roots.iter();
        for split in 0..count as u32 {
            let own = parents.get(split);
            if own.is_empty() && roots.next() != Some(&split) || own.windows(2).any(|pair| pair[0] >= pair[1])
            {
                return None;
            }
            for &parent in own {
                let slot = &mut next[parent as usize];
                if *slot >= children.start[parent as usize + 1] || children.items[*slot as usize] != split {
                    return None;
                }
                *slot += 1;
            }
        }
        roots.next().is_none().then_some(births)
    }

    /// Names the first derived array to differ from what is derived, or the broken collapse.
    fn find_difference(&self) -> Result<(), HierarchyError> {
        let derived = self.derived()?;
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
        Ok(())
    }

    /// Checks the invariants which need only [`Self::check_arrays`], the derived arrays and births.
    pub(super) fn check_promises(&self, births: &[u32]) -> Result<(), HierarchyError> {
        self.check_cycles()?;
        self.check_bounds()?;
        self.check_triangles(births)
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
            if lists.start.is_empty() && lists.items.is_empty() && splits > 0 && items == "dependencies" {
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
    /// ascending, until it returns false. Returns the birth of every leaf. Every index must be in range. O(n).
    ///
    /// # Errors
    /// The collapse that is broken, or whose children `nest` does not take.
    pub(super) fn replay(
        &self,
        split_of: &[u32],
        mut nest: impl FnMut(u32, &[u32]) -> bool,
    ) -> Result<Vec<u32>, HierarchyError> {
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
        let mut births = vec![0; self.leaves as usize];
        let mut below = Vec::new();
        for split in (0..self.bounds.len() as u32).rev() {
            let brings = self.brings.get(split);
            if brings.is_empty() {
                return broken("what is brought by split", split as usize);
            }
            below.clear();
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
                // The coarsest split comes last.
                births[first as usize] = split + 1;
                states[v].last = GONE;
                states[to] = State { end: own.end, last: split };
                below.extend([own.last, other.last].iter().filter(|&&last| last != NONE && last != split));
            }
            below.sort_unstable();
            below.dedup();
            if !nest(split, &below) {
                return broken("the children of split", split as usize);
            }
        }
        for (vertex, state) in states.iter().enumerate().filter(|(_, state)| state.last != GONE) {
            let first = self.first_leaf(vertex as u32);
            if first != state.end {
                births[first as usize] = 0;
            }
        }
        Ok(births)
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
        let is_sound = |bounds: &Bounds| {
            let sizes = [bounds.radius, bounds.error, bounds.parametric];
            sizes.iter().all(|x| x.is_finite() && *x >= 0.0) && bounds.centre.iter().all(|x| x.is_finite())
        };
        let count = self.bounds.len() as u32;
        if let Some(split) = parallel::first(count, |split| !is_sound(&self.bounds[split as usize])) {
            return broken("the bounds of split", split as usize);
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

    fn check_triangles(&self, births: &[u32]) -> Result<(), HierarchyError> {
        let least = RangeMinima::new(births);
        let is_wrong = |triangle: u32, owner: u32| {
            let [mut x, mut y, mut z] = self.triangles[triangle as usize];
            if x > y {
                (x, y) = (y, x);
            }
            if y > z {
                (y, z) = (z, y);
            }
            if x > y {
                (x, y) = (y, x);
            }
            x == y || y == z || least.of(x + 1, y).max(least.of(y + 1, z)) != owner
        };
        // Owner 0 has the triangles never removed, owner s + 1 those of split s.
        let wrong_of = |owner: u32| {
            let start = owner.checked_sub(1).map_or(0, |split| self.first_triangle[split as usize]);
            (start..self.first_triangle[owner as usize]).find(|&triangle| is_wrong(triangle, owner))
        };
        let owners = self.bounds.len() as u32 + 1;
        match parallel::first(owners, |owner| wrong_of(owner).is_some()).and_then(wrong_of) {
            Some(triangle) => broken("the split that brings back triangle", triangle as usize),
            None => Ok(()),
        }
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
