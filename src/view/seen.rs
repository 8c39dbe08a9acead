//! How bounds look from an eye: where their sphere is, how their normals stand to it, how large their error may look.

use std::f64::consts::FRAC_PI_2;

use glam::DVec3;

use super::bounds::Bounds;
use super::camera::ErrorKind;
use super::criteria::Answer;
use super::region;

/// What tests read of bounds.
pub(super) trait SeenBounds {
    /// Centre of the sphere.
    fn centre(&self) -> DVec3;

    /// Radius of the sphere.
    fn reach(&self) -> f64;

    /// The cone of normals: its axis at any length, and sine and cosine of its half-angle; `None` for all directions.
    fn facing(&self) -> Option<(DVec3, [f64; 2])>;

    /// The error as it may look from an eye to which the sphere is in that place.
    fn extent(&self, kind: ErrorKind, place: &Place) -> Extent;
}

impl SeenBounds for Bounds {
    #[inline]
    fn centre(&self) -> DVec3 {
        DVec3::from_array(self.centre.map(f64::from))
    }

    #[inline]
    fn reach(&self) -> f64 {
        region::reach(self.radius)
    }

    #[inline]
    fn facing(&self) -> Option<(DVec3, [f64; 2])> {
        region::facing(self.cone)
    }

    #[inline]
    fn extent(&self, kind: ErrorKind, _: &Place) -> Extent {
        let error = f64::from(match kind {
            ErrorKind::Geometric => self.error,
            ErrorKind::Parametric => self.parametric,
        });
        Extent { size: error, least: error, largest: error, slope: 0.0 }
    }
}

/// Where a sphere is, as all tests see it.
pub(super) struct Place {
    /// From the eye to its centre; by an orthographic view the direction of view.
    pub to: DVec3,
    /// Length of `to`, and its square; the latter is 1 by an orthographic view.
    pub distance: f64,
    pub square: f64,
    /// To the nearest point of the sphere; negative inside it.
    pub gap: f64,
}

impl Place {
    /// Sine and cosine of half the angle under which a sphere of that radius is seen, from outside it.
    #[inline]
    pub fn half(&self, reach: f64) -> [f64; 2] {
        let sine = reach / self.distance;
        [sine, ((1.0 - sine) * (1.0 + sine)).sqrt()]
    }
}

/// How large an error may look, object units: half of what it spans across the line of sight.
pub(super) struct Extent {
    /// From where the eye is.
    pub size: f64,
    /// From where it looks smallest, and largest.
    pub least: f64,
    pub largest: f64,
    /// By how much `size` changes, at most, for each radian that a line of sight turns.
    pub slope: f64,
}

impl Extent {
    /// How far the eye may move until `gap < size * reach` may no longer be what it is (`refine`).
    #[inline]
    pub fn slack(&self, reach: f64, gap: f64, refine: bool) -> f64 {
        let apart = (gap - self.size * reach).abs();
        if self.slope <= 0.0 {
            return apart;
        }
        let turning = if gap > 0.0 {
            // No point of the sphere is nearer than the gap, so lines of sight turn by no more than asin(moved / gap).
            (apart / (1.0 + FRAC_PI_2 * self.slope * reach / gap)).min(gap)
        } else {
            -gap
        };
        // Or whichever way it turns.
        let sure = if refine { self.least * reach - gap } else { gap - self.largest * reach };
        turning.max(sure)
    }
}

/// Normals against lines of sight, as sines and cosines of angles.
pub(super) struct Facing {
    /// Half the cone's angle plus half the angle under which the sphere is seen.
    pub wide: [f64; 2],
    /// By how much the axis points away from the eye beyond a right angle to the line of sight.
    pub away: [f64; 2],
    pub gap: f64,
}

impl Facing {
    /// Whether any normal may be at a right angle to a line of sight or beyond, towards the eye.
    #[inline]
    pub fn front(&self) -> Answer {
        self.compare(self.away[0])
    }

    /// The same away from the eye.
    #[inline]
    pub fn back(&self) -> Answer {
        self.compare(-self.away[0])
    }

    #[inline]
    fn compare(&self, away: f64) -> Answer {
        if self.gap <= 0.0 {
            return Answer { refine: true, moved: -self.gap, turned: f64::INFINITY };
        }
        let ([wide_sine, wide_cosine], away_cosine) = (self.wide, self.away[1]);
        // Sine and cosine of `wide - away`.
        let sine = wide_sine * away_cosine - wide_cosine * away;
        let cosine = wide_cosine * away_cosine + wide_sine * away;
        // All directions to points of the sphere turn by at most asin(moved / gap), and so does their angle to any normal.
        let allowed = if cosine < 0.0 { 1.0 } else { sine.abs().min(1.0) };
        let moved = if self.gap < f64::INFINITY { self.gap * allowed } else { f64::INFINITY };
        Answer { refine: sine >= 0.0 || wide_cosine <= 0.0, moved, turned: f64::INFINITY }
    }
}
