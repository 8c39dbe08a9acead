//! The mesh while it is simplified.
//!
//! | file | idea |
//! |---|---|
//! | `working_surface.rs` | [`WorkingSurface`]: points, triangles over points, stars |
//! | `stars.rs` | the corners around every point |
//! | `sheets.rs` | triangles over equal points |
//! | `classify.rs` | borders, seams and other kinds of points and edges |
//! | `curves.rs` | curves of the input, creases, and their images on the level |
//! | `hub_edges.rs` | edges between points with very many triangles |
//! | `patch.rs` | the triangles changed by a collapse |
//! | `wedge_map.rs` | where the wedges of a merged point go |
//! | `wedge_values.rs` | values that tell wedges apart, and the sides of triangles in texture space |

pub(super) mod classify;
pub(super) mod curves;
mod hub_edges;
pub(super) mod patch;
mod sheets;
mod stars;
pub(super) mod wedge_map;
mod wedge_values;
mod working_surface;

pub(crate) use curves::Rim;
pub(crate) use hub_edges::HUB;
pub use patch::{Facet, Patch};
pub use working_surface::{Corner, Frame, WorkingSurface};
