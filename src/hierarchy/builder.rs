//! Presets for building hierarchies.

use crate::lod::Builder;
use crate::simplify::metric::{EdgeLength, ErrorMetric, LindstromTurk, Quadric};
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
    /// Returns the builder of hierarchies that draw the fewest triangles for an error, where vertices may be new ones: Lindstrom and
    /// Turk's costs and placement, and cuts of a manifold that are manifolds. On scans it draws a quarter less than the default,
    /// and takes two to three times as long to build. Values of your own are mixed for the new vertices
    /// ([`Baked::arrange_blended`](crate::lod::Baked::arrange_blended)).
    ///
    /// ```
    /// use multires::hierarchy::HierarchyBuilder;
    /// use multires::mesh::shapes;
    ///
    /// let model = HierarchyBuilder::fewest_triangles().bake(&shapes::rock(2_000, 1))?;
    /// assert!(model.structure().vertex_count() > model.structure().leaf_count()); // with new vertices
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn fewest_triangles() -> HierarchyBuilder<LindstromTurk> {
        Self::new()
            .metric(LindstromTurk::new())
            .placement(Placement::Optimal)
            .dependencies(Dependencies::Manifold)
    }

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
