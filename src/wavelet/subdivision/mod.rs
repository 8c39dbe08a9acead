//! Subdivision connectivity: faces split in four, level by level.
//!
//! | file | idea |
//! |---|---|
//! | `connectivity.rs` | [`Subdivision`]: faces, wavelets, parents and children, most of it arithmetic |
//! | `build.rs` | building a subdivision level by level |

pub(super) mod build;
mod connectivity;

pub use connectivity::Subdivision;
pub(super) use connectivity::{MOST_ALONG, MOST_FACES, MOST_LEVELS, Side};
