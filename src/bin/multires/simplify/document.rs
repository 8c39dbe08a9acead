//! glTF to glTF: every mesh of a document for itself, all else kept.

use std::path::{Path, PathBuf};
use std::time::Instant;

use multires::CollapseSequence;
use multires::io::{GltfDocument, GltfLevels, ReadError, WriteError};
use multires::mesh::Mesh;
use serde_json::{Value, json};

use super::asked::Asked;
use super::level::Level;
use super::mesh_file::path_of_level;
use super::posed::{PoseError, Poses};
use super::told::Told;
use super::{LevelForm, Simplify, add};
use crate::files;
use crate::output::{Answer, Failure, Table};
use crate::progress::Bar;
use crate::workers;

/// Pixels of a screen's height by which coverages are told: a level takes over where its error is a pixel.
const SCREEN: f64 = 1080.0;

/// A mesh of the document.
pub struct Part {
    /// Its index in the document.
    pub index: usize,
    /// Prepared, with the displacements of poses.
    pub mesh: Mesh,
    poses: Poses,
    /// Length of a unit in the scenes.
    pub scale: f64,
    pub sequence: CollapseSequence,
}

/// A level of a part.
pub struct Made {
    pub level: Level,
    pub poses: Vec<PoseError>,
    pub steps: usize,
}

/// Simplifies all meshes of a document, and writes the document.
pub fn run(command: &Simplify, input: &Path, output: &Path) -> Result<Answer, Failure> {
    let start = Instant::now();
    let mut document = GltfDocument::read(input).map_err(|error| match error {
        ReadError::Io { .. } | ReadError::UnknownFormat { .. } => Failure::input(error),
        _ => Failure::Input(format!("{}: {error}", input.display())),
    })?;
    let bytes = files::size(input);
    let Surfaces { meshes, notes } = Surfaces::new(&document).map_err(|failure| failure.about(input))?;
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
    let asked = Asked::new(command, &meshes, triangles, diagonal);
    let bar = Bar::new("simplifying");
    let parts = parts(command, &document, meshes, &scales, &asked).map_err(|failure| failure.about(input))?;
    bar.begin("measuring", 0.9);
    let sizes = asked.levels();
    let levels =
        sizes.iter().map(|size| made(command, &parts, |factors| asked.steps(&parts, factors, *size)));
    let levels: Vec<Vec<Made>> = levels.collect();
    drop(bar);
    let written = write(command, &mut document, &parts, &levels, output)?;
    let told =
        Told { document: &document, parts: &parts, levels: &levels, written: &written, triangles, diagonal };
    let mut warnings = notes;
    warnings.extend(document.notes().iter().cloned());
    warnings.extend(told.stuck(asked.is_sized()));
    let seconds = start.elapsed().as_secs_f64();
    let mut table = Table::default();
    table.row("input", format!("{}: {vertices} vertices, {triangles} triangles", input.display()));
    let described = told.describe(&mut table);
    told.list(&mut table);
    table.row("by", command.rules.describe_text(command.rules.place()));
    table.row("seconds", format!("{seconds:.3}"));
    let path = input.display().to_string();
    let mut json = json!({
        "command": "simplify",
        "input": { "path": path, "bytes": bytes, "vertices": vertices, "triangles": triangles },
        "attribute_values": command.attribute_values.name(),
        "seconds": seconds,
        "warnings": warnings,
    });
    match (command.targets.levels.is_empty(), json.as_object_mut(), described) {
        (true, Some(members), described) => {
            members.extend(described.into_iter().filter_map(|level| level.as_object().cloned()).flatten());
        }
        (_, _, described) => json["levels"] = Value::from(described),
    }
    add(&mut json, command.rules.describe(command.rules.place()));
    Ok(Answer { json, text: table.text(), warnings, failures: Vec::new() })
}

/// Writes the levels in the form asked for; returns the files.
fn write(
    command: &Simplify,
    document: &mut GltfDocument,
    parts: &[Part],
    levels: &[Vec<Made>],
    output: &Path,
) -> Result<Vec<PathBuf>, Failure> {
    let about = |path: &Path, error: WriteError| match error {
        WriteError::Io { .. } => Failure::input(error),
        _ => Failure::Input(format!("{}: {error}", path.display())),
    };
    let form = match command.level_form {
        _ if command.targets.levels.is_empty() => {
            replace(document, parts, &levels[0]).map_err(|error| about(output, error))?;
            None
        }
        Some(LevelForm::Files) => {
            let mut written = Vec::new();
            let whole = document.clone();
            for (i, level) in levels.iter().enumerate() {
                *document = whole.clone();
                let path = path_of_level(output, i + 1);
                replace(document, parts, level).map_err(|error| about(&path, error))?;
                document.write(&path).map_err(|error| about(&path, error))?;
                written.push(path);
            }
            return Ok(written);
        }
        None | Some(LevelForm::MsftLod) => Some(GltfLevels::MsftLod),
        Some(LevelForm::Names) => Some(GltfLevels::Names),
    };
    if let Some(form) = form {
        for (p, part) in parts.iter().enumerate() {
            for made in levels.iter().map(|level| &level[p]) {
                let pixels = part.mesh.diagonal() / f64::from(made.level.error).max(f64::MIN_POSITIVE);
                let coverage = (pixels / SCREEN).min(1.0);
                let added = document.add_level(part.index, &made.level.mesh, coverage);
                added.map_err(|error| about(output, error))?;
            }
        }
        document.link_levels(form);
    }
    document.write(output).map_err(|error| about(output, error))?;
    Ok(vec![output.to_owned()])
}

/// The meshes that have triangles, and the notes of reading them.
struct Surfaces {
    /// Index in the document, and mesh.
    meshes: Vec<(usize, Mesh)>,
    notes: Vec<String>,
}

impl Surfaces {
    fn new(document: &GltfDocument) -> Result<Self, Failure> {
        let read = workers::each(document.mesh_count(), |i| document.mesh(i));
        let (mut meshes, mut notes) = (Vec::new(), Vec::new());
        for (i, imported) in read.into_iter().enumerate() {
            let Some(imported) = imported.map_err(Failure::input)? else { continue };
            // Points and lines stay, so nothing is left out.
            let told = imported.notes.into_iter().filter(|note| !note.contains("no triangles"));
            notes.extend(told.map(|note| format!("{}: {note}", name(document, i))));
            meshes.push((i, imported.mesh));
        }
        Ok(Self { meshes, notes })
    }
}

/// Names a mesh for people.
pub fn name(document: &GltfDocument, index: usize) -> String {
    match document.mesh_name(index) {
        "" => format!("mesh {index}"),
        name => format!("mesh {index} ({name})"),
    }
}

/// Returns the numbers of vertices and triangles.
pub fn totals<'a>(meshes: impl Iterator<Item = &'a Mesh>) -> [usize; 2] {
    let each = meshes.map(|mesh| [mesh.positions().len(), mesh.triangles().len()]);
    each.fold([0, 0], |sum, each| [sum[0] + each[0], sum[1] + each[1]])
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
