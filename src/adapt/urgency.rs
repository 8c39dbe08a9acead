//! The order of refinements within a number of triangles: the most urgent first.

use std::cmp::Ordering;

/// Orders refinements by urgency. If the criterion is monotone, parents come before children.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Key {
    pub urgency: f64,
    pub error: f32,
    pub refinement: u32,
}

impl Ord for Key {
    fn cmp(&self, other: &Self) -> Ordering {
        let urgency = self.urgency.total_cmp(&other.urgency);
        let error = self.error.total_cmp(&other.error);
        urgency.then(error).then(other.refinement.cmp(&self.refinement))
    }
}

impl PartialOrd for Key {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Key {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Key {}
