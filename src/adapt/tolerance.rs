//! A factor of all tolerances, which may change every frame without retesting all refinements.
//!
//! ```text
//!     error x reach    ----o--o---|--o-(--o-|-o--)-o---|---o-->    within ( ): answered for the factor alone, asked again
//!                        not needed         factor   needed        whenever it turns; beyond: answered for all factors
//!                                                                  from one end of the band to the other, and asleep
//! ```
//!
//! If a refinement is needed at some factor, it is needed at every smaller factor. So if it is needed at the upper end of
//! a band of factors, or not needed at the lower end, the answer holds for the whole band.

use crate::view::{Answer, Criterion, Motion};

/// Ratio of the factor to the middle of the band, up or down, beyond which all refinements are tested again.
const BAND: f64 = 1.05;

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Tolerance {
    factor: f32,
    /// Factor at the last update.
    answered: f32,
    /// Middle of the band of factors for which answers hold; NaN if there are no answers.
    middle: f64,
    /// Whether the factor was ever changed.
    turns: bool,
}

impl Default for Tolerance {
    fn default() -> Self {
        Self { factor: 1.0, answered: 1.0, middle: f64::NAN, turns: false }
    }
}

impl Tolerance {
    pub fn factor(&self) -> f32 {
        self.factor
    }

    /// Sets the factor. Ignores factors which are not positive and finite.
    pub fn set(&mut self, factor: f32) {
        if factor > 0.0 && factor.is_finite() {
            self.turns |= factor != self.factor;
            self.factor = factor;
        }
    }

    /// Whether the factor was never changed. Then criteria may be used without scaling.
    pub fn is_one(&self) -> bool {
        !self.turns
    }

    /// Returns the criterion with its tolerances multiplied, and the motion of the scaled criterion. `motion` is the
    /// motion of the unscaled criterion.
    pub fn scale<'a, C: ?Sized>(&mut self, criterion: &'a C, motion: Motion) -> (Scaled<'a, C>, Motion) {
        let factor = f64::from(self.factor);
        let turned = self.factor != self.answered;
        let motion = match motion {
            Motion::Moved { distance, angle } if self.holds(factor) => {
                // Any distance above 0 wakes sleepers without slack.
                let least = if turned { f64::MIN_POSITIVE } else { 0.0 };
                Motion::Moved { distance: distance.max(least), angle }
            }
            _ => {
                self.middle = factor;
                Motion::Other
            }
        };
        self.answered = self.factor;
        let ends = [self.middle / BAND, self.middle * BAND];
        (Scaled { criterion, factor, ends }, motion)
    }

    fn holds(&self, factor: f64) -> bool {
        (self.middle / BAND..=self.middle * BAND).contains(&factor)
    }
}

/// A criterion with its tolerances multiplied by a factor. Its answers hold for a band of factors.
pub(crate) struct Scaled<'a, C: ?Sized> {
    criterion: &'a C,
    factor: f64,
    ends: [f64; 2],
}

impl<B, C: Criterion<B> + ?Sized> Criterion<B> for Scaled<'_, C> {
    fn test(&self, bounds: &B) -> Answer {
        self.test_at(bounds, 1.0)
    }

    fn test_at(&self, bounds: &B, factor: f64) -> Answer {
        let [low, high] = self.ends.map(|end| self.criterion.test_scaled(bounds, end, factor));
        match (low.refine, high.refine) {
            (true, true) => low.and(high),
            (false, false) => low.or(high),
            _ => Answer::once(self.criterion.test_scaled(bounds, self.factor, factor).refine),
        }
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
