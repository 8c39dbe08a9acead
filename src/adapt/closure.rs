//! The smallest closed set containing all refinements asked for, by reference counts.
//!
//! A refinement is in the mesh if it is asked for, or if another refinement in the mesh needs it. Each refinement has a
//! count of the refinements in the mesh needing it. Needs have no cycles, so the count decides membership, in any order
//! of requests.

use std::collections::BTreeMap;

use super::front::{ASKED, DONE};
use super::refinements::Refinements;

#[derive(Debug, Clone)]
pub(super) struct Closure {
    /// Per refinement, how many refinements in the mesh need it. Empty if no refinement has dependencies besides its
    /// parents.
    held: Vec<u32>,
    stack: Vec<(u32, bool)>,
}

impl Closure {
    /// `dependencies`: whether any refinement has dependencies besides its parents.
    pub fn new(count: usize, dependencies: bool) -> Self {
        Self { held: if dependencies { vec![0; count] } else { Vec::new() }, stack: Vec::new() }
    }

    /// Records a change of the request for `r`: asked for from now on, or no longer. `apply` is called with each
    /// refinement which then comes into the mesh or goes, in order.
    pub fn change<R: Refinements + ?Sized>(
        &mut self,
        of: &R,
        state: &mut [u8],
        r: u32,
        asked: bool,
        apply: &mut impl FnMut(&[u8], u32, bool),
    ) {
        if self.held.is_empty() {
            // Refinements asked for are already closed under parents.
            state[r as usize] ^= DONE;
            apply(state, r, asked);
        } else if asked {
            self.bring(of, state, r, apply);
        } else if self.held[r as usize] == 0 {
            self.drop(of, state, r, apply);
        }
    }

    fn bring<R: Refinements + ?Sized>(
        &mut self,
        of: &R,
        state: &mut [u8],
        r: u32,
        apply: &mut impl FnMut(&[u8], u32, bool),
    ) {
        self.stack.push((r, false));
        while let Some((r, ready)) = self.stack.pop() {
            if state[r as usize] & DONE != 0 {
                continue;
            }
            if ready {
                state[r as usize] |= DONE;
                of.parents(r).chain(of.dependencies(r)).for_each(|n| self.held[n as usize] += 1);
                apply(state, r, true);
            } else {
                self.stack.push((r, true));
                let missing =
                    of.parents(r).chain(of.dependencies(r)).filter(|&n| state[n as usize] & DONE == 0);
                self.stack.extend(missing.map(|n| (n, false)));
            }
        }
    }

    fn drop<R: Refinements + ?Sized>(
        &mut self,
        of: &R,
        state: &mut [u8],
        r: u32,
        apply: &mut impl FnMut(&[u8], u32, bool),
    ) {
        self.stack.push((r, false));
        while let Some((r, _)) = self.stack.pop() {
            state[r as usize] &= !DONE;
            apply(state, r, false);
            for n in of.parents(r).chain(of.dependencies(r)) {
                self.held[n as usize] -= 1;
                if self.held[n as usize] == 0 && state[n as usize] & ASKED == 0 {
                    self.stack.push((n, false));
                }
            }
        }
    }

    /// Bytes of the counts.
    pub fn memory(&self) -> usize {
        size_of_val(&self.held[..])
    }
}

/// Whether all that a refinement needs is available, itself included, and none of it needs the refinement. Notes the first
/// refinement that is not available.
pub(super) fn may_come<R: Refinements + ?Sized>(of: &R, state: &[u8], r: u32) -> bool {
    if !R::PARTIAL {
        return true;
    }
    let needs = || of.parents(r).chain(of.dependencies(r));
    if of.available(r) && needs().all(|n| state[n as usize] & DONE != 0) {
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
        for need in of.parents(r).chain(of.dependencies(r)).filter(|&n| state[n as usize] & DONE == 0) {
            match seen.get(&need) {
                Some(false) => return false,
                Some(true) => {}
                None => stack.push((need, false)),
            }
        }
    }
    true
}
