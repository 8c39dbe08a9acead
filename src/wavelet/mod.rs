//! Meshes with subdivision connectivity: what a wavelet transform of a surface works on.
//!
//! | file | idea |
//! |---|---|
//! | `quadrisection.rs` | [`Quadrisection`]: base faces and their four-to-one subdivisions, a forest in level order |
//! | `recognise/` | [`recognise`]: finds the subdivision that a plain mesh has |

mod quadrisection;
mod recognise;

pub use quadrisection::Quadrisection;
pub use recognise::{Component, Recognition, Stop, recognise};
