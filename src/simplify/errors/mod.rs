//! How the error of a step is found.
//!
//! | file | idea |
//! |---|---|
//! | `step_errors.rs` | the error of a step, by the measure asked for |
//! | `tracked_samples.rs` | distance of the input from the level |
//! | `curve_samples.rs` | distance between the curves of input and level |
//! | `way_back.rs` | distance of the level from the input, next to curves and on coarse levels |
//! | `angles.rs` | few of many triangles around a point |
//! | `parametric_error.rs` | distance travelled by input points |
//! | `left_alone.rs` | points that a collapse leaves without triangles |

mod angles;
mod curve_samples;
mod left_alone;
mod parametric_error;
mod step_errors;
mod tracked_samples;
mod way_back;

pub(super) use step_errors::Errors;
