//! Separate parts of a surface: points joined by triangles.
//!
//! | file | idea |
//! |---|---|
//! | `separate.rs` | the shape of each part, and the part it was joined into |
//! | `near.rs` | nearest points of other parts |
//! | `pairs.rs` | pairs not joined by an edge |

mod near;
pub(super) mod pairs;
mod separate;

pub(super) use separate::{Parts, Shape};
