//! [`Weights`]: how far each refinement in transition has come. `adapt` advances them; structures only read them.
//!
//! ```text
//!     opening   from its weight at the start to 1
//!     closing   from its weight at the start to 0
//! ```
//!
//! A refinement which turns round starts anew from its current weight, so nothing jumps.

use crate::geometry::paged::{Paged, trim};
use crate::mesh::NONE;

/// A refinement on its way in or out.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Transition {
    pub refinement: u32,
    from: f32,
    to: f32,
    /// Share of the way travelled, 0 to 1.
    pub share: f32,
}

impl Transition {
    /// Whether the refinement is on its way out.
    #[inline]
    pub fn is_closing(&self) -> bool {
        self.to == 0.0
    }

    #[inline]
    pub fn is_over(&self) -> bool {
        self.share >= 1.0
    }

    /// Returns the current weight: 0 without the refinement, 1 with it.
    #[inline]
    pub fn weight(&self) -> f32 {
        if self.is_over() { self.to } else { self.from + (self.to - self.from) * self.share }
    }
}

/// The transitions of an instance. Refinements in none have weight 1 if shown, else 0.
#[derive(Debug, Clone)]
pub(crate) struct Weights {
    /// Per refinement its transition, or `NONE`; without elements if vertices do not move.
    transition_of: Paged<u32, 9>,
    transitions: Vec<Transition>,
}

/// No transitions.
pub(crate) static AT_REST: Weights = Weights { transition_of: Paged::new(NONE), transitions: Vec::new() };

impl Weights {
    /// Starts without transitions. `moves`: whether there may be any.
    pub fn new(refinements: usize, moves: bool) -> Self {
        let count = if moves { refinements } else { 0 };
        Self { transition_of: Paged::of(count, NONE), transitions: Vec::new() }
    }

    pub fn len(&self) -> usize {
        self.transitions.len()
    }

    /// Returns all transitions, in no order.
    #[inline]
    pub fn all(&self) -> &[Transition] {
        &self.transitions
    }

    /// Returns the transition of a refinement; `None` at rest.
    #[inline]
    pub fn of(&self, r: u32) -> Option<&Transition> {
        self.transitions.get(self.transition_of.get(r) as usize)
    }

    /// Advances all transitions by a share of their way.
    pub(super) fn advance(&mut self, progress: f32) {
        for transition in &mut self.transitions {
            transition.share = (transition.share + progress).min(1.0);
        }
    }

    /// Starts a transition between weights. A refinement in transition starts anew from its current weight, not from
    /// `from`.
    pub(super) fn start(&mut self, r: u32, from: f32, to: f32) {
        match self.transition_of.at(r) {
            NONE => {
                *self.transition_of.entry(r) = self.transitions.len() as u32;
                self.transitions.push(Transition { refinement: r, from, to, share: 0.0 });
            }
            at => {
                let transition = &mut self.transitions[at as usize];
                *transition = Transition { refinement: r, from: transition.weight(), to, share: 0.0 };
            }
        }
    }

    /// Removes a refinement's transition, if any.
    pub(super) fn end(&mut self, r: u32) {
        let at = self.transition_of.get(r);
        if at != NONE {
            self.transition_of.rest(r);
            self.transitions.swap_remove(at as usize);
            if let Some(moved) = self.transitions.get(at as usize) {
                *self.transition_of.entry(moved.refinement) = at;
            }
        }
    }

    /// Looks for pages without transitions.
    pub(super) fn sweep(&mut self) {
        self.transition_of.sweep();
    }

    /// Gives back memory if most of it is not in use.
    pub(super) fn trim(&mut self) {
        self.transition_of.trim();
        trim(&mut self.transitions);
    }

    /// Bytes of the arrays.
    pub fn memory(&self) -> usize {
        self.transition_of.memory() + size_of_val(&self.transitions[..])
    }
}
