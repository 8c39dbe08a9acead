//! From measured times to a number of triangles.
//!
//! ```text
//!     seconds, triangles --> seconds per triangle --> median of 5 --> rises at once, --> triangles = aim / seconds
//!     of a frame                                      (spikes)        falls slowly                   per triangle
//!        |
//!        +--> left out: pauses, and frames with too few triangles to tell
//! ```

use super::error::{ControlError, check, check_time};
use super::estimate::Estimate;

/// Largest window of the median.
const WIDEST: usize = 15;
/// Frames with less than this share of the target say little of the time of a triangle.
const FEW: f64 = 0.25;
/// Least share of a frame's time counted for triangles.
const LEAST: f64 = 0.01;

/// Options of [`FrameTime`]. Defaults: 16.7 ms, loads of 0.7 to 1 accepted and 0.85 aimed at, a median of 5, pauses from 0.5 s.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct FrameTimeOptions {
    /// Time for a frame, seconds, above 0. Default 1/60.
    pub seconds: f64,
    /// Time of a frame that triangles do not change, seconds, at least 0 and below `seconds`. Default 0: part of the time per
    /// triangle, and found by approximation.
    pub fixed: f64,
    /// Expected load (time over `seconds`) below and above which the target changes, and the load that a change aims at:
    /// `0 < min < aim < max`, finite. Default `[0.7, 0.85, 1.0]`.
    pub loads: [f64; 3],
    /// Number of frames in the median: odd, 1 to 15. A spike of fewer than half of them changes nothing; a lasting change is
    /// seen after half of them. Default 5.
    pub window: usize,
    /// Share of the way, in logarithms, that the time per triangle goes when it falls; above 0, at most 1. Rises are taken at
    /// once. Default 0.25.
    pub smoothing: f64,
    /// Time from which on a frame counts as a pause, seconds, above `seconds`: a debugger, a window being dragged. Pauses are left
    /// out, unless as many as the window come one after another. Default 0.5.
    pub pause: f64,
    /// Largest factor by which a frame raises the target, above 1. Default 1.1.
    pub growth: f64,
    /// Least and most triangles of the target: `1 <= least <= most`. Frames with fewer triangles than the least are left out: a
    /// load screen. Default `[10_000, 100_000_000]`.
    pub triangles: [usize; 2],
}

impl Default for FrameTimeOptions {
    fn default() -> Self {
        Self {
            seconds: 1.0 / 60.0,
            fixed: 0.0,
            loads: [0.7, 0.85, 1.0],
            window: 5,
            smoothing: 0.25,
            pause: 0.5,
            growth: 1.1,
            triangles: [10_000, 100_000_000],
        }
    }
}

impl FrameTimeOptions {
    /// Sets the time for a frame, seconds.
    #[must_use]
    pub fn with_seconds(mut self, seconds: f64) -> Self {
        self.seconds = seconds;
        self
    }

    /// Sets the time that triangles do not change, seconds.
    #[must_use]
    pub fn with_fixed(mut self, seconds: f64) -> Self {
        self.fixed = seconds;
        self
    }

    /// Sets the loads between which the target stays, and the load aimed at.
    #[must_use]
    pub fn with_loads(mut self, min: f64, aim: f64, max: f64) -> Self {
        self.loads = [min, aim, max];
        self
    }

    /// Sets the number of frames in the median.
    #[must_use]
    pub fn with_window(mut self, frames: usize) -> Self {
        self.window = frames;
        self
    }

    /// Sets the share of the way that a falling time per triangle goes.
    #[must_use]
    pub fn with_smoothing(mut self, share: f64) -> Self {
        self.smoothing = share;
        self
    }

    /// Sets the time from which on a frame counts as a pause, seconds.
    #[must_use]
    pub fn with_pause(mut self, seconds: f64) -> Self {
        self.pause = seconds;
        self
    }

    /// Sets the largest factor by which a frame raises the target.
    #[must_use]
    pub fn with_growth(mut self, factor: f64) -> Self {
        self.growth = factor;
        self
    }

    /// Sets the least and the most triangles of the target.
    #[must_use]
    pub fn with_triangles(mut self, least: usize, most: usize) -> Self {
        self.triangles = [least, most];
        self
    }

    fn check(&self) -> Result<(), ControlError> {
        let Self { seconds, fixed, loads: [min, aim, max], window, smoothing, pause, growth, .. } = *self;
        check("seconds", seconds, seconds > 0.0 && seconds.is_finite(), "above 0 and finite")?;
        check("fixed", fixed, fixed >= 0.0 && fixed < seconds, "at least 0 and below the time for a frame")?;
        check("the lower load", min, min > 0.0, "above 0")?;
        check("the load aimed at", aim, aim > min, "above the lower load")?;
        check("the upper load", max, max > aim && max.is_finite(), "above the load aimed at and finite")?;
        let odd = window % 2 == 1 && window <= WIDEST;
        check("window", window as f64, odd, "odd, 1 to 15")?;
        check("smoothing", smoothing, smoothing > 0.0 && smoothing <= 1.0, "above 0 and at most 1")?;
        check("pause", pause, pause > seconds, "above the time for a frame")?;
        check("growth", growth, growth > 1.0 && growth.is_finite(), "above 1 and finite")?;
        let [least, most] = self.triangles;
        check("the least triangles", least as f64, least >= 1, "at least 1")?;
        check("the most triangles", most as f64, most >= least, "at least the least triangles")
    }
}

/// Measurement of a frame, for [`FrameTime::update`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Time the frame took, of the graphics card or of the processor, seconds.
    pub seconds: f64,
    /// Triangles drawn in that frame. If times come some frames late, the triangles of the frame that was measured.
    pub triangles: usize,
}

/// Holds a frame time by a target of triangles.
///
/// The time per triangle is the median of the last frames (spikes go), then a filter that rises at once and falls exponentially.
/// The target changes only where it is expected to lead out of the accepted loads, so a steady scene has a steady target. Late
/// times do no harm: a frame is judged by its own triangles.
///
/// ```
/// use multires::control::{FrameTime, FrameTimeOptions, Sample};
///
/// let mut time = FrameTime::new(FrameTimeOptions::default(), 100_000)?; // 16.7 ms
/// for _ in 0..60 {
///     let drawn = time.triangles(); // to a Budget, a Bias or a SceneBudget
///     time.update(Sample { seconds: 2e-8 * drawn as f64, triangles: drawn })?;
/// }
/// let load = 2e-8 * time.triangles() as f64 * 60.0;
/// assert!((0.7..=1.0).contains(&load));
/// # Ok::<(), multires::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct FrameTime {
    options: FrameTimeOptions,
    target: usize,
    /// Last seconds per triangle: a ring.
    last: [f64; WIDEST],
    held: usize,
    next: usize,
    /// Filtered seconds per triangle; 0 at first.
    cost: f64,
    pauses: usize,
    load: f64,
}

impl FrameTime {
    /// Creates a controller with a first target, moved into the range of the options.
    ///
    /// # Errors
    /// An option is out of its range.
    pub fn new(options: FrameTimeOptions, triangles: usize) -> Result<Self, ControlError> {
        options.check()?;
        let [least, most] = options.triangles;
        Ok(Self {
            options,
            target: triangles.clamp(least, most),
            last: [0.0; WIDEST],
            held: 0,
            next: 0,
            cost: 0.0,
            pauses: 0,
            load: 0.0,
        })
    }

    /// Returns the options.
    pub fn options(&self) -> &FrameTimeOptions {
        &self.options
    }

    /// Sets the options. The filter begins anew; the target moves into the new range.
    ///
    /// # Errors
    /// An option is out of its range. Nothing has changed then.
    pub fn set_options(&mut self, options: FrameTimeOptions) -> Result<(), ControlError> {
        *self = Self::new(options, self.target)?;
        Ok(())
    }

    /// Takes in a measured frame. Returns the new target of triangles.
    ///
    /// # Errors
    /// The time is not above 0, or not finite. Nothing has changed then.
    pub fn update(&mut self, sample: Sample) -> Result<usize, ControlError> {
        check_time(sample.seconds)?;
        let FrameTimeOptions { seconds, fixed, loads: [min, aim, max], window, smoothing, .. } = self.options;
        self.load = sample.seconds / seconds;
        if sample.seconds >= self.options.pause {
            self.pauses += 1;
            if self.pauses < window {
                return Ok(self.target);
            }
        } else {
            self.pauses = 0;
        }
        let [least, most] = self.options.triangles;
        let few = (sample.triangles as f64) < FEW * self.target as f64 && self.load <= max;
        if sample.triangles < least || few {
            return Ok(self.target);
        }
        let used = (sample.seconds - fixed).max(LEAST * sample.seconds);
        self.last[self.next % window] = used / sample.triangles as f64;
        self.next = (self.next + 1) % window;
        self.held = (self.held + 1).min(window);
        let median = self.median();
        self.cost = if self.cost > 0.0 && median < self.cost {
            self.cost * (median / self.cost).powf(smoothing)
        } else {
            median
        };
        let expected = (fixed + self.cost * self.target as f64) / seconds;
        if !(min..=max).contains(&expected) {
            let target = (aim * seconds - fixed).max(0.0) / self.cost;
            let target = target.min(self.target as f64 * self.options.growth);
            self.target = (target as usize).clamp(least, most);
        }
        Ok(self.target)
    }

    fn median(&self) -> f64 {
        let mut sorted = self.last;
        let sorted = &mut sorted[..self.held];
        sorted.sort_unstable_by(f64::total_cmp);
        sorted[self.held / 2]
    }

    /// Returns the target of triangles.
    pub fn triangles(&self) -> usize {
        self.target
    }

    /// Returns the filtered time per triangle, seconds; 0 at first.
    pub fn seconds_per_triangle(&self) -> f64 {
        self.cost
    }

    /// Returns the load of the last measured frame, unfiltered: its time over the time for a frame; 0 at first.
    pub fn load(&self) -> f64 {
        self.load
    }

    /// Returns the factor for [`Lod::set_tolerance_factor`](crate::Lod::set_tolerance_factor) at which the target is expected:
    /// 1 where it is not exceeded, at most the largest finite number.
    pub fn tolerance_factor(&self, scene: &Estimate) -> f32 {
        scene.factor_for(self.target).min(f32::MAX)
    }
}
