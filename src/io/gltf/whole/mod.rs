//! A whole document: its meshes can be replaced, all else stays as it is.
//!
//! ```text
//!     file --> sections (text), geometric part, buffers
//!     mesh i --> Mesh --> simplified --> columns (encode.rs) --> accessors, views, buffer (pack.rs) --> file
//! ```
//!
//! | file | idea |
//! |---|---|
//! | `gltf_document.rs` | [`GltfDocument`] |
//! | `sections.rs` | the JSON text by sections: unchanged ones byte for byte |
//! | `uncompressed.rs` | sections of a document that was decoded |
//! | `encode.rs` | a mesh to columns, in the file's types |
//! | `pack.rs`, `ranges.rs` | columns to accessors, views and a buffer; no index changes |
//! | `assemble.rs` | the document to be written |
//! | `levels.rs` | nodes of levels of detail |
//! | `rig.rs`, `poses.rs` | skins and animations; [`GltfPose`], where they bend a mesh most |
//! | `save.rs` | .glb and .gltf files, pictures beside them |

mod assemble;
mod encode;
mod gltf_document;
mod levels;
mod pack;
mod poses;
mod ranges;
mod rig;
mod save;
mod sections;
mod uncompressed;

pub use gltf_document::GltfDocument;
pub use levels::GltfLevels;
pub use poses::GltfPose;
