//! Legality of collapses: small rules checked in order, each counting its refusals.
//!
//! Any collapse leaves a valid mesh (an image of the input's triangles). The rules decide whether the mesh is *good*:
//! same topology, no flipped triangles, seams and borders in place.
//!
//! | file | idea |
//! |---|---|
//! | `collapse.rs` | [`Oracle`], and the [`Collapse`] that it is asked about |
//! | `defaults.rs` | the default rules |
//! | `features.rs` | what a point is: locks, borders, seams, materials, non-manifold edges |
//! | `link_condition.rs` | [`LinkCondition`]: same topology |
//! | `triangle_shape.rs` | [`NormalFlip`], [`TriangleQuality`] |
//! | `self_intersection.rs` | [`SelfIntersection`]: whether the surface would cross itself |

mod collapse;
mod defaults;
mod features;
mod link_condition;
mod self_intersection;
mod triangle_shape;

pub use collapse::{Collapse, Oracle, Reads};
pub use defaults::default_oracles;
pub use features::{Borders, Locks, Materials, NonManifold, Seams, UvOrientation};
pub use link_condition::LinkCondition;
pub use self_intersection::SelfIntersection;
pub use triangle_shape::{NormalFlip, TriangleQuality};
