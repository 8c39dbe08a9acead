//! What the cut needs to know of a structure.

/// A partially ordered set of refinements, numbered so that each comes after those it needs.
///
/// *Parents* are those that a refinement is nested in: their bounds contain its own. *Needs* are further ones that must
/// be in the mesh before it, for whatever reason.
pub trait Refinements {
    /// What a [`Criterion`](crate::view::Criterion) is told of a refinement: small, since it is handed over by value.
    type Bounds: Copy;

    /// How many there are.
    fn len(&self) -> usize;

    /// Whether there are none.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Those without parents.
    fn roots(&self) -> impl Iterator<Item = u32>;

    /// What a refinement and all its children can change.
    fn bounds(&self, refinement: u32) -> Self::Bounds;

    /// Which of equally urgent refinements comes first within a budget of triangles: that with the larger error, then that with
    /// the smaller number. Must be no larger than its parents'. Unless implemented, it is the number that counts.
    fn error(&self, refinement: u32) -> f32 {
        let _ = refinement;
        0.0
    }

    /// Those that it is nested in.
    fn parents(&self, refinement: u32) -> impl Iterator<Item = u32>;

    /// Those that are nested in it.
    fn children(&self, refinement: u32) -> impl Iterator<Item = u32>;

    /// Those that must be in the mesh before it, besides its parents.
    fn dependencies(&self, refinement: u32) -> impl Iterator<Item = u32>;
}
