//! Geomorph mesh (g-mesh): few levels of detail that turn into each other without a jump, for objects drawn many times.
//!
//! ```text
//!     level       0 (finest)      1           2           3 (coarsest)
//!     vertices    |###########|
//!                 |######|          each level uses a prefix; vertices behind the prefix of the next level
//!                 |###|             move to their targets there, all others stay
//!                 |#|
//!     T           0 ---------- R_1 -------- R_2 -------- 1
//!     drawn at T  level i with R_i <= T < R_(i+1), share (T - R_i) / (R_(i+1) - R_i) of the way to level i + 1
//! ```
//!
//! A level is a batch of merges ([`Order::Batched`](crate::simplify::Order::Batched), or a stretch of a linear sequence). A
//! vertex merged in the batch after level `i` moves, while level `i` is drawn, from its own place to its target: the vertex it
//! is merged into. At the end of the way the triangles of level `i` that level `i + 1` lacks have two equal corners, and all
//! others lie where level `i + 1` has them, with the same attributes: the swap of levels shows nowhere (Southern, *Quality
//! control tools for interactive rendering of 3D triangle meshes*, chapter 6).
//!
//! Every vertex moves in a single level, the last in which it is drawn. So a vertex buffer, a buffer of targets' values and
//! the index buffers of all levels are uploaded once, for all instances, and an instance is two numbers
//! ([`MorphUniform`]) for a vertex shader ([`MORPH_WGSL`], [`MORPH_GLSL`]).
//!
//! | file | idea |
//! |---|---|
//! | `structure.rs` | [`Gmesh`]: levels, targets, triangles |
//! | `build.rs` | from a collapse sequence to levels and targets |
//! | `shrink.rs` | parts that vanish shrink in place |
//! | `parts.rs` | [`GmeshParts`] in and out, all promises checked |
//! | `partition.rs` | [`Partition`]: from the parameter T to a level and a share |
//! | `morph.rs` | [`Morph`]: a state between two levels, on the CPU |
//! | `shader.rs` | the same state in a vertex shader |
//! | `baked.rs` | the interface common to all structures |
//! | `instance.rs` | [`GmeshLod`]: a drawn instance following the view |
//!
//! # Drawing many
//!
//! ```
//! use multires::gmesh::{DistanceRange, Gmesh, Partition};
//! use multires::{Structure, mesh::shapes};
//!
//! let mesh = shapes::rock(2_000, 1);
//! let model = Gmesh::bake(&mesh)?;
//! let values = model.arrange(mesh.positions())?; // upload once
//! let gmesh = model.structure();
//! let targets = gmesh.target_values(&values); // upload once, as a second vertex stream
//! let partition = Partition::by_volume(gmesh);
//! let range = DistanceRange { near: 5.0, far: 50.0 };
//!
//! // Every frame, for every object: a range of indices and two numbers.
//! let morph = partition.at(range.t(20.0));
//! let triangles = gmesh.triangles(morph.level, 0);
//! let uniform = gmesh.uniform(morph);
//! assert!(triangles.len() < mesh.triangles().len() && uniform.share < 1.0);
//! # assert_eq!(targets.len(), values.len());
//! # Ok::<(), multires::Error>(())
//! ```

mod baked;
mod build;
mod error;
mod instance;
mod morph;
mod options;
mod partition;
mod parts;
#[cfg(feature = "io")]
mod sections;
mod shader;
mod shrink;
mod structure;

pub use baked::GmeshBuilder;
pub use build::GmeshBuild;
pub use error::GmeshError;
pub use instance::GmeshLod;
pub use morph::Morph;
pub use options::GmeshOptions;
pub use partition::{DistanceRange, Partition, PartitionError};
pub use parts::GmeshParts;
pub use shader::{MORPH_GLSL, MORPH_WGSL};

pub use crate::lod::MorphUniform;
pub use structure::{Gmesh, GmeshLevel};
