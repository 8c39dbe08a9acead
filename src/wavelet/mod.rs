//! Lazy-wavelet meshes: refinement by view over subdivision connectivity.
//!
//! A four-to-one subdivision of a coarse mesh is the coarse mesh plus a correction for every vertex added by subdivision. The
//! correction is a *lazy wavelet*: a hat at the midpoint of an edge, times a coefficient (Azuma et al. 2003, View-dependent
//! refinement of multiresolution meshes with subdivision connectivity). Any set of wavelets closed under parents is a mesh
//! without cracks, and a view selects a set. Textures cannot slide, since every point keeps its place on the base.
//!
//! | file | idea |
//! |---|---|
//! | `recognise/` | finding the coarsest mesh from which a mesh is subdivided |
//! | `subdivision/` | [`Subdivision`]: faces, wavelets, parents and children; building one level by level |
//! | `builder.rs` | [`WaveletBuilder`]: from a base mesh |
//! | `sources.rs` | vertices at points of another mesh |
//! | `heights.rs` | terrain from a grid of heights of any size |
//! | `mesh.rs` | [`WaveletMesh`]: connectivity, vertices and bounds, shared by instances |
//! | `from_quadrisection.rs` | a mesh and its quadrisection to a wavelet mesh |
//! | `bounds/` | bounds of the change when a wavelet is left out |
//! | `domain/` | places on the base: [`DomainPoint`], [`SurfaceSampler`], [`Atlas`] |
//! | `transform/` | [`WaveletTransform`]: lazy and k-disk wavelet coefficients, and dropping the smallest |
//! | `parts.rs`, `validate.rs` | the independent plain arrays, in and out; checking every invariant |
//! | `truncate.rs` | the wavelets with the largest errors, as many as fit |
//! | `edit.rs` | moving vertices of a level, with all finer vertices |
//! | `instance/` | [`WaveletLod`]: a drawn instance, its triangles and vertices |
//! | `baked.rs` | a wavelet mesh behind the interface common to all structures |
//! | `options.rs` | [`WaveletOptions`] and the enums it uses |
//! | `error.rs` | [`WaveletError`] |

mod baked;
mod bounds;
mod builder;
mod domain;
mod edit;
mod error;
mod from_quadrisection;
mod heights;
mod instance;
mod mesh;
mod options;
mod parts;
mod recognise;
#[cfg(feature = "io")]
mod sections;
mod sources;
mod subdivision;
mod transform;
mod truncate;
mod validate;

#[doc(no_inline)]
pub use crate::lod::Triangulation;
pub use bounds::WaveletBounds;
pub use builder::{Face, Midpoint, WaveletBuilder};
pub use domain::{Atlas, AtlasOptions, ChartSize, DomainPoint, SurfacePoint, SurfaceSampler};
pub use edit::{DetailFrame, Edited};
pub use error::WaveletError;
pub use instance::WaveletLod;
pub use mesh::WaveletMesh;
pub use options::{ErrorBound, Normals, WaveletOptions};
pub use parts::WaveletParts;
pub use recognise::{
    Component, Quadrisection, Recognition, Stop, recognise, recognise_across_seams, recognise_uneven,
};
pub use subdivision::Subdivision;
pub use transform::{Coefficients, Wavelet, WaveletTransform, l2_error};
