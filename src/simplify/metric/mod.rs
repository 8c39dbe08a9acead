//! Costs of collapses: the interface between the simplifier and its error metrics.
//!
//! | metric | cost of a collapse | source |
//! |---|---|---|
//! | [`EdgeLength`] | squared length of the edge | Southern 3.2.3, Berkey 3.1 |
//! | [`UnsignedVolume`] | volume swept by the surface, unsigned | Southern 3.2.4 |
//! | [`Hybrid`] | that volume times the largest normal deviation | Southern 3.2.4 |
//! | [`ProgressiveMeshMetric`] | distances to the planes around, plus springs | Southern 3.2.1 |
//! | [`MemorylessQuadric`] | area-weighted squared distances to the planes around | Southern 3.2.2 |
//! | [`Quadric`] | the same, accumulated since the input | Garland and Heckbert 1997 |
//! | [`VolumeArea`] | volume and area change | TOM 4.1 |
//! | [`LindstromTurk`] | volume, boundary and shape objectives | Lindstrom and Turk 1998 |
//! | [`WithAttributes`] | any of them plus squared attribute deviations | Hoppe 1999 |

mod attributes;
mod by_name;
mod deviation;
mod edge_length;
mod error_metric;
mod event;
mod hybrid;
mod lindstrom_turk;
mod loss;
mod memoryless_quadric;
mod per_batch;
mod progressive_mesh;
mod properties;
mod quadric;
mod region;
mod solve;
mod stars;
mod unsigned_volume;
mod volume_area;

pub use attributes::{Attributes, WithAttributes};
pub use by_name::{NAMES, by_name};
pub use deviation::{AttributeQuadric, AttributeSum};
pub use edge_length::EdgeLength;
pub(crate) use error_metric::{Borrowed, cost_at_kept};
pub use error_metric::{ErrorMetric, Optimum, Pair};
pub use event::{Batch, MetricEvent, Substitutions};
pub use hybrid::Hybrid;
pub use lindstrom_turk::LindstromTurk;
pub use loss::{Loss, VanishingLoss};
pub use memoryless_quadric::MemorylessQuadric;
pub use per_batch::PerBatch;
pub use progressive_mesh::ProgressiveMeshMetric;
pub use properties::{Dependence, MetricProperties};
pub use quadric::Quadric;
pub use unsigned_volume::UnsignedVolume;
pub use volume_area::VolumeArea;
