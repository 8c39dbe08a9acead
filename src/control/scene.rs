//! One number of triangles for many instances, by the factors of their tolerances.
//!
//! ```text
//!     triangles    0 ------------- 93 % ------------- 99 % ----- budget ------>
//!     factor       falls, in steps,  |      stays       |  rises    |  rises, and the frame is adapted again
//!                  to 96.5 %         |                  |  to 98 %  |  to 96.5 %
//! ```
//!
//! A change of the factor costs in proportion to its step: it wakes refinements whose answers the step may change. Small steps spread
//! that work over frames.
//!
//! Factors, not limits of each instance (`LodOptions::triangles`): an instance that is at its limit weighs refinements against each
//! other, by urgency, all along its cut. A factor only asks the refinements near the tolerance again, and all others sleep on.

use crate::geometry::parallel;
use crate::lod::Lod;
use crate::view::ObjectView;

use super::error::{ControlError, check};
use super::estimate::Estimate;

/// Instances that a core takes at least.
const AT_LEAST: usize = 64;
/// Shares of the budget: below `ROOM`, the factor falls until `AIM` is reached.
const ROOM: f64 = 0.93;
const AIM: f64 = 0.965;
/// Shares of the budget: above `HIGH`, the factor rises until `LEVEL` is reached.
const HIGH: f64 = 0.99;
const LEVEL: f64 = 0.98;
/// Growth of the triangles in a frame by a falling factor, as a share of the budget; half of what is unused, if that is more.
const PACE: f64 = 0.02;
/// Least rise of the factor when there are too many triangles.
const RISE: f32 = 1.01;
/// Most growth of the triangles, from frame to frame, that is provided for.
const GROWTH: f64 = 1.25;
/// Pending operations, per triangle drawn, from which on the factor does not fall.
const LAG: f64 = 0.1;
/// Change of the triangles by which a scene counts as another, after the factor could not fall.
const ANOTHER: f64 = 0.01;

/// Options of [`SceneBudget`]. Defaults: 1,000,000 triangles, at most 4 further rounds a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct SceneOptions {
    /// Most triangles of all instances together. Default 1,000,000.
    pub triangles: usize,
    /// Most further rounds of adapting in a frame with too many triangles, before instances are drawn at their coarsest. A round
    /// is quick: eye and objects have not moved. At least 1. Default 4.
    pub rounds: usize,
}

impl Default for SceneOptions {
    fn default() -> Self {
        Self { triangles: 1_000_000, rounds: 4 }
    }
}

impl SceneOptions {
    /// Sets the most triangles of all instances together.
    #[must_use]
    pub fn with_triangles(mut self, most: usize) -> Self {
        self.triangles = most;
        self
    }

    /// Sets the most further rounds of adapting in a frame.
    #[must_use]
    pub fn with_rounds(mut self, most: usize) -> Self {
        self.rounds = most;
        self
    }

    fn check(&self) -> Result<(), ControlError> {
        check("rounds", self.rounds as f64, self.rounds >= 1, "at least 1")
    }
}

/// An instance of a scene, in a frame.
pub struct SceneObject<'a> {
    /// The instance.
    pub lod: &'a mut dyn Lod,
    /// The views of it. None: the instance goes to its coarsest.
    pub views: &'a [ObjectView],
    /// Importance: the instance's factor is `1 + (factor - 1) / importance`. Values not above 0, or not finite, count as 1.
    pub importance: f32,
}

impl<'a> SceneObject<'a> {
    /// Creates an instance of importance 1.
    pub fn new(lod: &'a mut dyn Lod, views: &'a [ObjectView]) -> Self {
        Self { lod, views, importance: 1.0 }
    }

    /// Sets the importance.
    #[must_use]
    pub fn with_importance(mut self, importance: f32) -> Self {
        self.importance = importance;
        self
    }

    /// Adapts at a factor. Returns the triangles drawn, and the operations pending.
    fn adapt(&mut self, factor: f32, seconds: f32) -> [usize; 2] {
        let importance = self.importance;
        let importance = if importance > 0.0 && importance.is_finite() { importance } else { 1.0 };
        self.lod.set_tolerance_factor((1.0 + (factor - 1.0) / importance).min(f32::MAX));
        let change = self.lod.adapt(self.views, seconds);
        [change.triangles, change.pending]
    }

    /// Draws the level asked for, or without views the coarsest, at once. Returns the triangles drawn; nothing is pending.
    fn settle(&mut self, coarsest: bool) -> [usize; 2] {
        if coarsest {
            self.lod.adapt(&[], 0.0);
        }
        self.lod.settle();
        [(0..self.lod.groups()).map(|group| self.lod.triangles(group).len()).sum(), 0]
    }
}

/// Result of [`SceneBudget::adapt`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct SceneReport {
    /// Triangles drawn.
    pub triangles: usize,
    /// Factor of tolerances, of instances of importance 1.
    pub factor: f32,
    /// Further rounds of adapting.
    pub rounds: usize,
    /// Number of instances drawn at their coarsest because nothing else was enough.
    pub coarsest: usize,
    /// Set if the instances' coarsest levels have more triangles than the budget.
    pub over_budget: bool,
}

/// Adapts all instances of a scene within one number of triangles: hierarchies, wavelet meshes, totally ordered meshes, or any
/// [`Lod`].
///
/// All tolerances grow by one factor, so the largest screen error, weighted by importance, is as small as the budget allows.
/// (To make the sum of all errors smallest, across objects with known levels, use [`Budget`](super::Budget).) The factor is never
/// below 1. It rises when triangles exceed 99 % of the budget, or are about to at the rate of the last frame, and falls when they
/// leave more than 7 % of it unused: in steps of 2 % of the budget or half of what is unused a frame, so that no frame pays for all of
/// it, or at once where instances have work pending from frame to frame. A still scene comes to rest.
///
/// Never above the budget after [`adapt`](Self::adapt), unless the coarsest levels are: in a frame with too many triangles the
/// factor rises and all instances adapt again; pending work and geomorphs of such a frame are settled at once. Options of instances
/// are not changed.
///
/// ```
/// use multires::control::{SceneBudget, SceneObject, SceneOptions};
/// use multires::mesh::shapes;
/// use multires::prelude::*;
///
/// let rock = shapes::rock(4_000, 3);
/// let model = VertexHierarchy::bake(&rock)?;
/// let values = model.arrange(rock.positions())?;
/// let mut left = model.instance(values.clone(), &LodOptions::default())?;
/// let mut right = model.instance(values, &LodOptions::default())?;
/// let camera = multires::view::look_at([0.0, 0.5, 3.0], [0.0; 3], [0.0, 1.0, 0.0]);
/// let views = [View::perspective(camera, 1.0, [1920, 1080])?.with_tolerance_px(0.1).of_world()];
///
/// let mut budget = SceneBudget::new(SceneOptions::default().with_triangles(3_000))?;
/// for _ in 0..4 {
///     let mut scene = [SceneObject::new(&mut left, &views), SceneObject::new(&mut right, &views)];
///     let report = budget.adapt(&mut scene, 1.0 / 60.0);
///     assert!(report.triangles <= 3_000);
/// }
/// # Ok::<(), multires::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct SceneBudget {
    options: SceneOptions,
    factor: f32,
    scene: Estimate,
    /// Triangles of the last frame as first adapted, and expected for it at its factor: their ratio is the growth.
    growth: f64,
    /// Triangles drawn last; `None` before the first frame.
    drawn: Option<usize>,
    /// Set if anything that the factor asks for is not drawn yet (`waits`), and if much is (`lags`).
    waits: bool,
    lags: bool,
    /// Triangles drawn when a lower factor was too low.
    rest: Option<usize>,
    /// Set while the factor is on its way down to `AIM`.
    fills: bool,
}

impl SceneBudget {
    /// Creates a budget with factor 1.
    ///
    /// # Errors
    /// An option is out of its range.
    pub fn new(options: SceneOptions) -> Result<Self, ControlError> {
        options.check()?;
        Ok(Self {
            options,
            factor: 1.0,
            scene: Estimate::new(0),
            growth: 1.0,
            drawn: None,
            waits: false,
            lags: false,
            rest: None,
            fills: false,
        })
    }

    /// Returns the options.
    pub fn options(&self) -> &SceneOptions {
        &self.options
    }

    /// Sets the most triangles of all instances together: every frame, from [`FrameTime`](super::FrameTime) for example.
    pub fn set_triangles(&mut self, most: usize) {
        if most != self.options.triangles {
            self.options.triangles = most;
            self.rest = None;
        }
    }

    /// Returns the factor of tolerances, of instances of importance 1.
    pub fn factor(&self) -> f32 {
        self.factor
    }

    /// Sets the factor, adapts all instances to their views, on all cores with feature `parallel`, and advances geomorphs by `seconds`.
    pub fn adapt(&mut self, objects: &mut [SceneObject<'_>], seconds: f32) -> SceneReport {
        let limit = self.options.triangles;
        let aim = (AIM * limit as f64) as usize;
        let lowered = self.prepare();
        let expected = self.scene.triangles_at(self.factor);
        let [mut total, mut pending] = pass(objects, |object| object.adapt(self.factor, seconds));
        if self.drawn.is_some() && expected > 0.0 {
            self.growth = (total as f64 / expected).clamp(1.0 / GROWTH, GROWTH);
        }
        self.scene.observe(self.factor, total);
        let mut rounds = 0;
        while total > limit && rounds < self.options.rounds {
            rounds += 1;
            if pending > 0 {
                // The factor is judged by all that it asks for.
                let [asked, _] = pass(objects, |object| object.settle(false));
                self.scene.observe(self.factor, asked);
            }
            // The first rounds trust the estimate.
            let spare = aim as f64 * 0.9_f64.powi(rounds as i32 - 1);
            self.factor = self.scene.factor_for(spare as usize).max(self.factor * RISE).min(1e30);
            [total, pending] = pass(objects, |object| object.adapt(self.factor, 0.0));
            if total > limit {
                [total, pending] = pass(objects, |object| object.settle(false));
            }
            self.scene.observe_again(self.factor, total);
        }
        let mut coarsest = 0;
        if total > limit {
            [total, pending] = pass(objects, |object| object.settle(true));
            coarsest = objects.len();
        }
        if rounds > 0 {
            self.rest = lowered.then_some(total);
            self.fills = false;
        }
        self.drawn = Some(total);
        self.waits = pending > 0;
        self.lags = pending as f64 > LAG * total as f64;
        SceneReport { triangles: total, factor: self.factor, rounds, coarsest, over_budget: total > limit }
    }

    /// Sets the factor for the frame. Returns whether it fell.
    fn prepare(&mut self) -> bool {
        let (Some(drawn), limit) = (self.drawn, self.options.triangles as f64) else { return false };
        let (drawn, growth) = (drawn as f64, self.growth.max(1.0));
        let next = drawn * self.growth;
        let another = self.rest.is_none_or(|rest| (drawn / rest as f64 - 1.0).abs() > ANOTHER);
        if next > HIGH * limit && drawn > ROOM * limit {
            // Room for as much growth again: 2 to 3.5 %.
            let spare = limit * (2.0 - growth).clamp(AIM, LEVEL) / growth;
            self.factor = self.scene.factor_for(spare as usize).clamp(self.factor, self.factor * 2.0);
            self.fills = false;
        } else if (self.fills || next < ROOM * limit) && self.factor > 1.0 && another && !self.lags {
            let full = AIM * limit / growth;
            let paced = (drawn + (PACE * limit).max(0.5 * (full - drawn))) / self.growth.min(1.0);
            // Instances with work pending spread their work themselves.
            let spare = if self.waits { full } else { paced.min(full) };
            let factor = self.scene.factor_for(spare as usize).min(self.factor);
            let fell = factor < self.factor;
            self.factor = factor.max(1.0);
            self.fills = spare < full;
            self.rest = None;
            return fell;
        }
        false
    }
}

/// Sums two counts over all instances.
fn pass(
    objects: &mut [SceneObject<'_>],
    each: impl Fn(&mut SceneObject<'_>) -> [usize; 2] + Sync + Send,
) -> [usize; 2] {
    let add = |a: [usize; 2], b: [usize; 2]| [0, 1].map(|i| a[i].saturating_add(b[i]));
    parallel::sum_mut(objects, AT_LEAST, [0; 2], each, add)
}
