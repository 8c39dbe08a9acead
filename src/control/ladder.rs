//! Levels of detail by triangles and error, and an object on them.
//!
//! ```text
//!     error  o                        o levels on the convex hull: each step finer saves less error per triangle
//!             \                       x level above the hull: taken only where a small scene is split exactly
//!              \      x
//!               o---___               - level with an error no smaller than a level with fewer triangles: never taken
//!                      ---o----___    -
//!            +--------------------o--> triangles
//! ```

use crate::gmesh::Gmesh;

use super::error::ControlError;

/// Levels of a model: triangles and errors. Made once for each model, shared by its objects.
///
/// Levels are numbered as they were given. Levels whose error is no smaller than that of a level with fewer triangles are never
/// drawn, so errors need not be monotone.
///
/// ```
/// use multires::control::Ladder;
///
/// let ladder = Ladder::new(&[(10_000, 0.0), (2_000, 0.01), (200, 0.1)])?; // triangles, error in object units
/// assert_eq!(ladder.coarsest(), (2, 200, 0.1));
/// # Ok::<(), multires::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Ladder {
    /// Levels that may be drawn, coarsest first: triangles ascend, errors descend.
    rungs: Vec<Rung>,
    /// Steps from rung to rung of the hull, coarsest first.
    steps: Vec<Step>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Rung {
    pub triangles: u32,
    pub error: f32,
    pub level: u32,
}

/// A step to a finer rung of the hull.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Step {
    /// Error saved per triangle, object units.
    pub slope: f32,
    /// Triangles added.
    pub triangles: u32,
    /// Error before the step.
    pub error: f32,
    /// Number of the rung that the step leads to.
    pub to: u32,
}

impl Ladder {
    /// Creates a ladder of levels in any order: triangles, and error in object units (or any unit that
    /// [`LadderObject::pixels`] turns into pixels).
    ///
    /// # Errors
    /// As [`set`](Self::set).
    pub fn new(levels: &[(usize, f32)]) -> Result<Self, ControlError> {
        let mut ladder = Self::default();
        ladder.set(levels)?;
        Ok(ladder)
    }

    /// Creates the ladder of a geomorph mesh's levels.
    ///
    /// # Errors
    /// As [`set`](Self::set); never for a mesh built from a sequence.
    pub fn of_gmesh(gmesh: &Gmesh) -> Result<Self, ControlError> {
        let levels: Vec<(usize, f32)> =
            gmesh.levels().iter().map(|level| (level.triangles, level.error)).collect();
        Self::new(&levels)
    }

    /// Exchanges the levels. Allocates only for more levels than before.
    ///
    /// # Errors
    /// There are no levels; an error is negative or not finite; a level has more triangles than 32 bits hold. Nothing has changed
    /// then.
    pub fn set(&mut self, levels: &[(usize, f32)]) -> Result<(), ControlError> {
        if levels.is_empty() {
            return Err(ControlError::NoLevels);
        }
        for (level, &(triangles, error)) in levels.iter().enumerate() {
            if u32::try_from(triangles).is_err() {
                return Err(ControlError::TooLarge { level, triangles });
            }
            if !(error >= 0.0 && error.is_finite()) {
                return Err(ControlError::Error { level, error });
            }
        }
        let Self { rungs, steps } = self;
        rungs.clear();
        rungs.extend(levels.iter().zip(0..).map(|(&(triangles, error), level)| Rung {
            triangles: triangles as u32,
            error: error + 0.0,
            level,
        }));
        rungs.sort_unstable_by(|a, b| {
            let sizes = a.triangles.cmp(&b.triangles).then(a.error.total_cmp(&b.error));
            sizes.then(a.level.cmp(&b.level))
        });
        let mut least = f32::INFINITY;
        rungs.retain(|rung| {
            let better = rung.error < least;
            least = least.min(rung.error);
            better
        });
        climb(rungs, steps);
        Ok(())
    }

    /// Returns the number, triangles and error of the coarsest level; zeros for a default ladder.
    pub fn coarsest(&self) -> (usize, usize, f32) {
        self.rung(0)
    }

    /// Returns the number, triangles and error of the finest level that may be drawn; zeros for a default ladder.
    pub fn finest(&self) -> (usize, usize, f32) {
        self.rung(self.rungs.len().saturating_sub(1))
    }

    fn rung(&self, at: usize) -> (usize, usize, f32) {
        self.rungs
            .get(at)
            .map_or((0, 0, 0.0), |rung| (rung.level as usize, rung.triangles as usize, rung.error))
    }

    pub(super) fn rungs(&self) -> &[Rung] {
        &self.rungs
    }

    pub(super) fn steps(&self) -> &[Step] {
        &self.steps
    }
}

/// Finds the steps along the lower convex hull of the rungs.
fn climb(rungs: &[Rung], steps: &mut Vec<Step>) {
    let slope = |a: &Rung, b: &Rung| {
        let saved = f64::from(a.error) - f64::from(b.error);
        (saved / f64::from(b.triangles - a.triangles)) as f32
    };
    steps.clear();
    for (to, rung) in rungs.iter().enumerate().skip(1) {
        // A step that saves less than the next step is joined with it.
        loop {
            let from = steps.last().map_or(0, |step| step.to as usize);
            let next = slope(&rungs[from], rung);
            if steps.last().is_some_and(|last| last.slope < next) {
                steps.pop();
                continue;
            }
            steps.push(Step {
                slope: next,
                triangles: rung.triangles - rungs[from].triangles,
                error: rungs[from].error,
                to: to as u32,
            });
            break;
        }
    }
}

/// An object on a [`Ladder`], in a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LadderObject<'a> {
    /// Levels of the object's model.
    pub ladder: &'a Ladder,
    /// Pixels spanned by a unit of the ladder's errors, where the object is nearest to the eye:
    /// `tolerance in pixels / `[`ObjectView::error_at`](crate::view::ObjectView::error_at)`(distance)`. 0 for an object out of
    /// sight, which gets its coarsest level. Infinite counts as the largest number. NaN and negative count as 0.
    pub pixels: f32,
    /// Weight of the object's screen error, 0 or more: 1 for all alike; the share of the screen, for error summed over pixels.
    /// Infinite, NaN and negative count as for `pixels`.
    pub importance: f32,
}

impl<'a> LadderObject<'a> {
    /// Creates an object of importance 1.
    pub fn new(ladder: &'a Ladder, pixels: f32) -> Self {
        Self { ladder, pixels, importance: 1.0 }
    }

    /// Sets the importance.
    #[must_use]
    pub fn with_importance(mut self, importance: f32) -> Self {
        self.importance = importance;
        self
    }

    /// Returns the pixels, within 0 to the largest number.
    pub(super) fn scale(&self) -> f32 {
        positive(self.pixels)
    }

    /// Returns the coarsest rung of the hull with a screen error within the tolerance, or the finest rung; 0 without a weight.
    /// `weight` is the object's [`weight`](Self::weight).
    pub(super) fn finest_rung(&self, weight: f32, tolerance_px: f32) -> u32 {
        if weight <= 0.0 {
            return 0;
        }
        if tolerance_px <= 0.0 {
            return self.ladder.steps.last().map_or(0, |step| step.to);
        }
        let scale = self.scale();
        let steps = self.ladder.steps.iter().take_while(|step| scale * step.error > tolerance_px);
        steps.last().map_or(0, |step| step.to)
    }

    /// Returns the weight of an error in the ladder's unit.
    pub(super) fn weight(&self) -> f32 {
        (positive(self.pixels) * positive(self.importance)).min(f32::MAX)
    }
}

fn positive(number: f32) -> f32 {
    if number > 0.0 { number.min(f32::MAX) } else { 0.0 }
}
