//! Whether a refinement is needed, and how far one can move before that may change.

use super::bounds::Bounds;

/// An answer with its slack: it stays the same while the eye has moved by no more than a share of `moved` and turned by no more
/// than the rest of `turned` since; or wholly one and not at all the other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Answer {
    /// Whether the refinement is needed.
    pub refine: bool,
    /// How far the eye may move where it does not turn, object units.
    pub moved: f64,
    /// How far it may turn where it does not move, radians.
    pub turned: f64,
}

impl Answer {
    /// Needed from everywhere.
    pub const ALWAYS: Self = Self { refine: true, moved: f64::INFINITY, turned: f64::INFINITY };
    /// Needed from nowhere.
    pub const NEVER: Self = Self { refine: false, ..Self::ALWAYS };

    /// An answer that must be asked for again after any motion.
    pub fn once(refine: bool) -> Self {
        Self { refine, moved: 0.0, turned: 0.0 }
    }

    /// Needed if both are. A yes holds while both do; a no while either does.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        match (self.refine, other.refine) {
            (true, true) => self.both(other),
            (false, false) => self.longer(other),
            (true, false) => other,
            (false, true) => self,
        }
    }

    /// Needed if either is.
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

    /// One of the two: the one that turning wakes later, or else moving.
    fn longer(self, other: Self) -> Self {
        if (self.turned, self.moved) >= (other.turned, other.moved) { self } else { other }
    }
}

/// How a criterion differs from an earlier one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Motion {
    /// Moved and turned, all else equal.
    Moved {
        /// Object units.
        distance: f64,
        /// Radians.
        angle: f64,
    },
    /// Something else: no answer given before holds.
    Other,
}

/// Which refinements are needed.
///
/// `B` is what a structure says of a refinement. Must be monotone in it: what is needed for some bounds is needed for bounds
/// that [contain](Bounds::contains) them. A criterion that is not still yields a valid mesh: what is asked
/// for is then what it and all that it builds on are asked for, as far as the cut came to ask.
pub trait Criterion<B = Bounds> {
    /// Whether a refinement with these bounds is needed.
    fn test(&self, bounds: &B) -> Answer;

    /// What has happened since `before`. [`Motion::Other`] is always right, and the slowest.
    fn motion(&self, before: &Self) -> Motion;

    /// The factor by which tolerances would have to grow for the refinement to be no longer needed: above 1 where it is
    /// needed, 1 or less where it is not. A triangle budget splits the most urgent first and collapses the least urgent. Must
    /// be monotone in the bounds. Unless implemented, all that is needed is of endless urgency, and a larger error comes
    /// first.
    fn urgency(&self, bounds: &B) -> f64 {
        if self.test(bounds).refine { f64::INFINITY } else { 0.0 }
    }

    /// Whether the refinement would be needed with tolerances multiplied by `factor` (above 0): where it is, its
    /// [urgency](Self::urgency) is above the factor. Unless implemented, the answer holds once.
    fn test_at(&self, bounds: &B, factor: f64) -> Answer {
        Answer::once(self.urgency(bounds) > factor)
    }

    /// [`test_at`](Self::test_at) with tolerances multiplied by `scale` before a budget multiplies them by `factor`: what is
    /// needed for no error, as in a [focus](super::Focus), does not ask how large tolerances are, but gives way to a budget. Unless
    /// implemented, both are one factor.
    fn test_scaled(&self, bounds: &B, scale: f64, factor: f64) -> Answer {
        self.test_at(bounds, scale * factor)
    }

    /// The [urgency](Self::urgency) with tolerances multiplied by `scale`. Unless implemented, the urgency divided by that.
    fn urgency_scaled(&self, bounds: &B, scale: f64) -> f64 {
        self.urgency(bounds) / scale
    }

    /// Whether a change there may be seen; where not, it is made at once. Unless implemented, it may.
    fn sees(&self, bounds: &B) -> bool {
        let _ = bounds;
        true
    }
}

/// Several views at once (split screen, shadow cascades): needed where any needs it.
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
