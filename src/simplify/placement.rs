//! Position of the merged vertex (Southern 4.1).

/// Position of the merged vertex. The bits are the size of the choice in a compressed record.
///
/// ```
/// use multires::{Placement, Simplifier, mesh::shapes};
///
/// let mesh = shapes::icosphere(2);
/// let kept = Simplifier::new().placement(Placement::Endpoint).run(&mesh)?;
/// let moved = Simplifier::new().placement(Placement::Optimal).run(&mesh)?;
/// assert!(kept.new_vertices().is_empty() && !moved.new_vertices().is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Placement {
    /// Midpoint of the two vertices (0 bits).
    Midpoint,
    /// Either of the two vertices (1 bit). No new vertices: every vertex of every level is a vertex of the input.
    #[default]
    Endpoint,
    /// Either of the two vertices or their midpoint, whichever costs least (2 bits).
    Subset,
    /// Position of least cost (a full position).
    Optimal,
}

impl Placement {
    /// Whether every vertex of every level is a vertex of the input.
    pub fn keeps_vertices(self) -> bool {
        self == Self::Endpoint
    }
}
