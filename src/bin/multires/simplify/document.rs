//! glTF to glTF: every mesh of a document for itself, all else kept.

use std::path::Path;
use std::time::Instant;

use multires::CollapseSequence;
use multires::io::{GltfDocument, GltfLevels, ReadError, WriteError};
use multires::mesh::{Mesh, names};
use multires::simplify::{StopReason, Target};
use serde_json::{Value, json};

use super::common_error::{Share, steps_for_triangles};
use super::level::Level;
use super::mesh_file::path_of_level;
use super::posed::{PoseError, Poses};
use super::{LevelForm, Simplify, add, deviation};
use crate::extract::round_down;
use crate::files;
use crate::output::{Answer, Failure, Table, error_text, percent};
use crate::progress::Bar;
use crate::rules::{self, Rules};
use crate::workers;

/// Most meshes listed for people; the rest are counted.
const LISTED: usize = 16;

/// Pixels of a screen's height by which coverages are told: a level takes over where its error is a pixel.
const SCREEN: f64 = 1080.0;

/// A mesh of the document.
struct Part {
    /// Its index in the document.
    index: usize,
    /// Prepared, with the displacements of poses.
    mesh: Mesh,
    poses: Poses,
    /// Length of a unit in the scenes.
    scale: f64,
    sequence: CollapseSequence,
}

/// A level of a part.
struct Made {
    level: Level,
    poses: Vec<PoseError>,
    steps: usize,
}

/// Simplifies all meshes of a document, and writes the document.
pub fn run(command: &Simplify, input: &Path, output: &Path) -> Result<Answer, Failure> {
    let start = Instant::now();
    let mut document = GltfDocument::read(input).map_err(|error| match error {
        ReadError::Io { .. } | ReadError::UnknownFormat { .. } => Failure::input(error),
        _ => Failure::Input(format!("{}: {error}", input.display())),
    })?;
    let bytes_before = files::size(input);
    let (meshes, mut warnings) = surfaces(&document).map_err(|failure| failure.about(input))?;
    let drops = &command.rules.preparation.drop;
    let has =
        |name: &str| meshes.iter().any(|(_, mesh)| name == "material" || mesh.attribute(name).is_some());
    if let Some(name) = drops.iter().find(|name| !has(name)) {
        return Err(Failure::Input(format!("--drop: no mesh has an attribute named {name:?}")));
    }
    let [vertices, triangles] = totals(meshes.iter().map(|(_, mesh)| mesh));
    let scales = workers::each(meshes.len(), |i| document.mesh_scale(meshes[i].0));
    let diagonals = meshes.iter().zip(&scales).map(|((_, mesh), scale)| mesh.diagonal() * scale);
    let diagonal = diagonals.fold(0.0, f64::max);
    let bar = Bar::new("simplifying");
    let asked = Asked::new(command, &meshes, triangles, diagonal);
    let parts = parts(command, &document, meshes, &scales, &asked).map_err(|failure| failure.about(input))?;
    bar.begin("measuring", 0.9);

    let forms = match command.level_form {
        None | Some(LevelForm::MsftLod) => Some(GltfLevels::MsftLod),
        Some(LevelForm::Names) => Some(GltfLevels::Names),
        Some(LevelForm::Files) => None,
    };
    let shares = &command.targets.levels;
    let mut levels: Vec<Vec<Made>> = Vec::new();
    if shares.is_empty() {
        levels.push(made(command, &parts, |factors| asked.steps(&parts, factors)));
    }
    for share in shares {
        let most = (share * triangles as f64) as usize;
        levels.push(made(command, &parts, |factors| steps_for_triangles(&shares_of(&parts, factors), most)));
    }
    drop(bar);
    let refused = |error: WriteError| Failure::Input(format!("{}: {error}", output.display()));
    let write = |document: &GltfDocument, path: &Path| {
        document.write(path).map_err(|error| match error {
            WriteError::Io { .. } => Failure::input(error),
            _ => Failure::Input(format!("{}: {error}", path.display())),
        })
    };
    let mut written = Vec::new();
    if shares.is_empty() {
        replace(&mut document, &parts, &levels[0]).map_err(refused)?;
        write(&document, output)?;
        written.push(output.to_owned());
    } else if let Some(form) = forms {
        for (p, part) in parts.iter().enumerate() {
            for level in &levels {
                let made = &level[p];
                let size = part.mesh.diagonal() / f64::from(made.level.error).max(f64::MIN_POSITIVE);
                let coverage = (size / SCREEN).min(1.0);
                document.add_level(part.index, &made.level.mesh, coverage).map_err(refused)?;
            }
        }
        document.link_levels(form);
        write(&document, output)?;
        written.push(output.to_owned());
    } else {
        for (i, level) in levels.iter().enumerate() {
            let mut lighter = document.clone();
            replace(&mut lighter, &parts, level).map_err(refused)?;
            let path = path_of_level(output, i + 1);
            write(&lighter, &path)?;
            written.push(path);
        }
    }
    warnings.extend(document.notes().iter().cloned());
    for (part, made) in parts.iter().zip(levels.last().into_iter().flatten()) {
        warnings.extend(stuck(&document, part, made, &asked, shares.last().copied()));
    }
    let seconds = start.elapsed().as_secs_f64();

    let place = command.rules.place();
    let mut table = Table::default();
    table.row("input", format!("{}: {vertices} vertices, {triangles} triangles", input.display()));
    let described: Vec<Value> = levels
        .iter()
        .enumerate()
        .map(|(i, level)| {
            describe(&mut table, &document, &parts, level, &written, i, [triangles as f64, diagonal])
        })
        .collect();
    list(&mut table, &document, &parts, &levels);
    table.row("by", command.rules.describe_text(place));
    table.row("seconds", format!("{seconds:.3}"));
    let path = input.display().to_string();
    let mut json = json!({
        "command": "simplify",
        "input": { "path": path, "bytes": bytes_before, "vertices": vertices, "triangles": triangles },
        "attribute_values": command.attribute_values.name(),
        "seconds": seconds,
        "warnings": warnings,
    });
    match (shares.is_empty(), described.into_iter().next()) {
        (true, Some(Value::Object(only))) => {
            if let Some(members) = json.as_object_mut() {
                members.extend(only);
            }
        }
        _ => {
            let all = levels.iter().enumerate();
            let mut unused = Table::default();
            let all = all.map(|(i, level)| {
                describe(&mut unused, &document, &parts, level, &written, i, [triangles as f64, diagonal])
            });
            json["levels"] = all.collect();
        }
    }
    add(&mut json, command.rules.describe(place));
    Ok(Answer { json, text: table.text(), warnings, failures: Vec::new() })
}

/// Returns the meshes that have surfaces, and the notes of reading them.
fn surfaces(document: &GltfDocument) -> Result<(Vec<(usize, Mesh)>, Vec<String>), Failure> {
    let read = workers::each(document.mesh_count(), |i| document.mesh(i));
    let (mut meshes, mut notes) = (Vec::new(), Vec::new());
    for (i, imported) in read.into_iter().enumerate() {
        let Some(imported) = imported.map_err(Failure::input)? else { continue };
        // Points and lines stay, so nothing is left out.
        let told = imported.notes.into_iter().filter(|note| !note.contains("no triangles"));
        notes.extend(told.map(|note| format!("{}: {note}", name(document, i))));
        meshes.push((i, imported.mesh));
    }
    Ok((meshes, notes))
}

fn name(document: &GltfDocument, index: usize) -> String {
    match document.mesh_name(index) {
        "" => format!("mesh {index}"),
        name => format!("mesh {index} ({name})"),
    }
}

/// Returns the numbers of vertices and triangles.
fn totals<'a>(meshes: impl Iterator<Item = &'a Mesh>) -> [usize; 2] {
    let each = meshes.map(|mesh| [mesh.positions().len(), mesh.triangles().len()]);
    each.fold([0, 0], |sum, each| [sum[0] + each[0], sum[1] + each[1]])
}

/// What is asked for of all meshes together.
struct Asked {
    /// Largest error, scene units.
    error: f32,
    /// Sizes that suffice, the first reached.
    sizes: Vec<Target>,
    /// Fewest triangles of the levels asked for.
    least: usize,
}

impl Asked {
    fn new(command: &Simplify, meshes: &[(usize, Mesh)], triangles: usize, diagonal: f64) -> Self {
        let targets = &command.targets;
        let absolute = targets.error_percent.map(|p| round_down(p / 100.0 * diagonal));
        let errors = targets.error.map(round_down).into_iter().chain(absolute);
        let per_vertex = meshes.iter().map(|(_, mesh)| rules::bytes_per_vertex(mesh)).max().unwrap_or(12);
        let sizes = [
            targets.triangles.map(Target::Triangles),
            targets.ratio.map(|ratio| Target::Triangles((ratio * triangles as f64) as usize)),
            targets.vertices.map(Target::Vertices),
            targets.bytes.map(|bytes| Target::Bytes { bytes, per_vertex }),
        ];
        let sizes: Vec<Target> = sizes.into_iter().flatten().collect();
        let shares = targets.levels.iter().map(|share| (share * triangles as f64) as usize);
        let least = shares.min().unwrap_or(0);
        Self { error: errors.fold(f32::MAX, f32::min), sizes, least }
    }

    /// Returns the targets of a mesh: alone it is simplified as far as asked; among others as far as they might need.
    fn targets(&self, scale: f64, is_alone: bool) -> Vec<Target> {
        let mut targets = Vec::new();
        if self.error < f32::MAX {
            targets.push(Target::Error(round_down(f64::from(self.error) / scale)));
        }
        match (is_alone, self.sizes.is_empty()) {
            (true, false) => targets.extend(&self.sizes),
            (true, true) if self.error == f32::MAX => targets.push(Target::Triangles(self.least)),
            (false, _) if self.error == f32::MAX || !self.sizes.is_empty() => {
                targets.push(Target::Triangles(1))
            }
            _ => {}
        }
        targets
    }

    /// Returns the steps of each mesh for the sizes or the error asked for. `factors`: of errors, by poses.
    fn steps(&self, parts: &[Part], factors: &[f64]) -> Vec<usize> {
        let shares = shares_of(parts, factors);
        let all = shares.iter().map(|share| share.steps(self.error));
        if parts.len() < 2 || self.sizes.is_empty() {
            return all.collect();
        }
        let triangles = |steps: &[usize]| -> usize {
            parts.iter().zip(steps).map(|(part, &steps)| part.sequence.triangles_after(steps)).sum()
        };
        // Vertices are counted, since no formula gives them.
        let vertices = |steps: &[usize]| -> usize {
            let each = parts.iter().zip(steps).map(|(part, &steps)| part.sequence.extract(&part.mesh, steps));
            each.map(|level| level.positions().len()).sum()
        };
        let fits = |steps: &[usize]| {
            self.sizes.iter().any(|size| match *size {
                Target::Triangles(most) => triangles(steps) <= most,
                Target::Vertices(most) => vertices(steps) <= most,
                Target::Bytes { bytes, per_vertex } => {
                    12 * triangles(steps) + per_vertex * vertices(steps) <= bytes
                }
                _ => false,
            })
        };
        if let [Target::Triangles(most)] = self.sizes[..] {
            return steps_for_triangles(&shares, most);
        }
        let whole = triangles(&vec![0; parts.len()]);
        let (mut low, mut high) = (0, whole);
        while low < high {
            let middle = (low + high).div_ceil(2);
            if fits(&steps_for_triangles(&shares, middle)) { low = middle } else { high = middle - 1 }
        }
        steps_for_triangles(&shares, low)
    }
}

fn shares_of<'a>(parts: &'a [Part], factors: &[f64]) -> Vec<Share<'a>> {
    let share =
        |(part, factor): (&'a Part, &f64)| Share { sequence: &part.sequence, scale: part.scale * factor };
    parts.iter().zip(factors).map(share).collect()
}

/// Simplifies the meshes, on all cores.
fn parts(
    command: &Simplify,
    document: &GltfDocument,
    meshes: Vec<(usize, Mesh)>,
    scales: &[f64],
    asked: &Asked,
) -> Result<Vec<Part>, Failure> {
    let is_alone = meshes.len() == 1;
    let one = |place: usize| -> Result<Part, Failure> {
        let (index, mesh) = &meshes[place];
        let mut rules = command.rules.clone();
        rules.preparation.drop.retain(|name| name == "material" || mesh.attribute(name).is_some());
        let mesh = rules.prepared(mesh.clone())?;
        let poses = Poses::new(document, *index, &mesh, command.poses)?;
        let (mesh, weights) = poses.added_to(mesh, &rules.attributes)?;
        rules.attributes = weights;
        let scale = scales[place];
        let mut simplifier = rules.simplifier(rules.place(), rules.normals.unwrap_or_default())?;
        for target in asked.targets(scale, is_alone) {
            simplifier = simplifier.target(target);
        }
        let sequence = simplifier.run(&mesh).map_err(Failure::input)?;
        Ok(Part { index: *index, mesh, poses, scale, sequence })
    };
    workers::each(meshes.len(), one).into_iter().collect()
}

/// Rounds of taking errors in poses into account.
const ROUNDS: usize = 3;

/// Errors in poses that may be this much larger than the largest error of all meshes as they are.
const POSED: f64 = 1.2;

/// Makes a level of each part. `steps`: of all parts, from the factors by which their errors are larger in poses.
fn made(command: &Simplify, parts: &[Part], steps: impl Fn(&[f64]) -> Vec<usize>) -> Vec<Made> {
    let one = |p: usize, steps: usize| {
        let part = &parts[p];
        let level = Level::new(command, &part.mesh, &part.sequence, steps, f32::MAX);
        let poses = part.poses.errors(&part.mesh, &level.mesh);
        Made { level, poses, steps }
    };
    let mut factors = vec![1.0; parts.len()];
    let first = steps(&factors);
    let mut made = workers::each(parts.len(), |p| one(p, first[p]));
    for _ in 1..ROUNDS {
        let errors = parts.iter().zip(&made).map(|(part, made)| f64::from(made.level.error) * part.scale);
        let most = POSED * errors.fold(0.0, f64::max);
        let mut is_changed = false;
        for ((part, made), factor) in parts.iter().zip(&made).zip(&mut factors) {
            let posed = made.poses.iter().map(|pose| pose.error).fold(0.0, f64::max);
            let own = f64::from(made.level.error);
            if posed * part.scale > most && posed > own * *factor && own > 0.0 {
                *factor = posed / own;
                is_changed = true;
            }
        }
        if !is_changed {
            break;
        }
        let next = steps(&factors);
        let changed: Vec<usize> = (0..parts.len()).filter(|&p| next[p] != made[p].steps).collect();
        let again = workers::each(changed.len(), |i| one(changed[i], next[changed[i]]));
        for (p, level) in changed.into_iter().zip(again) {
            made[p] = level;
        }
    }
    made
}

/// Puts levels in the places of their meshes. A mesh without any step stays as it is in the file.
fn replace(document: &mut GltfDocument, parts: &[Part], levels: &[Made]) -> Result<(), WriteError> {
    for (part, made) in parts.iter().zip(levels) {
        if !made.level.mesh.triangles().is_empty() {
            document.replace(part.index, &made.level.mesh)?;
        }
    }
    Ok(())
}

/// Says why a mesh has more triangles than asked for.
fn stuck(
    document: &GltfDocument,
    part: &Part,
    made: &Made,
    asked: &Asked,
    share: Option<f64>,
) -> Option<String> {
    let report = part.sequence.report();
    let is_at_end = made.steps == part.sequence.len();
    let is_sized = share.is_some() || !asked.sizes.is_empty();
    let is_stuck = matches!(report.stop, StopReason::NothingLegal | StopReason::Guard);
    let left = made.level.mesh.triangles().len();
    // Four triangles are as few as a closed part has.
    (is_at_end && is_sized && is_stuck && left > 4).then(|| {
        format!("{}: stopped at {left} triangles: {}", name(document, part.index), Rules::obstacles(report))
    })
}

/// Describes the levels of all meshes: for people in the table, for JSON in the result.
fn describe(
    table: &mut Table,
    document: &GltfDocument,
    parts: &[Part],
    levels: &[Made],
    written: &[std::path::PathBuf],
    number: usize,
    [triangles, diagonal]: [f64; 2],
) -> Value {
    let [vertices, left] = totals(levels.iter().map(|made| &made.level.mesh));
    let path = written.get(number).or(written.last());
    let path = path.map(|path| path.display().to_string()).unwrap_or_default();
    let in_scene = |part: &Part, error: f32| f64::from(error) * part.scale;
    let largest = |of: &dyn Fn(&Part, &Made) -> f64| {
        parts.iter().zip(levels).map(|(part, made)| of(part, made)).fold(0.0, f64::max)
    };
    let error = largest(&|part, made| in_scene(part, made.level.error));
    let surface = largest(&|part, made| in_scene(part, part.sequence.surface_error_after(made.steps)));
    let curves = largest(&|part, made| in_scene(part, part.sequence.curve_error_after(made.steps)));
    let of_poses =
        |part: &Part, made: &Made| made.poses.iter().map(|pose| pose.error * part.scale).fold(0.0, f64::max);
    let posed = largest(&of_poses);
    let share = percent(left as f64, triangles);
    table.row("output", format!("{path}: {vertices} vertices, {left} triangles"));
    table.row("kept", format!("{:.2} % of the triangles", share.unwrap_or(100.0)));
    table.row("error", error_text(error, percent(error, diagonal)));
    let any_poses = levels.iter().any(|made| !made.poses.is_empty());
    if any_poses {
        table.row("in poses", error_text(posed, percent(posed, diagonal)));
    }
    let meshes = parts.iter().zip(levels).map(|(part, made)| {
        let report = part.sequence.report();
        let at_end = made.steps == part.sequence.len();
        let has_fewer = made.level.mesh.triangles().len() < part.mesh.triangles().len();
        json!({
            "mesh": part.index,
            "name": document.mesh_name(part.index),
            "triangles": made.level.mesh.triangles().len(),
            "input_triangles": part.mesh.triangles().len(),
            "vertices": made.level.mesh.positions().len(),
            "scale": part.scale,
            "error": in_scene(part, made.level.error),
            "poses": made.poses.iter().map(|pose| pose.json(part.scale)).collect::<Vec<_>>(),
            "attribute_deviations": made.level.deviations.iter()
                .filter(|d| !d.name.starts_with(names::DISPLACEMENT)).map(deviation).collect::<Vec<_>>(),
            "stop": if at_end { rules::stop_name(report.stop) } else { "target" },
            "given_up": if at_end && has_fewer { rules::given_up(report) } else { Value::Null },
            "parts_grown": made.level.growth.parts,
        })
    });
    json!({
        "output": { "path": path, "bytes": files::size(Path::new(&path)), "vertices": vertices, "triangles": left },
        "ratio": share.map(|p| p / 100.0),
        "error": error,
        "error_percent": percent(error, diagonal),
        "surface_error": surface,
        "curve_error": curves,
        "pose_error": any_poses.then_some(posed),
        "meshes": meshes.collect::<Vec<_>>(),
    })
}

/// Lists the meshes for people.
fn list(table: &mut Table, document: &GltfDocument, parts: &[Part], levels: &[Vec<Made>]) {
    if parts.len() < 2 {
        return;
    }
    for (p, part) in parts.iter().enumerate().take(LISTED) {
        let left: Vec<String> =
            levels.iter().map(|level| level[p].level.mesh.triangles().len().to_string()).collect();
        let text = format!("{} -> {} triangles", part.mesh.triangles().len(), left.join(", "));
        table.row(&format!("mesh {}", part.index), format!("{text}  {}", document.mesh_name(part.index)));
    }
    if parts.len() > LISTED {
        table.row("meshes", format!("{} in all", parts.len()));
    }
}
