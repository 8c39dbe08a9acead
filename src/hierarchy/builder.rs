//! Presets for building hierarchies.

use crate::lod::Builder;
use crate::simplify::metric::{EdgeLength, ErrorMetric, Quadric};
use crate::simplify::{Order, Placement};

use super::{Dependencies, HierarchyOptions, VertexHierarchy};

/// A [`Builder`] of hierarchies: how to simplify a mesh, and how near cuts must stay to meshes seen by the simplifier.
///
/// ```
/// use multires::hierarchy::{Dependencies, HierarchyBuilder};
/// use multires::{Placement, Simplifier, mesh::shapes};
///
/// let simplifier = Simplifier::new().placement(Placement::Optimal);
/// let mut builder = HierarchyBuilder::new().simplifier(simplifier).dependencies(Dependencies::Adjacent);
/// let model = builder.bake(&shapes::icosphere(3))?;
/// assert!(model.structure().base_triangle_count() < model.structure().triangle_count());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub type HierarchyBuilder<M = Quadric> = Builder<VertexHierarchy, M>;

impl HierarchyBuilder {
    /// Returns the builder of Berkey and Song, *Dynamic View Dependent Level of Detail*. Each step collapses the shortest
    /// edge outside all regions of influence of earlier collapses; when there is none, the regions are cleared (section
    /// 3.1). New vertices lie at the middle of the edge. Dependencies are all neighbours (3.2). With
    /// [`View::with_radius_test`](crate::view::View::with_radius_test) this is their system (3.4), extended to open and
    /// non-manifold meshes, and with a linear order of construction.
    ///
    /// In their system a collapse is legal if it keeps the topology. Here all rules of the simplifier hold, so triangles
    /// do not flip either; [`Builder::simplifier`] sets other rules.
    pub fn berkey_song() -> HierarchyBuilder<EdgeLength> {
        Self::new()
            .metric(EdgeLength::new())
            .placement(Placement::Midpoint)
            .order(Order::Batched)
            .dependencies(Dependencies::Neighbours)
    }
}

impl<M: ErrorMetric> HierarchyBuilder<M> {
    /// Sets how near a cut must stay to meshes seen by the simplifier.
    #[must_use]
    pub fn dependencies(self, dependencies: Dependencies) -> Self {
        self.options(HierarchyOptions::default().with_dependencies(dependencies))
    }
}
