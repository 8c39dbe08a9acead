//! From the parameter T of an object to a level and a share: how the range from near to far is divided among the levels.

use super::{Gmesh, Morph};

/// Smallest length of a range that stands for an error or a volume, as a share of an even one: the swap of levels without
/// error, too, is a motion.
const LEAST: f64 = 1.0 / 64.0;

/// The division of T, from 0 (near, finest) to 1 (far, coarsest), among the levels: T at which each level begins.
///
/// ```text
///     T           R_0 = 0      R_1        R_2              R_n = 1
///                   |-- level 0 --|-- level 1 --|-- ... --| level n, as long as T is 1 or more
///     share of the way to level i + 1:  (T - R_i) / (R_(i+1) - R_i)
/// ```
///
/// Starts ascend strictly, so a state follows T without a jump. Southern, section 6.2.1, with `R_i` the sum of the lengths
/// before `i`.
///
/// ```
/// use multires::gmesh::{Morph, Partition};
///
/// let partition = Partition::by_lengths(&[1.0, 3.0])?;
/// assert_eq!(partition.starts(), [0.0, 0.25, 1.0]);
/// assert_eq!(partition.at(-1.0), Morph { level: 0, share: 0.0 });
/// assert_eq!(partition.at(0.625), Morph { level: 1, share: 0.5 });
/// assert_eq!(partition.at(2.0), Morph { level: 2, share: 0.0 });
/// # Ok::<(), multires::gmesh::PartitionError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Partition {
    /// Strictly ascending from 0 to 1; a single 0 for a single level.
    starts: Vec<f32>,
}

/// Why lengths do not make a partition.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PartitionError {
    /// A length is not above 0, or not finite, or lost beside the others.
    #[error("length {index} is {length}, but lengths are above 0, finite, and of comparable size")]
    Length {
        /// Index of the length.
        index: usize,
        /// The length.
        length: f32,
    },
}

impl Partition {
    /// Divides T evenly among `levels` levels. O(levels).
    pub fn even(levels: usize) -> Self {
        Self::of_weights(&vec![1.0; levels.saturating_sub(1)])
    }

    /// Divides T by loss of volume: `r_i = (V_i - V_(i+1)) / (V_0 - V_n)`. By error instead ([`Partition::by_error`]) where a
    /// level is open or gains volume. No range is shorter than 1/64 of an even one. Southern, section 6.2.1.
    pub fn by_volume(gmesh: &Gmesh) -> Self {
        let volumes: Option<Vec<f64>> = gmesh.levels().iter().map(|level| level.volume).collect();
        let Some(volumes) = volumes else { return Self::by_error(gmesh) };
        // Solids turned inside out lose volume too.
        let losses: Vec<f64> = volumes.windows(2).map(|pair| pair[0].abs() - pair[1].abs()).collect();
        if losses.iter().any(|&loss| loss < 0.0) || losses.iter().sum::<f64>() <= 0.0 {
            return Self::by_error(gmesh);
        }
        Self::of_weights(&losses)
    }

    /// Divides T by error: `R_i = error of level i / error of the coarsest level`, but no range shorter than 1/64 of an even one.
    /// With a perspective view and T proportional to the distance, levels begin where their errors have one size on the
    /// screen: this is the division by screen error. (On its way to the next level a state may have the next level's error.)
    pub fn by_error(gmesh: &Gmesh) -> Self {
        let errors = gmesh.levels().windows(2);
        let steps: Vec<f64> =
            errors.map(|pair| f64::from(pair[1].error) - f64::from(pair[0].error)).collect();
        Self::of_weights(&steps)
    }

    /// Divides T by lengths of your own, one between each two levels; their sum does not matter.
    ///
    /// # Errors
    /// A length is not above 0 and finite, or so small that its range would be empty.
    pub fn by_lengths(lengths: &[f32]) -> Result<Self, PartitionError> {
        let is_length = |length: &f32| *length > 0.0 && length.is_finite();
        if let Some(index) = lengths.iter().position(|length| !is_length(length)) {
            return Err(PartitionError::Length { index, length: lengths[index] });
        }
        let whole: f64 = lengths.iter().map(|&length| f64::from(length)).sum();
        let mut sum = 0.0;
        let mut starts = vec![0.0_f32];
        for &length in lengths {
            sum += f64::from(length);
            starts.push((sum / whole) as f32);
        }
        if let Some(last) = starts.last_mut().filter(|_| !lengths.is_empty()) {
            *last = 1.0;
        }
        if let Some(index) = starts.windows(2).position(|pair| pair[0] >= pair[1]) {
            return Err(PartitionError::Length { index, length: lengths[index] });
        }
        Ok(Self { starts })
    }

    /// Makes a partition from weights of at least 0. No range is shorter than a small share of an even one.
    fn of_weights(weights: &[f64]) -> Self {
        let whole: f64 = weights.iter().sum();
        let even = 1.0 / weights.len().max(1) as f64;
        let share =
            |&weight: &f64| if whole > 0.0 && whole.is_finite() { (weight / whole).max(0.0) } else { even };
        let lengths: Vec<f32> = weights.iter().map(|weight| share(weight).max(LEAST * even) as f32).collect();
        // All lengths are of comparable size: at most 64 times the number of levels apart.
        Self::by_lengths(&lengths).unwrap_or_else(|_| Self { starts: vec![0.0] })
    }

    /// Returns T at which each level begins: one number for each level, from 0 to 1.
    pub fn starts(&self) -> &[f32] {
        &self.starts
    }

    /// Returns the state at T: the finest level for T of at most 0 and NaN, the last level for T of at least 1. O(log levels).
    pub fn at(&self, t: f32) -> Morph {
        let last = self.starts.len() - 1;
        if t.is_nan() || t <= 0.0 {
            return Morph::default();
        }
        if t >= 1.0 {
            return Morph { level: last, share: 0.0 };
        }
        let level = (self.starts.partition_point(|&start| start <= t) - 1).min(last);
        let Some(&next) = self.starts.get(level + 1) else { return Morph { level, share: 0.0 } };
        let start = self.starts[level];
        Morph { level, share: (t - start) / (next - start) }
    }

    /// Returns T of a state: the inverse of [`Partition::at`]. 1 for the last level and beyond.
    pub fn t_of(&self, morph: Morph) -> f32 {
        let Some(&start) = self.starts.get(morph.level) else { return 1.0 };
        let next = self.starts.get(morph.level + 1).copied().unwrap_or(start);
        start + morph.share * (next - start)
    }
}

/// Distances between which an object changes: T is 0 up to `near` and 1 from `far` on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DistanceRange {
    /// Distance up to which the finest level is drawn.
    pub near: f32,
    /// Distance from which the coarsest level is drawn.
    pub far: f32,
}

impl DistanceRange {
    /// Returns `T = (distance - near) / (far - near)`, not clamped, so that a bias can be added. Where `far` is not beyond `near`,
    /// T is 0 up to `near` and 1 beyond it.
    pub fn t(self, distance: f32) -> f32 {
        let (way, length) = (distance - self.near, self.far - self.near);
        if length > 0.0 { way / length } else { f32::from(u8::from(way > 0.0)) }
    }
}
