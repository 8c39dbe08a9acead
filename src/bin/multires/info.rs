//! `multires info`: what is in a file.

use std::path::{Path, PathBuf};

use clap::Args;
use multires::hierarchy::{Dependencies, HierarchyMesh};
use multires::io::{self, Format};
use multires::mesh::{Attribute, AttributeValues, Mesh, Report};
use multires::tom::{Resolution, TomMesh};
use multires::view::ErrorShape;
use multires::wavelet::{ErrorBound, WaveletMesh};
use serde_json::{Value, json};

use crate::output::{Answer, Failure, Run, Table, error_text, percent};
use crate::{files, simplify};

/// Tell what is in a mesh file or a baked file.
///
/// For a mesh: counts, borders and non-manifold parts, as stored and with vertices at the same position welded;
/// attributes and their widths, materials, bounds, memory. For a baked file: its kind, the finest and the coarsest
/// level, and memory in percent of the finest level as a plain mesh; the error bounds of a totally ordered mesh; the splits
/// and dependencies of a vertex hierarchy; the base faces, wavelets and levels of a wavelet mesh.
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
        // Rounded up: this is what --weld needs.
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
    Ok(Answer { json, text: table.text(), warnings })
}

fn baked(path: &Path) -> Result<Answer, Failure> {
    let (bytes, kind) = files::read_baked(path)?;
    if kind == HierarchyMesh::KIND {
        return Ok(baked_hierarchy(path, bytes.len(), &files::hierarchy(path, &bytes)?));
    }
    if kind == WaveletMesh::KIND {
        return Ok(baked_wavelet(path, bytes.len(), &files::wavelet(path, &bytes)?));
    }
    let bundle: TomMesh = files::tom(path, &bytes)?;
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
    let hierarchy = bundle.hierarchy();
    let file = Refined {
        kind: HierarchyMesh::KIND,
        vertices: bundle.vertices(),
        materials: hierarchy.materials(),
        bounds: bundle.bounds(),
        diagonal: hierarchy.diagonal(),
    };
    let mut table = Table::default();
    hierarchy_rows(&mut table, bundle);
    file.answer(path, bytes, &self::hierarchy(bundle), &table)
}

fn baked_wavelet(path: &Path, bytes: usize, bundle: &WaveletMesh) -> Answer {
    let file = Refined {
        kind: WaveletMesh::KIND,
        vertices: bundle.vertices(),
        materials: bundle.materials(),
        bounds: bundle.extent(),
        diagonal: bundle.diagonal(),
    };
    let mut table = Table::default();
    wavelet_rows(&mut table, bundle);
    file.answer(path, bytes, &wavelet(bundle), &table)
}

/// What structures that follow the view have in common.
struct Refined<'a> {
    kind: &'a str,
    vertices: &'a Mesh,
    materials: &'a [u32],
    bounds: Option<[[f32; 3]; 2]>,
    diagonal: f64,
}

impl Refined<'_> {
    /// With what the structure is besides.
    fn answer(&self, path: &Path, bytes: usize, members: &[(&'static str, Value)], rows: &Table) -> Answer {
        let Self { kind, vertices, materials, bounds, diagonal } = self;
        let name = |id: u32| vertices.material_names().get(id as usize);
        let list: Vec<Value> = materials.iter().map(|&id| json!({ "id": id, "name": name(id) })).collect();
        let mut json = json!({
            "file": path.display().to_string(),
            "format": "mres",
            "kind": kind,
            "version": io::BAKED_VERSION,
            "bytes": bytes,
            "attributes": attributes(vertices),
            "materials": list,
            "bounds": bounds,
            "diagonal": diagonal,
        });
        simplify::add(&mut json, members.iter().cloned());

        let mut table = Table::default();
        table.row("file", path.display());
        table.row("kind", format!("{kind}, format version {}, {bytes} bytes", io::BAKED_VERSION));
        table.block(rows.text());
        common_rows(&mut table, vertices);
        if !materials.is_empty() {
            table.row("materials", materials.len());
        }
        Answer { json, text: table.text(), warnings: Vec::new() }
    }
}

/// What a wavelet mesh is, for JSON.
pub fn wavelet(bundle: &WaveletMesh) -> [(&'static str, Value); 11] {
    let of = bundle.subdivision();
    let share = percent(bundle.memory() as f64, bundle.plain_memory() as f64);
    let vertices = of.vertex_count();
    let each = (vertices > 0).then(|| bundle.structure_memory() as f64 / vertices as f64);
    let levels = (0..=of.depth()).map(|level| {
        let end = of.wavelets_of(level).end;
        json!({
            "faces": of.faces_of(level).len(),
            "wavelets": of.wavelets_of(level).len(),
            "error": bundle.largest_left_out(|wavelet| wavelet < end),
        })
    });
    [
        ("levels", json!(of.depth())),
        ("base_triangles", json!(of.base_face_count())),
        ("wavelets", json!(of.wavelet_count())),
        ("vertices", json!(vertices)),
        ("triangles", json!(of.triangle_count())),
        ("by_level", levels.collect()),
        ("bound", json!(bound(bundle))),
        ("shape", json!(shape(bundle))),
        ("memory", json!(bundle.memory())),
        ("memory_percent", json!(share)),
        // Bytes a vertex of the finest level, beyond what the vertices are.
        ("structure_bytes_per_vertex", json!(each)),
    ]
}

/// The same for people.
pub fn wavelet_rows(table: &mut Table, bundle: &WaveletMesh) {
    let of = bundle.subdivision();
    let vertices = of.vertex_count();
    table.row("finest", format!("{vertices} vertices, {} triangles", of.triangle_count()));
    table.row("coarsest", format!("{} base faces", of.base_face_count()));
    table.row("wavelets", format!("{} on {} levels", of.wavelet_count(), of.depth()));
    for level in 0..of.depth() {
        let end = of.wavelets_of(level).end;
        let error = f64::from(bundle.largest_left_out(|wavelet| wavelet < end));
        table.row(&format!("error of level {level}"), error_text(error, percent(error, bundle.diagonal())));
    }
    table.row("bounds", format!("{}, {}", bound(bundle), shape(bundle)));
    let share = percent(bundle.memory() as f64, bundle.plain_memory() as f64);
    let share = share.map_or(String::from("-"), |p| format!("{p:.1}"));
    let each = bundle.structure_memory() as f64 / vertices.max(1) as f64;
    let memory = bundle.memory();
    table.row("memory", format!("{memory} bytes, {share} % of the plain mesh; structure {each:.1} a vertex"));
}

/// How bounds of a wavelet mesh were made.
pub fn bound(bundle: &WaveletMesh) -> &'static str {
    match bundle.options().bound {
        ErrorBound::Conservative => "conservative",
        ErrorBound::WithoutSiblings => "without-siblings",
        _ => "other",
    }
}

fn shape(bundle: &WaveletMesh) -> &'static str {
    match bundle.options().shape {
        ErrorShape::Spheroid => "spheroid",
        ErrorShape::SphereAndCones => "hoppe",
        _ => "other",
    }
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
