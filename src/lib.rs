//! Multiresolution triangle meshes.
#![forbid(unsafe_code)]
#![deny(missing_docs)]

pub mod error;
#[cfg(feature = "io")]
pub mod io;
pub mod mesh;
#[cfg(feature = "quality")]
pub mod quality;
pub mod simplify;
pub mod tom;

pub use error::MeshError;
pub use mesh::{Attribute, Mesh};
pub use simplify::{CollapseSequence, ProgressiveMesh, Simplifier};
pub use tom::{Level, Resolution, TomCursor, TotallyOrderedMesh};
