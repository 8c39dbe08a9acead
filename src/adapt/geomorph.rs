//! How long vertices take from where they are to where they belong.

use crate::view::Motion;

/// A transition takes some time before a still eye, and less before one that moves or turns, where one looks less closely and the
/// level of detail must keep up.
///
/// In each frame every vertex that moves goes on by this share of its way, to 1 at most:
///
/// ```text
///     elapsed / duration  +  distance the eye moved / (travel x diagonal of the object)  +  angle it turned / turn
/// ```
///
/// Where that is 1, or the duration not above 0, all is immediate.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Geomorph {
    /// Seconds before a still eye; default 0.5.
    pub duration: f32,
    /// Diagonals of the object on which the eye may move meanwhile; default 0.5.
    pub travel: f32,
    /// Radians by which it may turn meanwhile; default 1.
    pub turn: f32,
}

impl Default for Geomorph {
    fn default() -> Self {
        Self { duration: 0.5, travel: 0.5, turn: 1.0 }
    }
}

impl Geomorph {
    /// With this duration before a still eye, seconds.
    #[must_use]
    pub fn with_duration(mut self, seconds: f32) -> Self {
        self.duration = seconds;
        self
    }

    /// With this duration in frames of a sixtieth of a second.
    #[must_use]
    pub fn with_frames(self, frames: f32) -> Self {
        self.with_duration(frames / 60.0)
    }

    /// Ending by the time the eye has moved so many diagonals of the object; `f32::INFINITY` where that is not to count.
    #[must_use]
    pub fn with_travel(mut self, diagonals: f32) -> Self {
        self.travel = diagonals;
        self
    }

    /// Ending by the time the eye has turned by so many radians; `f32::INFINITY` where that is not to count.
    #[must_use]
    pub fn with_turn(mut self, radians: f32) -> Self {
        self.turn = radians;
        self
    }

    /// The share of its way that a vertex goes in a frame of so many seconds. A motion that is not known does not count.
    pub fn progress(&self, seconds: f32, motion: Motion, diagonal: f64) -> f32 {
        let share = |part: f64, whole: f64| {
            // Without any way to go, one is there at once.
            let share = if whole > 0.0 { part.max(0.0) / whole } else { f64::INFINITY };
            if share.is_nan() { 0.0 } else { share }
        };
        let mut progress = share(f64::from(seconds), f64::from(self.duration));
        if let Motion::Moved { distance, angle } = motion {
            if distance > 0.0 {
                progress += share(distance, f64::from(self.travel) * diagonal);
            }
            if angle > 0.0 {
                progress += share(angle, f64::from(self.turn));
            }
        }
        progress.min(1.0) as f32
    }
}
