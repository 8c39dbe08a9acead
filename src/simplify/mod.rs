//! How detail is removed: from a mesh to the sequence of every collapse.
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
//! | `keep_sides.rs` | fitted texture coordinates that mirror no triangle |
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
//! | `sequence.rs` | [`CollapseSequence`] |
//! | `report.rs` | what a simplification reached, and why it stopped |
//! | `grow.rs` | levels whose parts grow to replace vanished parts |
//! | `solved.rs` | attributes of new vertices, fitted to the surface |
//! | `footprint.rs` | where the input lies on a level |
//! | `refit.rs` | attributes of a level, fitted to the input |
//! | `attribute_deviation.rs` | deviation of a level's attributes |
//! | `collapse_forest.rs` | the substitutions of a sequence as a forest |
//! | `sequence_build.rs` | sequences from your own simplifier |
//! | `sequence_check.rs` | checks every promise of a sequence |
//! | `progressive.rs` | [`ProgressiveMesh`]: base mesh and vertex splits |
//! | `progressive_check.rs` | checks every promise of a progressive mesh |

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
