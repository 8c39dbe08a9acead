//! Lazy-wavelet meshes: refinement by view over subdivision connectivity.
//!
//! A four-to-one subdivision of a coarse mesh is the coarse mesh plus a correction for every vertex added by subdivision. The
//! correction is a *lazy wavelet*: a hat at the midpoint of an edge, times a coefficient (Azuma et al. 2003, View-dependent
//! refinement of multiresolution meshes with subdivision connectivity). Any set of wavelets closed under parents is a mesh
//! without cracks, and a view selects a set. Textures cannot slide, since every point keeps its place on the base.
//!
//! | file | idea |
//! |---|---|
//! | `quadrisection.rs`, `recognise/` | finding the coarsest mesh from which a mesh is subdivided |
//! | `subdivision.rs` | [`Subdivision`]: faces, wavelets, parents and children, most of it arithmetic |
//! | `build.rs`, `builder.rs` | building a subdivision level by level; [`WaveletBuilder`] from a base mesh |
//! | `heights.rs` | terrain from a grid of heights of any size |
//! | `mesh.rs` | [`WaveletMesh`]: connectivity, vertices and bounds, shared by instances |
//! | `domain.rs` | [`DomainPoint`]: where vertices are on the base |
//! | `sampler.rs` | [`SurfaceSampler`]: points of the full resolution by their place on the base |
//! | `atlas.rs`, `charts.rs` | [`Atlas`]: base faces as charts of a texture; baking it, and textured meshes |
//! | `bounds.rs`, `error_search.rs` | bounds of the change when a wavelet is left out |
//! | `parts.rs`, `validate.rs` | the independent plain arrays, in and out; checking every invariant |
//! | `truncate.rs` | the wavelets with the largest errors, as many as fit |
//! | `edit.rs` | moving vertices of a level, with all finer vertices |
//! | `use_counts.rs` | which faces are split and which vertices are in use |
//! | `surface.rs` | the triangles, without T-vertices |
//! | `vertices.rs` | where vertices are drawn |
//! | `instance.rs` | [`WaveletLod`]: a drawn instance |
//! | `transform/` | [`WaveletTransform`]: lazy and k-disk wavelet coefficients, and dropping the smallest |
//! | `baked.rs` | a wavelet mesh behind the interface common to all structures |
//! | `options.rs` | [`WaveletOptions`] and the enums it uses |

mod atlas;
mod baked;
mod bounds;
mod build;
mod builder;
mod charts;
mod domain;
mod edit;
mod error;
mod error_search;
mod heights;
mod instance;
mod mesh;
mod options;
mod parts;
mod quadrisection;
mod recognise;
mod sampler;
mod subdivision;
mod surface;
mod transform;
mod truncate;
mod use_counts;
mod validate;
mod vertices;

#[doc(no_inline)]
pub use crate::lod::Triangulation;
pub use atlas::{Atlas, AtlasOptions, ChartSize};
pub use bounds::WaveletBounds;
pub use builder::{Face, Midpoint, WaveletBuilder};
pub use domain::DomainPoint;
pub use edit::{DetailFrame, Edited};
pub use error::WaveletError;
pub use instance::WaveletLod;
pub use mesh::WaveletMesh;
pub use options::{ErrorBound, Normals, WaveletOptions};
pub use parts::WaveletParts;
pub use quadrisection::Quadrisection;
pub use recognise::{Component, Recognition, Stop, recognise, recognise_across_seams};
pub use sampler::{SurfacePoint, SurfaceSampler};
pub use subdivision::Subdivision;
pub use transform::{Coefficients, Wavelet, WaveletTransform, l2_error};
