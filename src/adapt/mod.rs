//! How a level of detail follows the view: the cut, what it asks for, and what of the output changed.
//!
//! | file | idea |
//! |---|---|
//! | `refinements.rs` | [`Refinements`]: what the cut needs to know of a structure |
//! | `front.rs` | what a view asks for, kept up to date by asking only where the answer may have changed |
//! | `wheel.rs` | sleepers by how far the eye may go until they are looked at again |
//! | `closure.rs` | the smallest closed set that holds what is asked for |
//! | `cut.rs` | [`Cut`]: the three together |
//! | `level_of_detail.rs` | [`LevelOfDetail`]: what an engine sees of it |
//! | `dirty.rs` | [`Dirty`]: ranges of a buffer that changed |

mod closure;
mod cut;
mod dirty;
mod front;
mod level_of_detail;
mod refinements;
mod wheel;

pub(crate) use cut::is_done;
pub use cut::{Cut, CutReport};
pub use dirty::{Dirty, DirtyRanges};
pub use level_of_detail::{Change, LevelOfDetail};
pub use refinements::Refinements;
