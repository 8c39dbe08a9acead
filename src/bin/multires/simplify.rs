//! `multires simplify`: a level of detail from a mesh.

use std::path::PathBuf;
use std::time::Instant;

use clap::{Args, ValueEnum};
use multires::mesh::{Mesh, names};
use multires::simplify::{AttributeDeviation, Growth, StopReason, Target};
use serde_json::{Value, json};

use crate::advice::Advice;
use crate::extract::round_down;
use crate::files;
use crate::output::{Answer, Failure, Run, Table, error_text, percent};
use crate::progress::Bar;
use crate::rules::{self, Rules, not_negative, share};

/// Simplify a mesh until a target is reached; with several targets, the first reached.
///
/// Seams, materials, borders and the topology are kept as far as a size asked for allows: see --permissive. If no legal
/// collapse is left before the target is reached, the mesh is written in that state, and a warning names the rules in the
/// way.
#[derive(Args)]
pub struct Simplify {
    /// The mesh file to read.
    #[arg(value_name = "IN")]
    input: PathBuf,
    /// The mesh file to write; may be IN.
    #[arg(value_name = "OUT")]
    output: PathBuf,
    #[command(flatten)]
    targets: Targets,
    /// Leave parts as large as they are where others like them vanished, instead of letting them grow to cover as much.
    #[arg(long)]
    no_growth: bool,
    #[command(flatten)]
    rules: Rules,
    /// Attribute values of the written mesh: fitted to the whole surface of the input (fitted), or its vertices' values in
    /// the input (kept).
    #[arg(long, value_name = "V", value_enum, default_value_t = Values::Fitted)]
    attribute_values: Values,
}

/// Source of attribute values.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Values {
    Fitted,
    Kept,
}

impl Values {
    fn name(self) -> &'static str {
        match self {
            Self::Fitted => "fitted",
            Self::Kept => "kept",
        }
    }
}

#[derive(Args)]
#[group(required = true, multiple = true)]
struct Targets {
    /// At most this many triangles.
    #[arg(long, value_name = "N")]
    triangles: Option<usize>,
    /// At most this many vertices.
    #[arg(long, value_name = "N")]
    vertices: Option<usize>,
    /// At most this share of the triangles, 0 to 1.
    #[arg(long, value_name = "R", value_parser = share)]
    ratio: Option<f64>,
    /// As few triangles as possible while the error stays within this, object units.
    #[arg(long, value_name = "E", value_parser = not_negative)]
    error: Option<f64>,
    /// As few triangles as possible while the error stays within this, in percent of the diagonal of the mesh's box.
    #[arg(long, value_name = "P", value_parser = not_negative)]
    error_percent: Option<f64>,
    /// At most this many bytes as an indexed mesh with 32-bit indices, all attributes and 4 bytes a number.
    #[arg(long, value_name = "B")]
    bytes: Option<usize>,
}

impl Targets {
    fn list(&self, mesh: &Mesh) -> Vec<Target> {
        let per_vertex = rules::bytes_per_vertex(mesh);
        let absolute = |percent: f64| percent / 100.0 * mesh.diagonal();
        let targets = [
            self.triangles.map(Target::Triangles),
            self.vertices.map(Target::Vertices),
            self.ratio.map(Target::Ratio),
            self.error.map(|e| Target::Error(round_down(e))),
            self.error_percent.map(|p| Target::Error(round_down(absolute(p)))),
            self.bytes.map(|bytes| Target::Bytes { bytes, per_vertex }),
        ];
        targets.into_iter().flatten().collect()
    }
}

impl Run for Simplify {
    fn run(&self) -> Result<Answer, Failure> {
        files::check_mesh_output(&self.output)?;
        let imported = files::read_mesh(&self.input)?;
        let input = files::describe(&self.input, &imported.mesh);
        let input_text = files::describe_text(&self.input, &imported.mesh);
        let mesh = self.rules.prepared(imported.mesh)?;

        let start = Instant::now();
        let place = self.rules.place();
        let mut simplifier = self.rules.simplifier(place, self.rules.normals.unwrap_or_default())?;
        let targets = self.targets.list(&mesh);
        for &target in &targets {
            simplifier = simplifier.target(target);
        }
        let bar = Bar::new("simplifying");
        let sequence = simplifier.run_with(&mesh, |progress| bar.show(progress)).map_err(Failure::input)?;
        drop(bar);
        let steps = sequence.len();
        let level = match self.attribute_values {
            Values::Fitted => sequence.extract_fitted(&mesh, steps),
            Values::Kept => sequence.extract(&mesh, steps),
        };
        let deviations = sequence.attribute_deviations(&mesh, steps, &level);
        let farthest = targets.iter().fold(f32::MAX, |least, target| match *target {
            Target::Error(error) => least.min(error),
            _ => least,
        });
        let (level, growth) = match self.no_growth {
            false => sequence.grow(&mesh, steps, level, farthest),
            true => (level, Growth::default()),
        };
        let seconds = start.elapsed().as_secs_f64();
        files::write_mesh(&self.output, &level)?;

        let report = sequence.report();
        let diagonal = mesh.diagonal();
        // Grown parts lie off the surface by as much.
        let error = report.error.max(growth.distance);
        let error_percent = percent(f64::from(error), diagonal);
        let share = percent(level.triangles().len() as f64, mesh.triangles().len() as f64);
        let mut warnings = imported.notes.clone();
        let mut advice = Vec::new();
        if matches!(report.stop, StopReason::NothingLegal | StopReason::Guard) {
            let left = level.triangles().len();
            let asked = targets.iter().map(|target| match *target {
                Target::Ratio(ratio) => Target::Triangles((ratio * mesh.triangles().len() as f64) as usize),
                other => other,
            });
            let asked: Vec<Target> = asked.collect();
            advice = Advice::find(&self.rules, place, report, &level, &asked)?;
            let (obstacles, tried) = (Rules::obstacles(report), Advice::text(&advice));
            warnings.push(format!("stopped at {left} triangles: {obstacles}{tried}"));
        }
        let mut json = json!({
            "command": "simplify",
            "input": input,
            "output": files::describe(&self.output, &level),
            "ratio": share.map(|p| p / 100.0),
            "error": error,
            "error_percent": error_percent,
            "attribute_values": self.attribute_values.name(),
            "attribute_deviations": deviations.iter().map(deviation).collect::<Vec<_>>(),
            "surface_error": report.surface_error,
            "curve_error": report.curve_error,
            "steps": report.steps,
            "stop": rules::stop_name(report.stop),
            "normals": rules::normals_done(report).0,
            "refusals": rules::refusals(report),
            "given_up": rules::given_up(report),
            "advice": Advice::json(&advice),
            "parts_removed": report.parts_removed,
            "parts_grown": growth.parts,
            "seconds": seconds,
            "warnings": warnings,
        });
        add(&mut json, self.rules.describe(place));

        let mut table = Table::default();
        table.row("input", input_text);
        table.row("output", files::describe_text(&self.output, &level));
        table.row("kept", format!("{:.2} % of the triangles", share.unwrap_or(100.0)));
        table.row("error", error_text(f64::from(error), error_percent));
        for d in &deviations {
            let unit = unit(&d.name);
            table.row(
                &format!("{} off by", d.name),
                format!("{:.3} {unit} (mean), {:.3} (most)", d.mean, d.max),
            );
        }
        let [surface, curves] = [report.surface_error, report.curve_error].map(f64::from);
        table.row("of the surface", error_text(surface, percent(surface, diagonal)));
        table.row("of its curves", error_text(curves, percent(curves, diagonal)));
        if level.attribute(names::NORMAL).is_some() {
            table.row("normals", rules::normals_done(report).1);
        }
        if report.parts_removed > 0 {
            let (removed, grown) = (report.parts_removed, growth.parts);
            table.row("parts", format!("{removed} vanished, {grown} grown in their place"));
        }
        table.row("stopped by", rules::stop_name(report.stop));
        if let Some(given_up) = rules::given_up_text(report) {
            table.row("gave", given_up);
        }
        table.row("by", self.rules.describe_text(place));
        table.row("seconds", format!("{seconds:.3}"));
        Ok(Answer { json, text: table.text(), warnings })
    }
}

/// Describes an attribute's deviation, for JSON.
fn deviation(d: &AttributeDeviation) -> Value {
    json!({ "name": d.name, "mean": d.mean, "max": d.max, "unit": unit(&d.name) })
}

/// Returns the unit of a deviation.
fn unit(name: &str) -> &'static str {
    match name {
        names::NORMAL => "degrees",
        _ if names::is_set_of(name, names::UV) => "object units",
        _ => "of a channel",
    }
}

/// Adds members to an object.
pub fn add(json: &mut Value, members: impl IntoIterator<Item = (&'static str, Value)>) {
    if let Some(object) = json.as_object_mut() {
        object.extend(members.into_iter().map(|(key, value)| (key.to_owned(), value)));
    }
}
