//! Every promise of a vertex hierarchy, checked.

use crate::adapt::Refinements;
use crate::mesh::NONE;

use super::{HierarchyError, Lists, VertexHierarchy};

impl VertexHierarchy {
    /// Checks that the structure holds together: every index in range; substitutes form a forest in which the leaves that a vertex
    /// stands for are one run; parents and children are each other's reverse; parents and needs have no cycle; bounds are
    /// nested; every triangle comes back with the split at which two of its corners part. O(n log n).
    ///
    /// # Errors
    /// The first promise that is broken, and where.
    pub fn validate(&self) -> Result<(), HierarchyError> {
        self.check_lengths()?;
        self.check_forest()?;
        self.check_order()?;
        self.check_bounds()?;
        self.check_triangles()
    }

    fn check_lengths(&self) -> Result<(), HierarchyError> {
        let (vertices, splits, triangles) = (self.substitute.len(), self.bounds.len(), self.triangles.len());
        let leaves = self.leaves as usize;
        expect("split of every vertex", self.split_of.len(), vertices)?;
        expect("first leaves of new vertices", self.first_leaf.len(), vertices.wrapping_sub(leaves))?;
        expect(
            "groups of triangles",
            self.group_of.len(),
            if self.materials.len() > 1 { triangles } else { 0 },
        )?;
        expect("starts of splits' triangles", self.first_triangle.len(), splits + 1)?;
        let limits = [
            ("brings", &self.brings, vertices),
            ("parents", &self.parents, splits),
            ("children", &self.children, splits),
            ("needs", &self.needs, splits),
        ];
        for (what, lists, limit) in limits {
            expect(what, lists.start.len(), splits + 1)?;
            let ends =
                lists.start.first() == Some(&0) && lists.start.last() == Some(&(lists.items.len() as u32));
            if !ends || !lists.start.is_sorted() {
                return broken("a list's start", what.len());
            }
            in_range(what, &lists.items, limit)?;
        }
        in_range("roots", &self.roots, splits)?;
        in_range("substitutes", &self.substitute, vertices)?;
        in_range("first leaves", &self.first_leaf, leaves)?;
        in_range("corners of triangles", self.triangles.as_flattened(), leaves)?;
        if let Some(triangle) = self.group_of.iter().position(|&g| usize::from(g) >= self.materials.len()) {
            return broken("the group of triangle", triangle);
        }
        if !self.materials.is_sorted() {
            return broken("the order of materials at", 0);
        }
        if !self.first_triangle.is_sorted() || self.first_triangle.last() != Some(&(triangles as u32)) {
            return broken("the start of splits' triangles at", 0);
        }
        if !self.diagonal.is_finite() || self.diagonal < 0.0 {
            return broken("the diagonal", 0);
        }
        Ok(())
    }

    fn check_forest(&self) -> Result<(), HierarchyError> {
        let mut split_of = vec![NONE; self.substitute.len()];
        for split in 0..self.bounds.len() as u32 {
            for &vertex in self.brings.get(split) {
                if std::mem::replace(&mut split_of[vertex as usize], split) != NONE {
                    return broken("what brings vertex", vertex as usize);
                }
            }
        }
        for (vertex, (&known, &found)) in self.split_of.iter().zip(&split_of).enumerate() {
            let stays = self.substitute[vertex] as usize == vertex;
            if known != found || stays != (found == NONE) {
                return broken("the split of vertex", vertex);
            }
        }
        // Splits from fine to coarse put together runs that touch.
        let mut run: Vec<(u32, u32)> = (0..self.substitute.len() as u32)
            .map(|v| if v < self.leaves { (v, v + 1) } else { (self.first_leaf(v), self.first_leaf(v)) })
            .collect();
        for split in (0..self.bounds.len() as u32).rev() {
            for &vertex in self.brings.get(split) {
                let (part, whole) =
                    (run[vertex as usize], &mut run[self.substitute[vertex as usize] as usize]);
                if part.0 != self.first_leaf(vertex) || part.0 != whole.1 {
                    return broken("the leaves of vertex", vertex as usize);
                }
                whole.1 = part.1;
            }
        }
        Ok(())
    }

    fn check_order(&self) -> Result<(), HierarchyError> {
        let count = self.bounds.len();
        let pairs = |lists: &Lists, flip: bool| {
            let mut all: Vec<[u32; 2]> = Vec::with_capacity(lists.items.len());
            for split in 0..count as u32 {
                all.extend(lists.get(split).iter().map(|&o| if flip { [o, split] } else { [split, o] }));
            }
            all.sort_unstable();
            all
        };
        if pairs(&self.parents, false) != pairs(&self.children, true) {
            return broken("the children of splits, which are not the reverse of parents, at", 0);
        }
        let roots = (0..count as u32).filter(|&split| self.parents.get(split).is_empty());
        if !roots.eq(self.roots.iter().copied()) {
            return broken("the roots at", 0);
        }
        for split in 0..count as u32 {
            if self.parents(split).any(|parent| parent >= split) {
                return broken("the place of split", split as usize);
            }
            // A vertex comes back only where what takes its place is there.
            for &vertex in self.brings.get(split) {
                let above = self.split_of[self.substitute[vertex as usize] as usize];
                let known = above == NONE || above == split || self.reaches(split, above);
                if !known {
                    return broken("the parents of split", split as usize);
                }
            }
        }
        // Needs and parents together: take away what nothing left needs until nothing is left.
        let mut held = vec![0_u32; count];
        let all = |split: u32| self.parents(split).chain(self.needs(split));
        (0..count as u32).for_each(|split| all(split).for_each(|other| held[other as usize] += 1));
        let mut free: Vec<u32> = (0..count as u32).filter(|&split| held[split as usize] == 0).collect();
        let mut taken = 0;
        while let Some(split) = free.pop() {
            taken += 1;
            for other in all(split) {
                held[other as usize] -= 1;
                if held[other as usize] == 0 {
                    free.push(other);
                }
            }
        }
        if taken != count { broken("the needs of splits, which form a cycle, at", taken) } else { Ok(()) }
    }

    /// Whether `above` is among what `split` is nested in. Parents come before their children.
    fn reaches(&self, split: u32, above: u32) -> bool {
        let mut stack = vec![split];
        while let Some(at) = stack.pop() {
            if at == above {
                return true;
            }
            stack.extend(self.parents(at).filter(|&parent| parent >= above));
        }
        false
    }

    fn check_bounds(&self) -> Result<(), HierarchyError> {
        for split in 0..self.bounds.len() as u32 {
            let bounds = &self.bounds[split as usize];
            let numbers = [bounds.radius, bounds.error, bounds.parametric];
            let sound = numbers.iter().all(|x| x.is_finite() && *x >= 0.0)
                && bounds.centre.iter().all(|x| x.is_finite());
            if !sound || !self.children(split).all(|child| bounds.contains(&self.bounds[child as usize])) {
                return broken("the bounds of split", split as usize);
            }
        }
        Ok(())
    }

    fn check_triangles(&self) -> Result<(), HierarchyError> {
        for (triangle, corners) in self.triangles.iter().enumerate() {
            let owner = self.first_triangle.partition_point(|&first| first as usize <= triangle);
            let equal = |there: &dyn Fn(u32) -> bool| {
                let [a, b, c] = corners.map(|leaf| self.active(leaf, there));
                a == b || b == c || c == a
            };
            let sound = match owner.checked_sub(1) {
                None => !equal(&|_| false),
                Some(owner) => {
                    let owner = owner as u32;
                    let needed = |other: u32| other < owner && self.reaches(owner, other);
                    equal(&needed) && !equal(&|other| other == owner || needed(other))
                }
            };
            if !sound {
                return broken("the split that brings back triangle", triangle);
            }
        }
        Ok(())
    }
}

fn expect(what: &'static str, found: usize, expected: usize) -> Result<(), HierarchyError> {
    if found == expected { Ok(()) } else { Err(HierarchyError::Length { what, found, expected }) }
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
