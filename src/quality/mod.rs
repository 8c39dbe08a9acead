//! How good a mesh is, and what it looks like: distances between meshes, ray-cast pictures, volume and slivers.
//!
//! Which measure answers which question: `docs/guide/quality.md` in the repository.
//!
//! | file | idea |
//! |---|---|
//! | `bvh.rs` | the surface in a hierarchy of boxes: nearest point, first hit of a ray |
//! | `samples.rs` | points spread evenly over a surface |
//! | `triangle.rs` | one triangle: nearest point, ray, angle and weights at a point |
//! | `surface.rs` | [`Surface`]: a mesh prepared once for measuring |
//! | `distance.rs` | [`distance()`]: Metro's two-sided distance between two meshes |
//! | `maximum.rs` | the largest distance to within a proven bound |
//! | `signed.rs` | [`signed_distance`]: how far outside and how far inside; `closed.rs`: whether there is an inside |
//! | `normal_deviation.rs` | [`normal_deviation()`]: how far normals turn |
//! | `parametric.rs` | [`parametric_deviation`]: how far points travel under a sequence's collapses |
//! | `texture.rs` | [`texture_deviation`]: how far the texture slides |
//! | `nearest.rs` | [`SurfacePoint`]: samples of a surface, and its nearest points |
//! | `sums.rs` | mean, root mean square and maximum |
//! | `volume.rs` | [`volume()`], [`volume_ratio`], [`area`] and [`ShapeReport`]: what a mesh encloses and how good its triangles are |
//! | `intersections.rs` | [`self_intersections`]: how often a surface crosses itself |
//! | `images.rs` | [`image_difference`]: what is seen of the difference, over views from all sides |
//! | `render.rs` | [`render`]: pictures without a graphics card |
//! | `sight.rs` | what a ray sees: the surface, its side, its normal |
//! | `camera.rs` | [`Camera`]: where a picture is taken from |
//! | `normals.rs` | normals to shade with |
//! | `picture.rs` | [`Picture`]: pixels, and pictures side by side |
//! | `palette.rs` | [`palette`]: colours for numbers and for materials |
//! | `error.rs` | [`QualityError`] |
//! | `hash.rs` | hashes that are the same on every machine |

mod bvh;
mod camera;
mod closed;
mod distance;
mod error;
mod hash;
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
mod triangle;
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

/// `work` for every chunk of `size` of `0..count`, results in order of the chunks; on all cores with `parallel`.
pub(crate) fn map_chunks<T: Send>(
    count: usize,
    size: usize,
    work: impl Fn(std::ops::Range<usize>) -> T + Sync,
) -> Vec<T> {
    let chunk = |index: usize| work(index * size..((index + 1) * size).min(count));
    #[cfg(feature = "parallel")]
    {
        use rayon::prelude::*;
        (0..count.div_ceil(size)).into_par_iter().map(chunk).collect()
    }
    #[cfg(not(feature = "parallel"))]
    {
        (0..count.div_ceil(size)).map(chunk).collect()
    }
}
