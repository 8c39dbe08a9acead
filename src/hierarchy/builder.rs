//! Presets of building a hierarchy.

use crate::lod::Builder;
use crate::simplify::metric::{EdgeLength, ErrorMetric, Quadric};
use crate::simplify::{Order, Placement};

use super::{Dependencies, HierarchyOptions, VertexHierarchy};

/// How to simplify a mesh, and how near cuts must stay to what the simplifier has seen: a [`Builder`] of hierarchies.
pub type HierarchyBuilder<M = Quadric> = Builder<VertexHierarchy, M>;

impl HierarchyBuilder {
    /// Berkey and Song, *Dynamic View Dependent Level of Detail*: the shortest edge next that is in no collapse's region of
    /// influence, until there is none, and then anew (section 3.1); its middle as a new vertex; and all neighbours as
    /// dependencies (3.2). With [`View::with_radius_test`](crate::view::View::with_radius_test) it is their system (3.4),
    /// on open and non-manifold meshes too, and with a linear order of construction.
    ///
    /// Theirs is legal whatever keeps the topology. Here all rules of the simplifier hold, so that nothing flips either;
    /// [`Builder::simplifier`] takes others.
    pub fn berkey_song() -> HierarchyBuilder<EdgeLength> {
        Self::new()
            .metric(EdgeLength::new())
            .placement(Placement::Midpoint)
            .order(Order::Batched)
            .dependencies(Dependencies::Neighbours)
    }
}

impl<M: ErrorMetric> HierarchyBuilder<M> {
    /// How near a cut must stay to meshes that the simplifier has seen.
    #[must_use]
    pub fn dependencies(self, dependencies: Dependencies) -> Self {
        self.options(HierarchyOptions::default().with_dependencies(dependencies))
    }
}
