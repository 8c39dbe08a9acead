//! The default rules.

use super::{
    Borders, LinkCondition, Locks, Materials, NonManifold, NormalFlip, Oracle, Seams, TriangleQuality,
    UvOrientation,
};

/// Returns the default rules, in the order of their checks: cheap rules first.
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
