//! How detail is taken away.

pub(crate) mod lineage;
mod progressive;
mod report;
mod sequence;
mod sequence_build;

pub use progressive::{ProgressiveMesh, VertexSplit};
pub use report::{Refusal, SimplifyReport, StopReason};
pub use sequence::{CollapseSequence, NewVertex, Origin};
pub use sequence_build::SequenceError;
