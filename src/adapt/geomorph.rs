//! Duration of vertex transitions.

use crate::view::Motion;

/// Duration of transitions of moving vertices. A transition is shorter if the eye moves or turns: details are seen less,
/// and the level of detail must keep up.
///
/// In each frame every moving vertex advances by this share of its way, at most 1:
///
/// ```text
///     elapsed / duration  +  distance the eye moved / (travel x diagonal of the object)  +  angle it turned / turn
/// ```
///
/// If the share is 1, or if `duration <= 0`, changes are immediate.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Geomorph {
    /// Duration with a still eye, seconds; default 0.5.
    pub duration: f32,
    /// Distance of the eye's motion which completes a transition, in diagonals of the object; default 0.5.
    pub travel: f32,
    /// Angle of the eye's turn which completes a transition, radians; default 1.
    pub turn: f32,
}

impl Default for Geomorph {
    fn default() -> Self {
        Self { duration: 0.5, travel: 0.5, turn: 1.0 }
    }
}

impl Geomorph {
    /// Sets the duration with a still eye, seconds.
    #[must_use]
    pub fn with_duration(mut self, seconds: f32) -> Self {
        self.duration = seconds;
        self
    }

    /// Sets the duration with a still eye, in frames of 1/60 s.
    #[must_use]
    pub fn with_frames(self, frames: f32) -> Self {
        self.with_duration(frames / 60.0)
    }

    /// Sets the eye's motion which completes a transition, in diagonals of the object. `f32::INFINITY`: motion has no
    /// effect.
    #[must_use]
    pub fn with_travel(mut self, diagonals: f32) -> Self {
        self.travel = diagonals;
        self
    }

    /// Sets the eye's turn which completes a transition, radians. `f32::INFINITY`: turning has no effect.
    #[must_use]
    pub fn with_turn(mut self, radians: f32) -> Self {
        self.turn = radians;
        self
    }

    /// Returns the share of its way by which a vertex advances in a frame of `seconds`. [`Motion::Other`] adds nothing.
    pub fn progress(&self, seconds: f32, motion: Motion, diagonal: f64) -> f32 {
        let share = |part: f64, whole: f64| {
            // A transition of length 0 is completed at once.
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
