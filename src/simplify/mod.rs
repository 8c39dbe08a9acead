//! How detail is taken away: from a mesh to the sequence of every collapse.
//!
//! | file | idea |
//! |---|---|
//! | `simplifier.rs` | [`Simplifier`], the front door; `options.rs`: order, targets, progress |
//! | `engine.rs` | the driver; `engine/around.rs`: what a collapse makes stale; `engine/give.rs`: what gives before a target is missed; `engine/vanish.rs`: how a part goes; `engine/finish.rs`: how it ends; `candidates.rs`: who, where and at what cost; `queue.rs`: points by cost; `pairs.rs`: pairs that no edge joins; `parts.rs`: separate parts; `near.rs`: what lies near |
//! | `surface.rs` | [`WorkingSurface`], the mesh while it is simplified; `stars.rs`: the corners around its points; `sheets.rs`: triangles over the same points; `classify.rs`: borders, seams and the like; `curves.rs`: those of the input and creases, and what became of them; `patch.rs`: what one collapse would change |
//! | `oracle.rs` | [`Oracle`]: which collapses are legal; `permissive.rs`: what gives where a target would be missed; `apart.rs`: whether the surface would cross itself |
//! | `wedge_map.rs` | where the wedges of a merged point go; `wedge_values.rs`: what tells them apart, and the sides of triangles in texture space; `keep_sides.rs`: fits that keep them |
//! | `normals.rs` | [`Normals`]: kept, recomputed after simplification, or dropped |
//! | `metric/` | [`ErrorMetric`]: what one costs |
//! | `placement.rs` | [`Placement`]: where the merged vertex goes |
//! | `lanes.rs` | four vectors at once; `sectors.rs`: four triangles around a point, and how far a place is from each |
//! | `errors.rs` | how the error of a step is found; `tracked_samples.rs`: how far the input lies from the level; `curve_samples.rs`: the same for curves; `way_back.rs`: how far the level lies from the input, next to curves and once it is coarse; `angles.rs`: few of many triangles around a point; `parametric_error.rs`: how far its points have travelled |
//! | `recorder.rs` | writes the sequence; `reorder.rs`: puts tiles' steps in order; `sequence.rs`: [`CollapseSequence`]; `report.rs`: why it stopped |
//! | `grow.rs` | levels whose parts grow for those that vanished |
//! | `solved.rs` | attributes of new vertices that fit the surface they stand for |
//! | `footprint.rs` | where the input lies on a level; `refit.rs`: attributes fitted to the input; `attribute_deviation.rs`: what they are off by |
//! | `sequence_build.rs` | sequences from a simplifier of your own; `sequence_check.rs`: every promise checked |
//! | `progressive.rs` | [`ProgressiveMesh`]: base mesh and vertex splits; `progressive_check.rs`: every promise checked |

mod angles;
mod apart;
mod attribute_deviation;
mod candidates;
mod classify;
pub(crate) mod collapse_forest;
mod curve_samples;
mod curves;
mod engine;
mod errors;
mod footprint;
mod grow;
mod keep_sides;
mod lanes;
pub mod metric;
mod near;
mod normals;
mod options;
pub mod oracle;
mod pairs;
mod parametric_error;
mod parts;
mod patch;
mod permissive;
mod placement;
mod progressive;
mod progressive_check;
mod queue;
mod recorder;
mod refit;
mod reorder;
mod report;
mod sectors;
mod sequence;
mod sequence_build;
mod sequence_check;
mod sheets;
mod simplifier;
mod solved;
mod stars;
mod surface;
mod tracked_samples;
mod way_back;
mod wedge_map;
mod wedge_values;

pub use attribute_deviation::AttributeDeviation;
pub use grow::Growth;
pub use metric::{Batch, ErrorMetric, Pair, VanishingLoss};
pub use normals::{Normals, NormalsDone};
pub use options::{AttributeWeights, ErrorMeasure, Guard, OptionError, Order, Parts, Progress, Target};
pub use oracle::{Collapse, Oracle, Reads};
pub use patch::{Facet, Patch};
pub use permissive::{GivenUp, Permissive};
pub use placement::Placement;
pub use progressive::{ProgressiveMesh, VertexSplit};
pub use progressive_check::ProgressiveError;
pub use report::{Refusal, SimplifyReport, StopReason};
pub use sequence::{CollapseSequence, NewVertex, Origin};
pub use sequence_build::SequenceError;
pub use simplifier::Simplifier;
pub use surface::{Corner, Frame, WorkingSurface};
