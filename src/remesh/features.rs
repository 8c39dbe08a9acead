//! Edges that base edges must follow.

/// Which bends of the surface count as features.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub enum Creasing {
    /// Creases of more than 41.4 degrees where they outline a made object, not the relief of a scan, and edges as sharp that
    /// continue them.
    #[default]
    Automatic,
    /// All edges whose triangles' normals differ by more than this angle, degrees, 0 to 180.
    Angle(f32),
}

/// Feature edges: edges of the base follow them, points of the mesh on a feature edge stay on the edge of the base.
///
/// Borders, non-manifold edges, edges of clashing orientation, borders between materials and seams of attributes are
/// always features. Seams of normals alone are features unless they are so many that the mesh must be shaded flat.
/// Vertices locked in the mesh ([`Mesh::with_locks`](crate::Mesh::with_locks)) become vertices of the base, and so do
/// corners: points where a feature curve turns by more than 45 degrees.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Features {
    /// Which bends count.
    pub(super) creasing: Creasing,
    /// Edges marked by the caller, as two vertices.
    pub(super) marked: Vec<[u32; 2]>,
}

impl Features {
    /// Features with the defaults.
    pub fn new() -> Self {
        Self::default()
    }

    /// Sets which bends count. Default: [`Creasing::Automatic`].
    #[must_use]
    pub fn creasing(mut self, creasing: Creasing) -> Self {
        self.creasing = creasing;
        self
    }

    /// Marks edges, each by its two vertices. Pairs which are no edge of the mesh are ignored.
    #[must_use]
    pub fn mark(mut self, edges: impl IntoIterator<Item = [u32; 2]>) -> Self {
        self.marked.extend(edges);
        self
    }
}
