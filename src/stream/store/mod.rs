//! A model in pages, fetched as they are looked at: a model larger than memory, or behind a slow line without a server.
//!
//! ```text
//!     header               coarsest mesh, and of every page its place and bounds
//!     page | page | ...    512 splits each: those of a region, of like fineness
//!
//!     instance   adapt(views) -> wanted()  ----->  read a range of a file, of an archive, of a URL
//!                supply(page, bytes)       <-----  on any thread, in any order
//! ```
//!
//! The cut stops at splits whose pages have not arrived: what is missing is coarse, never wrong. Pages with a split in the mesh
//! stay; the others are kept, while there is room in the cache, by their last use.
//!
//! Source: Southern, section 2.6 (a hierarchy read by pages); the pages are sets of splits instead of subtrees.
//!
//! | file | idea |
//! |---|---|
//! | `order.rs` | the order of splits in pages: like fineness, then place |
//! | `write.rs` | [`write_store`] |
//! | `header.rs` | [`Store`]: coarsest mesh and table of pages |
//! | `page.rs` | a page: its arrays, their bytes, their checks |
//! | `cache.rs` | the pages in memory, as the cut sees them |
//! | `blocks.rs` | ranges of numbers for vertices and triangles of pages that come and go |
//! | `shown.rs` | the mesh of the splits in the cut |
//! | `lod.rs` | [`StoreLod`]: a drawn instance |
//! | `error.rs` | [`StoreError`] |

mod blocks;
mod cache;
mod error;
mod header;
mod lod;
mod order;
mod page;
mod shown;
mod write;

pub use error::StoreError;
pub use header::Store;
pub use lod::{PageRange, StoreLod};
pub use write::{StoreOptions, write_store};
