//! From a mesh to a baked model in one call, with any metric and placement: simplify, build, put the vertices in order.

use std::ops::ControlFlow;

use crate::mesh::Mesh;
use crate::simplify::metric::{ErrorMetric, Quadric};
use crate::simplify::{Order, Placement, Simplifier};

use super::{Baked, FromSequence};

/// Share of a build's time that the simplification takes.
const SIMPLIFICATION: f32 = 0.8;

/// How to simplify a mesh, and how to build a structure from that. Defaults: those of [`Simplifier`] (accumulated quadrics,
/// endpoint placement, linear order, down to the base mesh) and of the structure's options.
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
    /// A builder with the defaults.
    pub fn new() -> Self {
        Self { simplifier: Simplifier::new(), options: S::Options::default() }
    }
}

impl<S: FromSequence, M: ErrorMetric> Builder<S, M> {
    /// What a collapse costs.
    #[must_use]
    pub fn metric<N: ErrorMetric>(self, metric: N) -> Builder<S, N> {
        Builder { simplifier: self.simplifier.metric(metric), options: self.options }
    }

    /// Where the merged vertex goes.
    #[must_use]
    pub fn placement(mut self, placement: Placement) -> Self {
        self.simplifier = self.simplifier.placement(placement);
        self
    }

    /// In which order collapses are done.
    #[must_use]
    pub fn order(mut self, order: Order) -> Self {
        self.simplifier = self.simplifier.order(order);
        self
    }

    /// Everything about the simplification at once: rules, targets, error measure too.
    #[must_use]
    pub fn simplifier<N: ErrorMetric>(self, simplifier: Simplifier<N>) -> Builder<S, N> {
        Builder { simplifier, options: self.options }
    }

    /// How the structure is built from the simplification.
    #[must_use]
    pub fn options(mut self, options: S::Options) -> Self {
        self.options = options;
        self
    }

    /// Simplifies a mesh and bakes its structure. Cost: that of [`Simplifier::run`] and of [`Baked::of_sequence`].
    ///
    /// # Errors
    /// An option outside its range, or what the structure refuses.
    pub fn bake(&mut self, mesh: &Mesh) -> Result<Baked<S>, S::Error> {
        self.bake_with(mesh, |_| ControlFlow::Continue(()))
    }

    /// The same; `progress` is told how far it is, 0 to 1, and may break.
    ///
    /// # Errors
    /// Those of [`Builder::bake`], and that `progress` broke.
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
