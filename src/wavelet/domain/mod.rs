//! The base mesh as the domain of functions on the surface: places on it, and textures over it.
//!
//! | file | idea |
//! |---|---|
//! | `domain_point.rs` | [`DomainPoint`]: where vertices are on the base |
//! | `sampler.rs` | [`SurfaceSampler`]: points of the full resolution by their place on the base |
//! | `atlas.rs` | [`Atlas`]: base faces as charts of a texture; baking it |
//! | `charts.rs` | textured meshes |

mod atlas;
mod charts;
mod domain_point;
mod sampler;

pub use atlas::{Atlas, AtlasOptions, ChartSize};
pub use domain_point::DomainPoint;
pub use sampler::{SurfacePoint, SurfaceSampler};
