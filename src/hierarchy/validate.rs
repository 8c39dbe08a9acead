//! Checks all invariants of a vertex hierarchy. A valid hierarchy never panics, never loops without end, and shows only
//! the image of its triangles.
//!
//! ```text
//!     replay all collapses, fine to coarse:
//!       who is taken, and by whom?      both are still there: so substitutes form a forest
//!       what does it stand for?         runs of leaves that touch: so one comparison a corner tells both sides of a split
//!     every triangle comes back with the split at which the last two of its corners part
//! ```
//!
//! All splits at a vertex are nested in one another by construction, because parents are derived from the same replay.
//! For the last invariant, vertices are numbered by reverse order of their collapses. The split of a triangle is the
//! split of the highest number at which paths of its corners meet. Jump pointers find it, for chains of any length.

use crate::mesh::{MAX_ELEMENTS, NONE};
use crate::sequence::collapse_forest::{Forest, is_degenerate};
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
    /// any input.
    ///
    /// # Errors
    /// The first broken invariant, and its place.
    pub fn validate(&self) -> Result<(), HierarchyError> {
        self.check_arrays()?;
        let derived = self.derived();
        for (what, known, found) in [
            ("the split of vertex", &self.split_of, &derived.split_of),
            ("the start of parents of split", &self.parents.start, &derived.parents.start),
            ("entry of parents", &self.parents.items, &derived.parents.items),
            ("the start of children of split", &self.children.start, &derived.children.start),
            ("entry of children", &self.children.items, &derived.children.items),
            ("entry of roots", &self.roots, &derived.roots),
        ] {
            same(what, known, found)?;
        }
        self.check_promises()?;
        same("the jump of vertex", &self.jump, &self.jumps())
    }

    /// Checks the invariants which need only [`Self::check_arrays`] and the derived arrays.
    pub(super) fn check_promises(&self) -> Result<(), HierarchyError> {
        self.check_collapses()?;
        self.check_cycles()?;
        self.check_bounds()?;
        self.check_triangles()
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

    /// Replays all collapses.
    fn check_collapses(&self) -> Result<(), HierarchyError> {
        for (vertex, (&to, &split)) in self.substitute.iter().zip(&self.split_of).enumerate() {
            if (to as usize == vertex) != (split == NONE) {
                return broken("the substitute of vertex", vertex);
            }
        }
        let mut gone = vec![false; self.substitute.len()];
        // Per vertex, the end of its run.
        let mut end: Vec<u32> =
            (0..self.leaves).map(|leaf| leaf + 1).chain(self.first_leaf.iter().copied()).collect();
        for split in (0..self.bounds.len() as u32).rev() {
            let brings = self.brings.get(split);
            if brings.is_empty() {
                return broken("what is brought by split", split as usize);
            }
            for &vertex in brings {
                let (v, to) = (vertex as usize, self.substitute[vertex as usize]);
                if self.split_of[v] != split || gone[v] || gone[to as usize] {
                    return broken("the collapse of vertex", v);
                }
                gone[v] = true;
                let first = self.first_leaf(vertex);
                if first == end[v] || first != end[to as usize] {
                    return broken("the run of leaves of vertex", v);
                }
                end[to as usize] = end[v];
            }
        }
        Ok(())
    }

    /// Checks dependencies and parents together for cycles: removes splits needed by no remaining split until none are
    /// left.
    fn check_cycles(&self) -> Result<(), HierarchyError> {
        let count = self.bounds.len();
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
        if let Some(split) = self.bounds.iter().position(|bounds| !is_sound(bounds)) {
            return broken("the bounds of split", split);
        }
        for (split, bounds) in self.bounds.iter().enumerate() {
            let mut children = self.children.get(split as u32).iter();
            if let Some(&child) = children.find(|&&child| !bounds.contains(&self.bounds[child as usize])) {
                return broken("within those of its parents, the bounds of split", child as usize);
            }
        }
        Ok(())
    }

    fn check_triangles(&self) -> Result<(), HierarchyError> {
        let count = self.substitute.len();
        let mut order: Vec<u32> =
            (0..count as u32).filter(|&vertex| self.split_of[vertex as usize] == NONE).collect();
        for split in 0..self.bounds.len() as u32 {
            order.extend(self.brings.get(split).iter().rev());
        }
        let mut number = vec![0_u32; count];
        order.iter().enumerate().for_each(|(i, &vertex)| number[vertex as usize] = i as u32);
        let parents = order.iter().map(|&vertex| number[self.substitute[vertex as usize] as usize]);
        let forest = Forest::new(parents.collect());

        let base = 0..self.first_triangle[0];
        let owned = (0..self.bounds.len() as u32).map(|split| (split, self.owned(split)));
        for (owner, triangles) in std::iter::once((NONE, base)).chain(owned) {
            for triangle in triangles {
                let corners = self.triangles[triangle as usize].map(|leaf| number[leaf as usize]);
                let parts = || match forest.vanishes(corners) {
                    Some(number) => self.split_of[order[number as usize] as usize],
                    None => NONE,
                };
                if is_degenerate(corners) || parts() != owner {
                    return broken("the split that brings back triangle", triangle as usize);
                }
            }
        }
        Ok(())
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
            ("the split of vertex", |h| h.split_of[0] ^= 1),
            ("the start of parents", |h| h.parents.start[3] += 1),
            ("entry of parents", |h| h.parents.items[2] += 1),
            ("the start of children", |h| h.children.start[3] += 1),
            ("entry of children", |h| h.children.items[2] += 1),
            ("entry of roots", |h| h.roots.push(1)),
            ("entry of roots", |h| h.roots.clear()),
            ("the jump of vertex", |h| h.jump.push(0)),
        ];
        for (why, damage) in breaks {
            let mut bad = good.clone();
            damage(&mut bad);
            let said = bad.validate().expect_err(why).to_string();
            assert!(said.starts_with(why), "{why}: {said}");
        }
    }
}
