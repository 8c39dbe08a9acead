//! Per refinement: whether it is asked for, whether it is in the mesh, and its place in the front. A word each, in pages.

use crate::geometry::paged::Paged;

/// Asked for by the view.
pub(super) const ASKED: u32 = 1 << 31;
/// In the mesh: asked for, or needed by a refinement in the mesh.
pub(super) const DONE: u32 = 1 << 30;
/// Not at the front until others arrive.
pub(super) const WAITS: u32 = 1 << 29;

/// Bits of a place. All of them: no place.
const PLACE: u32 = WAITS - 1;
/// No place in the front. Fronts are shorter.
pub(super) const NOWHERE: u32 = PLACE;

/// Flags and places of refinements. Refinements with neither take no memory, apart from a page with others.
#[derive(Debug, Clone)]
pub(crate) struct States {
    of: Paged<u32, 9>,
    /// The flag of refinements in the mesh: without dependencies, these are those asked for.
    done: u32,
}

impl States {
    /// Starts without flags and places. `dependencies`: whether any refinement has dependencies besides its parents.
    pub fn new(count: usize, dependencies: bool) -> Self {
        Self { of: Paged::of(count, NOWHERE), done: if dependencies { DONE } else { ASKED } }
    }

    /// Whether a refinement is in the mesh.
    #[inline]
    pub fn is_done(&self, r: u32) -> bool {
        self.has(r, self.done)
    }

    /// Whether a refinement has a flag; not if there is no such refinement.
    #[inline]
    pub fn has(&self, r: u32, flag: u32) -> bool {
        self.of.get(r) & flag != 0
    }

    #[inline]
    pub(super) fn set(&mut self, r: u32, flag: u32) {
        *self.of.entry(r) |= flag;
    }

    #[inline]
    pub(super) fn unset(&mut self, r: u32, flag: u32) {
        *self.of.entry(r) &= !flag;
    }

    /// Asks for a refinement, or no longer. Returns its place.
    #[inline]
    pub(super) fn ask(&mut self, r: u32, asked: bool) -> u32 {
        let state = self.of.entry(r);
        *state = if asked { *state | ASKED } else { *state & !ASKED };
        *state & PLACE
    }

    /// Returns the place of a refinement, or `NOWHERE`.
    #[inline]
    pub(super) fn place(&self, r: u32) -> u32 {
        self.of.at(r) & PLACE
    }

    /// Sets the place of a refinement.
    #[inline]
    pub(super) fn move_to(&mut self, r: u32, place: u32) {
        let state = self.of.entry(r);
        *state = *state & !PLACE | place;
    }

    /// Returns the refinements in the mesh, in ascending order. O(pages of refinements).
    pub fn done(&self) -> impl Iterator<Item = u32> + '_ {
        self.of.others().filter(|(_, state)| state & self.done != 0).map(|(r, _)| r)
    }

    /// Looks for pages without flags and places.
    pub(super) fn sweep(&mut self) {
        self.of.sweep();
    }

    /// Gives back memory if most of it is not in use.
    pub(super) fn trim(&mut self) {
        self.of.trim();
    }

    /// Bytes of the pages.
    pub fn memory(&self) -> usize {
        self.of.memory()
    }
}
