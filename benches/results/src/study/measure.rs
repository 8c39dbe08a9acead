//! A model simplified with every metric and every placement, and every level measured.
//!
//! Only geometry counts, as in Southern's experiment: attributes and materials are left behind, so that no seam holds a
//! collapse back. All ways share the simplifier, its order (linear) and its rules; they differ in metric and placement
//! alone.

use std::error::Error;
use std::ops::ControlFlow;
use std::time::Instant;

use multires::quality::{DistanceOptions, ShapeReport, Surface, volume};
use multires::simplify::{CollapseSequence, ErrorMeasure, ErrorMetric, OptionError, Placement, metric};
use multires::{Mesh, Simplifier, Target};

use super::grid::{
    CHANGE, L1, L2, MAX, MEASURES, METRICS, METRO, PLACEMENTS, Row, SILHOUETTE, SLIVER, Schedule, VOLUME,
};
use super::images::Images;

/// Runs of which the fastest tells the time.
const REPEATS: usize = 3;

/// What to measure with.
#[derive(Debug, Clone)]
pub struct Options {
    /// Directions that a model is seen from.
    pub views: usize,
    /// Pixels on a side of a picture.
    pub size: usize,
    /// Samples on the faces of each mesh of a distance.
    pub samples: usize,
    /// Levels, the model itself among them.
    pub steps: usize,
    /// Which levels.
    pub schedule: Schedule,
}

/// Every level of a model in every way. `say` is told of each way before it is gone.
pub fn rows(
    name: &str,
    mesh: &Mesh,
    options: &Options,
    mut say: impl FnMut(&str),
) -> Result<Vec<Row>, Box<dyn Error>> {
    let mesh = Mesh::new(mesh.positions(), mesh.triangles())?;
    let model = Model::new(&mesh, options)?;
    // From itself a surface has no distance but that of rounding.
    let mut own = model.values(&mesh)?;
    [own[METRO], own[MAX]] = [Some(0.0); 2];
    let mut rows = Vec::with_capacity(METRICS.len() * PLACEMENTS.len() * options.steps);
    for (metric, about) in METRICS.iter().enumerate() {
        for (placement, (place, place_name)) in PLACEMENTS.into_iter().enumerate() {
            say(&format!("{name}: {}, {place_name}", about.name));
            let (sequence, clock) = model.simplify(about.name, place)?;
            for step in 0..options.steps {
                let kept = options.schedule.kept(step, options.steps);
                let asked = model.asked(step);
                let collapses = if step == 0 { 0 } else { sequence.steps_for_triangles(asked) };
                let triangles = sequence.triangles_after(collapses);
                let values = match step {
                    0 => own,
                    _ if triangles > asked => [None; MEASURES.len()],
                    _ => model.values(&sequence.extract(&mesh, collapses))?,
                };
                let (model, diagonal, seconds) = (name.to_owned(), mesh.diagonal(), clock.at(triangles));
                rows.push(Row {
                    model,
                    diagonal,
                    metric,
                    placement,
                    step,
                    kept,
                    triangles,
                    collapses,
                    seconds,
                    values,
                });
            }
        }
    }
    Ok(rows)
}

/// A model, ready to have its levels measured.
struct Model<'a> {
    mesh: &'a Mesh,
    options: &'a Options,
    surface: Surface<'a>,
    volume: Option<f64>,
    images: Images,
}

impl<'a> Model<'a> {
    fn new(mesh: &'a Mesh, options: &'a Options) -> Result<Self, Box<dyn Error>> {
        let (surface, images) = (Surface::new(mesh)?, Images::new(mesh, options.views, options.size)?);
        Ok(Self { mesh, options, surface, volume: volume(mesh).filter(|&v| v != 0.0), images })
    }

    /// Triangles that a step asks for.
    fn asked(&self, step: usize) -> usize {
        let kept = self.options.schedule.kept(step, self.options.steps);
        (self.mesh.triangles().len() as f64 * kept).round() as usize
    }

    fn simplify(&self, name: &str, place: Placement) -> Result<(CollapseSequence, Clock), Box<dyn Error>> {
        let metric = metric::by_name(name).ok_or_else(|| format!("no metric is named {name}"))?;
        let last = self.asked(self.options.steps.saturating_sub(1));
        // The order of collapses alone is wanted, and the parametric measure of error costs least.
        let mut simplifier = Simplifier::new()
            .metric(metric)
            .placement(place)
            .error_measure(ErrorMeasure::Parametric)
            .target(Target::Triangles(last));
        // Whatever else the machine does only makes a run slower.
        let mut fastest = Clock::run(&mut simplifier, self.mesh)?;
        for _ in 1..REPEATS {
            let again = Clock::run(&mut simplifier, self.mesh)?;
            if again.1.total() < fastest.1.total() {
                fastest = again;
            }
        }
        Ok(fastest)
    }

    fn values(&self, level: &Mesh) -> Result<[Option<f64>; MEASURES.len()], Box<dyn Error>> {
        let mut values = [None; MEASURES.len()];
        [values[L1], values[L2], values[SILHOUETTE]] = self.images.difference(level);
        values[SLIVER] = Some(ShapeReport::new(level).sliver_mean);
        values[VOLUME] = self.volume.and_then(|whole| volume(level).map(|v| v / whole));
        values[CHANGE] = values[VOLUME].map(|ratio| (1.0 - ratio).abs());
        // A level that has lost all its surface has no distance.
        if let Ok(surface) = Surface::new(level) {
            let samples = DistanceOptions::default().with_samples(self.options.samples);
            let apart = self.surface.distance(&surface, &samples)?;
            values[METRO] = Some(apart.mean_percent());
            values[MAX] = Some(apart.hausdorff_percent());
        }
        Ok(values)
    }
}

/// How long it took until so many triangles were left.
struct Clock {
    /// Triangles and seconds, from the whole model down.
    readings: Vec<(usize, f64)>,
}

impl Clock {
    fn run<M: ErrorMetric>(
        simplifier: &mut Simplifier<M>,
        mesh: &Mesh,
    ) -> Result<(CollapseSequence, Self), OptionError> {
        let start = Instant::now();
        let mut readings = vec![(mesh.triangles().len(), 0.0)];
        let sequence = simplifier.run_with(mesh, |progress| {
            readings.push((progress.triangles, start.elapsed().as_secs_f64()));
            ControlFlow::Continue(())
        })?;
        readings.push((sequence.report().triangles, start.elapsed().as_secs_f64()));
        Ok((sequence, Self { readings }))
    }

    fn total(&self) -> f64 {
        self.readings.last().map_or(0.0, |reading| reading.1)
    }

    /// Between two readings, in proportion to the triangles.
    fn at(&self, triangles: usize) -> f64 {
        let after = self.readings.partition_point(|reading| reading.0 > triangles);
        let Some(&(low, late)) = self.readings.get(after) else {
            return self.total();
        };
        let Some(&(high, early)) = after.checked_sub(1).and_then(|before| self.readings.get(before)) else {
            return 0.0;
        };
        early + (late - early) * (high - triangles) as f64 / (high - low) as f64
    }
}
