//! How a level of detail follows the view: the cut, what it asks for, and what of the output changed.
//!
//! | file | idea |
//! |---|---|
//! | `refinements.rs` | [`Refinements`]: what the cut needs to know of a structure |
//! | `front.rs` | what a view asks for, kept up to date by asking only where the answer may have changed |
//! | `wheel.rs` | sleepers by how far the eye may go until they are looked at again |
//! | `closure.rs` | the smallest closed set that holds what is asked for |
//! | `cut.rs` | [`Cut`]: the three together |
//! | `budget.rs` | the same within a number of triangles: the most urgent, found by two heaps over rim and fringe |
//! | `transitions.rs` | what is shown follows the cut: so much a frame, smoothly if asked for |
//! | `frame_limits.rs` | between the cut and what is shown: budgets, and how much a frame |
//! | `tolerance.rs` | a factor for all tolerances that may turn every frame |
//! | `geomorph.rs` | [`Geomorph`]: how long a transition takes |
//! | `blend.rs` | [`Blend`]: what a vertex must be able to do to move |
//! | `change.rs` | [`Change`]: what one move of an instance did |
//! | `dirty.rs` | [`Dirty`]: ranges of a buffer that changed |

mod blend;
mod budget;
mod change;
mod closure;
mod cut;
mod dirty;
mod frame_limits;
mod front;
mod geomorph;
mod refinements;
mod tolerance;
mod transitions;
mod wheel;

pub use blend::Blend;
pub use change::Change;
pub(crate) use cut::is_done;
pub use cut::{Cut, CutReport};
pub use dirty::{Dirty, DirtyRanges};
pub(crate) use frame_limits::FrameLimits;
pub use geomorph::Geomorph;
pub use refinements::Refinements;
pub(crate) use tolerance::Tolerance;
pub(crate) use transitions::RefinementSink;
