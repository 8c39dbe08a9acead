//! A file of any format: all its meshes as one.

use std::path::{Path, PathBuf};
use std::time::Instant;

use multires::mesh::names;
use multires::simplify::{StopReason, Target};
use serde_json::json;

use super::level::Level;
use super::{LevelForm, Simplify, add, deviation, unit};
use crate::advice::Advice;
use crate::files;
use crate::output::{Answer, Failure, Table, error_text, percent};
use crate::progress::Bar;
use crate::rules::{self, Rules};

/// Simplifies a file, and writes a mesh.
pub fn run(command: &Simplify, input: &Path, output: &Path) -> Result<Answer, Failure> {
    if !command.targets.levels.is_empty() {
        return levels(command, input, output);
    }
    let (input_path, output_path) = (input, output);
    let imported = files::read_mesh(input_path)?;
    let input = files::describe(input_path, &imported.mesh);
    let input_text = files::describe_text(input_path, &imported.mesh);
    let mesh = command.rules.prepared(imported.mesh)?;

    let start = Instant::now();
    let place = command.rules.place();
    let mut simplifier = command.rules.simplifier(place, command.rules.normals.unwrap_or_default())?;
    let targets = command.targets.list(&mesh);
    for &target in &targets {
        simplifier = simplifier.target(target);
    }
    let bar = Bar::new("simplifying");
    let sequence = simplifier.run_with(&mesh, |progress| bar.show(progress)).map_err(Failure::input)?;
    drop(bar);
    let steps = sequence.len();
    let farthest = targets.iter().fold(f32::MAX, |least, target| match *target {
        Target::Error(error) => least.min(error),
        _ => least,
    });
    let Level { mesh: level, deviations, growth, error } =
        Level::new(command, &mesh, &sequence, steps, farthest);
    let seconds = start.elapsed().as_secs_f64();
    files::write_mesh(output_path, &level)?;

    let report = sequence.report();
    let diagonal = mesh.diagonal();
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
        advice = Advice::find(&command.rules, place, report, &level, &asked)?;
        let (obstacles, tried) = (Rules::obstacles(report), Advice::text(&advice));
        warnings.push(format!("stopped at {left} triangles: {obstacles}{tried}"));
    }
    let mut json = json!({
        "command": "simplify",
        "input": input,
        "output": files::describe(output_path, &level),
        "ratio": share.map(|p| p / 100.0),
        "error": error,
        "error_percent": error_percent,
        "attribute_values": command.attribute_values.name(),
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
    add(&mut json, command.rules.describe(place));

    let mut table = Table::default();
    table.row("input", input_text);
    table.row("output", files::describe_text(output_path, &level));
    table.row("kept", format!("{:.2} % of the triangles", share.unwrap_or(100.0)));
    table.row("error", error_text(f64::from(error), error_percent));
    for d in &deviations {
        let unit = unit(&d.name);
        table.row(&format!("{} off by", d.name), format!("{:.3} {unit} (mean), {:.3} (most)", d.mean, d.max));
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
    table.row("by", command.rules.describe_text(place));
    table.row("seconds", format!("{seconds:.3}"));
    Ok(Answer { json, text: table.text(), warnings, failures: Vec::new() })
}

/// Returns the path of a level: `NAME_LOD1.EXT` beside `NAME.EXT`.
pub fn path_of_level(output: &Path, level: usize) -> PathBuf {
    let mut name = output.file_stem().unwrap_or_default().to_owned();
    name.push(format!("_LOD{level}"));
    if let Some(extension) = output.extension() {
        name.push(".");
        name.push(extension);
    }
    output.with_file_name(name)
}

/// Writes several levels of one sequence, a file each.
fn levels(command: &Simplify, input: &Path, output: &Path) -> Result<Answer, Failure> {
    if command.level_form.is_some_and(|form| form != LevelForm::Files) {
        return Err(Failure::Usage(
            "--level-form: only glTF holds several levels, from glTF to glTF".to_owned(),
        ));
    }
    let imported = files::read_mesh(input)?;
    let described = files::describe(input, &imported.mesh);
    let mut table = Table::default();
    table.row("input", files::describe_text(input, &imported.mesh));
    let mesh = command.rules.prepared(imported.mesh)?;
    let start = Instant::now();
    let place = command.rules.place();
    let simplifier = command.rules.simplifier(place, command.rules.normals.unwrap_or_default())?;
    let shares = &command.targets.levels;
    let least = shares.iter().copied().fold(1.0, f64::min);
    let bar = Bar::new("simplifying");
    let mut simplifier = simplifier.target(Target::Ratio(least));
    let sequence = simplifier.run_with(&mesh, |progress| bar.show(progress)).map_err(Failure::input)?;
    drop(bar);
    let (mut written, mut warnings) = (Vec::new(), imported.notes);
    for (i, share) in shares.iter().enumerate() {
        let asked = (share * mesh.triangles().len() as f64) as usize;
        let steps = sequence.steps_for_triangles(asked);
        let level = Level::new(command, &mesh, &sequence, steps, f32::MAX);
        let path = path_of_level(output, i + 1);
        files::write_mesh(&path, &level.mesh)?;
        if level.mesh.triangles().len() > asked {
            let (left, obstacles) = (level.mesh.triangles().len(), Rules::obstacles(sequence.report()));
            warnings.push(format!("{}: stopped at {left} triangles: {obstacles}", path.display()));
        }
        let error_percent = percent(f64::from(level.error), mesh.diagonal());
        let error = error_text(f64::from(level.error), error_percent);
        table.row("output", format!("{}, error {error}", files::describe_text(&path, &level.mesh)));
        let mut json = files::describe(&path, &level.mesh);
        json["error"] = json!(level.error);
        json["error_percent"] = json!(error_percent);
        json["ratio"] = json!(level.mesh.triangles().len() as f64 / mesh.triangles().len().max(1) as f64);
        written.push(json);
    }
    let seconds = start.elapsed().as_secs_f64();
    table.row("by", command.rules.describe_text(place));
    table.row("seconds", format!("{seconds:.3}"));
    let mut json = json!({
        "command": "simplify",
        "input": described,
        "levels": written,
        "attribute_values": command.attribute_values.name(),
        "seconds": seconds,
        "warnings": warnings,
    });
    add(&mut json, command.rules.describe(place));
    Ok(Answer { json, text: table.text(), warnings, failures: Vec::new() })
}
