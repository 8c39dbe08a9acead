//! Batches of a simplification: the arguments about them, and the list of what each of them left.

use clap::{Args, ValueEnum};
use multires::mesh::Mesh;
use multires::quality;
use multires::simplify::metric::{self, Batch, ErrorMetric, PerBatch};
use multires::simplify::{CollapseSequence, Independence, Order, Placement};
use serde_json::{Value, json};

use crate::output::Failure;
use crate::rules::{Place, share};

#[derive(Args, Clone)]
pub struct Batches {
    /// Order of collapses: always the cheapest next, or batches of independent collapses [default: linear; batched for
    /// --structure gmesh].
    #[arg(long, value_name = "O", value_enum)]
    pub order: Option<Sequence>,
    /// Edges and points that a collapse takes out of its batch: all neighbours of its points, the edges of the triangles it changes, or its
    /// two points alone. Batches keep about 0.84, 0.70 and 0.59 of the triangles [default: ring; matching for --structure
    /// gmesh].
    #[arg(long, value_name = "I", value_enum)]
    pub independence: Option<Independent>,
    /// Change metric and placement between batches: once a batch starts with at most this share of the triangles, from 0 to 1.
    /// For example 0.25=quadric,0.05=lindstrom-turk/optimal.
    #[arg(long, value_name = "SHARE=METRIC[/PLACEMENT],...", value_delimiter = ',', value_parser = stage)]
    pub schedule: Vec<Stage>,
}

/// Order of collapses.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Sequence {
    Linear,
    Batched,
}

/// Edges and points that a collapse takes out of its batch.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Independent {
    Ring,
    Domain,
    Matching,
}

/// Metric and placement from a share of the triangles on.
#[derive(Clone)]
pub struct Stage {
    share: f64,
    metric: String,
    place: Option<Place>,
}

fn stage(text: &str) -> Result<Stage, String> {
    let (from, way) = text.split_once('=').ok_or(format!("{text:?} is not SHARE=METRIC[/PLACEMENT]"))?;
    let (metric, place) = way.split_once('/').map_or((way, None), |(metric, place)| (metric, Some(place)));
    if !metric::NAMES.contains(&metric) {
        return Err(format!("there is no metric named {metric:?}; there are {}", metric::NAMES.join(", ")));
    }
    let place = place.map(|place| Place::from_str(place, false)).transpose()?;
    Ok(Stage { share: share(from)?, metric: metric.to_owned(), place })
}

impl Batches {
    pub fn is_batched(&self) -> bool {
        self.order == Some(Sequence::Batched)
    }

    pub fn order(&self) -> Order {
        if self.is_batched() { Order::Batched } else { Order::Linear }
    }

    pub fn independence(&self) -> Independence {
        match self.independence {
            None | Some(Independent::Ring) => Independence::Ring,
            Some(Independent::Domain) => Independence::Domain,
            Some(Independent::Matching) => Independence::Matching,
        }
    }

    /// Refuses arguments about batches where there are none.
    pub fn check(&self) -> Result<(), Failure> {
        let given = match self {
            _ if self.is_batched() => None,
            Self { independence: Some(_), .. } => Some("--independence"),
            Self { schedule, .. } if !schedule.is_empty() => Some("--schedule"),
            _ => None,
        };
        match given {
            None => Ok(()),
            Some(option) => Err(Failure::Usage(format!("{option} is for --order batched"))),
        }
    }

    /// Returns the last stage reached at the start of a batch.
    fn stage<'a>(stages: &'a [Stage], batch: &Batch) -> Option<&'a Stage> {
        let left = batch.triangles as f64 / batch.input_triangles.max(1) as f64;
        let reached = stages.iter().filter(|stage| left <= stage.share);
        reached.min_by(|a, b| a.share.total_cmp(&b.share))
    }

    /// Returns the metric of each batch, the metric named `first` to begin with.
    pub fn metric(&self, first: &str) -> Option<Box<dyn ErrorMetric>> {
        let whole = metric::by_name(first)?;
        if self.schedule.is_empty() {
            return Some(whole);
        }
        let (stages, first) = (self.schedule.clone(), first.to_owned());
        Some(Box::new(PerBatch::new(move |batch| {
            let name = Self::stage(&stages, &batch).map_or(&first, |stage| &stage.metric);
            metric::by_name(name).unwrap_or_else(|| Box::new(metric::Quadric::new()))
        })))
    }

    /// Returns the placement of each batch, `first` to begin with; `None` if it is the same for all.
    pub fn placement(&self, first: Place) -> Option<impl Fn(Batch) -> Placement + Send + Sync + use<>> {
        if self.schedule.iter().all(|stage| stage.place.is_none()) {
            return None;
        }
        let stages = self.schedule.clone();
        Some(move |batch: Batch| {
            Self::stage(&stages, &batch).and_then(|stage| stage.place).unwrap_or(first).placement()
        })
    }

    /// Holds if some batch may make new vertices.
    pub fn makes_vertices(&self) -> bool {
        self.schedule.iter().any(|stage| stage.place.is_some_and(|place| place != Place::Endpoint))
    }

    pub fn order_name(&self) -> &'static str {
        if self.is_batched() { "batched" } else { "linear" }
    }

    /// Describes the arguments, for JSON.
    pub fn describe(&self) -> Vec<(&'static str, Value)> {
        let mut members = vec![("order", json!(self.order_name()))];
        if self.is_batched() {
            let independence = match self.independence() {
                Independence::Domain => "domain",
                Independence::Matching => "matching",
                _ => "ring",
            };
            let one = |stage: &Stage| json!({ "share": stage.share, "metric": stage.metric, "placement": stage.place.map(Place::name) });
            members.push(("independence", json!(independence)));
            members.push(("schedule", self.schedule.iter().map(one).collect()));
        }
        members
    }
}

/// Lists what each batch left: triangles, vertices, error, and volume (null for open surfaces).
pub fn list(mesh: &Mesh, sequence: &CollapseSequence) -> Value {
    let ends = sequence.batches().iter().map(|&end| end as usize);
    let one = |steps: usize| {
        let level = sequence.extract(mesh, steps);
        json!({
            "triangles": level.triangles().len(),
            "vertices": level.positions().len(),
            "error": sequence.error_after(steps),
            "volume": quality::volume(&level),
        })
    };
    std::iter::once(0).chain(ends).map(one).collect()
}
