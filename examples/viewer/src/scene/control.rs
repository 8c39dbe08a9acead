//! Controllers of a whole scene: a number of triangles, a frame time, or a bias of all parameters.
//!
//! ```text
//!     measured(seconds) -> FrameTime -> triangles --+
//!                                                   v
//!     options.triangles ----------------------> SceneBudget -> tolerance factor of every instance
//!     options.triangles ----------------------> Bias        -> T of every g-mesh, shown by its partition
//! ```

use multires::adapt::Change;
use multires::control::{
    Bias, BiasOptions, ControlError, FrameTime, FrameTimeOptions, Sample, SceneBudget, SceneObject,
    SceneOptions, Sight, StairObject, Stairs,
};
use multires::gmesh::{Gmesh, Partition};
use multires::lod::{Baked, LodError};
use multires::view::{Bounds, Criterion, ObjectView};

use super::instance::Instance;

/// Most change of the bias in a frame: for scenes through which the eye moves.
const BIAS_CHANGE: f64 = 0.1;
/// Least and most triangles of a frame time's target.
const TARGETS: [usize; 2] = [1_000, 100_000_000];

/// Choice of a controller.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Controller {
    /// Tolerances are as the views ask.
    #[default]
    Off,
    /// At most a number of triangles, by one factor of all tolerances.
    Triangles,
    /// A frame time, by a number of triangles that follows the measured times.
    Time,
    /// About a number of triangles, by one bias of the parameters of all g-meshes.
    Bias,
}

/// Options of the control of a scene. Defaults: off, 500,000 triangles, 1/30 s.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ControlOptions {
    /// The controller.
    pub controller: Controller,
    /// Triangles of all objects together.
    pub triangles: usize,
    /// Time for a frame, seconds; above 0.
    pub seconds: f64,
}

impl Default for ControlOptions {
    fn default() -> Self {
        Self { controller: Controller::Off, triangles: 500_000, seconds: 1.0 / 30.0 }
    }
}

impl ControlOptions {
    /// Sets the controller.
    #[must_use]
    pub fn with_controller(mut self, controller: Controller) -> Self {
        self.controller = controller;
        self
    }

    /// Sets the triangles of all objects together.
    #[must_use]
    pub fn with_triangles(mut self, triangles: usize) -> Self {
        self.triangles = triangles;
        self
    }

    /// Sets the time for a frame, seconds.
    #[must_use]
    pub fn with_seconds(mut self, seconds: f64) -> Self {
        self.seconds = seconds;
        self
    }
}

/// Why a scene cannot be controlled.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SceneControlError {
    /// A bias needs objects with a parameter.
    #[error("a bias moves the parameters of g-meshes, and the scene has none (--structure gmesh)")]
    NoGmesh,
    /// A target is outside its range, or the levels have no order.
    #[error(transparent)]
    Control(#[from] ControlError),
    /// The instances cannot be drawn.
    #[error(transparent)]
    Lod(#[from] LodError),
}

/// The controller at work, and what it goes by.
#[derive(Default)]
enum Active {
    #[default]
    Off,
    Triangles(SceneBudget),
    Time(Box<FrameTime>, SceneBudget),
    Bias(Box<Parameters>),
}

/// The control of a scene.
#[derive(Default)]
pub(super) struct Control {
    options: ControlOptions,
    active: Active,
}

impl Control {
    pub fn options(&self) -> &ControlOptions {
        &self.options
    }

    /// Sets the options. A controller that stays goes on from where it is.
    pub fn set_options(
        &mut self,
        options: ControlOptions,
        gmesh: Option<&Baked<Gmesh>>,
    ) -> Result<(), SceneControlError> {
        let ControlOptions { controller, triangles, seconds } = options;
        let time = FrameTimeOptions::default().with_seconds(seconds).with_triangles(TARGETS[0], TARGETS[1]);
        let time = time.with_pause((8.0 * seconds).max(0.5));
        match (&mut self.active, controller) {
            (Active::Off, Controller::Off) => {}
            (Active::Triangles(budget), Controller::Triangles) => budget.set_triangles(triangles),
            (Active::Time(frame, _), Controller::Time) => {
                if seconds != self.options.seconds {
                    frame.set_options(time)?;
                }
            }
            (Active::Bias(parameters), Controller::Bias) => parameters.set_triangles(triangles)?,
            (active, _) => {
                let budget = || SceneBudget::new(SceneOptions::default().with_triangles(triangles));
                *active = match controller {
                    Controller::Off => Active::Off,
                    Controller::Triangles => Active::Triangles(budget()?),
                    Controller::Time => Active::Time(Box::new(FrameTime::new(time, triangles)?), budget()?),
                    Controller::Bias => {
                        let gmesh = gmesh.ok_or(SceneControlError::NoGmesh)?;
                        Active::Bias(Box::new(Parameters::new(gmesh, triangles)?))
                    }
                };
            }
        }
        self.options = options;
        Ok(())
    }

    /// Takes in the time that a frame of so many triangles took. Times that are none are left out.
    pub fn measured(&mut self, seconds: f64, triangles: usize) {
        if let Active::Time(frame, _) = &mut self.active {
            let _ = frame.update(Sample { seconds, triangles });
        }
    }

    /// Adapts all instances. The views of instance `i` begin at `i * views.len() / instances`. Returns `None` if nothing controls the
    /// scene.
    pub fn adapt<'a>(
        &mut self,
        instances: impl ExactSizeIterator<Item = &'a mut Instance>,
        views: &[ObjectView],
        seconds: f32,
    ) -> Option<Controlled> {
        let each = views.len() / instances.len().max(1);
        let views = |i: usize| &views[i * each..(i + 1) * each];
        let budget = match &mut self.active {
            Active::Off => return None,
            Active::Bias(parameters) => return Some(parameters.adapt(instances, views)),
            Active::Triangles(budget) => budget,
            Active::Time(frame, budget) => {
                budget.set_triangles(frame.triangles());
                budget
            }
        };
        let before = budget.factor();
        let mut objects: Vec<_> = instances
            .enumerate()
            .map(|(i, instance)| SceneObject::new(instance.lod_mut(), views(i)))
            .collect();
        let report = budget.adapt(&mut objects, seconds);
        let mut change = Change::default();
        (change.triangles, change.over_budget) = (report.triangles, report.over_budget);
        Some(Controlled {
            change,
            target: budget.options().triangles,
            output: report.factor,
            settles: report.factor != before || report.rounds > 0,
        })
    }
}

/// What a controller did in a frame.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Controlled {
    /// Sums over all objects: of a bias all, else the triangles alone.
    pub change: Change,
    /// Triangles aimed at.
    pub target: usize,
    /// The factor of all tolerances, or the bias.
    pub output: f32,
    /// Whether the next frame will differ though nothing moves.
    pub settles: bool,
}

/// Levels of a g-mesh by the parameter T: the error allowed by the views over the error of the coarsest level.
struct Parameters {
    bias: Bias,
    stairs: Stairs,
    partition: Partition,
    /// The bounding sphere, with the diagonal as its error.
    bounds: Bounds,
    diagonal: f64,
    /// Error at T = 1.
    reach: f64,
    /// Parameter of every instance in a frame.
    at: Vec<(f32, Sight)>,
}

impl Parameters {
    fn new(baked: &Baked<Gmesh>, triangles: usize) -> Result<Self, SceneControlError> {
        let gmesh = baked.structure();
        let partition = Partition::by_error(gmesh);
        let levels = || gmesh.levels().iter().zip(partition.starts());
        let steps: Vec<_> = levels().map(|(level, &start)| (start, level.triangles)).collect();
        let stairs = Stairs::new(&steps)?;
        let reach = levels().skip(1).map(|(level, &start)| f64::from(level.error) / f64::from(start));
        let [low, high] = baked.bounds().unwrap_or_default().map(glam::Vec3::from_array);
        let (centre, radius) = ((low + high) * 0.5, (high - low).length() * 0.5);
        Ok(Self {
            bias: Bias::new(Self::options(&stairs, triangles))?,
            reach: reach.fold(0.0, f64::max),
            bounds: Bounds::new(centre.to_array(), radius, 2.0 * radius, 2.0 * radius),
            diagonal: 2.0 * f64::from(radius),
            at: Vec::new(),
            partition,
            stairs,
        })
    }

    /// The least tolerance that can always be kept.
    fn options(stairs: &Stairs, triangles: usize) -> BiasOptions {
        let options = BiasOptions::default().with_triangles(triangles).with_change(BIAS_CHANGE);
        options.with_tolerance(stairs.largest_step())
    }

    fn set_triangles(&mut self, triangles: usize) -> Result<(), ControlError> {
        if triangles != self.bias.options().triangles {
            self.bias.set_options(Self::options(&self.stairs, triangles))?;
        }
        Ok(())
    }

    /// Returns T of an instance without bias, and whether it is seen. An instance out of sight is drawn too, at its coarsest.
    fn parameter(&self, views: &[ObjectView]) -> (f32, Sight) {
        if !views.iter().any(|view| view.sees(&self.bounds)) {
            return (1.0, Sight::Hidden);
        }
        let urgency = views.urgency(&self.bounds);
        let allowed = self.diagonal / urgency.max(f64::MIN_POSITIVE);
        let parameter = if self.reach > 0.0 { allowed / self.reach } else { 1.0 };
        (parameter.min(1e6) as f32, Sight::Seen)
    }

    fn adapt<'a, 'v>(
        &mut self,
        instances: impl Iterator<Item = &'a mut Instance>,
        views: impl Fn(usize) -> &'v [ObjectView],
    ) -> Controlled {
        let instances: Vec<_> = instances.collect();
        let mut at = std::mem::take(&mut self.at);
        at.clear();
        at.extend((0..instances.len()).map(|i| self.parameter(views(i))));
        let object =
            |&(parameter, sight): &(f32, Sight)| StairObject::new(&self.stairs, parameter).with_sight(sight);
        let objects: Vec<_> = at.iter().map(object).collect();
        let report = self.bias.update(&objects, false);
        let mut change = Change::default();
        for (object, instance) in objects.iter().zip(instances) {
            let state = self.partition.at(object.parameter_at(self.bias.bias()));
            super::add(&mut change, instance.show(state).unwrap_or_default());
        }
        self.at = at;
        Controlled {
            change,
            target: self.bias.options().triangles,
            output: self.bias.bias() as f32,
            settles: report.change != 0.0,
        }
    }
}
