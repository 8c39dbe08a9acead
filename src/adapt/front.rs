//! The refinements asked for by a view, kept up to date by testing only refinements with answers due.
//!
//! ```text
//!              o          asked for: all that it needs is asked for too
//!            /   \
//!          o       o      the rim: asked for, with nothing asked for above it     -> may go
//!         / \     / \
//!        .   .   .   .    the fringe: not asked for, but all that it needs is     -> may come
//! ```
//!
//! Rim and fringe are the front. Its bounds and answers lie in dense arrays, so a frame reads memory in order: first how long
//! answers hold (`sleepers.rs`), then the bounds of those with answers due.
//!
//! Tests are monotone in nested bounds, so testing rim and fringe finds all refinements needed. An answer depends on the
//! view alone, so the set does not depend on its previous state.

use std::hint::black_box;

use crate::geometry::paged::{trim, trim_to};
use crate::view::{Answer, Criterion, Factors, Motion};

use super::closure::may_come;
use super::refinements::Refinements;
use super::sleepers::Sleepers;
use super::states::{ASKED, NOWHERE, States, WAITS};

/// Tests at a time.
const BATCH: usize = 64;

/// Changes at a time, looked at ahead.
const AHEAD: usize = 32;

/// What follows the changes of a set.
pub(super) trait Changes {
    /// Called with some changes that are likely to come next.
    fn look_ahead(&mut self, changes: &[(u32, bool)]);
    /// Called with each change, in an order which keeps the set closed. If it returns `false`, the update stops.
    fn change(&mut self, states: &mut States, r: u32, asked: bool) -> bool;
}

/// A refinement at the front.
#[derive(Debug, Clone, Copy)]
struct Node<B> {
    refinement: u32,
    asked: bool,
    bounds: B,
}

#[derive(Debug, Clone)]
pub(super) struct Front<B> {
    /// Flags of every refinement, and its place in the front.
    pub states: States,
    /// Per place, the refinement and how long its answer holds.
    nodes: Vec<Node<B>>,
    sleepers: Sleepers,
    /// Whether the roots have come to the front.
    started: bool,
    /// Places with answers due; refinements that are new at the front; and refinements with other answers than before, the last
    /// to be changed first, some at a time.
    due: Vec<u32>,
    new: Vec<u32>,
    work: Vec<(u32, bool)>,
    next: Vec<(u32, bool)>,
    /// Refinements looked at ahead.
    near: Vec<u32>,
    /// A batch of tests.
    bounds: Vec<B>,
    /// Refinements waiting for themselves, or for others they need, to arrive; and whether any arrived.
    waiting: Vec<u32>,
    arrived: bool,
    /// Tests so far.
    pub tests: u64,
    /// Blocks of the front in the last update, and those of them that slept.
    pub blocks: [usize; 2],
}

impl<B: Copy> Front<B> {
    /// Creates an empty set without answers. `size` is the object's size, object units. `dependencies`: whether any refinement has
    /// dependencies besides its parents.
    pub fn new(count: usize, size: f64, dependencies: bool) -> Self {
        Self {
            states: States::new(count, dependencies),
            nodes: Vec::new(),
            sleepers: Sleepers::new(size),
            started: false,
            due: Vec::new(),
            new: Vec::new(),
            work: Vec::new(),
            next: Vec::new(),
            near: Vec::new(),
            bounds: Vec::new(),
            waiting: Vec::new(),
            arrived: false,
            tests: 0,
            blocks: [0; 2],
        }
    }

    /// Moves the set to the refinements asked for now. If `changes` stops the update, all answers are forgotten, and the set is
    /// closed but not complete. Returns whether the update was completed.
    pub fn update<R: Refinements<Bounds = B> + ?Sized, C: Criterion<B> + ?Sized>(
        &mut self,
        of: &R,
        criterion: &C,
        motion: Motion,
        changes: &mut impl Changes,
    ) -> bool {
        self.new.clear();
        let asleep = self.sleepers.advance(motion, &mut self.due);
        self.blocks = [self.sleepers.blocks(), asleep];
        self.arrive(of, motion == Motion::Other);
        if motion == Motion::Other {
            self.renew(of);
        }
        self.test_due(criterion);
        // What lies close together is made close together: by number, and what follows from some changes before the next ones.
        while !self.work.is_empty() {
            let mut next = std::mem::take(&mut self.next);
            next.extend(self.work.drain(self.work.len().saturating_sub(AHEAD)..).rev());
            let all = self.make(of, &next, changes);
            next.clear();
            self.next = next;
            if !all {
                self.forget();
                return false;
            }
            self.test_due(criterion);
        }
        self.states.sweep();
        true
    }

    /// Gives back memory if most of it is not in use.
    pub fn trim(&mut self) {
        self.states.trim();
        let Self { nodes, sleepers, due, new, work, .. } = self;
        trim(nodes);
        sleepers.trim();
        [due, new].into_iter().for_each(|list| trim_to(list, nodes.len()));
        trim_to(work, nodes.len());
    }

    /// Makes changes, until one of them stops the update. Returns whether none did.
    fn make<R: Refinements<Bounds = B> + ?Sized>(
        &mut self,
        of: &R,
        next: &[(u32, bool)],
        changes: &mut impl Changes,
    ) -> bool {
        self.look_ahead(of, next);
        changes.look_ahead(next);
        for &(r, asked) in next {
            // Refinements that left the front since.
            if self.asked_at(r) != Some(!asked) {
                continue;
            }
            if asked && !self.may_come(of, r) {
                self.wait(r);
                continue;
            }
            self.toggle(of, r);
            if !changes.change(&mut self.states, r, asked) {
                return false;
            }
        }
        true
    }

    /// Fetches what some changes are going to read: reads that miss the cache are waited for once, not one after the other.
    fn look_ahead<R: Refinements<Bounds = B> + ?Sized>(&mut self, of: &R, changes: &[(u32, bool)]) {
        if R::PARTIAL {
            return;
        }
        let Self { near, states, .. } = self;
        near.clear();
        for &(r, asked) in changes {
            if asked {
                near.extend(of.children(r));
            } else {
                near.extend(of.parents(r));
            }
        }
        let mut sum = 0;
        for &n in near.iter() {
            sum ^= states.place(n);
            black_box(of.bounds(n));
            for other in of.parents(n).chain(of.children(n)) {
                sum ^= states.place(other);
            }
        }
        black_box(sum);
    }

    /// Asks about the places due and about what is new at the front, and notes other answers than before.
    fn test_due<C: Criterion<B> + ?Sized>(&mut self, criterion: &C) {
        let Self { nodes, states, sleepers, due, new, bounds, work, .. } = self;
        let mut answers = [Answer::NEVER; BATCH];
        // Some may have left again.
        due.extend(new.drain(..).map(|r| states.place(r)).filter(|&place| place != NOWHERE));
        let before = work.len();
        for due in due.chunks(BATCH) {
            bounds.clear();
            bounds.extend(due.iter().map(|&place| nodes[place as usize].bounds));
            let answers = &mut answers[..due.len()];
            criterion.test_each(bounds, Factors::NONE, answers);
            for (&place, answer) in due.iter().zip(answers) {
                sleepers.rest(place as usize, *answer);
                let node = &nodes[place as usize];
                if answer.refine != node.asked {
                    work.push((node.refinement, answer.refine));
                }
            }
        }
        work[before..].sort_unstable_by(|a, b| b.cmp(a));
        self.tests += due.len() as u64;
        due.clear();
    }

    /// Whether all that a refinement needs has arrived. Notes what has not.
    pub fn may_come<R: Refinements<Bounds = B> + ?Sized>(&self, of: &R, r: u32) -> bool {
        if !R::PARTIAL {
            return true;
        }
        if !of.available(r) {
            of.miss(r, false);
            return false;
        }
        // What comes from outside may be contradictory: parents that would not know of it would leave without it.
        let knows =
            |parent: u32| self.states.has(parent, ASKED) && of.children(parent).any(|child| child == r);
        of.parents(r).all(knows) && may_come(of, &self.states, r)
    }

    /// Asks for a refinement at the front, or no longer, where all answers are forgotten.
    pub fn force<R: Refinements<Bounds = B> + ?Sized>(&mut self, of: &R, r: u32) {
        self.toggle(of, r);
        self.new.clear();
    }

    /// Asks for a refinement at the front, or no longer.
    fn toggle<R: Refinements<Bounds = B> + ?Sized>(&mut self, of: &R, r: u32) {
        let asked = !self.states.has(r, ASKED);
        let place = self.states.ask(r, asked);
        self.nodes[place as usize].asked = asked;
        // Refinements on one side leave the front, refinements on the other may come to it.
        if asked {
            of.parents(r).for_each(|parent| self.leave(parent));
            for child in of.children(r) {
                self.enter(of, child);
            }
        } else {
            of.children(r).for_each(|child| self.leave(child));
            for parent in of.parents(r) {
                self.enter(of, parent);
            }
        }
    }

    /// Adds a refinement to the front if it belongs there.
    #[inline]
    fn enter<R: Refinements<Bounds = B> + ?Sized>(&mut self, of: &R, r: u32) {
        if self.states.place(r) != NOWHERE || !self.belongs(of, r) {
            return;
        }
        self.states.move_to(r, self.nodes.len() as u32);
        let asked = self.states.has(r, ASKED);
        self.nodes.push(Node { refinement: r, asked, bounds: of.bounds(r) });
        self.sleepers.push();
        self.new.push(r);
    }

    /// Whether a refinement is on the rim or the fringe, and waits for nothing.
    #[inline]
    fn belongs<R: Refinements<Bounds = B> + ?Sized>(&mut self, of: &R, r: u32) -> bool {
        if self.states.has(r, ASKED) {
            return !of.children(r).any(|child| self.states.has(child, ASKED));
        }
        if R::PARTIAL && self.states.has(r, WAITS) {
            return false;
        }
        if R::PARTIAL && !of.available(r) {
            of.miss(r, false);
            self.wait(r);
            return false;
        }
        of.parents(r).all(|parent| self.states.has(parent, ASKED))
    }

    /// Takes a refinement away from the front, if it is there.
    #[inline]
    fn leave(&mut self, r: u32) {
        let place = self.states.place(r);
        if place == NOWHERE {
            return;
        }
        self.states.move_to(r, NOWHERE);
        self.nodes.swap_remove(place as usize);
        self.sleepers.swap_remove(place as usize);
        if let Some(moved) = self.nodes.get(place as usize) {
            self.states.move_to(moved.refinement, place);
        }
    }

    /// Takes a refinement away from the front until others arrive.
    fn wait(&mut self, r: u32) {
        self.leave(r);
        self.states.set(r, WAITS);
        self.waiting.push(r);
    }

    /// Asks again, in the next update, about what waits for others to arrive.
    #[cfg(all(feature = "stream", feature = "io"))]
    pub fn arrived(&mut self) {
        self.arrived = true;
    }

    /// Brings the roots to the front once, and, if others have arrived or `all`, what waits for others.
    fn arrive<R: Refinements<Bounds = B> + ?Sized>(&mut self, of: &R, all: bool) {
        if !std::mem::replace(&mut self.started, true) {
            for root in of.roots() {
                self.enter(of, root);
            }
        }
        if std::mem::take(&mut self.arrived) || all {
            let waiting = std::mem::take(&mut self.waiting);
            for &r in &waiting {
                self.states.unset(r, WAITS);
            }
            for r in waiting {
                self.enter(of, r);
            }
        }
    }

    /// Reads all bounds anew: a structure may have changed.
    fn renew<R: Refinements<Bounds = B> + ?Sized>(&mut self, of: &R) {
        for node in &mut self.nodes {
            if !R::PARTIAL || of.available(node.refinement) {
                node.bounds = of.bounds(node.refinement);
            }
        }
    }

    /// Forgets all answers, but not the set.
    pub fn forget(&mut self) {
        self.sleepers.forget();
        self.work.clear();
        self.new.clear();
    }

    /// Forgets all answers, and returns the refinements at the front, and whether each is asked for.
    pub fn all<R: Refinements<Bounds = B> + ?Sized>(&mut self, of: &R) -> impl Iterator<Item = (u32, bool)> {
        self.forget();
        self.arrive(of, true);
        if R::PARTIAL {
            let gone = |node: &&Node<B>| !node.asked && !of.available(node.refinement);
            let gone: Vec<u32> = self.nodes.iter().filter(gone).map(|node| node.refinement).collect();
            for r in gone {
                of.miss(r, false);
                self.wait(r);
            }
        }
        self.nodes.iter().map(|node| (node.refinement, node.asked))
    }

    /// Returns whether a refinement at the front is asked for; `None` if it is not at the front.
    #[inline]
    pub fn asked_at(&self, r: u32) -> Option<bool> {
        self.nodes.get(self.states.place(r) as usize).map(|node| node.asked)
    }

    /// Blocks of the front.
    pub fn blocks_now(&self) -> usize {
        self.sleepers.blocks()
    }

    /// Bytes of the arrays.
    pub fn memory(&self) -> usize {
        self.states.memory()
            + self.nodes.capacity() * size_of::<Node<B>>()
            + (self.due.capacity() + self.new.capacity() + self.waiting.capacity()) * size_of::<u32>()
            + self.work.capacity() * size_of::<(u32, bool)>()
            + self.sleepers.memory()
    }
}
