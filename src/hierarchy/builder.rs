//! From a mesh to its hierarchy in one call: simplify, build, put the vertices in order.

use crate::mesh::Mesh;
use crate::simplify::metric::{EdgeLength, ErrorMetric, Quadric};
use crate::simplify::{Order, Placement, Simplifier};

use super::{Dependencies, HierarchyError, HierarchyMesh, VertexHierarchy};

/// How to simplify a mesh, and how near cuts must stay to what the simplifier has seen.
///
/// Defaults: those of [`Simplifier`] (accumulated quadrics, endpoint placement, linear order, down to the base mesh), and no
/// dependencies.
///
/// ```
/// use multires::hierarchy::{Dependencies, HierarchyBuilder};
/// use multires::{mesh::shapes, simplify::Placement};
///
/// let mesh = shapes::rock(2_000, 1);
/// let rock = HierarchyBuilder::new()
///     .placement(Placement::Optimal)
///     .dependencies(Dependencies::Adjacent)
///     .build(&mesh)?;
/// assert_eq!(rock.hierarchy().triangle_count(), mesh.triangles().len());
/// # Ok::<(), multires::hierarchy::HierarchyError>(())
/// ```
pub struct HierarchyBuilder<M = Quadric> {
    simplifier: Simplifier<M>,
    dependencies: Dependencies,
}

impl Default for HierarchyBuilder {
    fn default() -> Self {
        Self::new()
    }
}

impl HierarchyBuilder {
    /// A builder with the defaults.
    pub fn new() -> Self {
        Self { simplifier: Simplifier::new(), dependencies: Dependencies::None }
    }

    /// Berkey and Song, *Dynamic View Dependent Level of Detail*: the shortest edge next that is in no collapse's region of
    /// influence, until there is none, and then anew (section 3.1); its middle as a new vertex; and all neighbours as
    /// dependencies (3.2). With [`View::with_radius_test`](crate::view::View::with_radius_test) it is their system (3.4),
    /// on open and non-manifold meshes too, and with a linear order of construction.
    ///
    /// Theirs is legal whatever keeps the topology. Here all rules of the simplifier hold, so that nothing flips either;
    /// [`HierarchyBuilder::simplifier`] takes others.
    pub fn berkey_song() -> HierarchyBuilder<EdgeLength> {
        Self::new()
            .metric(EdgeLength::new())
            .placement(Placement::Midpoint)
            .order(Order::Batched)
            .dependencies(Dependencies::Neighbours)
    }
}

impl<M: ErrorMetric> HierarchyBuilder<M> {
    /// What a collapse costs.
    #[must_use]
    pub fn metric<N: ErrorMetric>(self, metric: N) -> HierarchyBuilder<N> {
        HierarchyBuilder { simplifier: self.simplifier.metric(metric), dependencies: self.dependencies }
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

    /// How near a cut must stay to meshes that the simplifier has seen.
    #[must_use]
    pub fn dependencies(mut self, dependencies: Dependencies) -> Self {
        self.dependencies = dependencies;
        self
    }

    /// Everything about the simplification at once: rules, targets, error measure too.
    #[must_use]
    pub fn simplifier<N: ErrorMetric>(self, simplifier: Simplifier<N>) -> HierarchyBuilder<N> {
        HierarchyBuilder { simplifier, dependencies: self.dependencies }
    }

    /// Simplifies a mesh and makes its hierarchy. Cost: that of [`Simplifier::run`] and of [`HierarchyMesh::new`].
    ///
    /// # Errors
    /// An option outside its range, or more elements than can be numbered. Any mesh is legal.
    pub fn build(&mut self, mesh: &Mesh) -> Result<HierarchyMesh, HierarchyError> {
        let sequence = self.simplifier.run(mesh)?;
        HierarchyMesh::new(mesh, &sequence, self.dependencies)
    }
}

impl VertexHierarchy {
    /// A [`HierarchyBuilder`] with the defaults.
    pub fn builder() -> HierarchyBuilder {
        HierarchyBuilder::new()
    }
}
