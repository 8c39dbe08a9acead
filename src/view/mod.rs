//! Cameras and criteria: which refinements a view needs.
//!
//! | file | idea |
//! |---|---|
//! | `camera.rs` | [`View`]: eye, frustum, pixels, tolerances, from plain matrices |
//! | `look_at.rs` | [`look_at`]: the matrix of a camera looking at a point |
//! | `object.rs` | [`ObjectView`]: a view in the space of an object, as needed by tests |
//! | `numbers.rs` | a view as plain numbers, to travel (feature `stream`) |
//! | `bounds.rs` | [`Bounds`] of a refinement: a sphere, a cone of normals, an error |
//! | `deviation.rs` | [`DeviationBounds`]: bounds with directional errors |
//! | `error_shape.rs` | [`ErrorShape`]: spheroids, and spheres with cones, around error vectors |
//! | `region.rs` | the sphere and the cone shared by all kinds of bounds |
//! | `seen.rs` | how bounds look from an eye |
//! | `lanes.rs` | tests of many bounds at once, in single precision |
//! | `criteria.rs` | [`Criterion`]: whether a refinement is needed, and how long the answer holds |
//!
//! # Nested tests
//!
//! The bounds of a refinement contain the bounds of every refinement needing it. All tests are monotone in the bounds: a
//! refinement needed with some sphere, cone and error is needed with a larger sphere, a wider cone and a larger error. So
//! the set of needed refinements is closed, and testing its rim finds it.

mod bounds;
mod camera;
mod criteria;
mod deviation;
mod error_shape;
mod lanes;
mod look_at;
mod matrix;
#[cfg(feature = "stream")]
mod numbers;
mod object;
mod region;
mod seen;

pub use bounds::Bounds;
pub use camera::{ErrorKind, Focus, View, ViewError};
pub use criteria::{Answer, Criterion, Factors, Motion};
pub use deviation::DeviationBounds;
pub use error_shape::ErrorShape;
pub(crate) use error_shape::Fit;
pub use look_at::look_at;
pub use object::ObjectView;
pub(crate) use region::angle_between;
