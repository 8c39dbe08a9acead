//! Where the merged vertex goes (Southern 4.1).

/// Where the merged vertex goes. The bits are what a compressed record of the choice takes.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Placement {
    /// Half-way between the two (0 bits).
    Midpoint,
    /// At one of the two (1 bit): no new vertices, so every vertex of every level is a vertex of the input.
    #[default]
    Endpoint,
    /// At one of the two or half-way, whichever costs least (2 bits).
    Subset,
    /// Where the metric's cost is least (a full position).
    Optimal,
}

impl Placement {
    /// Whether every vertex of every level is a vertex of the input.
    pub fn keeps_vertices(self) -> bool {
        self == Self::Endpoint
    }
}
