//! Load and stress: a frame that takes too long coarsens the next frame.
//!
//! ```text
//!     load      0 ------------ min ------------- max ------------------->
//!     stress       x (1 - a)    |     stays       |   x (1 + a), or more where the load is far too high
//!                  (unless all  |                 |   (unless all that is visible
//!                  is at full)  |                 |   is at its coarsest)
//! ```

use super::error::{ControlError, check, check_time};

/// Options of [`Stress`]. Defaults: 16.7 ms, band 0.5 to 1, alpha 0.4, at most 4 times the stress a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct StressOptions {
    /// Time expected for a frame, seconds, above 0. Default 1/60.
    pub seconds: f64,
    /// Load below which stress falls and load above which stress rises: `0 < min < max`. The ratio `max / min` must be at
    /// least `1 / (1 - alpha)` and `1 + alpha`: otherwise a step leads out of the band on the other side, and stress never
    /// rests. Default `[0.5, 1]`.
    pub band: [f64; 2],
    /// Share of the stress by which a frame changes it, above 0 and below 1. Default 0.4.
    pub alpha: f64,
    /// Largest factor by which a frame raises the stress, at least 1. A load far above the band raises the stress by
    /// `load / middle of the band` up to this factor, or by `1 + alpha` if that is more. 1 is the paper: always `1 + alpha`.
    /// Default 4.
    pub leap: f64,
    /// Smallest and largest stress: `0 < least <= greatest`, both finite. Default `[1/1024, 1024]`.
    pub range: [f64; 2],
}

impl Default for StressOptions {
    fn default() -> Self {
        Self { seconds: 1.0 / 60.0, band: [0.5, 1.0], alpha: 0.4, leap: 4.0, range: [1.0 / 1024.0, 1024.0] }
    }
}

impl StressOptions {
    /// Returns the options of Bouvier and Gobbetti, Fig. 9: 100 ms, band 0.5 to 1, alpha 0.4, no leaps.
    pub fn paper() -> Self {
        Self { seconds: 0.1, leap: 1.0, ..Self::default() }
    }

    /// Returns options for [`Stress::tolerance_factor`]: stress at least 1, so no tolerance is finer than asked for, and a load
    /// that stays low winds up nothing.
    pub fn for_tolerances() -> Self {
        Self { range: [1.0, 1024.0], ..Self::default() }
    }

    /// Sets the time expected for a frame, seconds.
    #[must_use]
    pub fn with_seconds(mut self, seconds: f64) -> Self {
        self.seconds = seconds;
        self
    }

    /// Sets the loads between which stress stays.
    #[must_use]
    pub fn with_band(mut self, min: f64, max: f64) -> Self {
        self.band = [min, max];
        self
    }

    /// Sets the share by which a frame changes the stress.
    #[must_use]
    pub fn with_alpha(mut self, alpha: f64) -> Self {
        self.alpha = alpha;
        self
    }

    /// Sets the largest factor by which a frame raises the stress.
    #[must_use]
    pub fn with_leap(mut self, leap: f64) -> Self {
        self.leap = leap;
        self
    }

    /// Sets the smallest and the largest stress.
    #[must_use]
    pub fn with_range(mut self, least: f64, greatest: f64) -> Self {
        self.range = [least, greatest];
        self
    }

    fn check(&self) -> Result<(), ControlError> {
        let Self { seconds, band: [min, max], alpha, leap, range: [least, greatest] } = *self;
        let finite = |value: f64| value > 0.0 && value.is_finite();
        check("seconds", seconds, finite(seconds), "above 0 and finite")?;
        check("alpha", alpha, alpha > 0.0 && alpha < 1.0, "above 0 and below 1")?;
        check("the lower load", min, finite(min), "above 0 and finite")?;
        check("the upper load", max, finite(max) && max > min, "above the lower load and finite")?;
        let widest = (1.0 / (1.0 - alpha)).max(1.0 + alpha);
        let ratio = max / min * (1.0 + 1e-9);
        check("upper over lower load", max / min, ratio >= widest, "at least 1 / (1 - alpha) and 1 + alpha")?;
        check("leap", leap, leap >= 1.0 && leap.is_finite(), "at least 1 and finite")?;
        check("the least stress", least, finite(least), "above 0 and finite")?;
        let ordered = greatest >= least && greatest.is_finite();
        check("the greatest stress", greatest, ordered, "at least the least stress and finite")
    }
}

/// Measurement of a frame, for [`Stress::update`]. Default: nothing visible.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct StressFrame {
    /// Time the frame took, seconds, above 0.
    pub seconds: f64,
    /// Number of visible objects. 0: the frame says nothing, and is ignored.
    pub visible: usize,
    /// Visible objects drawn at full resolution.
    pub at_full: usize,
    /// Visible objects drawn at their coarsest.
    pub at_base: usize,
}

impl StressFrame {
    /// Creates a measurement with `visible` objects, none of which is at an end of its range.
    pub fn new(seconds: f64, visible: usize) -> Self {
        Self { seconds, visible, ..Self::default() }
    }

    /// Sets the numbers of visible objects at full resolution and at their coarsest.
    #[must_use]
    pub fn with_ends(mut self, at_full: usize, at_base: usize) -> Self {
        self.at_full = at_full;
        self.at_base = at_base;
        self
    }
}

/// Feedback from the time of a frame to the resolution of the next frame.
///
/// `load = seconds / expected seconds`. Stress starts at 1. A load below the band multiplies the stress by `1 - alpha`, a load
/// above by `1 + alpha` (Bouvier and Gobbetti, section 4.4). Four additions to the paper:
///
/// - While all that is visible is at full resolution, stress does not fall; while all is at its coarsest, it does not rise.
///   Otherwise 20 idle frames wind the stress down to 4e-5, and the next 20 frames are overloaded.
/// - Frames without a visible object are ignored.
/// - Times not above 0, or not finite, are refused.
/// - A load far above the band raises the stress by more ([`StressOptions::leap`]).
///
/// Measured times belong to the stress of their frame. If times come late, as times of graphics cards do, leaps repeat: use
/// [`FrameTime`](super::FrameTime), or `leap` 1.
///
/// ```
/// use multires::control::{Stress, StressFrame, StressOptions};
///
/// let mut stress = Stress::new(StressOptions::paper())?; // 100 ms
/// stress.update(StressFrame::new(0.120, 40))?; // load 1.2
/// assert_eq!((stress.load(), stress.stress()), (1.2, 1.4));
/// let triangles = stress.triangles(0.7, [200, 10_200]); // an object that covers 0.7 of the screen
/// assert_eq!(triangles, 5_200);
/// # Ok::<(), multires::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Stress {
    options: StressOptions,
    stress: f64,
    load: f64,
}

impl Stress {
    /// Creates a controller with stress 1, or the value of the range nearest to 1.
    ///
    /// # Errors
    /// An option is out of its range.
    pub fn new(options: StressOptions) -> Result<Self, ControlError> {
        options.check()?;
        let [least, greatest] = options.range;
        Ok(Self { options, stress: 1_f64.clamp(least, greatest), load: 0.0 })
    }

    /// Returns the options.
    pub fn options(&self) -> &StressOptions {
        &self.options
    }

    /// Sets the options. Stress moves into the new range.
    ///
    /// # Errors
    /// An option is out of its range. Nothing has changed then.
    pub fn set_options(&mut self, options: StressOptions) -> Result<(), ControlError> {
        options.check()?;
        self.options = options;
        self.stress = self.stress.clamp(options.range[0], options.range[1]);
        Ok(())
    }

    /// Takes in a measured frame. Returns the new stress.
    ///
    /// # Errors
    /// The time is not above 0 or not finite, while objects are visible. Nothing has changed then.
    pub fn update(&mut self, frame: StressFrame) -> Result<f64, ControlError> {
        if frame.visible == 0 {
            return Ok(self.stress);
        }
        check_time(frame.seconds)?;
        let StressOptions { seconds, band: [min, max], alpha, leap, range: [least, greatest] } = self.options;
        self.load = frame.seconds / seconds;
        let factor = if self.load < min && frame.at_full < frame.visible {
            1.0 - alpha
        } else if self.load > max && frame.at_base < frame.visible {
            (1.0 + alpha).max((self.load / (0.5 * (min + max))).min(leap))
        } else {
            1.0
        };
        self.stress = (self.stress * factor).clamp(least, greatest);
        Ok(self.stress)
    }

    /// Returns the stress: 1 at first; higher is coarser.
    pub fn stress(&self) -> f64 {
        self.stress
    }

    /// Returns the load of the last measured frame: its seconds over the expected seconds; 0 at first.
    pub fn load(&self) -> f64 {
        self.load
    }

    /// Returns the resolution of an object as a share of its range: `coverage / stress`, within 0 (coarsest) to 1 (full).
    /// `coverage` is the share of the screen covered by the object's bounding box, 0 to 1; NaN is 0.
    pub fn resolution(&self, coverage: f64) -> f64 {
        let resolution = coverage / self.stress;
        if resolution > 0.0 { resolution.min(1.0) } else { 0.0 }
    }

    /// Returns the triangles of an object with `[coarsest, full]` triangles: linear in [`resolution`](Self::resolution).
    pub fn triangles(&self, coverage: f64, [coarsest, full]: [usize; 2]) -> usize {
        let range = full.saturating_sub(coarsest);
        coarsest + ((range as f64 * self.resolution(coverage)) as usize).min(range)
    }

    /// Returns the factor for [`Lod::set_tolerance_factor`](crate::Lod::set_tolerance_factor): the stress. Triangles of an
    /// instance fall about as the reciprocal of the tolerance, so as resolution falls with stress. Use
    /// [`StressOptions::for_tolerances`].
    pub fn tolerance_factor(&self) -> f32 {
        self.stress.clamp(f64::from(f32::MIN_POSITIVE), f64::from(f32::MAX)) as f32
    }
}
