//! The result of a simplification: every collapse in order, and any level of detail again.
//!
//! Imports no simplifier: structures are built from a [`CollapseSequence`], whoever made it.
//!
//! | file | idea |
//! |---|---|
//! | `collapse_sequence.rs` | [`CollapseSequence`] |
//! | `build.rs` | sequences from your own simplifier |
//! | `validate.rs` | checks every promise of a sequence |
//! | `report.rs` | what a simplification reached, and why it stopped |
//! | `normals_done.rs` | what it did with normals |
//! | `collapse_forest.rs` | the substitutions of a sequence as a forest |
//! | `solved.rs` | attributes of new vertices, fitted to the surface |
//! | `footprint.rs` | where the input lies on a level |
//! | `refit.rs` | attributes of a level, fitted to the input |
//! | `keep_sides.rs` | fitted texture coordinates that mirror no triangle |
//! | `attribute_deviation.rs` | deviation of a level's attributes |
//! | `error.rs` | [`SequenceError`] |

mod attribute_deviation;
mod build;
pub(crate) mod collapse_forest;
mod collapse_sequence;
mod error;
mod footprint;
mod keep_sides;
mod normals_done;
mod refit;
mod report;
mod solved;
mod validate;

pub use attribute_deviation::AttributeDeviation;
pub use collapse_sequence::{CollapseSequence, NewVertex, Origin};
pub use error::SequenceError;
pub use normals_done::NormalsDone;
pub use report::{GivenUp, Refusal, SimplifyReport, StopReason};
