//! How detail is removed: from a mesh to the sequence of every collapse.
//!
//! The result, [`CollapseSequence`], is of the room [`sequence`](crate::sequence).
//!
//! | file | idea |
//! |---|---|
//! | `simplifier.rs` | [`Simplifier`], the entry point |
//! | `options.rs` | order, targets, progress |
//! | `engine.rs` | the driver: takes the cheapest collapse, asks the oracles, collapses |
//! | `engine/around.rs` | what a collapse makes stale |
//! | `engine/give.rs` | rules that give before a target is missed |
//! | `engine/hubs.rs` | points with very many triangles |
//! | `engine/vanish.rs` | how a part vanishes |
//! | `engine/watch.rs` | the guard: the largest error explained by the remaining triangles |
//! | `engine/finish.rs` | how a simplification ends |
//! | `candidates.rs` | candidates: pair, position and cost |
//! | `queue.rs` | points by cost |
//! | `pairs.rs` | pairs not joined by an edge |
//! | `parts.rs` | separate parts |
//! | `near.rs` | nearest points of other parts |
//! | `surface.rs` | [`WorkingSurface`], the mesh while it is simplified |
//! | `stars.rs` | the corners around every point |
//! | `sheets.rs` | triangles over equal points |
//! | `classify.rs` | borders, seams and other kinds of points and edges |
//! | `curves.rs` | curves of the input, creases, and their images on the level |
//! | `patch.rs` | the triangles changed by a collapse |
//! | `oracle.rs` | [`Oracle`]: which collapses are legal |
//! | `permissive.rs` | rules that give where a target would be missed |
//! | `apart.rs` | whether the surface would cross itself |
//! | `wedge_map.rs` | where the wedges of a merged point go |
//! | `wedge_values.rs` | values that tell wedges apart, and the sides of triangles in texture space |
//! | `normals.rs` | [`Normals`]: kept, recomputed after simplification, or dropped |
//! | `metric/` | [`ErrorMetric`]: costs of collapses |
//! | `placement.rs` | [`Placement`]: where the merged vertex goes |
//! | `lanes.rs` | four vectors at once |
//! | `sectors.rs` | four triangles around a point, and the distance of a place from each |
//! | `errors.rs` | how the error of a step is found |
//! | `tracked_samples.rs` | distance of the input from the level |
//! | `curve_samples.rs` | distance between the curves of input and level |
//! | `way_back.rs` | distance of the level from the input, next to curves and on coarse levels |
//! | `angles.rs` | few of many triangles around a point |
//! | `parametric_error.rs` | distance travelled by input points |
//! | `recorder.rs` | writes the sequence |
//! | `reorder.rs` | puts the steps of tiles in order |
//! | `grow.rs` | levels whose parts grow to replace vanished parts |

mod angles;
mod apart;
mod candidates;
mod classify;
mod curve_samples;
mod curves;
mod engine;
mod errors;
mod grow;
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
mod queue;
mod recorder;
mod reorder;
mod sheets;
mod simplifier;
mod stars;
mod surface;
mod tracked_samples;
mod way_back;
mod wedge_map;
mod wedge_values;

pub use grow::Growth;
pub use metric::{Batch, ErrorMetric, Pair, VanishingLoss};
pub use normals::Normals;
pub use options::{AttributeWeights, ErrorMeasure, Guard, OptionError, Order, Parts, Progress, Target};
pub use oracle::{Collapse, Oracle, Reads};
pub use patch::{Facet, Patch};
pub use permissive::Permissive;
pub use placement::Placement;
pub use simplifier::Simplifier;
pub use surface::{Corner, Frame, WorkingSurface};

#[doc(no_inline)]
pub use crate::progressive::{ProgressiveError, ProgressiveMesh, VertexSplit};
#[doc(no_inline)]
pub use crate::sequence::{
    AttributeDeviation, CollapseSequence, GivenUp, NewVertex, NormalsDone, Origin, Refusal, SequenceError,
    SimplifyReport, StopReason,
};
