//! What the cut needs to know of a structure.

use crate::view::Bounds;

/// A partially ordered set of refinements, numbered so that each comes after those it needs.
///
/// *Parents* are those that a refinement is nested in: their [`Bounds`] contain its own. *Needs* are further ones that must
/// be in the mesh before it, for whatever reason.
pub trait Refinements {
    /// How many there are.
    fn len(&self) -> usize;

    /// Whether there are none.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Those without parents.
    fn roots(&self) -> impl Iterator<Item = u32>;

    /// What a refinement and all its children can change.
    fn bounds(&self, refinement: u32) -> &Bounds;

    /// Those that it is nested in.
    fn parents(&self, refinement: u32) -> impl Iterator<Item = u32>;

    /// Those that are nested in it.
    fn children(&self, refinement: u32) -> impl Iterator<Item = u32>;

    /// Those that must be in the mesh before it, besides its parents.
    fn needs(&self, refinement: u32) -> impl Iterator<Item = u32>;
}
