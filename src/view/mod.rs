//! Where one looks from, and how much of a mesh that asks for.
//!
//! | file | idea |
//! |---|---|
//! | `camera.rs` | [`View`]: eye, frustum, pixels, tolerances, from plain matrices |
//! | `look_at.rs` | [`look_at`]: the matrix of a camera that looks at a point |
//! | `object.rs` | [`ObjectView`]: the same in the space of one object, as tests need it |
//! | `bounds.rs` | [`Bounds`]: what a refinement can change: a sphere, a cone of normals, an error |
//! | `deviation.rs` | [`DeviationBounds`]: the same with errors that have a direction |
//! | `error_shape.rs` | [`ErrorShape`]: spheroids, and spheres with cones, around error vectors |
//! | `region.rs` | the sphere and the cone that bounds of all kinds have |
//! | `seen.rs` | how bounds look from an eye |
//! | `criteria.rs` | [`Criterion`]: whether a refinement is needed, and for how long that stays so |
//!
//! # Nested tests
//!
//! The bounds of a refinement contain those of every refinement that needs it. All tests are monotone in the bounds: what is
//! needed for a smaller sphere, a narrower cone and a smaller error is needed for larger ones too. So a cut of needed
//! refinements is closed, and looking at its rim is enough to find it.

mod bounds;
mod camera;
mod criteria;
mod deviation;
mod error_shape;
mod look_at;
mod matrix;
mod object;
mod region;
mod seen;

pub use bounds::Bounds;
pub use camera::{ErrorKind, Focus, View, ViewError};
pub use criteria::{Answer, Criterion, Motion};
pub use deviation::DeviationBounds;
pub use error_shape::ErrorShape;
pub(crate) use error_shape::Fit;
pub use look_at::look_at;
pub use object::ObjectView;
pub(crate) use region::angle_between;
