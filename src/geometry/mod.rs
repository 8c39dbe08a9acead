//! Helpers that several rooms need. Imports no other room.
//!
//! | file | idea |
//! |---|---|
//! | `array.rs` | an array, owned or within the bytes of a file |
//! | `boxes.rs` | smallest and largest corner of points |
//! | `triangle.rs` | a triangle: nearest point, distance, ray, angle and weights at a point |
//! | `texture.rs` | a triangle in texture space: area and side |
//! | `crossing.rs` | whether two triangles cross |
//! | `segment.rs` | a segment: nearest point |
//! | `lanes.rs`, `sectors.rs` | four vectors at once; four triangles around a point at once |
//! | `bvh.rs` | triangles in a hierarchy of boxes: nearest point, first hit of a ray (feature `quality`) |
//! | `turned_boxes.rs` | second boxes, along long thin triangles |
//! | `rounding.rs` | single precision, rounded up |
//! | `paged.rs` | arrays in which most elements are alike: memory follows the others |
//! | `lists.rs` | lists in two flat arrays, by counting, prefix sum and filling |
//! | `sets.rs` | disjoint sets |
//! | `hash.rs` | hashes identical on every machine |
//! | `parallel.rs` | loops over all cores, with results in order |

pub(crate) mod array;
pub(crate) mod boxes;
#[cfg(feature = "quality")]
pub(crate) mod bvh;
pub(crate) mod crossing;
pub(crate) mod hash;
pub(crate) mod lanes;
pub(crate) mod lists;
pub(crate) mod paged;
pub(crate) mod parallel;
pub(crate) mod rounding;
pub(crate) mod sectors;
pub(crate) mod segment;
pub(crate) mod sets;
pub(crate) mod texture;
#[cfg_attr(not(feature = "quality"), allow(dead_code))]
pub(crate) mod triangle;
#[cfg(feature = "quality")]
mod turned_boxes;
