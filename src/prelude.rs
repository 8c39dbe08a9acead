//! What most programs use: `use multires::prelude::*`.
//!
//! ```
//! use multires::prelude::*;
//!
//! let mesh = multires::mesh::shapes::demo();
//! let sequence = Simplifier::new().target(Target::Ratio(0.25)).run(&mesh)?;
//! assert!(sequence.report().triangles <= mesh.triangles().len() / 4);
//! # Ok::<(), Error>(())
//! ```

pub use crate::Error;
pub use crate::adapt::{Change, LevelOfDetail, LodOptions};
pub use crate::hierarchy::{HierarchyBuilder, HierarchyLod, HierarchyMesh, VertexHierarchy};
pub use crate::mesh::{Attribute, Mesh, names};
pub use crate::simplify::{CollapseSequence, Placement, Simplifier, StopReason, Target};
pub use crate::tom::{Level, TomCursor, TomMesh, TomSteps, TotallyOrderedMesh};
pub use crate::view::View;
pub use crate::wavelet::{WaveletBuilder, WaveletLod, WaveletMesh};
