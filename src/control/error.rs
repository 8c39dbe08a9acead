//! Errors of controllers.

/// Why a controller, or what it controls, could not be made, or a frame could not be taken in.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ControlError {
    /// An option lies outside its range.
    #[error("{option} is {value}, which is not {expected}")]
    OutOfRange {
        /// The option.
        option: &'static str,
        /// The given value.
        value: f64,
        /// The allowed values.
        expected: &'static str,
    },
    /// A measured time is not above 0, or not finite. The controller has not changed.
    #[error("a frame took {seconds} seconds, which is not above 0 and finite")]
    Time {
        /// The given time, seconds.
        seconds: f64,
    },
    /// A partition has another number of levels than the geomorph mesh.
    #[error("the partition has {found} levels, the geomorph mesh {expected}")]
    Levels {
        /// Levels of the partition.
        found: usize,
        /// Levels of the mesh.
        expected: usize,
    },
    /// There are no levels.
    #[error("there are no levels: at least 1 is needed")]
    NoLevels,
    /// A level has more triangles than 32 bits hold.
    #[error("level {level} has {triangles} triangles, more than 32 bits hold")]
    TooLarge {
        /// Number of the level.
        level: usize,
        /// Its triangles.
        triangles: usize,
    },
    /// An error of a level is negative or not finite.
    #[error("the error of level {level} is {error}, which is not 0 or more and finite")]
    Error {
        /// Number of the level.
        level: usize,
        /// The given error.
        error: f32,
    },
    /// A parameter is not finite, or does not exceed the parameter of the level before.
    #[error("level {level} begins at {parameter}, which is not finite or not above the level before")]
    Parameter {
        /// Number of the level.
        level: usize,
        /// The given parameter.
        parameter: f32,
    },
    /// A level has no fewer triangles than the level before.
    #[error("level {level} has {triangles} triangles, no fewer than the level before")]
    NotCoarser {
        /// Number of the level.
        level: usize,
        /// Its triangles.
        triangles: usize,
    },
}

/// Checks an option; `expected` says what `holds` asks for.
pub(super) fn check(
    option: &'static str,
    value: f64,
    holds: bool,
    expected: &'static str,
) -> Result<(), ControlError> {
    if holds { Ok(()) } else { Err(ControlError::OutOfRange { option, value, expected }) }
}

/// Checks a measured time.
pub(super) fn check_time(seconds: f64) -> Result<(), ControlError> {
    if seconds > 0.0 && seconds.is_finite() { Ok(()) } else { Err(ControlError::Time { seconds }) }
}
