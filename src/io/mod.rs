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
//! | `obj.rs`, `ply/`, `stl/`, `off/`, `gltf/` | a format each; its head tells what is kept and how it is parsed |
//! | `draft.rs` | output of readers: a mesh before rounding |
//! | `text.rs` | lines, words and numbers |
//! | `polygon.rs` | polygons to triangles |
//! | `corners.rs` | values by corner and by face: vertices split where they differ |
//! | `atomic.rs` | [`atomic`]: atomic writes of files |
//! | `temporary_name.rs` | names of temporary files, which tell who writes them |
//! | `baked.rs` | [`bake`] and [`unbake`]: any value in the baked container; [`Aligned`] bytes for files within a program |
//! | `baked_3.rs` | files of format version 3 |
//! | `model.rs` | [`read_model`], [`open_model`]: a baked model of any structure; for a known structure: [`Baked::read`](crate::lod::Baked::read), [`Baked::from_shared`](crate::lod::Baked::from_shared) |
//! | `error.rs` | errors of reading and writing |
//!
//! No file makes a reader panic, run for long, or reserve more than a multiple of the file's size: every declared count
//! is checked against the bytes present.

pub mod atomic;
mod baked;
mod baked_3;
mod corners;
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
mod temporary_name;
mod text;

pub use crate::lod::Stored;
pub use crate::sections::{BakeError, BakeOptions, Compression, OpenOptions, SectionInfo, Trust};
pub use baked::{
    Aligned, VERSION as BAKED_VERSION, bake, baked_kind, baked_sections, baked_version, read_baked, unbake,
    write_baked,
};
pub use error::{Place, ReadError, WriteError};
pub use format::Format;
pub use gltf::{GltfDocument, GltfLevels, GltfPose, GltfTextures};
pub use import::{Imported, ReadOptions, SceneOrigin};
pub use model::{StoredModel, open_model, read_model, read_model_with, unbake_model};
pub use read_write::{read, read_bytes, read_bytes_with, read_with, write, write_bytes, write_textured};
