//! multires for JavaScript: simplification and levels of detail of meshes that are typed arrays.
//!
//! | file | idea |
//! |---|---|
//! | `input.rs` | a mesh from typed arrays, and options from an object |
//! | `simplify.rs` | [`simplify`]: fewer triangles over the same vertices |
//! | `lod.rs` | [`Lod`]: a level of detail that follows a camera, as views of this module's memory |
//!
//! Vertices stay where they are: what comes out are indices of the vertices that went in, or of the same vertices in another
//! [order](Lod::order). So normals, texture coordinates, skins and whatever else a vertex has stay the caller's.
//!
//! `npm/` holds what goes to npm beside the bindings: types, and the few lines that arrange an attribute.
#![cfg(target_arch = "wasm32")]

mod input;
mod lod;
mod simplify;

pub use lod::Lod;
pub use simplify::{Simplified, simplify};
