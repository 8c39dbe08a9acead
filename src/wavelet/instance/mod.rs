//! A drawn instance: triangles and vertices of the wavelets in use.
//!
//! | file | idea |
//! |---|---|
//! | `lod.rs` | [`WaveletLod`]: a drawn instance |
//! | `use_counts.rs` | which faces are split and which vertices are in use |
//! | `surface.rs` | the triangles, without T-vertices |
//! | `vertices.rs` | where vertices are drawn |

mod lod;
pub(super) mod surface;
pub(super) mod use_counts;
mod vertices;

pub use lod::WaveletLod;
