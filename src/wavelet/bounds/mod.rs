//! Bounds of the change when a wavelet is left out.
//!
//! | file | idea |
//! |---|---|
//! | `wavelet_bounds.rs` | [`WaveletBounds`]: a sphere, a cone of normals, an error with a direction |
//! | `error_search.rs` | the least error that bounds a set of wavelets |

mod error_search;
mod wavelet_bounds;

pub use wavelet_bounds::WaveletBounds;
pub(super) use wavelet_bounds::{all_bounds, bounds, update};
