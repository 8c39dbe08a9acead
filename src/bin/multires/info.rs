//! `multires info`: what is in a file.

use std::path::{Path, PathBuf};

use clap::Args;
use multires::hierarchy::{Dependencies, HierarchyMesh};
use multires::io::{self, Format};
use multires::mesh::{Attribute, AttributeValues, Mesh, Report};
use multires::tom::{Resolution, TomMesh};
use serde_json::{Value, json};

use crate::output::{Answer, Failure, Run, Table, error_text, percent};
use crate::{files, simplify};

/// Tell what is in a mesh file or a baked file.
///
/// For a mesh: counts, borders and non-manifold parts, as stored and with vertices at the same position welded;
/// attributes and their widths, materials, bounds, memory. For a baked file: its kind, the finest and the coarsest
/// level, and memory in percent of the finest level as a plain mesh; the error bounds of a totally ordered mesh; the splits
/// and dependencies of a vertex hierarchy.
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
    if kind == HierarchyMesh::KIND {
        let bundle = io::unbake(HierarchyMesh::KIND, &bytes).map_err(|e| files::baked(path, &e))?;
        return Ok(baked_hierarchy(path, bytes.len(), &bundle));
    }
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

fn baked_hierarchy(path: &Path, bytes: usize, bundle: &HierarchyMesh) -> Answer {
    let ids = bundle.hierarchy().materials();
    let name = |id: u32| bundle.vertices().material_names().get(id as usize);
    let materials: Vec<Value> = ids.iter().map(|&id| json!({ "id": id, "name": name(id) })).collect();
    let mut json = json!({
        "file": path.display().to_string(),
        "format": "mres",
        "kind": HierarchyMesh::KIND,
        "version": io::BAKED_VERSION,
        "bytes": bytes,
        "attributes": attributes(bundle.vertices()),
        "materials": materials,
        "bounds": bundle.bounds(),
        "diagonal": bundle.hierarchy().diagonal(),
    });
    simplify::add(&mut json, hierarchy(bundle));

    let mut table = Table::default();
    table.row("file", path.display());
    let version = io::BAKED_VERSION;
    table.row("kind", format!("{}, format version {version}, {bytes} bytes", HierarchyMesh::KIND));
    hierarchy_rows(&mut table, bundle);
    common_rows(&mut table, bundle.vertices());
    if !ids.is_empty() {
        table.row("materials", ids.len());
    }
    Answer { json, text: table.text(), warnings: Vec::new() }
}

/// What a hierarchy is, for JSON.
pub fn hierarchy(bundle: &HierarchyMesh) -> [(&'static str, Value); 8] {
    let hierarchy = bundle.hierarchy();
    let leaves = hierarchy.leaf_count();
    let share = percent(bundle.memory() as f64, bundle.plain_memory() as f64);
    let overhead = (leaves > 0).then(|| hierarchy.overhead() as f64 / leaves as f64);
    [
        ("splits", json!(hierarchy.split_count())),
        ("vertices", json!({ "finest": leaves, "all": hierarchy.vertex_count() })),
        ("triangles", json!(hierarchy.triangle_count())),
        ("base_triangles", json!(hierarchy.base_triangle_count())),
        ("dependencies", json!(dependencies(hierarchy.dependencies()))),
        ("memory", json!(bundle.memory())),
        ("memory_percent", json!(share)),
        // Bytes a vertex of the finest level, beyond the plain mesh's triangles.
        ("structure_bytes_per_vertex", json!(overhead)),
    ]
}

/// The same for people.
pub fn hierarchy_rows(table: &mut Table, bundle: &HierarchyMesh) {
    let hierarchy = bundle.hierarchy();
    let (leaves, triangles) = (hierarchy.leaf_count(), hierarchy.triangle_count());
    table.row("finest", format!("{leaves} vertices, {triangles} triangles"));
    table.row("coarsest", format!("{} triangles", hierarchy.base_triangle_count()));
    let made = hierarchy.vertex_count() - leaves;
    table.row("splits", format!("{}, {made} new vertices", hierarchy.split_count()));
    table.row("dependencies", dependencies(hierarchy.dependencies()));
    let share = percent(bundle.memory() as f64, bundle.plain_memory() as f64);
    let share = share.map_or(String::from("-"), |p| format!("{p:.1}"));
    let each = hierarchy.overhead() as f64 / leaves.max(1) as f64;
    let memory = bundle.memory();
    table.row("memory", format!("{memory} bytes, {share} % of the plain mesh; structure {each:.1} a vertex"));
}

fn dependencies(dependencies: Dependencies) -> &'static str {
    match dependencies {
        Dependencies::None => "none",
        Dependencies::Adjacent => "adjacent",
        Dependencies::Neighbours => "neighbours",
        _ => "other",
    }
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
