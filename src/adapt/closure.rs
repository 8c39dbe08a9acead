//! The smallest closed set containing all refinements asked for, by reference counts.
//!
//! A refinement is in the mesh if it is asked for, or if another refinement in the mesh needs it. Each refinement has a
//! count of the refinements in the mesh needing it. Needs have no cycles, so the count decides membership, in any order
//! of requests.

use std::collections::BTreeMap;

use crate::geometry::paged::Paged;

use super::refinements::Refinements;
use super::states::{ASKED, DONE, States};

#[derive(Debug, Clone)]
pub(super) struct Closure {
    /// Per refinement, how many refinements in the mesh need it. `None` if no refinement has dependencies besides its
    /// parents.
    held: Option<Paged<u32, 9>>,
    stack: Vec<(u32, bool)>,
}

impl Closure {
    /// `dependencies`: whether any refinement has dependencies besides its parents.
    pub fn new(count: usize, dependencies: bool) -> Self {
        Self { held: dependencies.then(|| Paged::of(count, 0)), stack: Vec::new() }
    }

    /// Records a change of the request for `r`: asked for from now on, or no longer. `apply` is called with each
    /// refinement which then comes into the mesh or goes, in order.
    pub fn change<R: Refinements + ?Sized>(
        &mut self,
        of: &R,
        states: &mut States,
        r: u32,
        asked: bool,
        apply: &mut impl FnMut(&States, u32, bool),
    ) {
        let Self { held, stack } = self;
        match held {
            // Refinements asked for are already closed under parents.
            None => apply(states, r, asked),
            Some(held) if asked => bring(of, (held, stack), states, r, apply),
            Some(held) if held.at(r) == 0 => drop(of, (held, stack), states, r, apply),
            Some(_) => {}
        }
    }

    /// Looks for pages without counts.
    pub fn sweep(&mut self) {
        self.held.iter_mut().for_each(Paged::sweep);
    }

    /// Gives back memory if most of it is not in use.
    pub fn trim(&mut self) {
        self.held.iter_mut().for_each(Paged::trim);
    }

    /// Bytes of the counts.
    pub fn memory(&self) -> usize {
        self.held.as_ref().map_or(0, Paged::memory)
    }
}

type Counts<'a> = (&'a mut Paged<u32, 9>, &'a mut Vec<(u32, bool)>);

/// Brings a refinement with all that it needs.
fn bring<R: Refinements + ?Sized>(
    of: &R,
    (held, stack): Counts<'_>,
    states: &mut States,
    r: u32,
    apply: &mut impl FnMut(&States, u32, bool),
) {
    stack.push((r, false));
    while let Some((r, ready)) = stack.pop() {
        if states.is_done(r) {
            continue;
        }
        if ready {
            states.set(r, DONE);
            of.parents(r).chain(of.dependencies(r)).for_each(|n| *held.entry(n) += 1);
            apply(states, r, true);
        } else {
            stack.push((r, true));
            let missing = of.parents(r).chain(of.dependencies(r)).filter(|&n| !states.is_done(n));
            stack.extend(missing.map(|n| (n, false)));
        }
    }
}

/// Drops a refinement that nothing needs, with all that is then neither needed nor asked for.
fn drop<R: Refinements + ?Sized>(
    of: &R,
    (held, stack): Counts<'_>,
    states: &mut States,
    r: u32,
    apply: &mut impl FnMut(&States, u32, bool),
) {
    stack.push((r, false));
    while let Some((r, _)) = stack.pop() {
        states.unset(r, DONE);
        apply(states, r, false);
        for n in of.parents(r).chain(of.dependencies(r)) {
            let count = held.entry(n);
            *count -= 1;
            if *count == 0 && !states.has(n, ASKED) {
                stack.push((n, false));
            }
        }
    }
}

/// Whether all that a refinement needs is available, itself included, and none of it needs the refinement. Notes the first
/// refinement that is not available.
pub(super) fn may_come<R: Refinements + ?Sized>(of: &R, states: &States, r: u32) -> bool {
    if !R::PARTIAL {
        return true;
    }
    let needs = || of.parents(r).chain(of.dependencies(r));
    if of.available(r) && needs().all(|n| states.is_done(n)) {
        return true;
    }
    let (mut stack, mut seen) = (vec![(r, false)], BTreeMap::new());
    while let Some((r, all_seen)) = stack.pop() {
        // True for refinements of which all needs were looked at.
        if seen.insert(r, all_seen) == Some(true) || all_seen {
            seen.insert(r, true);
            continue;
        }
        if !of.available(r) {
            of.miss(r, true);
            return false;
        }
        stack.push((r, true));
        for need in of.parents(r).chain(of.dependencies(r)).filter(|&n| !states.is_done(n)) {
            match seen.get(&need) {
                Some(false) => return false,
                Some(true) => {}
                None => stack.push((need, false)),
            }
        }
    }
    true
}
