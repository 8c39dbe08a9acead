//! Controllers of a scene's level of detail: hold a frame time, or a number of triangles, over any structure.
//!
//! State machines: numbers in, numbers out. No clock, no graphics interface, no randomness: equal calls give equal results.
//! Nothing allocates once buffers have reached their largest size. No input panics.
//!
//! ```text
//!     measured seconds --> Stress ------> resolution of an object, or tolerance factor of a Lod
//!     measured seconds --> FrameTime ---> triangles of the scene --+
//!                                                                  |
//!             levels with errors  -->  Budget  <-------------------+    level of each object
//!             levels by parameter -->  Bias  <---------------------+    one bias of all parameters
//!             any Lod             -->  SceneBudget  <--------------+    tolerance factor of each Lod
//! ```
//!
//! | controller | holds | by | for |
//! |---|---|---|---|
//! | [`Stress`] | a time | a factor of screen coverage, `x (1 - alpha)` or `x (1 + alpha)` a frame | the simplest loop; totally ordered meshes |
//! | [`FrameTime`] | a time | a target of triangles, from the filtered seconds per triangle | feeding the three below |
//! | [`Bias`] | a number of triangles | one bias of all parameters, from one change of level to the next | geomorph meshes; no jumps of quality |
//! | [`Budget`] | a number of triangles | the levels that save the most screen error per triangle | objects with known levels and errors |
//! | [`SceneBudget`] | a number of triangles | tolerance factors | hierarchies, wavelet meshes, any [`Lod`](crate::Lod) |
//!
//! | file | idea |
//! |---|---|
//! | `stress.rs` | [`Stress`]: load and stress (Bouvier and Gobbetti) |
//! | `frame_time.rs` | [`FrameTime`]: seconds to triangles |
//! | `controllable.rs` | [`Controllable`]: an object whose triangles depend on a bias |
//! | `stairs.rs` | [`Stairs`]: levels by parameter, and an object on them |
//! | `bias.rs` | [`Bias`]: the bias of all parameters (Southern) |
//! | `ladder.rs` | [`Ladder`]: levels by triangles and error, and an object on them |
//! | `budget.rs` | [`Budget`]: a split of triangles by error (Funkhouser and Sequin) |
//! | `exact.rs` | the best split of a small scene |
//! | `estimate.rs` | [`Estimate`]: triangles as a power of the tolerance, fitted |
//! | `scene.rs` | [`SceneBudget`]: a number of triangles for many [`Lod`](crate::Lod)s |
//! | `selection.rs` | the entry at which a sum is reached, without a full sort |
//! | `error.rs` | [`ControlError`] |

mod bias;
mod budget;
mod controllable;
mod error;
mod estimate;
mod exact;
mod frame_time;
mod ladder;
mod scene;
mod selection;
mod stairs;
mod stress;

pub use bias::{Bias, BiasOptions, BiasReport, BiasStop};
pub use budget::{Budget, BudgetOptions, Split};
pub use controllable::{Controllable, Crossing, Toward};
pub use error::ControlError;
pub use estimate::Estimate;
pub use frame_time::{FrameTime, FrameTimeOptions, Sample};
pub use ladder::{Ladder, LadderObject};
pub use scene::{SceneBudget, SceneObject, SceneOptions, SceneReport};
pub use stairs::{Sight, StairObject, Stairs};
pub use stress::{Stress, StressFrame, StressOptions};
