//! Measures and pictures of meshes: distances between meshes, ray-cast pictures, volume and slivers.
//!
//! `docs/guide/quality.md` in the repository tells which measure answers which question.
//!
//! | file | idea |
//! |---|---|
//! | `samples.rs` | points spread evenly over a surface |
//! | `surface.rs` | [`Surface`]: a mesh prepared once for measuring |
//! | `distance.rs` | [`distance()`]: Metro's two-sided distance between two meshes |
//! | `maximum.rs` | branch and bound: the largest distance within a proven bound |
//! | `signed.rs` | [`signed_distance`]: how far outside and how far inside; `closed.rs`: tests for an inside |
//! | `normal_deviation.rs` | [`normal_deviation()`]: how far normals turn |
//! | `parametric.rs` | [`parametric_deviation`]: how far points travel under a sequence's collapses |
//! | `texture.rs` | [`texture_deviation`]: how far the texture slides |
//! | `nearest.rs` | [`SurfacePoint`]: samples of a surface, and its nearest points |
//! | `sums.rs` | mean, root mean square and maximum |
//! | `volume.rs` | [`volume()`], [`volume_ratio`], [`area`] and [`ShapeReport`]: enclosed volume, area, shape of triangles |
//! | `intersections.rs` | [`self_intersections`]: how often a surface crosses itself |
//! | `images.rs` | [`image_difference`]: pixel differences over views from all sides |
//! | `render.rs` | [`render`]: pictures without a graphics card |
//! | `sight.rs` | first hit of a ray: the surface, its side, its normal |
//! | `camera.rs` | [`Camera`]: a pinhole camera |
//! | `normals.rs` | normals to shade with |
//! | `picture.rs` | [`Picture`]: pixels, and pictures side by side |
//! | `palette.rs` | [`palette`]: colours for numbers and for materials |
//! | `error.rs` | [`QualityError`] |

mod camera;
mod closed;
mod distance;
mod error;
mod images;
mod intersections;
mod maximum;
mod nearest;
mod normal_deviation;
mod normals;
pub mod palette;
mod parametric;
mod picture;
mod render;
mod samples;
mod sight;
mod signed;
mod sums;
mod surface;
mod texture;
mod volume;

pub use camera::Camera;
pub use distance::{Distance, DistanceOptions, OneSided, distance, vertex_distances};
pub use error::QualityError;
pub use images::{ImageDifference, ImageOptions, ReferenceImages, image_difference};
pub use intersections::self_intersections;
pub use nearest::SurfacePoint;
pub use normal_deviation::{Angles, NormalDeviation, OneSidedNormals, normal_deviation};
pub use parametric::{ParametricDeviation, parametric_deviation};
pub use picture::Picture;
pub use render::{Colours, RenderOptions, Shading, render};
pub use signed::{SignedDistance, SignedOneSided, signed_distance, vertex_signed_distances};
pub use surface::Surface;
pub use texture::{TextureDeviation, texture_deviation};
pub use volume::{ShapeReport, area, volume, volume_ratio};
