//! The one face of all structures: bake a model, make an instance, adapt it, draw it.
//!
//! ```text
//!     Mesh  --bake-->  Baked<S>  --instance(values, options)-->  Lod     every frame: adapt, uploads, clean, draws
//!                        |  ^
//!                        v  |      to and from bytes
//!                       file
//! ```
//!
//! | file | idea |
//! |---|---|
//! | `structure.rs` | [`Structure`]: what a structure is to whoever bakes, loads and draws it |
//! | `baked.rs` | [`Baked`]: a structure, its vertices and where they come from |
//! | `origins.rs` | [`Origins`]: how values of any type follow |
//! | `values.rs` | [`Values`]: those values, in the structure's order |
//! | `builder.rs` | [`Builder`]: simplify and bake in one call, with any metric |
//! | `options.rs` | [`LodOptions`]: how an instance follows the view |
//! | `instance.rs` | [`Lod`]: a drawn instance |
//! | `uploads.rs` | [`Upload`], [`Draw`]: what a frame writes and draws |
//! | `driver.rs` | what instances that refine by view have in common |
//! | `level.rs` | [`Level`]: a level of detail of the whole model |
//! | `model.rs` | [`Model`]: a baked model of whatever structure |
//! | `short_indices.rs` | [`ShortIndices`]: 16-bit indices where they fit |
//! | `error.rs` | [`LodError`] |

mod baked;
mod builder;
mod driver;
mod error;
mod instance;
mod level;
mod model;
mod options;
mod origins;
mod short_indices;
mod structure;
mod uploads;
mod values;

pub use baked::Baked;
pub use builder::Builder;
pub(crate) use driver::{Driver, Everything};
pub use error::LodError;
pub use instance::Lod;
pub use level::{Extracted, Level};
pub use model::Model;
pub use options::{LodOptions, Triangulation, VertexBuffer};
pub use origins::{Mixture, Origins};
pub use short_indices::ShortIndices;
pub use structure::{FromSequence, Progress, Structure, VertexRank};
pub use uploads::{Draw, Draws, Upload, Uploads};
pub(crate) use values::Mix;
pub use values::{Values, Vertex};
