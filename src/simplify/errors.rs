//! How the error of a step is found: by the distance that points have travelled, or by witnesses.

use glam::Vec3;

use super::metric::Pair;
use super::options::ErrorMeasure;
use super::patch::Patch;
use super::surface::Surface;
use super::travel::Travel;
use super::witness::Witnesses;

/// How the error of a step is found.
pub(super) enum Errors {
    Travel(Travel),
    Witnesses(Box<Witnesses>),
}

impl Errors {
    pub fn new(surface: &Surface, measure: ErrorMeasure) -> Self {
        match measure {
            ErrorMeasure::Travel => Self::Travel(Travel::new(surface)),
            _ => Self::Witnesses(Box::new(Witnesses::new(surface, measure == ErrorMeasure::Verified))),
        }
    }

    pub fn measure(&mut self, surface: &Surface, patch: &Patch, pair: Pair, x: Vec3) -> f32 {
        match self {
            Self::Travel(travel) => travel.measure(surface, pair, x),
            Self::Witnesses(witnesses) => witnesses.measure(surface, patch, pair, x),
        }
    }

    pub fn hand_over(&mut self, surface: &Surface, patch: &Patch, pair: Pair, x: Vec3) -> f32 {
        match self {
            Self::Travel(travel) => travel.merge(surface, pair, x),
            Self::Witnesses(witnesses) => witnesses.hand_over(surface, patch, pair, x),
        }
    }

    /// The integral of squared distance that a collapse adds, each input point standing for its share of the area.
    pub fn added(&mut self, surface: &Surface, patch: &Patch, pair: Pair, x: Vec3) -> Option<f32> {
        match self {
            Self::Travel(_) => None,
            Self::Witnesses(witnesses) => Some(witnesses.added(surface, patch, pair, x)),
        }
    }

    /// The error of a part of `points` that vanishes, and is taken for the point `into`; `nearest` gives the squared
    /// distance of a position to what is left near it, and the triangle that has it.
    pub fn measure_vanishing(
        &mut self,
        surface: &Surface,
        points: &[u32],
        into: u32,
        nearest: impl FnMut(Vec3) -> (f32, u32),
    ) -> f32 {
        match self {
            Self::Travel(travel) => travel.measure_vanishing(surface, points, into),
            Self::Witnesses(witnesses) => witnesses.measure_vanishing(surface, points, nearest),
        }
    }

    /// Takes down that a part vanishes, just before it does and after it was measured: its error.
    pub fn vanish(&mut self, surface: &Surface, points: &[u32], into: u32) -> f32 {
        match self {
            Self::Travel(travel) => travel.vanish(surface, points, into),
            Self::Witnesses(witnesses) => witnesses.vanish(surface, points),
        }
    }

    /// The triangles that what was measured last would hang on.
    pub fn takers(&self) -> impl Iterator<Item = u32> + '_ {
        let handed = match self {
            Self::Travel(_) => &[][..],
            Self::Witnesses(witnesses) => witnesses.handed(),
        };
        handed.iter().map(|&(_, _, triangle)| triangle)
    }
}
