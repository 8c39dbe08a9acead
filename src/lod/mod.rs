//! The interface common to all structures: bake a model, make an instance, adapt it, draw it.
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
//! | `structure.rs` | [`Structure`]: what baking, loading and drawing need of a structure |
//! | `baked.rs` | [`Baked`]: a structure, its vertices and their origins |
//! | `origins.rs` | [`Origins`]: from values of the input's vertices to values of the structure's |
//! | `values.rs` | [`Values`]: values in the structure's order |
//! | `builder.rs` | [`Builder`]: simplify and bake in a single call, with any metric |
//! | `options.rs` | [`LodOptions`]: how an instance follows the view |
//! | `instance.rs` | [`Lod`]: a drawn instance |
//! | `adapt_all.rs` | [`adapt_all`]: many instances, over all cores |
//! | `uploads.rs` | [`Upload`], [`Draw`]: what a frame writes and draws |
//! | `patience.rs` | when an instance gives memory back |
//! | `driver.rs` | common parts of instances refined by view |
//! | `whole.rs` | common parts of instances of a single resolution |
//! | `level.rs` | [`Level`]: a level of detail of the whole model |
//! | `model.rs` | [`Model`]: a baked model of any structure |
//! | `sections.rs` | models in the sections of a baked file |
//! | `short_indices.rs` | [`ShortIndices`]: 16-bit indices where they fit |
//! | `error.rs` | [`LodError`] |

mod adapt_all;
mod baked;
mod builder;
mod driver;
mod error;
mod instance;
mod level;
mod model;
mod options;
mod origins;
mod patience;
#[cfg(feature = "io")]
mod sections;
mod short_indices;
mod structure;
mod uploads;
mod values;
mod whole;

pub use adapt_all::adapt_all;
pub use baked::Baked;
pub use builder::Builder;
pub(crate) use driver::{Driver, Everything};
pub use error::LodError;
pub use instance::{Lod, MorphUniform};
pub use level::{Extracted, Level};
pub use model::Model;
pub use options::{LodOptions, Triangulation, VertexBuffer};
pub use origins::{Mixture, Origins};
#[cfg(feature = "io")]
pub use sections::Stored;
pub use short_indices::ShortIndices;
pub use structure::{FromSequence, Progress, Structure, VertexRank};
pub use uploads::{Draw, Draws, Upload, Uploads};
pub(crate) use values::Mix;
pub use values::{Values, Vertex};
pub(crate) use whole::{Allowed, Whole, WholeInstance};
