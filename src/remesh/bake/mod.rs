//! Textures for the atlas of a remesh, filled from the mesh that was remeshed.
//!
//! ```text
//!     texel of the atlas -> place on the base -> point of the mesh -> its texture, its colours, its normal
//! ```
//!
//! The [`Atlas`](crate::wavelet::Atlas) gives every texel of a chart and of its gutter a place on the base, the
//! [`Parameterisation`](super::Parameterisation) takes it to the mesh. Seams of the mesh lie on edges of the base, so
//! every chart shows a single side of a seam.
//!
//! | file | idea |
//! |---|---|
//! | `texture.rs` | [`Texture`]: texels to read, [`BakedTexture`]: texels that were filled |
//! | `colours.rs` | base colours: from textures or vertex colours |
//! | `stream.rs` | a float attribute, read at any point |
//! | `normals.rs` | [`NormalMap`]: normals in the frame of a level, or of the object |

mod colours;
mod normals;
mod stream;
mod texture;

pub use normals::{NormalMap, NormalSpace};
pub use texture::{BakedTexture, Texture};
