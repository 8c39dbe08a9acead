//! Reading and writing files.
//!
//! ```text
//!     bytes --> reader of a format --> Draft (f64) --> origin moved, rounded --> Mesh
//!     Mesh  --> writer of a format --> bytes --> temporary file --> renamed over the old one
//! ```
//!
//! | file | idea |
//! |---|---|
//! | `read_write.rs` | [`read`] and [`write`](write()) by extension; [`write_textured`] |
//! | `format.rs`, `import.rs` | [`Format`]; [`ReadOptions`] and [`Imported`] |
//! | `obj.rs`, `ply/`, `stl.rs`, `off.rs`, `gltf/` | a format each; its head tells what is kept and how it is parsed |
//! | `draft.rs` | output of readers: a mesh before rounding |
//! | `text.rs` | lines, words and numbers |
//! | `polygon.rs` | polygons to triangles |
//! | `atomic.rs` | [`atomic`]: atomic writes of files |
//! | `baked.rs` | [`bake`] and [`unbake`]: any structure in a checked container |
//! | `model.rs` | [`read_model`]: a baked model of any structure; for a known structure: [`Baked::read`](crate::lod::Baked::read) |
//! | `error.rs` | errors of reading and writing |
//!
//! No file makes a reader panic, run for long, or reserve more than a multiple of the file's size: every declared count
//! is checked against the bytes present.

pub mod atomic;
mod baked;
mod draft;
mod error;
mod format;
mod gltf;
mod import;
mod model;
mod obj;
mod off;
mod ply;
mod polygon;
mod read_write;
mod stl;
mod text;

pub use baked::{BakeError, VERSION as BAKED_VERSION, bake, baked_kind, read_baked, unbake, write_baked};
pub use error::{Place, ReadError, WriteError};
pub use format::Format;
pub use gltf::GltfTextures;
pub use import::{Imported, ReadOptions, SceneOrigin};
pub use model::{StoredModel, read_model, unbake_model};
pub use read_write::{read, read_bytes, read_bytes_with, read_with, write, write_bytes, write_textured};
