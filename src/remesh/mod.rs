//! Remeshing: any mesh as a mesh with subdivision connectivity.
//!
//! Hardly any mesh has subdivision connectivity, as [`wavelet`](crate::wavelet) meshes need it. A [`Remesher`] simplifies the
//! mesh to a base and keeps a one-to-one map between both, the [`Parameterisation`]: every collapse is a change of the
//! triangulation of a flat polygon, so points of one triangulation are points of the other (Lee et al. 1998, MAPS:
//! Multiresolution Adaptive Parameterization of Surfaces; Liu et al. 2020, Neural Subdivision, for the composition of maps).
//! The remesh has its vertices at the images of the dyadic points of the base.
//!
//! | file | idea |
//! |---|---|
//! | `remesher.rs` | [`Remesher`]: options, and the run |
//! | `features.rs` | [`Features`]: edges that base edges must follow |
//! | `sectors.rs` | the mesh cut along its features, for the simplifier |
//! | `oracle.rs` | rules for collapses that make a base |
//! | `flatten.rs` | the star of a vertex in the plane |
//! | `coarsen.rs` | from a mesh to a base, with the map of every collapse |
//! | `layout.rs` | the list of maps; points travel both ways |
//! | `corners.rs` | the corners of the cells of a level, numbered |
//! | `charts.rs` | base faces in the plane, with the faces across their sides |
//! | `warp.rs` | a map of the base onto itself, linear on cells |
//! | `smooth.rs` | the map of the base onto itself that makes the whole map smooth |
//! | `parameterisation.rs` | [`Parameterisation`]: base, and the map between mesh and base |
//! | `distortion.rs` | [`Distortion`]: how far the map is from keeping angles and areas |
//! | `cells.rs` | faces of a subdivided base by number, and their neighbours |
//! | `unfold.rs` | moves corners of cells that face away from the mesh |
//! | `fit.rs` | moves vertices off the mesh, so that triangles come closest to it |
//! | `depth.rs` | [`Depth`]: which faces to split |
//! | `bake/` | [`BakedTexture`], [`NormalMap`]: the mesh's textures, colours and normals for the atlas of a remesh |
//! | `error.rs` | [`RemeshError`] |

mod bake;
mod cells;
mod charts;
mod coarsen;
mod corners;
mod depth;
mod distortion;
mod error;
mod features;
mod fit;
mod flatten;
mod layout;
mod oracle;
mod parameterisation;
mod remesher;
mod sectors;
mod smooth;
mod unfold;
mod warp;

pub use bake::{BakedTexture, NormalMap, NormalSpace, Texture};
pub use depth::Depth;
pub use distortion::{Distortion, Spread};
pub use error::RemeshError;
pub use features::{Creasing, Features};
pub use parameterisation::{Parameterisation, Remesh};
pub use remesher::{Fitting, Remesher, Smoothing};
