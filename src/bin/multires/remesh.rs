//! `multires remesh`: a mesh of any connectivity as one with subdivision connectivity.

use std::path::PathBuf;
use std::time::Instant;

use clap::builder::RangedU64ValueParser;
use clap::{Args, ValueEnum};
use multires::Baked;
use multires::mesh::Mesh;
use multires::quality::{self, DistanceOptions};
use multires::remesh::{
    self, Creasing, Depth, Features, Fitting, Parameterisation, Remesher, Smoothing, Spread,
};
use multires::simplify::metric;
use multires::wavelet::{Normals, WaveletMesh, WaveletOptions};
use serde_json::{Value, json};

use crate::bake::Baking;
use crate::extract::round_down;
use crate::facts::Facts;
use crate::files;
use crate::measure::{distances, number};
use crate::model::Model;
use crate::output::{Answer, Failure, Run, Table};
use crate::prepare::Preparation;
use crate::progress::Bar;
use crate::rules::{Rules, degrees, metric_name, not_negative};
use crate::simplify;

/// Deepest level at which the distortion is measured.
const MEASURED_LEVEL: usize = 5;

/// Remesh: simplify a mesh to a base, and subdivide the base, with every new vertex at its point of the mesh.
///
/// The remesh has subdivision connectivity, as wavelets need it, and all attributes and materials of the mesh. A mesh file gets
/// the full depth; a .mres file the wavelet mesh, for `adapt`, `fly` and `extract`. Edges of the base follow borders, seams,
/// borders between materials and creases: --drop leaves out attributes whose seams are in the way.
///
/// The distortion is that of the map from the base's triangles to the mesh: 1 keeps angles, and 1 keeps relative areas.
#[derive(Args)]
pub struct Remesh {
    /// The mesh file to read.
    #[arg(value_name = "IN")]
    input: PathBuf,
    /// The mesh file to write, or the baked file (.mres); may be IN.
    #[arg(value_name = "OUT")]
    output: PathBuf,
    #[command(flatten)]
    deep: Deep,
    #[command(flatten)]
    base: Base,
    /// Cost of the collapses that make the base.
    #[arg(long, value_name = "M", default_value = METRIC, value_parser = metric_name())]
    metric: String,
    #[command(flatten)]
    preparation: Preparation,
    #[command(flatten)]
    baking: Baking,
    /// Measure the distances between IN and the remesh, both ways.
    #[arg(long)]
    measure: bool,
}

/// Metric of a remesher by default.
const METRIC: &str = "memoryless-quadric";

/// How deep the base is subdivided: one of three.
#[derive(Args, Clone)]
#[group(multiple = false)]
pub struct Deep {
    /// Split every face of the base four to one this many times, 0 to 10.
    #[arg(long, value_name = "J", value_parser = RangedU64ValueParser::<usize>::new().range(0..=10))]
    levels: Option<usize>,
    /// Split faces until the distance between mesh and remesh, measured both ways, is at most this, object units.
    #[arg(long, value_name = "E", value_parser = not_negative)]
    error: Option<f64>,
    /// Split faces until the distance between mesh and remesh, measured both ways, is at most this, in percent of the diagonal
    /// of the mesh's box.
    #[arg(long, value_name = "P", value_parser = not_negative)]
    error_percent: Option<f64>,
}

impl Deep {
    /// Whether one was given.
    pub fn is_given(&self) -> bool {
        self.levels.is_some() || self.error.is_some() || self.error_percent.is_some()
    }

    /// Refuses to remesh without a depth.
    pub fn check(&self) -> Result<(), Failure> {
        match self.is_given() {
            true => Ok(()),
            false => {
                Err(Failure::Usage("how deep: --levels, --error or --error-percent is needed".to_owned()))
            }
        }
    }

    fn depth(&self, mesh: &Mesh) -> Depth {
        let percent = self.error_percent.map(|percent| percent / 100.0 * mesh.diagonal());
        match self.error.or(percent) {
            Some(error) => Depth::Error(round_down(error)),
            None => Depth::Levels(self.levels.unwrap_or_default()),
        }
    }
}

/// Size and curves of the base.
#[derive(Args, Clone)]
pub struct Base {
    /// Faces of the base to aim at; more are left where features, the topology or the shapes of triangles forbid fewer
    /// [default: 500].
    #[arg(long = "base", value_name = "N")]
    faces: Option<usize>,
    /// Edges whose triangles' normals differ by more than this many degrees are features [default: creases of more than 41.4
    /// degrees that outline a made object].
    #[arg(long, value_name = "DEG", value_parser = degrees)]
    features: Option<f64>,
    /// Smooth the map, so that edges of the base do not show in the remesh, or leave it as it is [default: harmonic].
    #[arg(long, value_name = "S", value_enum)]
    smoothing: Option<Smooth>,
    /// Move vertices off the mesh, so that the triangles of --levels come closest to it, or leave them on it [default:
    /// least-squares].
    #[arg(long, value_name = "F", value_enum)]
    fitting: Option<Fit>,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Smooth {
    Harmonic,
    Off,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Fit {
    LeastSquares,
    Off,
}

/// Faces of the base to aim at.
const FACES: usize = 500;

impl Base {
    /// Whether nothing was given.
    pub fn is_default(&self) -> bool {
        self.faces.is_none() && self.features.is_none() && self.smoothing.is_none() && self.fitting.is_none()
    }
}

/// A remesh, and facts to report.
pub struct Remeshed {
    pub baked: Baked<WaveletMesh>,
    pub map: Parameterisation,
    pub members: Vec<(&'static str, Value)>,
    pub rows: Table,
    pub warnings: Vec<String>,
}

impl Remeshed {
    /// Remeshes with a metric given by name.
    pub fn new(
        mesh: &Mesh,
        (deep, base, metric): (&Deep, &Base, Option<&str>),
        options: &WaveletOptions,
    ) -> Result<Self, Failure> {
        let name = metric.unwrap_or(METRIC);
        let unknown = || Failure::Usage(format!("there is no metric named {name}"));
        let metric = metric::by_name(name).ok_or_else(unknown)?;
        let creasing = base.features.map_or(Creasing::Automatic, |angle| Creasing::Angle(angle as f32));
        let asked = base.faces.unwrap_or(FACES);
        let (smoothing, smoothing_name) = match base.smoothing {
            None | Some(Smooth::Harmonic) => (Smoothing::Harmonic, "harmonic"),
            Some(Smooth::Off) => (Smoothing::Off, "off"),
        };
        let (fitting, fitting_name) = match base.fitting {
            None | Some(Fit::LeastSquares) => (Fitting::LeastSquares, "least-squares"),
            Some(Fit::Off) => (Fitting::Off, "off"),
        };
        let features = Features::new().creasing(creasing);
        let remesher = Remesher::new().metric(metric).base_faces(asked).features(features);
        let mut remesher = remesher.smoothing(smoothing).fitting(fitting);
        let bar = Bar::new("mapping");
        let map = remesher.run_with(mesh, |share| bar.share(share)).map_err(Failure::input)?;
        drop(bar);
        let depth = deep.depth(mesh);
        let mut remesh = bake(&map, mesh, depth, options)?;
        let mut missed = None;
        if let Depth::Error(asked) = depth {
            (remesh, missed) = tightened(&map, mesh, asked, options, remesh)?;
        }
        let (baked, unfolded, folded) = (remesh.model, remesh.unfolded, remesh.folded);
        let depth = baked.structure().subdivision().depth();
        let level = depth.min(MEASURED_LEVEL);
        let distortion = map.distortion(mesh, level);

        let faces = map.base().triangles().len();
        let vertices = map.base().positions().len();
        let sides = (0..faces as u32).flat_map(|face| (0..3).map(move |side| (face, side)));
        let feature_sides = sides.filter(|&(face, side)| map.is_feature(face, side)).count();
        let bytes = map.memory();
        let each = bytes as f64 / mesh.triangles().len().max(1) as f64;
        let mut warnings = Vec::new();
        if faces > asked.max(1) {
            warnings
                .push(format!("the base has {faces} faces, not {asked}: {}", Rules::obstacles(map.report())));
        }
        if folded > 0 {
            warnings.push(format!("{folded} triangles face away from the mesh: folds finer than they are"));
        }
        warnings.extend(missed);
        let members = vec![
            ("metric", json!(name)),
            ("smoothing", json!(smoothing_name)),
            ("fitting", json!(fitting_name)),
            (
                "base",
                json!({ "asked": asked, "faces": faces, "vertices": vertices, "feature_sides": feature_sides }),
            ),
            ("unfolded", json!(unfolded)),
            ("folded", json!(folded)),
            ("map", json!({ "bytes": bytes, "bytes_per_triangle": each })),
            (
                "distortion",
                json!({
                    "level": level,
                    "triangles": distortion.triangles,
                    "angle": spread(&distortion.angle),
                    "area": spread(&distortion.area),
                }),
            ),
        ];
        let mut rows = Table::default();
        rows.row("base", format!("{vertices} vertices, {faces} faces, by {name}"));
        rows.row("on features", format!("{feature_sides} of {} sides of base faces", 3 * faces));
        rows.row("map", format!("{bytes} bytes, {each:.1} a triangle of the input"));
        rows.row("angles stretched by", spread_text(&distortion.angle));
        rows.row("areas stretched by", spread_text(&distortion.area));
        rows.row("folded", format!("{folded} triangles; {unfolded} unfolded"));
        Ok(Self { baked, map, members, rows, warnings })
    }
}

/// Remeshes to a depth, with a bar.
fn bake(
    map: &Parameterisation,
    mesh: &Mesh,
    depth: Depth,
    options: &WaveletOptions,
) -> Result<remesh::Remesh, Failure> {
    let bar = Bar::new("remeshing");
    map.bake_with(mesh, depth, options, |share| bar.share(share)).map_err(Failure::input)
}

/// Rounds of measuring and remeshing with a smaller tolerance.
const ROUNDS: usize = 4;

/// Remeshes with smaller tolerances until the measured distance, both ways, is at most `asked`. Also returns a warning if it
/// never is.
fn tightened(
    map: &Parameterisation,
    mesh: &Mesh,
    asked: f32,
    options: &WaveletOptions,
    mut remesh: remesh::Remesh,
) -> Result<(remesh::Remesh, Option<String>), Failure> {
    let mut tolerance = asked;
    for round in 0..=ROUNDS {
        let finest = remesh.model.structure().finest(Normals::Kept);
        let bar = Bar::new("measuring");
        let distance = quality::distance(mesh, &finest, &DistanceOptions::default());
        drop(bar);
        let found = distance.map_err(Failure::input)?.hausdorff();
        if found <= f64::from(asked) || tolerance <= 0.0 {
            return Ok((remesh, None));
        }
        if round == ROUNDS {
            let text = format!("the measured distance is {}, above the error asked for", number(found));
            return Ok((remesh, Some(text)));
        }
        tolerance *= (0.9 * f64::from(asked) / found).max(LEAST_SHARE) as f32;
        remesh = bake(map, mesh, Depth::Error(tolerance), options)?;
    }
    Ok((remesh, None))
}

/// Least share of the tolerance that the next round takes: a distance may be measured at a place that no depth changes.
const LEAST_SHARE: f64 = 0.4;

fn spread(spread: &Spread) -> Value {
    json!({ "mean": spread.mean, "p99": spread.p99 })
}

fn spread_text(spread: &Spread) -> String {
    format!("{:.3} (mean), {:.3} (99 % are below)", spread.mean, spread.p99)
}

impl Run for Remesh {
    fn run(&self) -> Result<Answer, Failure> {
        self.deep.check()?;
        self.baking.check(&self.output, self.deep.levels.is_some())?;
        let is_baked = self.output.extension().is_some_and(|e| e.eq_ignore_ascii_case("mres"));
        match is_baked {
            true => files::check_place(&self.output)?,
            false => files::check_mesh_output(&self.output)?,
        }
        let imported = files::read_mesh(&self.input)?;
        let input = files::describe(&self.input, &imported.mesh);
        let input_text = files::describe_text(&self.input, &imported.mesh);
        let mesh = self.preparation.prepared(imported.mesh)?;
        let start = Instant::now();
        let how = (&self.deep, &self.base, Some(&*self.metric));
        let remeshed = Remeshed::new(&mesh, how, &WaveletOptions::default());
        let Remeshed { baked, map, members, rows, warnings: found } =
            remeshed.map_err(|failure| failure.about(&self.input))?;
        let mut seconds = start.elapsed().as_secs_f64();
        let mut warnings = imported.notes;
        warnings.extend(found);
        let pictures = self.baking.run(&mesh, &map, baked.structure(), &self.output)?;
        drop(map);

        let finest = (self.measure || !is_baked).then(|| baked.structure().finest(Normals::Kept));
        let mut distance = None;
        if let (true, Some(finest)) = (self.measure, &finest) {
            seconds = start.elapsed().as_secs_f64();
            let bar = Bar::new("measuring");
            distance =
                Some(quality::distance(&mesh, finest, &DistanceOptions::default()).map_err(Failure::input)?);
            drop(bar);
        }
        let of = baked.structure().subdivision();
        let (levels, triangles, vertices) = (of.depth(), of.triangle_count(), of.vertex_count());
        let model = Model(Box::new(baked));
        let finest = pictures.as_ref().map(|pictures| pictures.mesh.clone()).or(finest);
        let (output, output_text) = match &finest {
            Some(finest) if pictures.is_some() => {
                if let Some(pictures) = &pictures {
                    pictures.write(&self.output)?;
                }
                (files::describe(&self.output, finest), files::describe_text(&self.output, finest))
            }
            Some(finest) if !is_baked => {
                files::write_mesh(&self.output, finest)?;
                (files::describe(&self.output, finest), files::describe_text(&self.output, finest))
            }
            _ => {
                model.0.write(&self.output).map_err(|error| files::baked(&self.output, &error))?;
                let bytes = files::size(&self.output);
                let path = self.output.display();
                (json!({ "path": path.to_string(), "bytes": bytes }), format!("{path}: {bytes} bytes"))
            }
        };
        let mut json = json!({
            "command": "remesh",
            "input": input,
            "output": output,
            "levels": levels,
            "triangles": triangles,
            "vertices": vertices,
            "distance": distance.as_ref().map(distances),
            "seconds": seconds,
            "warnings": warnings,
        });
        if let Some(pictures) = &pictures {
            json["baked"] = pictures.json.clone();
        }
        simplify::add(&mut json, members);
        let mut table = Table::default();
        table.row("input", input_text);
        table.row("output", output_text);
        if let Some(pictures) = &pictures {
            table.row("baked", &pictures.text);
        }
        table.block(rows.text());
        if is_baked {
            let facts = Facts::new(&model);
            simplify::add(&mut json, facts.members);
            table.block(facts.rows.text());
        } else {
            table.row("levels", levels);
        }
        if let Some(distance) = &distance {
            for (label, side) in [("IN to remesh", &distance.forward), ("remesh to IN", &distance.backward)] {
                let [mean, most] = [side.mean, side.max]
                    .map(|length| format!("{} ({} %)", number(length), number(distance.percent(length))));
                table.row(label, format!("{mean} on average, {most} at most"));
            }
        }
        table.row("seconds", format!("{seconds:.3}"));
        Ok(Answer { json, text: table.text(), warnings, failures: Vec::new() })
    }
}
