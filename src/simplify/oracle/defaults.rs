//! The default rules.

use super::{
    Borders, LinkCondition, Locks, Materials, NonManifold, NormalFlip, Oracle, Seams, TriangleQuality,
    UvOrientation,
};

/// Returns the default rules, in the order of their checks: cheap rules first.
///
/// ```
/// use multires::simplify::oracle::{SelfIntersection, default_oracles};
/// use multires::{Simplifier, mesh::shapes};
///
/// let mut oracles = default_oracles();
/// oracles.push(Box::new(SelfIntersection::new()));
/// let sequence = Simplifier::new().oracles(oracles).run(&shapes::torus(1.0, 0.4, 24, 12))?;
/// assert!(!sequence.is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn default_oracles() -> Vec<Box<dyn Oracle>> {
    vec![
        Box::new(Locks),
        Box::new(Borders::Slide),
        Box::new(NonManifold::Slide),
        Box::new(Seams),
        Box::new(Materials),
        Box::new(LinkCondition),
        Box::new(NormalFlip::default()),
        Box::new(TriangleQuality::default()),
        Box::new(UvOrientation),
    ]
}
