//! Subdivision connectivity: faces split in four, level by level.
//!
//! | file | idea |
//! |---|---|
//! | `connectivity.rs` | [`Subdivision`]: faces, wavelets, parents and children, most of it arithmetic |
//! | `build.rs` | building a subdivision level by level |
//! | `base_edges.rs` | edges of the base faces, and which of them are seams |
//! | `midpoints.rs` | vertices at midpoints, several along seams |

mod base_edges;
mod build;
mod connectivity;
mod midpoints;

pub(super) use build::SubdivisionBuilder;
pub use connectivity::Subdivision;
pub(super) use connectivity::{MOST_ALONG, MOST_FACES, MOST_LEVELS, Side};
pub(super) use midpoints::Part;
