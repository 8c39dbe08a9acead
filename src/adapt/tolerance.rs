//! A factor of all tolerances, which may change every frame without retesting all refinements.
//!
//! ```text
//!     needed        not needed
//!     ----o--o---|---o-----o---->  factor at which a refinement stops being needed
//!              factor
//!                |<->| asleep until the factor has turned this far, the eye has moved or turned as far in its measure, or
//!                      parts of both
//! ```
//!
//! A refinement is needed below some factor of its own. How far the factor may turn until the answer changes is one more slack
//! of the answer, beside distance and angle: `|ln(factor / factor before)|` is added to the angle turned by the eye, so a
//! turning factor wakes only refinements whose answers may change.

use crate::view::{Answer, Criterion, Factors, Motion};

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Tolerance {
    factor: f32,
    /// Factor at the last update; `None` before the first update with a factor.
    answered: Option<f64>,
    /// Whether the factor was ever set. Whoever sets it will turn it: answers are given for that from the first time on, so the
    /// first turn does not ask all anew.
    turns: bool,
}

impl Default for Tolerance {
    fn default() -> Self {
        Self { factor: 1.0, answered: None, turns: false }
    }
}

impl Tolerance {
    pub fn factor(&self) -> f32 {
        self.factor
    }

    /// Sets the factor. Ignores factors which are not positive and finite.
    pub fn set(&mut self, factor: f32) {
        if factor > 0.0 && factor.is_finite() {
            self.turns = true;
            self.factor = factor;
        }
    }

    /// Whether the factor was never set. Then criteria may be used without scaling.
    pub fn is_one(&self) -> bool {
        !self.turns
    }

    /// Returns the criterion with its tolerances multiplied, and the motion of the scaled criterion. `motion` is the
    /// motion of the unscaled criterion.
    pub fn scale<'a, C: ?Sized>(&mut self, criterion: &'a C, motion: Motion) -> (Scaled<'a, C>, Motion) {
        let factor = f64::from(self.factor);
        let before = self.answered.replace(factor);
        let motion = match (motion, before) {
            (Motion::Moved { distance, angle }, Some(before)) => {
                Motion::Moved { distance, angle: angle + (factor / before).ln().abs() }
            }
            // Answers without a factor do not say how far the factor may turn.
            _ => Motion::Other,
        };
        (Scaled { criterion, factor }, motion)
    }
}

/// A criterion with its tolerances multiplied by a factor.
pub(crate) struct Scaled<'a, C: ?Sized> {
    criterion: &'a C,
    factor: f64,
}

impl<B, C: Criterion<B> + ?Sized> Criterion<B> for Scaled<'_, C> {
    fn test(&self, bounds: &B) -> Answer {
        self.test_at(bounds, 1.0)
    }

    fn test_at(&self, bounds: &B, factor: f64) -> Answer {
        self.criterion.test_turning(bounds, self.factor, factor)
    }

    fn test_each(&self, bounds: &[B], factors: Factors, answers: &mut [Answer]) {
        self.criterion.test_each(bounds, Factors { turning: Some(self.factor), ..factors }, answers);
    }

    fn motion(&self, _: &Self) -> Motion {
        Motion::Other
    }

    fn urgency(&self, bounds: &B) -> f64 {
        self.criterion.urgency_scaled(bounds, self.factor)
    }

    fn sees(&self, bounds: &B) -> bool {
        self.criterion.sees(bounds)
    }
}
