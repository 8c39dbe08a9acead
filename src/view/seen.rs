//! Bounds as seen from an eye: place of the sphere, angles of the normals, size of the error.

use std::f64::consts::FRAC_PI_2;

use glam::DVec3;

use super::bounds::Bounds;
use super::camera::ErrorKind;
use super::criteria::Answer;
use super::region;

/// Bounds, as read by tests.
pub(super) trait SeenBounds {
    /// Centre of the sphere.
    fn centre(&self) -> DVec3;

    /// Radius of the sphere. Larger than any distance for all of space.
    fn reach(&self) -> f64;

    /// The cone of normals: axis at any length, and sine and cosine of the half-angle; `None` for all directions.
    fn facing(&self) -> Option<(DVec3, [f64; 2])>;

    /// Apparent sizes of the error, from an eye with the sphere at `place`.
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

/// Place of a sphere relative to the eye, shared by all tests.
pub(super) struct Place {
    /// Vector from the eye to the centre; for an orthographic view the direction of view.
    pub to: DVec3,
    /// Length of `to` (`distance`) and its square. For an orthographic view `square` is 1 and `distance` infinite.
    pub distance: f64,
    pub square: f64,
    /// Distance to the nearest point of the sphere; negative inside it. Infinite for an orthographic view.
    pub gap: f64,
}

impl Place {
    /// Sine and cosine of half the angle under which a sphere of radius `reach` is seen, from outside it.
    #[inline]
    pub fn half(&self, reach: f64) -> [f64; 2] {
        let sine = reach / self.distance;
        [sine, ((1.0 - sine) * (1.0 + sine)).sqrt()]
    }
}

/// Apparent size of an error, object units: half of its extent across the line of sight.
pub(super) struct Extent {
    /// From the place of the eye.
    pub size: f64,
    /// From where the error looks smallest, and largest.
    pub least: f64,
    pub largest: f64,
    /// Largest change of `size` per radian turned by a line of sight.
    pub slope: f64,
}

impl Extent {
    /// Returns how far the eye may move until the value of `gap < size * reach` (now `refine`) may change.
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
        // A bound for any turn of the lines of sight.
        let sure = if refine { self.least * reach - gap } else { gap - self.largest * reach };
        turning.max(sure)
    }
}

/// Normals compared with lines of sight, as sines and cosines of angles.
pub(super) struct Facing {
    /// Half the cone's angle plus half the angle under which the sphere is seen.
    pub wide: [f64; 2],
    /// Angle by which the axis points away from the eye, beyond a right angle to the line of sight.
    pub away: [f64; 2],
    pub gap: f64,
}

impl Facing {
    /// Whether any normal may face the eye, or be at a right angle to a line of sight.
    #[inline]
    pub fn front(&self) -> Answer {
        self.compare(self.away[0])
    }

    /// Whether any normal may face away from the eye, or be at a right angle to a line of sight.
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
        // Directions to all points of the sphere turn by at most asin(moved / gap), and their angles to normals by as
        // much.
        let allowed = if cosine < 0.0 { 1.0 } else { sine.abs().min(1.0) };
        let moved = if self.gap < f64::INFINITY { self.gap * allowed } else { f64::INFINITY };
        Answer { refine: sine >= 0.0 || wide_cosine <= 0.0, moved, turned: f64::INFINITY }
    }
}
