//! What a simplification reached, and why it stopped.

/// Why a simplification stopped.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum StopReason {
    /// The triangles, vertices or bytes asked for were reached.
    Target,
    /// The next collapse would have gone beyond the error asked for.
    Error,
    /// No legal collapse is left: see the refusals.
    NothingLegal,
    /// The progress callback asked to stop. The sequence up to there is whole and usable.
    Cancelled,
}

/// How many candidates one oracle refused.
#[derive(Debug, Clone, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Refusal {
    /// The oracle's name.
    pub oracle: String,
    /// Candidates it refused, a candidate counted each time it was asked about.
    pub count: u64,
    /// Candidates it refuses in the final mesh, counted only where nothing legal was left.
    pub standing: u64,
}

/// What a simplification reached, and why it stopped.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct SimplifyReport {
    /// Why it stopped.
    pub stop: StopReason,
    /// Collapses done.
    pub steps: usize,
    /// Triangles left.
    pub triangles: usize,
    /// Vertices (wedges) left that a triangle uses.
    pub vertices: usize,
    /// Error bound of the last level, object units.
    pub error: f32,
    /// Parts of the input (points joined by triangles) of which nothing is left. 0 in sequences that were not made by a
    /// [`Simplifier`](super::Simplifier).
    pub parts_removed: usize,
    /// Refusals, one entry per oracle in the order they were asked.
    pub refusals: Vec<Refusal>,
}
