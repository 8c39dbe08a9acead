//! The front door: options, and one call that makes the sequence.

use std::ops::ControlFlow;

use crate::mesh::{Mesh, Tolerances, names};

use super::engine::{Engine, Plan};
use super::metric::{ErrorMetric, Quadric, WithAttributes};
use super::normals::{Normals, NormalsDone};
use super::options::{
    AttributeWeights, ErrorMeasure, Guard, Limits, OptionError, Order, Parts, Progress, Target,
};
use super::oracle::{Oracle, default_oracles};
use super::permissive::{Permissive, Schedule};
use super::placement::Placement;
use super::sequence::CollapseSequence;

/// Simplifies meshes: pluggable metric, placement, order and oracles.
///
/// Defaults: accumulated quadrics, endpoint placement, linear order, all oracles, down to the base mesh; normals, texture
/// coordinates and colours count where the mesh has them.
///
/// # The error
/// The error of each step, in object units, is the larger of two that are measured, to within the rounding of single
/// precision:
///
/// - *No vertex that the input's triangles use is farther from the level's surface than*
///   [`surface_error_after`](CollapseSequence::surface_error_after) says. Every merged point is kept on the part of the
///   surface it lies over, and its distance is taken whenever that part changes.
/// - *No vertex on a curve of the input is farther from the level's curve, and no point measured along an edge of that
///   farther from the input's, than* [`curve_error_after`](CollapseSequence::curve_error_after) says. Curves are borders,
///   non-manifold edges, borders between materials, seams, and creases of more than 41.4 degrees where they draw the
///   outline of a made thing rather than the relief of a scan. The level's curve is the image of the input's, so a hole
///   that shrinks, a rim that is cut off and an island that vanishes are told by it, also on a flat face, where the
///   surface tells nothing. A curve that shrinks to a point counts with its distance from there.
///
/// [`error_after`](CollapseSequence::error_after) is the larger of both and never decreases along the sequence. What is
/// at most a few units in the last place of the coordinates (2^-21 of the size of the mesh, rounded to a power of two)
/// counts as 0: an error of 0 takes away what is redundant, and nothing else. Points on borders that nothing but rounding
/// parts ([`Tolerances::position`]) are one place from the start. Other measures: [`ErrorMeasure`].
///
/// Next to curves, and everywhere once one triangle in 16 is left or 4096, places on new triangles are held against the
/// input too, so that a large triangle that spans a hollow counts; on finer levels nothing is claimed between the vertices
/// of the input, nor of the level's surface. By samples, the two-sided maximum is mostly within 10 % of the error
/// (`docs/performance.md` in the repository has the table).
///
/// # Determinism
/// The same mesh and options give the same bytes, whatever the number of threads and with or without `parallel`.
///
/// # Cost
/// O(n) expected time for bounded valence, and O(n log n) for measuring the error; around 200 bytes a point while it runs.
pub struct Simplifier<M = Quadric> {
    metric: M,
    oracles: Vec<Box<dyn Oracle>>,
    targets: Vec<Target>,
    settings: Settings,
}

/// Everything that can be set besides metric, oracles and targets.
#[derive(Debug, Clone, Default)]
pub(super) struct Settings {
    pub placement: Placement,
    pub order: Order,
    pub measure: ErrorMeasure,
    pub permissive: Permissive,
    /// Object units.
    pub join_distance: f32,
    pub tolerances: Tolerances,
    pub guard: Guard,
    pub parts: Parts,
    pub attributes: AttributeWeights,
    pub normals: Normals,
}

impl Settings {
    fn check(&self) -> Result<(), OptionError> {
        if self.join_distance.is_nan() || self.join_distance < 0.0 {
            let value = f64::from(self.join_distance);
            return Err(OptionError::OutOfRange { option: "join distance", value, expected: "0 or more" });
        }
        if let Some((option, value, expected)) = self.tolerances.out_of_range() {
            return Err(OptionError::OutOfRange { option, value: f64::from(value), expected });
        }
        Ok(())
    }

    /// What is to be done with the normals of a mesh: where they are to steer collapses, or all levels are made, they are not
    /// recomputed unless asked for.
    fn normals(&self, mesh: &Mesh, all_levels: bool) -> Result<NormalsDone, OptionError> {
        let steer = match &self.attributes {
            AttributeWeights::Chosen(list) => list.iter().any(|(name, _)| name == names::NORMAL),
            _ => false,
        };
        if self.normals == Normals::Automatic && (steer || all_levels) {
            return Ok(NormalsDone::Kept);
        }
        self.normals.resolve(mesh)
    }
}

impl Default for Simplifier {
    fn default() -> Self {
        Self::new()
    }
}

impl Simplifier {
    /// A simplifier with the defaults.
    pub fn new() -> Self {
        Self {
            metric: Quadric::new(),
            oracles: default_oracles(),
            targets: Vec::new(),
            settings: Settings::default(),
        }
    }
}

impl<M: ErrorMetric> Simplifier<M> {
    /// What a collapse costs. Default: [`Quadric`].
    #[must_use]
    pub fn metric<N: ErrorMetric>(self, metric: N) -> Simplifier<N> {
        let Self { oracles, targets, settings, .. } = self;
        Simplifier { metric, oracles, targets, settings }
    }

    /// Where the merged vertex goes. Default: [`Placement::Endpoint`].
    #[must_use]
    pub fn placement(mut self, placement: Placement) -> Self {
        self.settings.placement = placement;
        self
    }

    /// In which order collapses are done. Default: [`Order::Linear`].
    #[must_use]
    pub fn order(mut self, order: Order) -> Self {
        self.settings.order = order;
        self
    }

    /// What the error of a step is. Default: [`ErrorMeasure::Measured`].
    #[must_use]
    pub fn error_measure(mut self, measure: ErrorMeasure) -> Self {
        self.settings.measure = measure;
        self
    }

    /// Whether seams, creases, material borders and the topology may give, and when. Default: [`Permissive::Auto`], before a size is
    /// missed.
    #[must_use]
    pub fn permissive(mut self, permissive: Permissive) -> Self {
        self.settings.permissive = permissive;
        self
    }

    /// One more rule, asked after those already there.
    #[must_use]
    pub fn oracle(mut self, oracle: impl Oracle + 'static) -> Self {
        // A rule of the same name takes the old one's place.
        match self.oracles.iter().position(|o| o.name() == oracle.name()) {
            Some(at) => self.oracles[at] = Box::new(oracle),
            None => self.oracles.push(Box::new(oracle)),
        }
        self
    }

    /// These rules instead of the default ones.
    #[must_use]
    pub fn oracles(mut self, oracles: Vec<Box<dyn Oracle>>) -> Self {
        self.oracles = oracles;
        self
    }

    /// One more target; the first one reached stops. Default: none, down to the base mesh.
    #[must_use]
    pub fn target(mut self, target: Target) -> Self {
        self.targets.push(target);
        self
    }

    /// Lets separate parts grow together when they are at most this far apart (object units). Default 0: never.
    ///
    /// With [`Parts::Vanish`] a corner of the nearest kin moves to the far end of a part that vanishes, where that is within
    /// this distance, so that less of what was covered is lost. With [`Parts::Keep`] points of different parts may be merged
    /// (vertex pairs, TOM 4.1): every point has the eight nearest of other parts, found anew whenever it takes in another; about
    /// parts that were joined, rules that keep the topology are not asked ([`Oracle::keeps_topology`]).
    #[must_use]
    pub fn join_distance(mut self, distance: f32) -> Self {
        self.settings.join_distance = distance;
        self
    }

    /// Up to which differences vertices at one point are one wedge, so that noise makes no seams. Default: one step of
    /// 16-bit storage ([`Tolerances::default`]). Nearly equal vertices are folded into one before the first step
    /// ([`CollapseSequence::aliases`]).
    #[must_use]
    pub fn tolerances(mut self, tolerances: Tolerances) -> Self {
        self.settings.tolerances = tolerances;
        self
    }

    /// Whether collapses are refused that would ruin the shape. Default: [`Guard::On`].
    #[must_use]
    pub fn guard(mut self, guard: Guard) -> Self {
        self.settings.guard = guard;
        self
    }

    /// What becomes of normals. Default: [`Normals::Automatic`].
    #[must_use]
    pub fn normals(mut self, normals: Normals) -> Self {
        self.settings.normals = normals;
        self
    }

    /// Whether separate parts vanish as a whole when that is the cheapest step. Default: [`Parts::Vanish`].
    #[must_use]
    pub fn parts(mut self, parts: Parts) -> Self {
        self.settings.parts = parts;
        self
    }

    /// Which attributes count in what collapses cost. Default: [`AttributeWeights::Customary`], normals, texture
    /// coordinates and colours where the mesh has them. A metric that counts attributes by itself
    /// ([`WithAttributes`]) is left as it is.
    #[must_use]
    pub fn attributes(mut self, weights: AttributeWeights) -> Self {
        self.settings.attributes = weights;
        self
    }

    /// Simplifies a mesh.
    ///
    /// # Errors
    /// An option outside its range, an attribute that the mesh does not have. Any mesh is legal.
    pub fn run(&mut self, mesh: &Mesh) -> Result<CollapseSequence, OptionError> {
        self.run_with(mesh, |_| ControlFlow::Continue(()))
    }

    /// Simplifies a mesh and tells how far it is every few thousand steps. Where `progress` breaks, the sequence ends
    /// there and is usable up to there.
    ///
    /// # Errors
    /// An option outside its range, an attribute that the mesh does not have.
    pub fn run_with(
        &mut self,
        mesh: &Mesh,
        mut progress: impl FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<CollapseSequence, OptionError> {
        let limits = Limits::new(&self.targets, mesh.triangles().len())?;
        self.settings.check()?;
        let normals = self.settings.normals(mesh, self.targets.is_empty())?;
        let bare = normals.bare(mesh);
        let mesh = bare.as_ref().unwrap_or(mesh);
        let attributes = self.settings.attributes.of(mesh)?;
        let mut schedule = Schedule::default();
        let mut sequence = loop {
            let settings = &self.settings;
            let plan = Plan { oracles: &mut self.oracles, limits, settings, schedule };
            let run = match &attributes {
                None => Engine::new(mesh, &mut self.metric, plan).run(mesh, &mut progress),
                Some(attributes) => {
                    let mut metric = WithAttributes::by_default(&mut self.metric, attributes);
                    Engine::new(mesh, &mut metric, plan).run(mesh, &mut progress)
                }
            };
            match run {
                Ok(sequence) => break sequence,
                Err(earlier) => schedule = earlier,
            }
        };
        sequence.report.normals = normals;
        Ok(sequence)
    }
}
