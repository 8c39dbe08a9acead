//! The seam: a collapse, and what a rule may say about it.

use crate::simplify::metric::Pair;
use crate::simplify::surface::{Patch, WorkingSurface};

/// A collapse submitted to an oracle.
#[derive(Debug, Clone, Copy)]
pub struct Collapse<'a> {
    /// The lost and the kept point.
    pub pair: Pair,
    /// Position of the merged point, inner frame.
    pub position: [f32; 3],
    /// The triangles changed by the collapse, before and after.
    pub patch: &'a Patch,
}

impl Collapse<'_> {
    /// Whether the kept point does not move.
    pub fn keeps_position(&self, surface: &WorkingSurface) -> bool {
        surface.position(self.pair.kept) == self.position
    }
}

/// Data read by an oracle besides the surface. Around points with many triangles, the whole patch is gathered only for
/// candidates allowed by the rules that read less.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Reads {
    /// Only the pair and the position.
    Pair,
    /// The patch's facets, each independently: a facet refused alone is refused in any patch.
    Facets,
    /// The patch as a whole.
    #[default]
    Patch,
}

/// A rule deciding which collapses are legal.
///
/// ```
/// use multires::simplify::{Collapse, Oracle, WorkingSurface};
/// use multires::{Simplifier, mesh::shapes};
///
/// /// Keeps everything above a height (inner frame).
/// struct Above(f32);
///
/// impl Oracle for Above {
///     fn name(&self) -> &'static str {
///         "above"
///     }
///     fn allows(&self, surface: &WorkingSurface, collapse: &Collapse) -> bool {
///         surface.position(collapse.pair.lost)[1] < self.0
///     }
/// }
///
/// let sequence = Simplifier::new().oracle(Above(0.0)).run(&shapes::icosphere(3))?;
/// assert!(sequence.report().refusals.iter().any(|refusal| refusal.oracle == "above"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Oracle: Send + Sync {
    /// Name under which refusals are counted.
    fn name(&self) -> &str;

    /// Whether the collapse is legal.
    fn allows(&self, surface: &WorkingSurface, collapse: &Collapse) -> bool;

    /// The data read by the rule. Default: the whole patch, which is always correct.
    fn reads(&self) -> Reads {
        Reads::Patch
    }

    /// Cost factor of candidates refused by this rule, at least 1: the candidate is done once collapses of the increased
    /// cost are due. Default `None`: a refused candidate is never done.
    fn surcharge(&self) -> Option<f32> {
        None
    }

    /// Called before the first collapse on a surface. Returns whether the rule wants calls of
    /// [`changed`](Oracle::changed). Default: no.
    fn begin(&mut self, surface: &WorkingSurface) -> bool {
        let _ = surface;
        false
    }

    /// Called after each step if [`begin`](Oracle::begin) returned true. The triangles `dead` are removed, and the
    /// triangles around `kept` may have changed (`None` if a part vanished and nothing else changed).
    fn changed(&mut self, surface: &WorkingSurface, kept: Option<u32>, dead: &[u32]) {
        let _ = (surface, kept, dead);
    }

    /// Whether a part of the surface may vanish as a whole ([`Parts::Vanish`](crate::simplify::Parts::Vanish)).
    /// `points` are all points of the part. Default: yes.
    fn allows_vanishing(&self, surface: &WorkingSurface, points: &[u32]) -> bool {
        let _ = (surface, points);
        true
    }

    /// Whether the rule keeps the topology. Such rules do not apply to joined parts
    /// ([`join_distance`](crate::simplify::Simplifier::join_distance)), whose topology has changed anyway, and they
    /// give before a size is missed ([`Permissive`](crate::simplify::Permissive)). Default: no.
    fn keeps_topology(&self) -> bool {
        false
    }
}
