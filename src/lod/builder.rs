//! From a mesh to a baked model in a single call, with any metric and placement: simplify, build, put the vertices in
//! order.

use std::ops::ControlFlow;

use crate::mesh::Mesh;
use crate::simplify::metric::{ErrorMetric, Quadric};
use crate::simplify::{Order, Placement, Simplifier};

use super::{Baked, FromSequence};

/// Share of a build's time taken by the simplification.
const SIMPLIFICATION: f32 = 0.8;

/// Simplifies a mesh and builds a structure from the result. Defaults: the structure's simplifier
/// ([`FromSequence::simplifier`]: accumulated quadrics, endpoint placement, linear order unless the structure needs batches,
/// down to the base mesh) and options.
///
/// ```
/// use multires::hierarchy::{Dependencies, HierarchyBuilder};
/// use multires::{mesh::shapes, simplify::Placement};
///
/// let mesh = shapes::rock(2_000, 1);
/// let rock = HierarchyBuilder::new()
///     .placement(Placement::Optimal)
///     .dependencies(Dependencies::Adjacent)
///     .bake(&mesh)?;
/// assert_eq!(rock.structure().triangle_count(), mesh.triangles().len());
/// # Ok::<(), multires::hierarchy::HierarchyError>(())
/// ```
pub struct Builder<S: FromSequence, M = Quadric> {
    simplifier: Simplifier<M>,
    options: S::Options,
}

impl<S: FromSequence> Default for Builder<S> {
    fn default() -> Self {
        Self::new()
    }
}

impl<S: FromSequence> Builder<S> {
    /// Makes a builder with the defaults.
    pub fn new() -> Self {
        Self { simplifier: S::simplifier(), options: S::Options::default() }
    }
}

impl<S: FromSequence, M: ErrorMetric> Builder<S, M> {
    /// Sets the cost of a collapse.
    #[must_use]
    pub fn metric<N: ErrorMetric>(self, metric: N) -> Builder<S, N> {
        Builder { simplifier: self.simplifier.metric(metric), options: self.options }
    }

    /// Sets where the merged vertex goes.
    #[must_use]
    pub fn placement(mut self, placement: Placement) -> Self {
        self.simplifier = self.simplifier.placement(placement);
        self
    }

    /// Sets the order of collapses.
    #[must_use]
    pub fn order(mut self, order: Order) -> Self {
        self.simplifier = self.simplifier.order(order);
        self
    }

    /// Sets everything about the simplification at once: rules, targets, error measure too.
    #[must_use]
    pub fn simplifier<N: ErrorMetric>(self, simplifier: Simplifier<N>) -> Builder<S, N> {
        Builder { simplifier, options: self.options }
    }

    /// Sets the options of building the structure.
    #[must_use]
    pub fn options(mut self, options: S::Options) -> Self {
        self.options = options;
        self
    }

    /// Simplifies a mesh and bakes its structure. Cost: [`Simplifier::run`] plus [`Baked::of_sequence`].
    ///
    /// # Errors
    /// An option is outside its range, or the structure refuses the mesh.
    pub fn bake(&mut self, mesh: &Mesh) -> Result<Baked<S>, S::Error> {
        self.bake_with(mesh, |_| ControlFlow::Continue(()))
    }

    /// Simplifies a mesh and bakes its structure, like [`Builder::bake`]. Calls `progress` with the share done, 0 to 1; it
    /// may break.
    ///
    /// # Errors
    /// As [`Builder::bake`], or `progress` broke.
    pub fn bake_with(
        &mut self,
        mesh: &Mesh,
        mut progress: impl FnMut(f32) -> ControlFlow<()>,
    ) -> Result<Baked<S>, S::Error> {
        let mut broke = progress(0.0).is_break();
        let sequence = self.simplifier.run_with(mesh, |at| {
            if !broke {
                broke = progress(SIMPLIFICATION * at.fraction()).is_break();
            }
            if broke { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        })?;
        let mut rest = |share: f32| {
            if broke {
                return ControlFlow::Break(());
            }
            progress(SIMPLIFICATION + (1.0 - SIMPLIFICATION) * share)
        };
        S::bake_sequence(mesh, &sequence, &self.options, &mut rest)
    }
}
