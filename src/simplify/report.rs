//! What a simplification reached, and why it stopped.

use super::NormalsDone;
use super::permissive::GivenUp;

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
    /// Every legal collapse left would bring the error beyond what the triangles left explain: see
    /// [`Guard`](super::Guard).
    Guard,
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
    /// Error of the last level, object units: the larger of the next two.
    pub error: f32,
    /// Error of its surface, object units.
    pub surface_error: f32,
    /// Error of its curves, object units: borders, non-manifold edges, seams, borders between materials, and creases.
    pub curve_error: f32,
    /// What became of normals.
    pub normals: NormalsDone,
    /// Parts of the input (points joined by triangles) of which nothing is left. 0 in sequences that were not made by a
    /// [`Simplifier`](super::Simplifier).
    pub parts_removed: usize,
    /// Refusals, one entry per oracle in the order they were asked.
    pub refusals: Vec<Refusal>,
    /// Collapses by which seams, creases and material borders gave ([`Permissive`](super::Permissive)).
    pub given_up: GivenUp,
}

impl SimplifyReport {
    /// A report of no steps yet.
    pub(super) fn new(stop: StopReason) -> Self {
        Self {
            stop,
            steps: 0,
            triangles: 0,
            vertices: 0,
            error: 0.0,
            surface_error: 0.0,
            curve_error: 0.0,
            normals: NormalsDone::Kept,
            parts_removed: 0,
            refusals: Vec::new(),
            given_up: GivenUp::default(),
        }
    }
}
