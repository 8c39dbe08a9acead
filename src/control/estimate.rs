//! Triangles of a view-dependent structure as a power of the factor of its tolerances, fitted to what was drawn last.

use super::ControlError;
use super::ladder::Ladder;

/// Exponents taken for possible.
const EXPONENTS: [f64; 2] = [0.25, 2.5];
/// Weight of a new exponent.
const NEW: f64 = 0.25;
/// Least ratio of two factors that tells an exponent.
const APART: f64 = 1.02;
/// Levels written to a ladder, two an octave of factors.
const LEVELS: usize = 13;

/// An estimate of the triangles that an instance, or a scene of instances, draws at another factor of tolerances:
///
/// ```text
///     triangles(factor) = coarsest + (drawn - coarsest) * (factor / drawn at factor) ^ -exponent
/// ```
///
/// The exponent is 1 at first: a smooth surface of n triangles has an error of about 1/n. It is learned from two factors in a
/// single view ([`observe_again`](Self::observe_again)); the rest follows the last drawn frame.
///
/// ```
/// use multires::control::Estimate;
///
/// let mut terrain = Estimate::new(200);
/// terrain.observe(1.0, 80_200);
/// assert!((terrain.factor_for(40_200) - 2.0).abs() < 1e-6);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    coarsest: f64,
    exponent: f64,
    /// Factor and triangles beyond the coarsest, last drawn.
    factor: f64,
    drawn: f64,
}

impl Estimate {
    /// Creates an estimate for an instance with so many triangles at its coarsest, where nothing was drawn yet.
    pub fn new(coarsest: usize) -> Self {
        Self { coarsest: coarsest as f64, exponent: 1.0, factor: 1.0, drawn: 0.0 }
    }

    /// Takes in a drawn frame: the factor of tolerances, and the triangles. A factor not above 0, or not finite, is ignored.
    pub fn observe(&mut self, factor: f32, triangles: usize) {
        if factor > 0.0 && factor.is_finite() {
            self.factor = f64::from(factor);
            self.drawn = (triangles as f64 - self.coarsest).max(0.0);
        }
    }

    /// Takes in a second frame of the same view, at another factor: learns the exponent, too, from a factor at least 2 % off.
    pub fn observe_again(&mut self, factor: f32, triangles: usize) {
        let [before, drawn] = [self.factor, self.drawn];
        self.observe(factor, triangles);
        let ratio = self.factor / before;
        if drawn > 0.0 && self.drawn > 0.0 && ratio.max(1.0 / ratio) >= APART {
            let exponent = -(self.drawn / drawn).ln() / ratio.ln();
            let exponent = exponent.clamp(EXPONENTS[0], EXPONENTS[1]);
            self.exponent += NEW * (exponent - self.exponent);
        }
    }

    /// Returns the exponent.
    pub fn exponent(&self) -> f64 {
        self.exponent
    }

    /// Returns the triangles expected at a factor. Those of the coarsest for a factor that is not above 0 or not finite.
    pub fn triangles_at(&self, factor: f32) -> f64 {
        let ratio = f64::from(factor) / self.factor;
        let share = if ratio > 0.0 && ratio.is_finite() { ratio.powf(-self.exponent) } else { 0.0 };
        (self.coarsest + self.drawn * share).min(f64::from(u32::MAX))
    }

    /// Returns the smallest factor, at least 1, at which no more than `triangles` are expected. Infinite if the coarsest has no
    /// fewer.
    pub fn factor_for(&self, triangles: usize) -> f32 {
        let room = triangles as f64 - self.coarsest;
        if self.drawn <= 0.0 {
            return 1.0;
        }
        if room <= 0.0 {
            return f32::INFINITY;
        }
        (self.factor * (self.drawn / room).powf(1.0 / self.exponent)).max(1.0) as f32
    }

    /// Returns the factor of a level written by [`write`](Self::write): `2 ^ (level / 2)`.
    pub fn factor_of(level: u32) -> f32 {
        (0.5 * level as f32).exp2()
    }

    /// Writes 13 levels at factors of 1 to 64 into a ladder, for a [`Budget`](super::Budget) that splits triangles between this
    /// instance and objects with levels of their own. Errors are in pixels: `tolerance_px * factor`, so the
    /// [`LadderObject`](super::LadderObject) has `pixels` 1. Set the factor of the chosen level
    /// ([`factor_of`](Self::factor_of)) by [`Lod::set_tolerance_factor`](crate::Lod::set_tolerance_factor).
    ///
    /// # Errors
    /// The tolerance is negative or not finite. The ladder has not changed then.
    pub fn write(&self, tolerance_px: f32, ladder: &mut Ladder) -> Result<(), ControlError> {
        let levels: [(usize, f32); LEVELS] = std::array::from_fn(|level| {
            let factor = Self::factor_of(level as u32);
            (self.triangles_at(factor).ceil() as usize, tolerance_px * factor)
        });
        ladder.set(&levels)
    }
}
