//! Result of a simplification, and the reason for stopping.

use super::NormalsDone;

/// Reason for stopping a simplification.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum StopReason {
    /// The target number of triangles, vertices or bytes was reached.
    Target,
    /// The next collapse would exceed the target error.
    Error,
    /// No legal collapse is left; see [`SimplifyReport::refusals`].
    NothingLegal,
    /// Each legal collapse left would raise the error beyond the value explained by the triangles left; see
    /// [`Guard`](crate::simplify::Guard).
    Guard,
    /// The progress callback stopped the run. The sequence up to there is whole and usable.
    Cancelled,
}

/// Number of candidates refused by an oracle.
#[derive(Debug, Clone, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Refusal {
    /// Name of the oracle.
    pub oracle: String,
    /// Candidates refused; a candidate counts each time the oracle was asked about it.
    pub count: u64,
    /// Candidates refused in the final mesh; counted only after stopping with [`StopReason::NothingLegal`],
    /// [`StopReason::Error`] or [`StopReason::Guard`].
    pub standing: u64,
}

/// Counts of collapses, by the rule given up for them.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct GivenUp {
    /// A point left its seam, or wedges of a seam were chosen anew.
    pub seams: u64,
    /// A point left a seam made by normals alone, or wedges of such a seam were chosen anew.
    pub creases: u64,
    /// A point left its border between materials.
    pub materials: u64,
    /// The topology changed: a hole closed, a handle was cut, two sheets met.
    pub topology: u64,
}

impl GivenUp {
    /// Whether nothing was given up.
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }
}

/// Result of a simplification, and the reason for stopping.
///
/// ```
/// use multires::{Simplifier, Target, mesh::shapes, sequence::StopReason};
///
/// let sequence = Simplifier::new().target(Target::Triangles(100)).run(&shapes::icosphere(3))?;
/// let report = sequence.report();
/// assert_eq!(report.stop, StopReason::Target);
/// for refusal in &report.refusals {
///     println!("{} refused {} collapses", refusal.oracle, refusal.count);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct SimplifyReport {
    /// Reason for stopping.
    pub stop: StopReason,
    /// Collapses done.
    pub steps: usize,
    /// Triangles left.
    pub triangles: usize,
    /// Vertices (wedges) left, used by triangles.
    pub vertices: usize,
    /// Error of the last level, object units: `max(surface_error, curve_error)`.
    pub error: f32,
    /// Surface error of the last level, object units.
    pub surface_error: f32,
    /// Curve error of the last level, object units. Curves are borders, non-manifold edges, seams, borders between
    /// materials, and creases.
    pub curve_error: f32,
    /// Treatment of normals.
    pub normals: NormalsDone,
    /// Number of vanished parts of the input (points joined by triangles). 0 in sequences not made by a
    /// [`Simplifier`](crate::simplify::Simplifier).
    pub parts_removed: usize,
    /// Refusals, an entry per oracle in the order of asking.
    pub refusals: Vec<Refusal>,
    /// Collapses giving up seams, creases, material borders or topology ([`Permissive`](crate::simplify::Permissive)).
    pub given_up: GivenUp,
}

impl SimplifyReport {
    /// Creates a report of 0 steps.
    pub(crate) fn new(stop: StopReason) -> Self {
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
