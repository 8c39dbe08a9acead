//! A factor for all tolerances that may turn every frame, without all answers being asked for again.
//!
//! ```text
//!     error x reach    ----o--o---|--o-(--o-|-o--)-o---|---o-->    within ( ): answered for the factor alone, asked again
//!                        not needed         factor   needed        whenever it turns; beyond: answered for all factors
//!                                                                  from one end of the band to the other, and asleep
//! ```
//!
//! Whether a refinement is needed falls with the factor. So where it is needed at the upper end of a band of factors, or not
//! needed at the lower end, that holds for all of them.

use crate::view::{Answer, Criterion, Motion};

/// By how much the factor may turn, up or down, until all answers are asked for again.
const BAND: f64 = 1.05;

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Tolerance {
    factor: f32,
    /// The factor that answers were last given for.
    answered: f32,
    /// The middle of the band that answers hold for; not a number where there is none.
    middle: f64,
    /// Whether it was ever turned.
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

    /// Turns it; numbers that are not above 0, or endless, are ignored.
    pub fn set(&mut self, factor: f32) {
        if factor > 0.0 && factor.is_finite() {
            self.turns |= factor != self.factor;
            self.factor = factor;
        }
    }

    /// Whether it was never turned: criteria may be asked as they are.
    pub fn is_one(&self) -> bool {
        !self.turns
    }

    /// A criterion with its tolerances multiplied, and what has happened to it where `motion` has happened to the criterion.
    pub fn scale<'a, C: ?Sized>(&mut self, criterion: &'a C, motion: Motion) -> (Scaled<'a, C>, Motion) {
        let factor = f64::from(self.factor);
        let turned = self.factor != self.answered;
        let motion = match motion {
            Motion::Moved { distance, angle } if self.holds(factor) => {
                // Any distance wakes those who cannot sleep at all.
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

/// A criterion with its tolerances multiplied by a factor. Answers hold for a band of factors.
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
