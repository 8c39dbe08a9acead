//! Levels of detail by a parameter, and an object on them.
//!
//! ```text
//!     triangles  c0 |--------+
//!                c1 |        +-------+
//!                c2 |                +---------------
//!                   +--------|-------|--------------->  T = parameter + bias
//!                           R1      R2                  level i is drawn from R_i to below R_(i+1)
//! ```

use crate::gmesh::{Gmesh, Partition};

use super::controllable::{Controllable, Crossing, Toward};
use super::error::ControlError;

/// Levels of a model by a parameter `T`, finest first: level i is drawn for `R_i <= T < R_(i+1)`, level 0 also below `R_0`, the
/// last level also above. Made once for each model, shared by its objects. For a geomorph mesh: its partition of T (Southern,
/// section 6.2), with the triangles of each level.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Stairs {
    begins: Vec<f64>,
    triangles: Vec<u32>,
}

impl Stairs {
    /// Creates stairs of levels, finest first: the parameter at which each begins, and its triangles.
    ///
    /// # Errors
    /// There are no levels; a parameter is not finite, or not above the parameter before; a level has no fewer triangles than
    /// the level before, or more than 32 bits hold.
    pub fn new(levels: &[(f32, usize)]) -> Result<Self, ControlError> {
        if levels.is_empty() {
            return Err(ControlError::NoLevels);
        }
        let mut stairs = Self::default();
        for (level, &(parameter, triangles)) in levels.iter().enumerate() {
            if !parameter.is_finite()
                || stairs.begins.last().is_some_and(|&last| last >= f64::from(parameter))
            {
                return Err(ControlError::Parameter { level, parameter });
            }
            let count = u32::try_from(triangles).map_err(|_| ControlError::TooLarge { level, triangles })?;
            if stairs.triangles.last().is_some_and(|&last| last <= count) {
                return Err(ControlError::NotCoarser { level, triangles });
            }
            stairs.begins.push(f64::from(parameter));
            stairs.triangles.push(count);
        }
        Ok(stairs)
    }

    /// Creates the stairs of a geomorph mesh, divided by a partition of T of its levels.
    ///
    /// # Errors
    /// As [`new`](Self::new), never for a mesh built from a sequence and its own partition; a partition of another number of
    /// levels ([`ControlError::Levels`]).
    pub fn of_gmesh(gmesh: &Gmesh, partition: &Partition) -> Result<Self, ControlError> {
        let (found, expected) = (partition.starts().len(), gmesh.levels().len());
        if found != expected {
            return Err(ControlError::Levels { found, expected });
        }
        let begins = partition.starts().iter().zip(gmesh.levels());
        let levels: Vec<(f32, usize)> = begins.map(|(&begin, level)| (begin, level.triangles)).collect();
        Self::new(&levels)
    }

    /// Returns the number of levels, at least 1.
    pub fn len(&self) -> usize {
        self.begins.len()
    }

    /// Holds if there are no levels: of default stairs only.
    pub fn is_empty(&self) -> bool {
        self.begins.is_empty()
    }

    /// Returns the level drawn at a parameter. NaN gives the coarsest level.
    pub fn level(&self, parameter: f64) -> usize {
        // All are compared: no branch to be guessed.
        let begun = self.begins.iter().filter(|&&begin| begin <= parameter).count();
        if parameter.is_nan() { self.len().saturating_sub(1) } else { begun.saturating_sub(1) }
    }

    /// Returns the triangles of a level; 0 if there is no such level.
    pub fn triangles(&self, level: usize) -> usize {
        self.triangles.get(level).map_or(0, |&triangles| triangles as usize)
    }

    /// Returns the largest number of triangles between two neighbouring levels; 0 for a single level. Largest of all models in a
    /// scene, it is the smallest [`BiasOptions::tolerance`](super::BiasOptions::tolerance) that can always be kept while no two
    /// objects change at one bias.
    pub fn largest_step(&self) -> usize {
        self.triangles.windows(2).map(|pair| (pair[0] - pair[1]) as usize).max().unwrap_or(0)
    }
}

/// How much of an object is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Sight {
    /// Seen: follows the bias.
    #[default]
    Seen,
    /// Drawn, but not seen, as behind a wall: at its coarsest, before any seen object loses detail. Its triangles count.
    Hidden,
    /// Not drawn. Its triangles do not count.
    Culled,
}

/// An object on [`Stairs`], in a frame. `T = parameter + bias / importance` while the bias is above 0 (coarser), and
/// `T = parameter + bias * importance` while below (finer): objects of importance above 1 are finer at any bias but 0.
///
/// ```
/// use multires::control::{StairObject, Stairs};
///
/// let stairs = Stairs::new(&[(0.0, 10_000), (0.5, 2_000), (1.0, 200)])?;
/// let object = StairObject::new(&stairs, 0.4).with_importance(2.0);
/// assert!((object.parameter_at(0.1) - 0.45).abs() < 1e-6);
/// assert_eq!(object.level_at(0.3), 1);
/// # Ok::<(), multires::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StairObject<'a> {
    /// Levels of the object's model.
    pub stairs: &'a Stairs,
    /// Parameter before the bias: 0 near and fine, 1 far and coarse, `(d - near) / (far - near)` for example. NaN gives the
    /// coarsest level at any bias.
    pub parameter: f32,
    /// Importance, within 1/1000 to 1000; values not above 0, or not finite, count as 1.
    pub importance: f32,
    /// How much of the object is drawn.
    pub sight: Sight,
}

impl<'a> StairObject<'a> {
    /// Creates a seen object of importance 1.
    pub fn new(stairs: &'a Stairs, parameter: f32) -> Self {
        Self { stairs, parameter, importance: 1.0, sight: Sight::Seen }
    }

    /// Sets the importance.
    #[must_use]
    pub fn with_importance(mut self, importance: f32) -> Self {
        self.importance = importance;
        self
    }

    /// Sets how much of the object is drawn.
    #[must_use]
    pub fn with_sight(mut self, sight: Sight) -> Self {
        self.sight = sight;
        self
    }

    /// Returns the parameter to draw at, for a bias: infinite for an object that is not seen.
    pub fn parameter_at(&self, bias: f64) -> f32 {
        if self.sight == Sight::Seen { self.at(bias) as f32 } else { f32::INFINITY }
    }

    /// Returns the level to draw, for a bias.
    pub fn level_at(&self, bias: f64) -> usize {
        self.stairs.level(if self.sight == Sight::Seen { self.at(bias) } else { f64::INFINITY })
    }

    fn weight(&self) -> f64 {
        let importance = f64::from(self.importance);
        if importance > 0.0 && importance.is_finite() { importance.clamp(1e-3, 1e3) } else { 1.0 }
    }

    fn at(&self, bias: f64) -> f64 {
        if self.importance == 1.0 {
            return f64::from(self.parameter) + bias;
        }
        let importance = self.weight();
        let bias = if bias > 0.0 { bias / importance } else { bias * importance };
        f64::from(self.parameter) + bias
    }

    /// Returns the bias at which the parameter comes to `to`, moved on until the parameter has arrived in spite of rounding.
    fn bias_at(&self, to: f64, toward: Toward) -> Option<f64> {
        let importance = self.weight();
        let (parameter, way) = (f64::from(self.parameter), to - f64::from(self.parameter));
        let bias = if way > 0.0 { way * importance } else { way / importance };
        let arrives = |bias: &f64| match toward {
            Toward::Coarse => self.at(*bias) >= to,
            Toward::Fine => self.at(*bias) < to,
        };
        if arrives(&bias) {
            return Some(bias);
        }
        let size = (parameter.abs() + to.abs() + bias.abs()) * importance.max(1.0 / importance);
        let rounding = f64::EPSILON * if toward == Toward::Coarse { size } else { -size };
        [1.0, 2.0, 4.0, 8.0, 16.0].map(|step| bias + step * rounding).into_iter().find(arrives)
    }
}

impl Controllable for StairObject<'_> {
    fn triangles(&self, bias: f64) -> usize {
        if self.sight == Sight::Culled { 0 } else { self.stairs.triangles(self.level_at(bias)) }
    }

    fn next(&self, bias: f64, toward: Toward) -> Option<Crossing> {
        if self.sight != Sight::Seen || !self.parameter.is_finite() {
            return None;
        }
        let level = self.level_at(bias);
        let [fine, coarse] = match toward {
            Toward::Coarse => [level, level + 1],
            Toward::Fine => [level.checked_sub(1)?, level],
        };
        let begin = *self.stairs.begins.get(coarse)?;
        let triangles = self.stairs.triangles(fine) - self.stairs.triangles(coarse);
        Some(Crossing { bias: self.bias_at(begin, toward)?, triangles })
    }
}
