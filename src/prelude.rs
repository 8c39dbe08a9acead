//! Names used by most programs: `use multires::prelude::*`.
//!
//! ```
//! use multires::prelude::*;
//!
//! let mesh = multires::mesh::shapes::demo();
//! let model = VertexHierarchy::bake(&mesh)?;
//! let mut lod = model.instance(model.arrange(mesh.positions())?, &LodOptions::default())?;
//! assert!(lod.refine_fully().triangles > 70_000);
//! # Ok::<(), Error>(())
//! ```

pub use crate::adapt::{Blend, Change, Geomorph};
pub use crate::any_error::Error;
pub use crate::gmesh::Gmesh;
pub use crate::hierarchy::VertexHierarchy;
pub use crate::lod::{Baked, FromSequence, Level, Lod, LodOptions, Structure, Values, Vertex, VertexBuffer};
pub use crate::mesh::{Attribute, Mesh, names};
pub use crate::sequence::{CollapseSequence, StopReason};
pub use crate::simplify::{Placement, Simplifier, Target};
pub use crate::tom::TotallyOrderedMesh;
pub use crate::view::{ObjectView, View};
pub use crate::wavelet::WaveletMesh;
