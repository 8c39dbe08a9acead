//! Vertex hierarchies: view-dependent refinement of any mesh accepted by the simplifier.
//!
//! Every collapse of a [`CollapseSequence`](crate::sequence::CollapseSequence) is undone by a *split*. Splits build on
//! one another: a split which brings back a vertex needs the vertex's substitute in the mesh. A *cut* is a set of
//! splits closed under needs. **The mesh at a cut is the image of the input's triangles under the remaining collapses,
//! without triangles with two equal corners.** This holds for any cut, so connectivity cannot be corrupted, also on
//! open, non-manifold and otherwise odd meshes. [`Dependencies`] decide only how near a cut must stay to meshes seen by
//! the simplifier.
//!
//! | file | idea |
//! |---|---|
//! | `vertex_hierarchy.rs` | [`VertexHierarchy`]: the arrays |
//! | `build.rs` | builds splits from a collapse sequence, numbered for locality |
//! | `bounds.rs` | nested bounds of splits |
//! | `context.rs` | error of a split left out of an otherwise fine mesh |
//! | `wings.rs` | dependencies that keep cuts manifold |
//! | `dependencies.rs` | [`Dependencies`] of splits besides parents |
//! | `stars.rs` | the corners around every active vertex, in a pool |
//! | `slots.rs` | the vertices in use, packed |
//! | `surface.rs` | the mesh at a cut: splits and collapses |
//! | `look_ahead.rs` | fetches what splits and collapses are going to read |
//! | `instance.rs` | [`HierarchyLod`]: a drawn instance |
//! | `baked.rs` | the common interface of all structures; [`HierarchyOptions`] |
//! | `builder.rs` | [`HierarchyBuilder`]: presets |
//! | `parts.rs` | [`HierarchyParts`]: plain arrays, in and out |
//! | `sink.rs` | applies splits and collapses to the drawn mesh |
//! | `vertices.rs` | the vertex buffer, with moving vertices |
//! | `validate.rs` | checks of all invariants |
//! | `error.rs` | [`HierarchyError`] |

mod baked;
mod bounds;
mod build;
mod builder;
mod context;
mod dependencies;
mod error;
mod instance;
mod look_ahead;
mod parts;
#[cfg(feature = "io")]
mod sections;
mod sink;
mod slots;
mod stars;
mod surface;
mod validate;
mod vertex_hierarchy;
mod vertices;
mod wings;

pub use baked::HierarchyOptions;
pub use build::HierarchyBuild;
pub use builder::HierarchyBuilder;
pub use dependencies::Dependencies;
pub use error::HierarchyError;
pub use instance::HierarchyLod;
pub use parts::HierarchyParts;
pub use surface::CutSurface;
#[cfg(feature = "stream")]
pub(crate) use surface::SplitSource;
pub use vertex_hierarchy::VertexHierarchy;
