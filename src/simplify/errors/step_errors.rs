//! Finds the error of a step: by the distance points have travelled, or by tracked samples on surface and curves.

use glam::Vec3;

use crate::simplify::metric::Pair;
use crate::simplify::options::ErrorMeasure;
use crate::simplify::surface::WorkingSurface;
use crate::simplify::surface::patch::Patch;

use super::curve_samples::CurveSamples;
use super::parametric_error::ParametricError;
use super::tracked_samples::TrackedSamples;
use super::way_back::WayBack;

/// Deviations up to this are rounding and count as 0, inner units: a few units in the last place of the coordinates, at
/// most 1e-6 of the diagonal.
const ROUNDING: f32 = 1.0 / 2_097_152.0;
/// A step is heavy if it hands over more samples than this, and this many times as many as there are for each point.
const HEAVY: usize = 256;

/// Distance of the level from the input after a step, inner units.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Deviation {
    pub surface: f32,
    pub curve: f32,
}

impl Deviation {
    fn new(surface: f32, curve: f32) -> Self {
        let clean = |x: f32| if x > ROUNDING { x } else { 0.0 };
        Self { surface: clean(surface), curve: clean(curve) }
    }

    /// Returns the larger of both.
    pub fn largest(self) -> f32 {
        self.surface.max(self.curve)
    }
}

/// Method of finding the error of a step.
pub(crate) enum Errors {
    /// Bounds surface and curves alike.
    Parametric(ParametricError),
    TrackedSamples(Box<Watch>),
}

/// Tracked samples of surface and curves.
pub(crate) struct Watch {
    surface: TrackedSamples,
    curves: CurveSamples,
    back: WayBack,
    /// Last measurement: pair, position and result.
    measured: Option<(Pair, Vec3, Deviation)>,
}

impl Errors {
    pub fn new(surface: &WorkingSurface, measure: ErrorMeasure) -> Self {
        match measure {
            ErrorMeasure::Parametric => Self::Parametric(ParametricError::new(surface)),
            _ => Self::TrackedSamples(Box::new(Watch {
                surface: TrackedSamples::new(surface, measure == ErrorMeasure::Verified),
                curves: CurveSamples::new(surface),
                back: WayBack::new(surface),
                measured: None,
            })),
        }
    }

    pub fn measure(&mut self, surface: &WorkingSurface, patch: &Patch, pair: Pair, x: Vec3) -> Deviation {
        match self {
            Self::Parametric(error) => both(error.measure(surface, patch, pair, x)),
            Self::TrackedSamples(watch) => {
                let apart = watch.surface.measure(surface, patch, pair, x);
                let concerns = watch.curves.concerns(surface, pair, x);
                let curve = if concerns { watch.curves.measure(surface, pair, x).worst } else { 0.0 };
                let found = watch.with_way_back(surface, patch, pair, x, [apart, curve.sqrt()]);
                watch.measured = Some((pair, x, found));
                found
            }
        }
    }

    /// Returns true if the last step handed over very many samples.
    pub fn is_heavy(&self, surface: &WorkingSurface) -> bool {
        match self {
            Self::Parametric(_) => false,
            Self::TrackedSamples(watch) => {
                let handed = watch.surface.handed_over() + watch.curves.handed_over();
                handed > HEAVY && handed > surface.point_count() / surface.live_points().max(1) * HEAVY
            }
        }
    }

    pub fn hand_over(&mut self, surface: &WorkingSurface, patch: &Patch, pair: Pair, x: Vec3) -> Deviation {
        match self {
            Self::Parametric(error) => both(error.merge(surface, patch, pair, x)),
            Self::TrackedSamples(watch) => {
                let apart = watch.surface.hand_over(surface, patch, pair, x);
                let concerns = watch.curves.concerns(surface, pair, x);
                watch.curves.clear_loose();
                let curve = if concerns { watch.curves.hand_over(surface, pair, x).worst } else { 0.0 };
                let mut found = watch.with_way_back(surface, patch, pair, x, [apart, curve.sqrt()]);
                // The way back starts from other points now; the earlier measurement is equally true, and has passed the
                // limits.
                if let Some((_, _, before)) = watch.measured.take().filter(|&(p, at, _)| (p, at) == (pair, x))
                {
                    found.surface = found.surface.min(before.surface);
                    found.curve = found.curve.min(before.curve);
                }
                watch.surface.note(found.surface);
                found
            }
        }
    }

    /// Returns the growth of the integral of squared distance by a collapse. Each input point stands for its share of
    /// the area, on the surface and once more on a curve.
    pub fn added(&mut self, surface: &WorkingSurface, patch: &Patch, pair: Pair, x: Vec3) -> Option<f32> {
        match self {
            Self::Parametric(_) => None,
            Self::TrackedSamples(watch) => {
                let concerns = watch.curves.concerns(surface, pair, x);
                let curve = if concerns { watch.curves.measure(surface, pair, x).added } else { 0.0 };
                Some(watch.surface.added(surface, patch, pair, x) + curve * watch.surface.share())
            }
        }
    }

    /// Returns the error of a vanishing part of `points`, replaced by the point `into`. `nearest` gives the squared
    /// distance of a position to the remaining surface near it, and the nearest triangle. Curves of the part vanish too:
    /// they are as far from the remaining surface as the part's surface. An error above `enough` may be any such.
    pub fn measure_vanishing(
        &mut self,
        surface: &WorkingSurface,
        points: &[u32],
        into: u32,
        enough: f32,
        nearest: impl FnMut(Vec3) -> (f32, u32),
    ) -> Deviation {
        match self {
            Self::Parametric(error) => both(error.measure_vanishing(surface, points, into)),
            Self::TrackedSamples(watch) => {
                both(watch.surface.measure_vanishing(surface, points, enough, nearest))
            }
        }
    }

    /// Returns the error of the collapse of `pair` at `x` right after a part of `points`, measured last, vanished into the lost
    /// point: what the part hands over counts.
    pub fn measure_reaching(
        &mut self,
        surface: &WorkingSurface,
        patch: &Patch,
        pair: Pair,
        x: Vec3,
        points: &[u32],
    ) -> Deviation {
        let mut found = self.measure(surface, patch, pair, x);
        match self {
            Self::Parametric(error) => both(error.measure_reaching(surface, pair, x, points)),
            Self::TrackedSamples(watch) => {
                found.surface = found.surface.max(watch.surface.measure_handed(surface, pair, x));
                watch.measured = Some((pair, x, found));
                found
            }
        }
    }

    /// Records that a part vanishes, after it was measured and just before it vanishes. Returns its error.
    pub fn vanish(&mut self, surface: &WorkingSurface, points: &[u32], into: u32) -> Deviation {
        match self {
            Self::Parametric(error) => both(error.vanish(surface, points, into)),
            Self::TrackedSamples(watch) => both(watch.surface.vanish(surface, points)),
        }
    }

    /// Returns the triangles taking over the samples measured last.
    pub fn takers(&self) -> impl Iterator<Item = u32> + '_ {
        let handed = match self {
            Self::Parametric(_) => &[][..],
            Self::TrackedSamples(watch) => watch.surface.handed(),
        };
        handed.iter().map(|&(_, _, triangle)| triangle)
    }
}

impl Watch {
    /// Returns the distances of surface and curves, including the distance from the level's new triangles to the input:
    /// next to curves, on small meshes and on coarse levels.
    #[inline]
    fn with_way_back(
        &self,
        surface: &WorkingSurface,
        patch: &Patch,
        pair: Pair,
        x: Vec3,
        [apart, curve]: [f32; 2],
    ) -> Deviation {
        // Around an inner point, the small triangles of a fine level cover nothing new; nor do any triangles where
        // everything before lies on the new surface.
        let covers = self.curves.concerns(surface, pair, x) || surface.is_coarse();
        if !covers || apart.max(curve) <= ROUNDING {
            return Deviation::new(apart, curve);
        }
        let known = (apart * apart).max(curve * curve).max(self.surface.largest()).max(ROUNDING * ROUNDING);
        let on = |triangle: u32, place: Vec3| self.surface.nearest_on(triangle, place);
        let back = self.back.farthest(surface, patch, pair, x, known, on);
        Deviation::new(if back > known { back.sqrt() } else { apart }, curve)
    }
}

/// Uses the bound for surface and curves.
fn both(bound: f32) -> Deviation {
    Deviation { surface: bound, curve: bound }
}
