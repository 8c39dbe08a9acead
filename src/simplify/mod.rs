//! How detail is taken away.

mod engine;
pub mod metric;
mod options;
pub mod oracle;
mod pairs;
mod patch;
mod placement;
mod queue;
mod recorder;
mod report;
mod sequence;
mod simplifier;
mod surface;
mod witness;

pub use metric::{Batch, ErrorMetric, Pair};
pub use options::{OptionError, Order, Progress, Target};
pub use oracle::{Collapse, Oracle};
pub use patch::{Facet, Patch};
pub use placement::Placement;
pub use report::{Refusal, SimplifyReport, StopReason};
pub use sequence::{CollapseSequence, NewVertex, Origin};
pub use simplifier::Simplifier;
pub use surface::{Corner, Frame, Surface};
