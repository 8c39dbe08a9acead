//! Report of one call of an instance's `adapt`.

use super::CutReport;

/// Counts from one call of [`Lod::adapt`](crate::lod::Lod::adapt).
///
/// ```
/// use multires::view::{View, look_at};
/// use multires::{Lod, LodOptions, Structure, hierarchy::VertexHierarchy, mesh::shapes};
///
/// let mesh = shapes::rock(2_000, 1);
/// let model = VertexHierarchy::bake(&mesh)?;
/// let options = LodOptions::default().with_operations(100);
/// let mut lod = model.instance(model.arrange(mesh.positions())?, &options)?;
/// let camera = look_at([0.0, 0.0, 3.0], [0.0; 3], [0.0, 1.0, 0.0]);
/// let change = lod.adapt(&[View::perspective(camera, 1.0, [1920, 1080])?.of_world()], 1.0 / 60.0);
/// assert!(change.cut.splits + change.cut.collapses <= 100); // the rest is pending
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub struct Change {
    /// Tests, and the splits and collapses applied to the drawn mesh.
    pub cut: CutReport,
    /// Triangles drawn after the call.
    pub triangles: usize,
    /// Splits and collapses still to come until the drawn mesh is the mesh asked for by the view.
    pub pending: usize,
    /// Splits and collapses whose vertices are moving.
    pub moving: usize,
    /// Whether the drawn mesh has more triangles than the budget; then it is the coarsest mesh.
    pub over_budget: bool,
}
