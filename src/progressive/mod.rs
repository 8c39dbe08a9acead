//! Progressive meshes: a base mesh and the vertex splits that refine it, one step at a time.
//!
//! | file | idea |
//! |---|---|
//! | `progressive_mesh.rs` | [`ProgressiveMesh`]: base mesh and vertex splits |
//! | `validate.rs` | checks every promise of a progressive mesh |
//! | `error.rs` | [`ProgressiveError`] |

mod error;
mod progressive_mesh;
mod validate;

pub use error::ProgressiveError;
pub use progressive_mesh::{ProgressiveMesh, VertexSplit};
