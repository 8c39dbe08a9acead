//! `multires info`: what is in a file.

use std::path::{Path, PathBuf};

use clap::Args;
use multires::io::{self, Format};
use multires::mesh::{Attribute, AttributeValues, Mesh, Report};
use multires::tom::{Resolution, TomMesh};
use serde_json::{Value, json};

use crate::files;
use crate::output::{Answer, Failure, Run, Table, error_text, percent};

/// Tell what is in a mesh file or a baked file.
///
/// For a mesh: counts, borders and non-manifold parts, as stored and with vertices at the same position welded;
/// attributes and their widths, materials, bounds, memory. For a baked file: its kind, the finest and the coarsest
/// level, error bounds, and memory in percent of the finest level as a plain mesh.
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
        "notes": imported.notes,
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
    Ok(Answer { json, text: table.text(), warnings: imported.notes })
}

fn baked(path: &Path) -> Result<Answer, Failure> {
    let bytes = std::fs::read(path).map_err(|e| Failure::Input(format!("{}: {e}", path.display())))?;
    let kind = io::baked_kind(&bytes).map_err(|e| files::baked(path, &e))?;
    let bundle: TomMesh = io::unbake(TomMesh::KIND, &bytes).map_err(|e| files::baked(path, &e))?;
    let tom = bundle.tom();
    let finest = bundle.mesh_at(tom.finest());
    let diagonal = finest.diagonal();
    let share = percent(bundle.memory() as f64, bundle.plain_memory() as f64);
    let marks: Vec<Value> =
        tom.error_marks().iter().map(|m| json!({ "vertices": m.vertices, "error": m.error })).collect();
    let json = json!({
        "file": path.display().to_string(),
        "format": "mres",
        "kind": kind,
        "version": io::BAKED_VERSION,
        "bytes": bytes.len(),
        "finest": level(tom.finest(), diagonal),
        "coarsest": level(tom.coarsest(), diagonal),
        "error_marks": marks,
        "attributes": attributes(&finest),
        "materials": materials(&finest),
        "bounds": finest.bounds(),
        "diagonal": diagonal,
        "memory": bundle.memory(),
        "memory_percent": share,
    });

    let mut table = Table::default();
    table.row("file", path.display());
    table.row("kind", format!("{kind}, format version {}, {} bytes", io::BAKED_VERSION, bytes.len()));
    for (label, resolution) in [("finest", tom.finest()), ("coarsest", tom.coarsest())] {
        let (vertices, triangles) = (resolution.vertices(), resolution.triangles());
        table.row(label, format!("{vertices} vertices, {triangles} triangles"));
    }
    let worst = f64::from(tom.coarsest().error());
    table.row("error of coarsest", error_text(worst, percent(worst, diagonal)));
    table.row("error marks", tom.error_marks().len());
    common_rows(&mut table, &finest);
    let share = share.map_or(String::from("-"), |p| format!("{p:.1}"));
    table.row("memory", format!("{} bytes, {share} % of the plain mesh", bundle.memory()));
    Ok(Answer { json, text: table.text(), warnings: Vec::new() })
}

/// A resolution for JSON.
pub fn level(resolution: Resolution, diagonal: f64) -> Value {
    let error = resolution.error();
    json!({
        "vertices": resolution.vertices(),
        "triangles": resolution.triangles(),
        "error": error,
        "error_percent": percent(f64::from(error), diagonal),
    })
}

/// A report's counts and what follows from them.
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

/// Ids in use, ascending, with their triangles.
fn material_counts(mesh: &Mesh) -> Vec<(u32, usize)> {
    let mut ids = mesh.materials().to_vec();
    ids.sort_unstable();
    ids.chunk_by(|a, b| a == b).map(|same| (same[0], same.len())).collect()
}

fn materials(mesh: &Mesh) -> Vec<Value> {
    let one = |(id, triangles): (u32, usize)| json!({ "id": id, "name": mesh.material_names().get(id as usize), "triangles": triangles });
    material_counts(mesh).into_iter().map(one).collect()
}

/// Materials that are listed for people; more are counted.
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
