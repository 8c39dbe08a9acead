//! How detail is removed: from a mesh to the sequence of every collapse.
//!
//! The result, [`CollapseSequence`], is of the room [`sequence`](crate::sequence).
//!
//! | file | idea |
//! |---|---|
//! | `simplifier.rs` | [`Simplifier`], the entry point |
//! | `options.rs` | order, targets, progress |
//! | `placement.rs` | [`Placement`]: where the merged vertex goes |
//! | `permissive.rs` | rules that give where a target would be missed |
//! | `normals.rs` | [`Normals`]: kept, recomputed after simplification, or dropped |
//! | `metric/` | [`ErrorMetric`]: costs of collapses |
//! | `oracle/` | [`Oracle`]: which collapses are legal |
//! | `engine/` | the driver: takes the cheapest collapse, asks the oracles, collapses, writes the sequence |
//! | `surface/` | [`WorkingSurface`], the mesh while it is simplified: stars, kinds of points, curves, sheets, wedges |
//! | `parts/` | separate parts, and pairs not joined by an edge |
//! | `errors/` | how the error of a step is found |
//! | `grow.rs` | levels whose parts grow to replace vanished parts |

mod engine;
mod errors;
mod grow;
pub mod metric;
mod normals;
mod options;
pub mod oracle;
mod parts;
mod permissive;
mod placement;
mod simplifier;
mod surface;

pub use grow::Growth;
pub use metric::{Batch, ErrorMetric, MetricEvent, MetricProperties, Pair};
pub use normals::Normals;
pub use options::{
    AttributeWeights, ErrorMeasure, Guard, Independence, OptionError, Order, Parts, Progress, Target,
};
pub use oracle::{Collapse, Oracle, Reads};
pub use permissive::Permissive;
pub use placement::Placement;
pub use simplifier::Simplifier;
pub(crate) use surface::Rim;
pub use surface::{Corner, Facet, Frame, Patch, WorkingSurface};

#[doc(no_inline)]
pub use crate::progressive::{ProgressiveError, ProgressiveMesh, VertexSplit};
#[doc(no_inline)]
pub use crate::sequence::{
    AttributeDeviation, CollapseSequence, GivenUp, NewVertex, NormalsDone, Origin, Refusal, SequenceError,
    SimplifyReport, StopReason,
};
