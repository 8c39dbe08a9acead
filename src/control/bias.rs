//! One bias of all parameters: the least change of it that brings the triangles of a scene to a number.
//!
//! ```text
//!     too many triangles             0    D       A    E   B C      F      distances to the next coarser levels
//!     by 50                          |----o-------o----o---o-o------o--->  bias
//!                                        25      75                        triangles saved so far
//!                                         the bias moves to here ^ (A), the first at which 50 are saved
//! ```
//!
//! Southern, section 6.3.1, with the signs derived anew: too many triangles move the bias toward coarse, too few toward fine.
//! The paper sorts the nearest change of each object, accumulates, moves, recounts, and repeats. Here all changes within the
//! limit of the frame are gathered at once, so mostly one round does.

use std::cmp::Ordering;

use super::controllable::{Controllable, Toward};
use super::error::{ControlError, check};
use super::selection::reach;

/// Most rounds of moving and recounting in a frame. More than one only if an object names fewer changes than it has.
const ROUNDS: usize = 8;
/// Most changes of one object taken in by a round.
const CHANGES: usize = 64;

/// Change of the bias within which changes of level are gathered first, and the factor by which it grows where they are too few.
const WINDOW: f64 = 0.01;
const WIDER: f64 = 8.0;

/// Options of [`Bias`]. Defaults: 1,000,000 triangles within 5,000, a change of at most 0.01 a frame, also in motion.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct BiasOptions {
    /// Triangles wanted: `p` of the paper. Default 1,000,000.
    pub triangles: usize,
    /// Triangles by which the scene may be off: `epsilon` of the paper. At least the triangles that an object gains between its
    /// two finest levels ([`Stairs::largest_step`](super::Stairs::largest_step)): below that, no bias may be near enough.
    /// Default 5,000.
    pub tolerance: usize,
    /// Most change of the bias in a frame, above 0; `None`: no limit. The paper uses 0.01 for still scenes, 0.1 for volatile
    /// scenes. Default 0.01.
    pub change: Option<f64>,
    /// Lifts the limit of change while the eye moves: holds the frame rate where changes of quality are not noticed (section
    /// 6.3.4). Default `false`.
    pub free_in_motion: bool,
}

impl Default for BiasOptions {
    fn default() -> Self {
        Self { triangles: 1_000_000, tolerance: 5_000, change: Some(0.01), free_in_motion: false }
    }
}

impl BiasOptions {
    /// Sets the triangles wanted.
    #[must_use]
    pub fn with_triangles(mut self, triangles: usize) -> Self {
        self.triangles = triangles;
        self
    }

    /// Sets the triangles by which the scene may be off.
    #[must_use]
    pub fn with_tolerance(mut self, triangles: usize) -> Self {
        self.tolerance = triangles;
        self
    }

    /// Limits the change of the bias in a frame, or (`None`) lifts the limit.
    #[must_use]
    pub fn with_change(mut self, most: impl Into<Option<f64>>) -> Self {
        self.change = most.into();
        self
    }

    /// Lifts the limit of change while the eye moves, or not.
    #[must_use]
    pub fn with_free_in_motion(mut self, free: bool) -> Self {
        self.free_in_motion = free;
        self
    }

    fn check(&self) -> Result<(), ControlError> {
        let change = self.change.unwrap_or(1.0);
        check("change", change, change > 0.0 && change.is_finite(), "above 0 and finite")
    }
}

/// Why [`Bias::update`] ended where it did.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum BiasStop {
    /// The triangles are within the tolerance.
    Inside,
    /// The next change would lead, or the last change has led, to the other side of the number wanted by more than the
    /// tolerance. Too many triangles are never accepted for it, too few are.
    Coarse,
    /// The limit of change in a frame, or of rounds of moving and recounting.
    Limited,
    /// No object can get coarser, or finer, any more.
    Exhausted,
}

/// Result of [`Bias::update`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct BiasReport {
    /// Triangles at the bias of the frame before: `q` of the paper.
    pub before: usize,
    /// Triangles at the new bias.
    pub triangles: usize,
    /// Change of the bias: above 0 toward coarse.
    pub change: f64,
    /// Why the change ended.
    pub stop: BiasStop,
}

#[derive(Debug, Clone, Copy)]
struct Event {
    bias: f64,
    object: u32,
    triangles: u32,
}

/// Holds the triangles of a scene near a number, by a bias added to the parameters of all objects.
///
/// Each frame moves the bias as little as possible: to the change of level, of a single object, at which enough triangles are
/// saved or added. The bias moves in one direction within a frame, and not at all while the triangles are within the tolerance.
/// So a still scene comes to rest.
///
/// O(n) expected, n the changes of level within the limit of a frame. Allocates only while the number of changes grows.
///
/// ```
/// use multires::control::{Bias, BiasOptions, StairObject, Stairs};
///
/// let stairs = Stairs::new(&[(0.0, 10_000), (0.5, 2_000), (1.0, 200)])?; // once for each model
/// let options = BiasOptions::default().with_triangles(60_000).with_tolerance(stairs.largest_step());
/// let mut bias = Bias::new(options)?;
///
/// let mut objects = Vec::new();
/// for _ in 0..40 {
///     // Every frame: where objects are, then which level each is drawn at.
///     objects.clear();
///     objects.extend((0..10).map(|i| StairObject::new(&stairs, 0.04 * i as f32)));
///     bias.update(&objects, false);
///     let _level = objects[3].parameter_at(bias.bias()); // a geomorph mesh: at(T)
/// }
/// let drawn: usize = objects.iter().map(|object| stairs.triangles(object.level_at(bias.bias()))).sum();
/// assert!(drawn.abs_diff(60_000) <= 8_000);
/// # Ok::<(), multires::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Bias {
    options: BiasOptions,
    bias: f64,
    events: Vec<Event>,
}

impl Bias {
    /// Creates a controller with bias 0.
    ///
    /// # Errors
    /// An option is out of its range.
    pub fn new(options: BiasOptions) -> Result<Self, ControlError> {
        options.check()?;
        Ok(Self { options, bias: 0.0, events: Vec::new() })
    }

    /// Returns the options.
    pub fn options(&self) -> &BiasOptions {
        &self.options
    }

    /// Sets the options. The bias stays.
    ///
    /// # Errors
    /// An option is out of its range. Nothing has changed then.
    pub fn set_options(&mut self, options: BiasOptions) -> Result<(), ControlError> {
        options.check()?;
        self.options = options;
        Ok(())
    }

    /// Returns the bias: added to parameters; above 0 is coarser.
    pub fn bias(&self) -> f64 {
        self.bias
    }

    /// Sets the bias, after a cut to another scene for example. A bias that is not finite is ignored.
    pub fn set_bias(&mut self, bias: f64) {
        if bias.is_finite() {
            self.bias = bias;
        }
    }

    /// Moves the bias for the objects of a frame, before they are drawn. `moving`: whether the eye moves.
    pub fn update<C: Controllable>(&mut self, objects: &[C], moving: bool) -> BiasReport {
        let BiasOptions { triangles: wanted, tolerance, change, free_in_motion } = self.options;
        let limit = change.filter(|_| !(moving && free_in_motion)).unwrap_or(f64::INFINITY);
        let start = self.bias;
        let before = count(objects, start);
        let mut report = BiasReport { before, triangles: before, change: 0.0, stop: BiasStop::Inside };
        let (toward, end) = match before.cmp(&wanted) {
            Ordering::Greater => (Toward::Coarse, start + limit),
            _ => (Toward::Fine, start - limit),
        };
        let mut window = WINDOW;
        for _ in 0..ROUNDS {
            if report.triangles.abs_diff(wanted) <= tolerance {
                report.stop = BiasStop::Inside;
                break;
            }
            if (report.triangles > wanted) != (before > wanted) {
                report.stop = BiasStop::Coarse;
                break;
            }
            let (more, to, stop) = loop {
                let within = match toward {
                    Toward::Coarse => end.min(self.bias + window),
                    Toward::Fine => end.max(self.bias - window),
                };
                let more = self.gather(objects, toward, within);
                let (to, stop) = self.choose(toward, report.triangles);
                if to.is_some() || !more || within == end {
                    break (more, to, stop);
                }
                window *= WIDER;
            };
            let (to, stop) = match to {
                Some(to) => (to, stop),
                None if more => (end, BiasStop::Limited),
                None => {
                    let last =
                        self.events.iter().map(|event| event.bias).max_by(|a, b| along(toward, *a, *b));
                    (last.unwrap_or(self.bias), BiasStop::Exhausted)
                }
            };
            report.stop = stop;
            if to == self.bias {
                break;
            }
            let triangles = count(objects, to);
            if toward == Toward::Fine && triangles > wanted.saturating_add(tolerance) {
                // An object has gained more than it said.
                report.stop = BiasStop::Coarse;
                break;
            }
            (self.bias, report.triangles) = (to, triangles);
            if stop == BiasStop::Limited || stop == BiasStop::Coarse {
                break;
            }
        }
        if report.triangles.abs_diff(wanted) <= tolerance {
            report.stop = BiasStop::Inside;
        } else if report.stop == BiasStop::Inside {
            report.stop = BiasStop::Limited;
        }
        report.change = self.bias - start;
        report
    }

    /// Gathers the changes from the bias to `end`. Returns whether there are changes beyond.
    fn gather<C: Controllable>(&mut self, objects: &[C], toward: Toward, end: f64) -> bool {
        let mut more = false;
        self.events.clear();
        for (number, object) in objects.iter().enumerate() {
            let mut at = self.bias;
            for _ in 0..CHANGES {
                let Some(crossing) = object.next(at, toward) else { break };
                if !crossing.bias.is_finite() || along(toward, at, crossing.bias) != Ordering::Less {
                    break;
                }
                if along(toward, crossing.bias, end) == Ordering::Greater {
                    more = true;
                    break;
                }
                at = crossing.bias;
                self.events.push(Event {
                    bias: at,
                    object: number as u32,
                    triangles: u32::try_from(crossing.triangles).unwrap_or(u32::MAX),
                });
            }
        }
        more
    }

    /// Returns the bias of the change at which the sum of changes reaches the number wanted; `None` if all together do not.
    /// Toward fine, returns the change before, or the bias as it is, if the number wanted would be passed by more than the
    /// tolerance.
    fn choose(&mut self, toward: Toward, now: usize) -> (Option<f64>, BiasStop) {
        let BiasOptions { triangles: wanted, tolerance, .. } = self.options;
        let order = |a: &Event, b: &Event| along(toward, a.bias, b.bias).then(a.object.cmp(&b.object));
        let needed = now.abs_diff(wanted) as u64;
        let Some(reached) = reach(&mut self.events, needed, order, |event| u64::from(event.triangles)) else {
            return (None, BiasStop::Limited);
        };
        let to = self.events[reached - 1].bias;
        if toward == Toward::Fine {
            // Objects that change at one bias change together.
            let crossed = self.events.iter().filter(|event| event.bias >= to);
            let added = crossed.fold(0_u64, |sum, event| sum + u64::from(event.triangles));
            if added > needed.saturating_add(tolerance as u64) {
                let earlier = self.events[..reached].iter().map(|event| event.bias).filter(|&bias| bias > to);
                return (Some(earlier.fold(f64::INFINITY, f64::min).min(self.bias)), BiasStop::Coarse);
            }
        }
        (Some(to), BiasStop::Inside)
    }
}

/// Orders two biases by which comes first on the way.
fn along(toward: Toward, a: f64, b: f64) -> Ordering {
    match toward {
        Toward::Coarse => a.total_cmp(&b),
        Toward::Fine => b.total_cmp(&a),
    }
}

fn count<C: Controllable>(objects: &[C], bias: f64) -> usize {
    objects.iter().fold(0_usize, |sum, object| sum.saturating_add(object.triangles(bias)))
}
