//! The interface between a structure and the cut.

/// A partially ordered set of refinements, without cycles of parents and dependencies.
///
/// *Parents* of a refinement are refinements whose bounds contain its bounds. *Dependencies* (*needs*) are further
/// refinements which must be in the mesh before it.
pub trait Refinements {
    /// Bounds of a refinement, as passed to a [`Criterion`](crate::view::Criterion). Small, since passed by value.
    type Bounds: Copy;

    /// Whether refinements may be unavailable ([`Refinements::available`]).
    const PARTIAL: bool = false;

    /// Returns the number of refinements.
    fn len(&self) -> usize;

    /// Whether there are no refinements.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the refinements without parents.
    fn roots(&self) -> impl Iterator<Item = u32>;

    /// Returns bounds of the changes made by a refinement and all its descendants.
    fn bounds(&self, refinement: u32) -> Self::Bounds;

    /// Returns the error used to order refinements of equal urgency within a budget of triangles: larger errors come
    /// first, then smaller numbers. Must not exceed the errors of the parents; where it equals a parent's, the parent must
    /// have the smaller number. By default only the number counts.
    fn error(&self, refinement: u32) -> f32 {
        let _ = refinement;
        0.0
    }

    /// Returns the parents: refinements whose bounds contain this refinement's bounds.
    fn parents(&self, refinement: u32) -> impl Iterator<Item = u32>;

    /// Returns the children: refinements with this refinement as a parent.
    fn children(&self, refinement: u32) -> impl Iterator<Item = u32>;

    /// Returns the dependencies: refinements besides the parents which must be in the mesh before this refinement.
    fn dependencies(&self, refinement: u32) -> impl Iterator<Item = u32>;

    /// Whether a refinement has arrived. An unavailable refinement has no known bounds, parents, children or dependencies, and
    /// stays out of the mesh. Refinements in the mesh must stay available.
    fn available(&self, refinement: u32) -> bool {
        let _ = refinement;
        true
    }

    /// Notes that the cut has come to a refinement which is not available. `needed`: a refinement asked for needs it, whether
    /// or not it is asked for itself.
    fn miss(&self, refinement: u32, needed: bool) {
        let _ = (refinement, needed);
    }
}
