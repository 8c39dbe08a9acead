#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]
#![deny(missing_docs)]

mod auto_lod;
mod build;
mod cache;
pub mod convert;
mod follow;
mod format;
mod model;
mod plugin;

pub use auto_lod::{AutoLod, DrawnLod, LodBuilt, LodLevel, LodLevels, LodSettings, LodStats, NoAutoLod};
pub use build::{BuildError, Ladder};
pub use cache::LodCache;
pub use convert::ConvertError;
pub use model::{LodModel, LodModel3d, LodModelLoader, LodPart, ModelError};
pub use plugin::{LodSystems, MultiresPlugin};
