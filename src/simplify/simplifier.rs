//! The simplifier: its options, and a single call making the sequence.

use std::ops::ControlFlow;

use crate::mesh::{Mesh, Tolerances, names};
use crate::sequence::{CollapseSequence, NormalsDone};

use super::engine::{Engine, Plan};
use super::metric::{Batch, Borrowed, ErrorMetric, Quadric, WithAttributes};
use super::normals::Normals;
use super::options::{
    AttributeWeights, ErrorMeasure, Guard, Independence, Limits, OptionError, Order, Parts, Progress, Target,
};
use super::oracle::{Oracle, default_oracles};
use super::permissive::{Permissive, Schedule};
use super::placement::Placement;

/// Simplifies meshes: pluggable metric, placement, order and oracles.
///
/// Defaults: accumulated quadrics, endpoint placement, linear order, all oracles, down to the base mesh; normals, texture
/// coordinates and colours count where the mesh has them.
///
/// # The error
/// The error of each step, in object units, is the larger of two measured errors. Both are bounds up to
/// single-precision rounding:
///
/// - [`surface_error_after`](CollapseSequence::surface_error_after): *the largest distance from an input vertex used by
///   triangles to the level's surface*. Each merged point is tracked on the part of the surface it lies over. Its
///   distance is measured whenever this part changes.
/// - [`curve_error_after`](CollapseSequence::curve_error_after): *the largest distance from a vertex on a curve of the
///   input to the level's curve, and from a point measured along an edge of the level's curve to the input's curve*.
///   Curves are borders, non-manifold edges, borders between materials, seams, and creases of more than 41.4 degrees
///   where they outline a made object, not the relief of a scan. The level's curve is the image of the input's curve.
///   The curve error therefore counts shrinking holes, cut rims and vanishing islands, even on a flat face, where the
///   surface error is 0. A curve shrunk to a point counts with its distance from the point.
///
/// [`error_after`](CollapseSequence::error_after) is the larger of both and never decreases along the sequence. Errors
/// of at most a few units in the last place of the coordinates (2^-21 of the size of the mesh, rounded to a power of
/// two) count as 0: a target error of 0 removes redundant geometry only. Border points separated by nothing but
/// rounding ([`Tolerances::position`]) coincide from the start. Other measures: [`ErrorMeasure`].
///
/// Next to curves, and everywhere on levels of at most 4096 triangles or 1/16 of the input, places on new triangles are
/// also measured against the input, so a large triangle spanning a hollow counts. On finer levels nothing is claimed
/// between the vertices of the input or of the level's surface. By samples, the two-sided maximum is mostly within 10 %
/// of the error (`docs/performance.md` in the repository has the table).
///
/// # Determinism
/// Equal mesh and options give equal bytes, for any number of threads, with or without `parallel`.
///
/// # Cost
/// O(n) expected time for bounded valence, and O(n log n) for measuring the error; about 200 bytes per point while
/// running.
///
/// ```
/// use multires::{Placement, Simplifier, Target, mesh::shapes};
///
/// let mesh = shapes::rock(2_000, 1);
/// let mut simplifier = Simplifier::new().placement(Placement::Optimal).target(Target::Error(0.01));
/// let sequence = simplifier.run(&mesh)?;
/// assert!(sequence.report().error <= 0.01);
/// let level = sequence.extract(&mesh, sequence.len());
/// assert_eq!(level.triangles().len(), sequence.report().triangles);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Simplifier<M = Quadric> {
    metric: M,
    oracles: Vec<Box<dyn Oracle>>,
    targets: Vec<Target>,
    placements: Option<Placements>,
    settings: Settings,
}

/// Chooses the placement of each batch.
pub(super) type Placements = Box<dyn Fn(Batch) -> Placement + Send + Sync>;

/// All settings except metric, oracles and targets.
#[derive(Debug, Clone, Default)]
pub(super) struct Settings {
    pub placement: Placement,
    pub order: Order,
    pub independence: Independence,
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

    /// Returns the treatment of a mesh's normals. [`Normals::Automatic`] keeps normals where they steer collapses
    /// (chosen weights), or where all levels are made; otherwise it decides by the mesh.
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
    /// Creates a simplifier with the defaults.
    pub fn new() -> Self {
        Self {
            metric: Quadric::new(),
            oracles: default_oracles(),
            targets: Vec::new(),
            placements: None,
            settings: Settings::default(),
        }
    }
}

impl<M: ErrorMetric> Simplifier<M> {
    /// Sets the cost of a collapse. Default: [`Quadric`].
    #[must_use]
    pub fn metric<N: ErrorMetric>(self, metric: N) -> Simplifier<N> {
        let Self { oracles, targets, placements, settings, .. } = self;
        Simplifier { metric, oracles, targets, placements, settings }
    }

    /// Sets the position of merged vertices. Default: [`Placement::Endpoint`].
    #[must_use]
    pub fn placement(mut self, placement: Placement) -> Self {
        self.settings.placement = placement;
        self.placements = None;
        self
    }

    /// Sets the position of merged vertices anew for each batch: `choose` gets the batch about to start. In linear order
    /// there is a single batch. [`PerBatch`](super::metric::PerBatch) does the same for the metric.
    ///
    /// ```
    /// use multires::mesh::shapes;
    /// use multires::simplify::{Order, Placement, Simplifier};
    ///
    /// // Fine levels on the vertices of the input, coarse levels where they fit best.
    /// let sequence = Simplifier::new()
    ///     .order(Order::Batched)
    ///     .placement_per_batch(|batch| match batch.triangles {
    ///         0..500 => Placement::Optimal,
    ///         _ => Placement::Endpoint,
    ///     })
    ///     .run(&shapes::rock(2_000, 1))?;
    /// assert!(sequence.new_vertices().len() < 250);
    /// # Ok::<(), multires::simplify::OptionError>(())
    /// ```
    #[must_use]
    pub fn placement_per_batch(
        mut self,
        choose: impl Fn(Batch) -> Placement + Send + Sync + 'static,
    ) -> Self {
        self.placements = Some(Box::new(choose));
        self
    }

    /// Sets the order of collapses. Default: [`Order::Linear`].
    #[must_use]
    pub fn order(mut self, order: Order) -> Self {
        self.settings.order = order;
        self
    }

    /// Sets which collapses may share a batch of [`Order::Batched`]. Default: [`Independence::Ring`].
    #[must_use]
    pub fn independence(mut self, independence: Independence) -> Self {
        self.settings.independence = independence;
        self
    }

    /// Sets the measure of a step's error. Default: [`ErrorMeasure::Measured`].
    #[must_use]
    pub fn error_measure(mut self, measure: ErrorMeasure) -> Self {
        self.settings.measure = measure;
        self
    }

    /// Sets whether and when seams, creases, material borders and the topology may be given up. Default:
    /// [`Permissive::Auto`], only where a target size would be missed otherwise.
    #[must_use]
    pub fn permissive(mut self, permissive: Permissive) -> Self {
        self.settings.permissive = permissive;
        self
    }

    /// Adds an oracle, asked after all present oracles, or in place of the present oracle of equal name.
    #[must_use]
    pub fn oracle(mut self, oracle: impl Oracle + 'static) -> Self {
        // An oracle of equal name replaces the old oracle.
        match self.oracles.iter().position(|o| o.name() == oracle.name()) {
            Some(at) => self.oracles[at] = Box::new(oracle),
            None => self.oracles.push(Box::new(oracle)),
        }
        self
    }

    /// Replaces all oracles, defaults included.
    #[must_use]
    pub fn oracles(mut self, oracles: Vec<Box<dyn Oracle>>) -> Self {
        self.oracles = oracles;
        self
    }

    /// Adds a target; the first target reached stops the run. Default: no target, down to the base mesh.
    #[must_use]
    pub fn target(mut self, target: Target) -> Self {
        self.targets.push(target);
        self
    }

    /// Lets separate parts join across at most this distance (object units). Default 0: never.
    ///
    /// With [`Parts::Vanish`], a corner of the nearest kin moves to the far end of a vanishing part, where this end is
    /// within the distance, so less coverage is lost. With [`Parts::Keep`], points of different parts may be merged
    /// (vertex pairs, TOM 4.1). Each point is paired with the eight nearest points of other parts, found anew after
    /// each merge into it. About joined parts, oracles keeping the topology are not asked ([`Oracle::keeps_topology`]).
    #[must_use]
    pub fn join_distance(mut self, distance: f32) -> Self {
        self.settings.join_distance = distance;
        self
    }

    /// Sets the largest differences between vertices of a single wedge at a point, so noise makes no seams. Default: 1
    /// step of 16-bit storage ([`Tolerances::default`]). Nearly equal vertices are folded before the first step
    /// ([`CollapseSequence::aliases`]).
    #[must_use]
    pub fn tolerances(mut self, tolerances: Tolerances) -> Self {
        self.settings.tolerances = tolerances;
        self
    }

    /// Sets whether collapses ruining the shape are refused. Default: [`Guard::On`].
    #[must_use]
    pub fn guard(mut self, guard: Guard) -> Self {
        self.settings.guard = guard;
        self
    }

    /// Sets the treatment of normals. Default: [`Normals::Automatic`].
    #[must_use]
    pub fn normals(mut self, normals: Normals) -> Self {
        self.settings.normals = normals;
        self
    }

    /// Sets whether a separate part vanishes as a whole when this is the cheapest step. Default: [`Parts::Vanish`].
    #[must_use]
    pub fn parts(mut self, parts: Parts) -> Self {
        self.settings.parts = parts;
        self
    }

    /// Sets the attributes counted in the cost of collapses. Default: [`AttributeWeights::Customary`], normals, texture
    /// coordinates and colours where the mesh has them. A metric counting attributes by itself ([`WithAttributes`]) is
    /// left as it is.
    #[must_use]
    pub fn attributes(mut self, weights: AttributeWeights) -> Self {
        self.settings.attributes = weights;
        self
    }

    /// Simplifies a mesh.
    ///
    /// # Errors
    /// An option outside its range, an attribute missing in the mesh. Any mesh is legal.
    pub fn run(&mut self, mesh: &Mesh) -> Result<CollapseSequence, OptionError> {
        self.run_with(mesh, |_| ControlFlow::Continue(()))
    }

    /// Simplifies a mesh and reports progress every few thousand steps. Where `progress` breaks, the sequence ends; it
    /// is usable up to there.
    ///
    /// # Errors
    /// An option outside its range, an attribute missing in the mesh.
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
            let placements = self.placements.as_ref();
            let plan = Plan { oracles: &mut self.oracles, placements, limits, settings, schedule };
            let run = match &attributes {
                None => Engine::new(mesh, &mut self.metric, plan).run(mesh, &mut progress),
                Some(attributes) => {
                    let mut metric = WithAttributes::by_default(Borrowed(&mut self.metric), attributes);
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
