//! Lazy-wavelet meshes: refinement by view over subdivision connectivity.
//!
//! A mesh that is a four-to-one subdivision of a coarse one is the coarse mesh plus one correction for every vertex that
//! subdivision added: a *lazy wavelet*, a hat at the midpoint of an edge, times a coefficient (Azuma et al. 2003, View-dependent
//! refinement of multiresolution meshes with subdivision connectivity). Any set of them that is closed under parents is a
//! mesh without cracks; a view asks for a set, and textures cannot slide, since every point stays what it is on the base.
//!
//! | file | idea |
//! |---|---|
//! | `quadrisection.rs`, `recognise/` | finding the coarsest mesh that a mesh is a subdivision of |
//! | `subdivision.rs` | [`Subdivision`]: faces, wavelets, parents and children, most of it arithmetic |
//! | `build.rs`, `builder.rs` | building it level by level; [`WaveletBuilder`] from a base mesh |
//! | `heights.rs` | terrain from a grid of heights of any size |
//! | `mesh.rs` | [`WaveletMesh`]: connectivity, vertices and bounds, shared by instances |
//! | `domain.rs` | [`DomainPoint`]: where vertices are on the base |
//! | `sampler.rs` | [`SurfaceSampler`]: points of the full resolution by their place on the base |
//! | `atlas.rs`, `charts.rs` | [`Atlas`]: base faces as charts of one texture; baking it, and meshes that wear it |
//! | `bounds.rs`, `error_search.rs` | what leaving a wavelet out can change |
//! | `parts.rs`, `validate.rs` | the plain arrays that follow from nothing else, in and out, and every promise checked |
//! | `truncate.rs` | the wavelets that change most, as many as fit |
//! | `edit.rs` | moving vertices of a level, with all that is finer |
//! | `use_counts.rs` | which faces are split and which vertices are in use |
//! | `surface.rs` | the triangles, without T-vertices |
//! | `vertices.rs` | where vertices are drawn |
//! | `instance.rs` | [`WaveletLod`]: one drawn instance |
//! | `transform/` | [`WaveletTransform`]: lazy and k-disk wavelet coefficients, and leaving out the least of them |
//! | `baked.rs` | a wavelet mesh under the one face of all structures |
//! | `options.rs` | [`WaveletOptions`] and what they choose from |

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
