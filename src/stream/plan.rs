//! What a session must do for its views: the splits that they ask for, against the splits that its client has.

use std::collections::BinaryHeap;

use crate::adapt::{Key, Refinements};
use crate::hierarchy::VertexHierarchy;
use crate::view::{Criterion, ObjectView};

use super::bits::Bits;

/// The steps from what a client has to what its views ask for, in the order in which they are sent.
///
/// ```text
///     collapses   a split after all that build on it; first what is least urgent
///     splits      breadth first: the first level builds on what is there, the next on the first ...; in a level the most urgent first
/// ```
#[derive(Debug, Default)]
pub(super) struct Plan {
    /// Ends of the levels of `collapses` and of `splits`.
    pub collapse_levels: Vec<usize>,
    pub collapses: Vec<u32>,
    pub split_levels: Vec<usize>,
    pub splits: Vec<u32>,
    wanted: Bits,
    /// Splits in `wanted`, to empty it again.
    listed: Vec<u32>,
    stack: Vec<u32>,
    heap: BinaryHeap<Key>,
    level_of: Vec<u32>,
    sorted: Vec<(u32, Key)>,
}

/// What a session's client asks for.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Wish {
    pub views: Vec<ObjectView>,
    /// Most triangles.
    pub triangles: usize,
    /// Whether splits that no view asks for any more stay, while triangles are not limited.
    pub keeps: bool,
}

impl Plan {
    pub fn new(splits: usize) -> Self {
        Self { wanted: Bits::new(splits), level_of: vec![0; splits], ..Self::default() }
    }

    /// Plans the steps from `has` to what is asked for. Deterministic. O(has + asked for), each with a few tests, and log of it.
    pub fn make(&mut self, of: &VertexHierarchy, has: &Bits, wish: &Wish) {
        self.find_wanted(of, wish);
        self.collapses.clear();
        self.splits.clear();
        let keeps = wish.keeps && wish.triangles == usize::MAX;
        if !keeps {
            has.without(&self.wanted, |split| self.collapses.push(split));
        }
        self.wanted.without(has, |split| self.splits.push(split));
        for at in 0..self.listed.len() {
            self.wanted.remove(self.listed[at]);
        }
        self.listed.clear();
        let Self { collapses, splits, level_of, sorted, .. } = self;
        let key = |split: u32| Key {
            urgency: wish.views.iter().map(|view| view.urgency(&of.bounds(split))).fold(0.0, f64::max),
            error: of.error(split),
            refinement: split,
        };
        // A level above all levels of what it builds on, or, to go, of what builds on it. Numbers ascend from coarse to fine.
        sorted.clear();
        for &split in &*splits {
            let before = of.parents(split).chain(of.dependencies(split));
            let level = before.map(|other| level_of[other as usize]).max().unwrap_or(0) + 1;
            level_of[split as usize] = level;
            sorted.push((level, key(split)));
        }
        splits.iter().for_each(|&split| level_of[split as usize] = 0);
        sorted.sort_unstable_by(|a, b| a.0.cmp(&b.0).then(b.1.cmp(&a.1)));
        unpack(sorted, splits, &mut self.split_levels);
        sorted.clear();
        for &split in collapses.iter().rev() {
            let level = level_of[split as usize] + 1;
            for other in of.parents(split).chain(of.dependencies(split)) {
                let above = &mut level_of[other as usize];
                *above = (*above).max(level);
            }
            sorted.push((level, key(split)));
        }
        // Levels of splits that stay were raised too.
        for &split in &*collapses {
            level_of[split as usize] = 0;
            of.parents(split).chain(of.dependencies(split)).for_each(|other| level_of[other as usize] = 0);
        }
        sorted.sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.cmp(&b.1)));
        unpack(sorted, collapses, &mut self.collapse_levels);
    }

    fn find_wanted(&mut self, of: &VertexHierarchy, wish: &Wish) {
        self.stack.clear();
        self.heap.clear();
        if wish.views.is_empty() {
            return;
        }
        let views = &wish.views[..];
        if wish.triangles == usize::MAX {
            // All that is asked for: a split needs an answer once all its parents have a yes.
            self.stack.extend(of.roots());
            while let Some(split) = self.stack.pop() {
                let due = !self.wanted.has(split) && of.parents(split).all(|parent| self.wanted.has(parent));
                if due && views.test(&of.bounds(split)).refine {
                    self.wanted.add(split);
                    self.listed.push(split);
                    self.stack.extend(of.children(split));
                }
            }
            if of.has_dependencies() {
                for at in 0..self.listed.len() {
                    self.close(of, self.listed[at]);
                }
            }
            return;
        }
        let key = |split: u32| Key {
            urgency: views.urgency(&of.bounds(split)),
            error: of.error(split),
            refinement: split,
        };
        self.heap.extend(of.roots().map(key));
        let mut triangles = of.base_triangle_count();
        while let Some(next) = self.heap.pop() {
            if next.urgency <= 1.0 || next.urgency.is_nan() {
                break;
            }
            if self.wanted.has(next.refinement) {
                // Needed by another, and so its children were looked at.
                continue;
            }
            let before = self.listed.len();
            self.close(of, next.refinement);
            let added: usize = self.listed[before..].iter().map(|&split| of.owned(split).len()).sum();
            if triangles + added > wish.triangles {
                self.listed.drain(before..).for_each(|split| self.wanted.remove(split));
                break;
            }
            triangles += added;
            for at in before..self.listed.len() {
                // A child comes after all its parents, none of which is less urgent.
                let children = of.children(self.listed[at]).filter(|&child| !self.wanted.has(child));
                let due = children.filter(|&child| of.parents(child).all(|parent| self.wanted.has(parent)));
                self.heap.extend(due.map(key).filter(|child| child.urgency > 1.0));
            }
        }
    }

    /// Adds a split, and all that it needs.
    fn close(&mut self, of: &VertexHierarchy, split: u32) {
        let first = self.stack.len();
        self.stack.push(split);
        if self.wanted.has(split) {
            // Its own needs may be missing.
            self.stack.pop();
            self.stack.extend(of.dependencies(split).chain(of.parents(split)));
        }
        while self.stack.len() > first {
            let Some(next) = self.stack.pop() else { break };
            if !self.wanted.has(next) {
                self.wanted.add(next);
                self.listed.push(next);
                self.stack.extend(of.dependencies(next).chain(of.parents(next)));
            }
        }
    }
}

fn unpack(sorted: &[(u32, Key)], splits: &mut Vec<u32>, levels: &mut Vec<usize>) {
    splits.clear();
    levels.clear();
    for (at, (level, key)) in sorted.iter().enumerate() {
        if at > 0 && sorted[at - 1].0 != *level {
            levels.push(at);
        }
        splits.push(key.refinement);
    }
    if !sorted.is_empty() {
        levels.push(sorted.len());
    }
}
