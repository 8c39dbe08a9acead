//! View-dependent adaption: the cut, the refinements asked for, and the changed parts of the output.
//!
//! | file | idea |
//! |---|---|
//! | `refinements.rs` | [`Refinements`]: a structure, as seen by the cut |
//! | `front.rs` | refinements asked for by a view, updated by testing only refinements with answers due |
//! | `sleepers.rs` | how long each answer holds: by place, and by block of places |
//! | `states.rs` | per refinement: whether it is asked for and in the mesh, and its place in the front |
//! | `closure.rs` | the smallest closed set containing all refinements asked for |
//! | `cut.rs` | [`Cut`]: front and closure together |
//! | `budget.rs` | a cut within a number of triangles: the most urgent refinements, by two heaps over rim and fringe |
//! | `urgency.rs` | the order of refinements within a number of triangles |
//! | `transitions.rs` | the shown mesh follows the cut: limited a frame, smoothly if asked for |
//! | `weights.rs` | weights of refinements in transition |
//! | `frame_limits.rs` | limits between the cut and the shown mesh: triangles, and operations a frame |
//! | `tolerance.rs` | a factor of all tolerances, which may change every frame |
//! | `geomorph.rs` | [`Geomorph`]: duration of a transition |
//! | `blend.rs` | [`Blend`]: interpolation of vertices |
//! | `change.rs` | [`Change`]: report of one `adapt` |
//! | `dirty.rs` | [`Dirty`]: changed ranges of a buffer |

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
mod sleepers;
mod states;
mod tolerance;
mod transitions;
mod urgency;
mod weights;

pub use blend::Blend;
pub use change::Change;
pub(crate) use cut::Apply;
pub use cut::{Cut, CutReport};
pub use dirty::{Dirty, DirtyRanges};
pub(crate) use frame_limits::FrameLimits;
pub use geomorph::Geomorph;
pub use refinements::Refinements;
pub(crate) use states::States;
pub(crate) use tolerance::Tolerance;
pub(crate) use transitions::RefinementSink;
#[cfg(feature = "stream")]
pub(crate) use urgency::Key;
pub(crate) use weights::{AT_REST, Transition, Weights};
