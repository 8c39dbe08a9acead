//! How detail is taken away.

mod report;
mod sequence;

pub use report::{Refusal, SimplifyReport, StopReason};
pub use sequence::{CollapseSequence, NewVertex, Origin};
