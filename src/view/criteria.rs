//! Criteria: whether a refinement is needed, and how far the eye can move before the answer may change.

use super::bounds::Bounds;

/// An answer and how long it holds: while `distance / moved + angle / turned <= 1`, for the distance moved and the angle
/// turned by the eye since.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Answer {
    /// Whether the refinement is needed.
    pub refine: bool,
    /// Distance the eye may move without turning, object units.
    pub moved: f64,
    /// Angle the eye may turn without moving, radians.
    pub turned: f64,
}

impl Answer {
    /// Needed from every view.
    pub const ALWAYS: Self = Self { refine: true, moved: f64::INFINITY, turned: f64::INFINITY };
    /// Needed from no view.
    pub const NEVER: Self = Self { refine: false, ..Self::ALWAYS };

    /// Creates an answer which holds only without motion.
    pub fn once(refine: bool) -> Self {
        Self { refine, moved: 0.0, turned: 0.0 }
    }

    /// Logical and: needed if both are needed. A yes holds while both hold; a no holds while either no holds.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        match (self.refine, other.refine) {
            (true, true) => self.both(other),
            (false, false) => self.longer(other),
            (true, false) => other,
            (false, true) => self,
        }
    }

    /// Logical or: needed if either is needed. A yes holds while either yes holds; a no holds while both hold.
    #[must_use]
    pub fn or(self, other: Self) -> Self {
        match (self.refine, other.refine) {
            (true, true) => self.longer(other),
            (false, false) => self.both(other),
            (true, false) => self,
            (false, true) => other,
        }
    }

    fn both(self, other: Self) -> Self {
        Self {
            refine: self.refine,
            moved: self.moved.min(other.moved),
            turned: self.turned.min(other.turned),
        }
    }

    /// Returns the answer with the larger `turned`, or if equal, the larger `moved`.
    fn longer(self, other: Self) -> Self {
        if (self.turned, self.moved) >= (other.turned, other.moved) { self } else { other }
    }
}

/// Difference between two states of a criterion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Motion {
    /// The eye moved and turned. Nothing else changed.
    Moved {
        /// Distance moved, object units.
        distance: f64,
        /// Angle turned, radians.
        angle: f64,
    },
    /// Anything else changed. No previous answer holds.
    Other,
}

/// Decides which refinements are needed.
///
/// `B` is the type of a structure's bounds. A criterion must be monotone: if a refinement is needed with some bounds, it
/// is needed with all bounds which [contain](Bounds::contains) them. If a criterion is not monotone, the mesh stays
/// valid, but the cut depends on earlier views.
///
/// ```
/// use multires::hierarchy::{HierarchyLod, VertexHierarchy};
/// use multires::view::{Answer, Bounds, Criterion, Motion};
/// use multires::{Lod, Structure, mesh::shapes};
///
/// /// Full resolution above a height.
/// struct Above(f32);
///
/// impl Criterion for Above {
///     fn test(&self, bounds: &Bounds) -> Answer {
///         Answer::once(bounds.centre[1] + bounds.radius > self.0)
///     }
///     fn motion(&self, _: &Self) -> Motion {
///         Motion::Other
///     }
/// }
///
/// let model = VertexHierarchy::bake(&shapes::icosphere(4))?;
/// let mut lod = HierarchyLod::new(model.structure().clone());
/// let above = lod.adapt_by(&Above(0.5), Motion::Other, 0.0).triangles;
/// assert!(above < model.structure().triangle_count());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Criterion<B = Bounds> {
    /// Whether a refinement with the given bounds is needed.
    fn test(&self, bounds: &B) -> Answer;

    /// Returns the motion since `before`. [`Motion::Other`] is always correct, and slowest.
    fn motion(&self, before: &Self) -> Motion;

    /// Returns the factor of the tolerances at which the refinement stops being needed: above 1 if it is needed, 1 or
    /// less if it is not. A triangle budget splits the most urgent refinement first, and collapses the least urgent
    /// first. Must be monotone in the bounds. By default all needed refinements have infinite urgency, and larger errors
    /// come first.
    fn urgency(&self, bounds: &B) -> f64 {
        if self.test(bounds).refine { f64::INFINITY } else { 0.0 }
    }

    /// Whether the refinement is needed with tolerances multiplied by `factor > 0`: if it is, its
    /// [urgency](Self::urgency) exceeds `factor`. The default answer must be tested again after any motion.
    fn test_at(&self, bounds: &B, factor: f64) -> Answer {
        Answer::once(self.urgency(bounds) > factor)
    }

    /// [`test_at`](Self::test_at) with two factors: `scale` of the tolerances, and `factor` of a budget. Refinements
    /// needed without any error, such as in a [focus](super::Focus), ignore `scale`, but yield to `factor`. The default
    /// uses `scale * factor`.
    fn test_scaled(&self, bounds: &B, scale: f64, factor: f64) -> Answer {
        self.test_at(bounds, scale * factor)
    }

    /// [`test_scaled`](Self::test_scaled), for a `scale` that changes from view to view. The answer also says how long it
    /// holds then: while `distance / moved + (angle + |ln(scale' / scale)|) / turned <= 1`. By default, tests at both ends
    /// of a band of 5 %: if the two agree, the answer holds within the band, otherwise for this scale and view alone.
    fn test_turning(&self, bounds: &B, scale: f64, factor: f64) -> Answer {
        within_band(scale, |scale| self.test_scaled(bounds, scale, factor))
    }

    /// Tests many bounds, and writes an answer for each: the same as [`test`](Self::test), [`test_at`](Self::test_at) or
    /// [`test_turning`](Self::test_turning), whichever the factors say. Answers may hold for less than theirs. By default tests one
    /// after the other.
    fn test_each(&self, bounds: &[B], factors: Factors, answers: &mut [Answer]) {
        one_by_one(self, bounds, factors, answers);
    }

    /// Returns the [urgency](Self::urgency) with tolerances multiplied by `scale`. The default is `urgency / scale`.
    fn urgency_scaled(&self, bounds: &B, scale: f64) -> f64 {
        self.urgency(bounds) / scale
    }

    /// Whether a change within the bounds may be visible. Invisible changes are made at once. Defaults to `true`.
    fn sees(&self, bounds: &B) -> bool {
        let _ = bounds;
        true
    }
}

/// Factors of all tolerances in [`Criterion::test_each`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Factors {
    /// A factor that changes from view to view, if there is one ([`Criterion::test_turning`]).
    pub turning: Option<f64>,
    /// The factor of a budget; 1 without a budget.
    pub budget: f64,
}

impl Factors {
    /// Tolerances as they are.
    pub const NONE: Self = Self { turning: None, budget: 1.0 };
}

/// Answers for many bounds, one after the other.
pub(super) fn one_by_one<B, C: Criterion<B> + ?Sized>(
    criterion: &C,
    bounds: &[B],
    factors: Factors,
    answers: &mut [Answer],
) {
    for (bounds, answer) in bounds.iter().zip(answers) {
        *answer = match factors {
            Factors { turning: Some(scale), budget } => criterion.test_turning(bounds, scale, budget),
            Factors { turning: None, budget } if budget != 1.0 => criterion.test_at(bounds, budget),
            _ => criterion.test(bounds),
        };
    }
}

/// Ratio of a factor to the ends of its band.
const BAND: f64 = 1.05;

/// Returns an answer for a band of factors about `scale`, from a test that never changes from no to yes as the factor grows.
pub(super) fn within_band(scale: f64, test: impl Fn(f64) -> Answer) -> Answer {
    let [low, high] = [scale / BAND, scale * BAND].map(&test);
    // Less than ln(BAND).
    let turned = 1.0 - 1.0 / BAND;
    let held = |answer: Answer| Answer { turned: answer.turned.min(turned), ..answer };
    match (low.refine, high.refine) {
        (true, true) => held(low.and(high)),
        (false, false) => held(low.or(high)),
        _ => Answer::once(test(scale).refine),
    }
}

/// Several views at once (split screen, shadow cascades): a refinement is needed if any view needs it.
impl<B, C: Criterion<B>> Criterion<B> for [C] {
    #[inline]
    fn test(&self, bounds: &B) -> Answer {
        if let [one] = self {
            return one.test(bounds);
        }
        let mut answer = Answer::NEVER;
        for view in self {
            answer = answer.or(view.test(bounds));
            if answer == Answer::ALWAYS {
                break;
            }
        }
        answer
    }

    fn urgency(&self, bounds: &B) -> f64 {
        self.iter().map(|view| view.urgency(bounds)).fold(0.0, f64::max)
    }

    fn urgency_scaled(&self, bounds: &B, scale: f64) -> f64 {
        self.iter().map(|view| view.urgency_scaled(bounds, scale)).fold(0.0, f64::max)
    }

    fn test_scaled(&self, bounds: &B, scale: f64, factor: f64) -> Answer {
        let mut answer = Answer::NEVER;
        for view in self {
            answer = answer.or(view.test_scaled(bounds, scale, factor));
        }
        answer
    }

    fn test_turning(&self, bounds: &B, scale: f64, factor: f64) -> Answer {
        if let [one] = self {
            return one.test_turning(bounds, scale, factor);
        }
        let mut answer = Answer::NEVER;
        for view in self {
            answer = answer.or(view.test_turning(bounds, scale, factor));
        }
        answer
    }

    fn test_at(&self, bounds: &B, factor: f64) -> Answer {
        let mut answer = Answer::NEVER;
        for view in self {
            answer = answer.or(view.test_at(bounds, factor));
            if answer == Answer::ALWAYS {
                break;
            }
        }
        answer
    }

    fn test_each(&self, bounds: &[B], factors: Factors, answers: &mut [Answer]) {
        if let [one] = self {
            one.test_each(bounds, factors, answers);
        } else {
            one_by_one(self, bounds, factors, answers);
        }
    }

    fn sees(&self, bounds: &B) -> bool {
        self.iter().any(|view| view.sees(bounds))
    }

    fn motion(&self, before: &Self) -> Motion {
        if self.len() != before.len() {
            return Motion::Other;
        }
        let mut all = (0.0_f64, 0.0_f64);
        for (now, before) in self.iter().zip(before) {
            match now.motion(before) {
                Motion::Moved { distance, angle } => all = (all.0.max(distance), all.1.max(angle)),
                Motion::Other => return Motion::Other,
            }
        }
        Motion::Moved { distance: all.0, angle: all.1 }
    }
}
