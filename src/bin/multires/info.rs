//! `multires info`: the contents of a file.

use std::path::{Path, PathBuf};

use clap::Args;
use multires::io::{self, Format};
use multires::mesh::{Attribute, AttributeValues, Mesh, Report};
use serde_json::{Value, json};

use crate::facts::Facts;
use crate::model::Model;
use crate::output::{Answer, Failure, Run, Table};
use crate::{files, simplify};

/// Tell what is in a mesh file or a baked file.
///
/// For a mesh: counts, borders and non-manifold parts, as stored and with vertices at the same position welded; attributes
/// and their widths, materials, bounds, memory. For a baked file: its kind, the finest and the coarsest level, and memory
/// in percent of the finest level as a plain mesh, and sections with their sizes. Besides, for a totally ordered mesh: error bounds; for a vertex
/// hierarchy: splits and dependencies; for a wavelet mesh: base faces, wavelets and levels.
#[derive(Args)]
pub struct Info {
    /// The file.
    file: PathBuf,
}

impl Run for Info {
    fn run(&self) -> Result<Answer, Failure> {
        let extension = self.file.extension().map(|e| e.to_ascii_lowercase());
        if extension.is_some_and(|e| e == "mres") { baked(&self.file) } else { mesh(&self.file) }
    }
}

fn mesh(path: &Path) -> Result<Answer, Failure> {
    let imported = files::read_mesh(path)?;
    let mesh = &imported.mesh;
    let (stored, welded) = (Report::new(mesh), Report::welded(mesh));
    let format = Format::from_path(path).map(Format::extension);
    let mut warnings = imported.notes.clone();
    if welded.near_twins > 0 {
        // Rounded up, for use with --weld.
        let (count, distance) = (welded.near_twins, 1.01 * welded.twin_distance);
        warnings.push(format!(
            "{count} points on open borders nearly coincide with another; --weld {distance:.2e} makes them one"
        ));
    }
    let json = json!({
        "file": path.display().to_string(),
        "format": format,
        "bytes": files::size(path),
        "stored": report(&stored),
        "welded": report(&welded),
        "attributes": attributes(mesh),
        "materials": materials(mesh),
        "bounds": mesh.bounds(),
        "diagonal": mesh.diagonal(),
        "memory": mesh.memory(),
        "notes": warnings,
    });

    let mut table = Table::default();
    table.row("file", path.display()).row("format", format.unwrap_or_default());
    table.block("\nas stored").block(&stored).block("\nwelded by position").block(&welded).block("");
    common_rows(&mut table, mesh);
    match mesh.bounds() {
        Some([low, high]) => table.row("bounds", format!("{low:?} to {high:?}")),
        None => table.row("bounds", "-"),
    };
    table.row("memory", format!("{} bytes", mesh.memory()));
    Ok(Answer { json, text: table.text(), warnings, failures: Vec::new() })
}

fn baked(path: &Path) -> Result<Answer, Failure> {
    let model = Model::read(path)?;
    // Header and table are all that is needed, and were read just now.
    let file = std::fs::read(path).map_err(|error| Failure::Input(format!("{}: {error}", path.display())))?;
    let version = io::baked_version(&file).map_err(|error| files::baked(path, &error))?;
    let sections = io::baked_sections(&file).map_err(|error| files::baked(path, &error))?;
    let Facts { members, rows } = Facts::new(&model);
    let (vertices, bytes) = (model.vertices(), files::size(path));
    let name = |id: u32| vertices.material_names().get(id as usize);
    let materials = model.0.materials();
    let list: Vec<Value> = materials.iter().map(|&id| json!({ "id": id, "name": name(id) })).collect();
    let mut json = json!({
        "file": path.display().to_string(),
        "format": "mres",
        "kind": model.0.kind(),
        "version": version,
        "bytes": bytes,
        "sections": sections.iter().map(section).collect::<Vec<Value>>(),
        "attributes": attributes(vertices),
        "materials": list,
        "bounds": model.0.bounds(),
        "diagonal": model.diagonal(),
    });
    simplify::add(&mut json, members);

    let mut table = Table::default();
    table.row("file", path.display());
    let kind = model.0.kind();
    table.row("kind", format!("{kind}, format version {version}, {bytes} bytes"));
    table.block(rows.text());
    common_rows(&mut table, vertices);
    if !materials.is_empty() {
        table.row("materials", materials.len());
    }
    for section in &sections {
        let elements = section.plain / section.element;
        let plain = if section.compressed { format!(", {} in memory", section.plain) } else { String::new() };
        let (name, stored, element) = (&section.name, section.stored, section.element);
        table.row("section", format!("{name}: {elements} of {element} bytes, {stored} bytes{plain}"));
    }
    Ok(Answer { json, text: table.text(), warnings: Vec::new(), failures: Vec::new() })
}

/// Describes a section, for JSON.
fn section(section: &io::SectionInfo) -> Value {
    json!({
        "name": section.name,
        "offset": section.offset,
        "stored": section.stored,
        "plain": section.plain,
        "element": section.element,
        "compressed": section.compressed,
    })
}

/// Returns a report's counts and facts derived from them.
fn report(report: &Report) -> Value {
    let mut value = json!(report);
    if let Some(object) = value.as_object_mut() {
        object.insert("closed".to_owned(), json!(report.is_closed()));
        object.insert("manifold".to_owned(), json!(report.is_manifold()));
        object.insert("genus".to_owned(), json!(report.genus()));
    }
    value
}

fn scalar(attribute: &Attribute) -> &'static str {
    match attribute.values() {
        AttributeValues::Float(_) => "float",
        AttributeValues::Int(_) => "int",
        AttributeValues::Uint(_) => "uint",
        _ => "other",
    }
}

fn attributes(mesh: &Mesh) -> Vec<Value> {
    let one = |a: &Attribute| json!({ "name": a.name(), "type": scalar(a), "width": a.width() });
    mesh.attributes().iter().map(one).collect()
}

/// Returns ids in use, ascending, each with its number of triangles.
fn material_counts(mesh: &Mesh) -> Vec<(u32, usize)> {
    let mut ids = mesh.materials().to_vec();
    ids.sort_unstable();
    ids.chunk_by(|a, b| a == b).map(|same| (same[0], same.len())).collect()
}

fn materials(mesh: &Mesh) -> Vec<Value> {
    let one = |(id, triangles): (u32, usize)| json!({ "id": id, "name": mesh.material_names().get(id as usize), "triangles": triangles });
    material_counts(mesh).into_iter().map(one).collect()
}

/// Most materials listed for people; the rest are counted.
const LISTED: usize = 32;

fn common_rows(table: &mut Table, mesh: &Mesh) {
    for a in mesh.attributes() {
        table.row("attribute", format!("{} ({} x {})", a.name(), a.width(), scalar(a)));
    }
    let counts = material_counts(mesh);
    for &(id, triangles) in counts.iter().take(LISTED) {
        let name = mesh.material_names().get(id as usize).map_or("", String::as_str);
        table.row("material", format!("{id} {name:?}, {triangles} triangles"));
    }
    if counts.len() > LISTED {
        table.row("material", format!("... {} in all", counts.len()));
    }
}
