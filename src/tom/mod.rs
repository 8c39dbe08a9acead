//! Totally ordered mesh (TOM): all levels of detail in a vertex array, a triangle array and an index per vertex.
//!
//! ```text
//!     vertices    base | last removed ... first removed        the first `resolution.vertices()` are active
//!     substitute   =   | an earlier vertex each                takes its place when it is not active
//!     triangles   base | last vanishing ... first vanishing    the first `resolution.triangles()` are drawn
//! ```
//!
//! An inactive corner is replaced by its substitute until it is active: no other connectivity is stored (Bouvier and
//! Gobbetti, *TOM: Totally Ordered Mesh*, section 3). With positions and normals of 24 bytes a vertex, the whole takes at
//! most 108.5 % of the plain mesh.
//!
//! Vertices removed by a single step form a *group*. They come and go together, so the wedges of a seam never part, and
//! the paper's degenerate triangles are not needed. The structure holds topology only. [`TotallyOrderedMesh::build`]
//! returns the order for positions and all other vertex data; [`Baked`](crate::lod::Baked) stores the data in this order.
//!
//! | file | idea |
//! |---|---|
//! | `totally_ordered_mesh.rs` | [`TotallyOrderedMesh`]: the arrays |
//! | `build.rs` | from a collapse sequence to the total order |
//! | `level.rs` | from a [`Level`] to a [`Resolution`] |
//! | `extract.rs` | the indices of a resolution, whole or by material |
//! | `geomorph.rs` | where vertices move between two resolutions |
//! | `steps.rs` | [`TomSteps`]: the corners rewritten by every step |
//! | `baked.rs` | the interface common to all structures |
//! | `instance.rs` | [`TomLod`]: a drawn instance following the view |
//! | `indices.rs` | an index buffer, moved at the cost of the difference |
//! | `cursor.rs` | [`TomCursor`]: an index buffer, moved by its owner |
//! | `validate.rs` | [`TomParts`] in and out, all promises checked |
//!
//! # Drawing
//!
//! ```
//! use multires::lod::Structure;
//! use multires::{Level, TotallyOrderedMesh, mesh::shapes};
//!
//! let mesh = shapes::rock(2_000, 1);
//! let model = TotallyOrderedMesh::bake(&mesh)?;
//! let positions = model.arrange(mesh.positions())?; // upload once
//!
//! let tom = model.structure();
//! let resolution = tom.at(Level::Ratio(0.5));
//! let mut indices = Vec::new();
//! tom.fill_indices(resolution, &mut indices); // upload and draw
//! assert_eq!(indices.len(), 3 * resolution.triangles());
//! assert!(indices.iter().all(|&v| (v as usize) < resolution.vertices() && resolution.vertices() <= positions.len()));
//! # Ok::<(), multires::Error>(())
//! ```
//!
//! To follow a view, use [`TomLod`]: it finds the level, and moves its indices at the cost of the difference.

mod baked;
mod build;
mod cursor;
mod error;
mod extract;
mod geomorph;
mod indices;
mod instance;
mod level;
#[cfg(feature = "io")]
mod sections;
mod steps;
mod totally_ordered_mesh;
mod validate;

#[doc(no_inline)]
pub use crate::lod::Level;
pub use baked::{TomBuilder, TomOptions};
pub use build::TomBuild;
pub use cursor::{Change, TomCursor};
pub use error::TomError;
pub use extract::MaterialRange;
pub use instance::TomLod;
pub use level::Resolution;
pub use steps::TomSteps;
pub use totally_ordered_mesh::{ErrorMark, TotallyOrderedMesh};
pub use validate::TomParts;
