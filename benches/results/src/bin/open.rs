//! Opening baked files: the tables "Opening a file" of docs/performance.md.
//!
//! ```text
//! cargo run --release -p multires-results --bin open [-- MODEL...]
//! ```
//!
//! Without models a rock of a million triangles. For each: time to build a hierarchy; time to open its file in memory,
//! checked and trusted, in place, without derived arrays, and compressed; bytes reserved by opening; time from open to the
//! first adapted instance; and bytes a vertex of the input. Times are the least of seven, in milliseconds of the wall clock.
//! With `--structures`, times of all structures that take the mesh.

use std::error::Error;
use std::hint::black_box;
use std::io::Write;
use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Instant;

use multires::io::{BakeOptions, Compression, OpenOptions, Stored, Trust};
use multires::lod::{Baked, LodOptions, Structure};
use multires::mesh::{Mesh, shapes};
use multires::view::{View, look_at};
use multires::{Gmesh, Lod, TotallyOrderedMesh, VertexHierarchy, io, wavelet::WaveletMesh};
use multires_results::say;

/// Times are the least of as many.
const RUNS: usize = 7;

fn main() -> ExitCode {
    let (flags, models): (Vec<String>, Vec<String>) =
        std::env::args().skip(1).partition(|a| a.starts_with('-'));
    if flags.iter().any(|flag| flag != "--structures") {
        eprintln!("usage: open [--structures] [MODEL...]");
        return ExitCode::from(2);
    }
    let table = |name: &str, mesh: &Mesh, says: &mut dyn Write| match flags.is_empty() {
        true => hierarchy(name, mesh, says),
        false => structures(name, mesh, says),
    };
    say::to_stdout(|says| {
        if models.is_empty() {
            return table("rock", &shapes::rock(1_000_000, 1), says);
        }
        models.iter().try_for_each(|model| {
            let path = Path::new(model);
            let mesh = io::read(path).map_err(|error| say::name_file(path, &error))?;
            let name = path.file_stem().map_or(model.clone(), |name| name.to_string_lossy().into_owned());
            table(&name, &mesh, says)
        })
    })
}

/// Least time of some calls, milliseconds.
fn least<T>(mut call: impl FnMut() -> T) -> f64 {
    let time = |_| {
        let start = Instant::now();
        let result = call();
        let time = start.elapsed().as_secs_f64() * 1e3;
        drop(black_box(result));
        time
    };
    (0..RUNS).map(time).fold(f64::INFINITY, f64::min)
}

fn open<S: Stored>(bytes: &Arc<Vec<u8>>, trust: Trust) -> Result<Baked<S>, io::BakeError> {
    Baked::from_shared(bytes.clone(), OpenOptions::default().with_trust(trust))
}

/// Time to open a file, milliseconds.
fn time_to_open<S: Stored>(bytes: &Arc<Vec<u8>>, trust: Trust) -> Result<f64, Box<dyn Error>> {
    open::<S>(bytes, trust)?;
    Ok(least(|| open::<S>(bytes, trust)))
}

/// Adapts a new instance of a model to a view of all of it. Returns the number of triangles.
fn first_frame(model: &Baked<VertexHierarchy>) -> Result<usize, Box<dyn Error>> {
    let positions = model.vertices().positions();
    let values = model.values(|vertex| positions[vertex]);
    let mut lod = model.instance(values, &LodOptions::default())?;
    let size = model.structure().diagonal() as f32;
    let camera = look_at([0.0, 0.3 * size, 1.5 * size], [0.0; 3], [0.0, 1.0, 0.0]);
    let view = View::perspective(camera, 1.0, [1920, 1080])?.of_world();
    Ok(lod.adapt(&[view], 1.0 / 60.0).triangles)
}

fn hierarchy(name: &str, mesh: &Mesh, says: &mut dyn Write) -> Result<(), Box<dyn Error>> {
    let start = Instant::now();
    let model = VertexHierarchy::bake(mesh)?;
    let build = start.elapsed().as_secs_f64() * 1e3;
    let leaves = model.structure().leaf_count();
    writeln!(says, "{name}: {} triangles, {leaves} vertices, build {build:.0} ms", mesh.triangles().len())?;
    writeln!(says, "| file | bytes a vertex | open, checked | open, trusted | build / open |")?;
    writeln!(says, "|---|--:|--:|--:|--:|")?;
    let default = BakeOptions::default();
    for (what, options) in [
        ("in place", default),
        ("in place, without derived arrays", default.with_derived(false)),
        ("compressed", default.with_compression(Compression::Lz4)),
    ] {
        let bytes = Arc::new(model.to_bytes_with(options)?);
        let [checked, trusted] =
            [Trust::Checked, Trust::Own].map(|t| time_to_open::<VertexHierarchy>(&bytes, t));
        let (checked, trusted) = (checked?, trusted?);
        let size = bytes.len() as f64 / leaves as f64;
        let share = build / checked;
        writeln!(says, "| {what} | {size:.1} | {checked:.2} | {trusted:.3} | {share:.0} |")?;
    }
    let bytes = Arc::new(model.to_bytes()?);
    let copied = least(|| Baked::<VertexHierarchy>::from_bytes(&bytes));
    writeln!(says, "copied from borrowed bytes, checked: {copied:.2} ms")?;
    let opened = open::<VertexHierarchy>(&bytes, Trust::Own)?;
    let triangles = first_frame(&opened)?;
    let frame = least(|| first_frame(&opened).ok());
    writeln!(says, "first frame after open: {frame:.2} ms, {triangles} triangles")?;
    let sections = io::baked_sections(&bytes)?;
    let packed = io::baked_sections(&model.to_bytes_with(default.with_compression(Compression::Lz4))?)?;
    writeln!(says, "bytes a vertex of each section (compressed):")?;
    for section in &sections {
        let other = packed.iter().find(|other| other.name == section.name);
        let each = |bytes: usize| bytes as f64 / leaves as f64;
        let packed = other.map_or(String::new(), |other| format!(" ({:.2})", each(other.stored)));
        writeln!(says, "    {} {:.2}{packed}", section.name, each(section.stored))?;
    }
    Ok(())
}

fn structures(name: &str, mesh: &Mesh, says: &mut dyn Write) -> Result<(), Box<dyn Error>> {
    writeln!(says, "| {name} | bytes | compressed | open, checked | open, trusted | compressed, checked |")?;
    writeln!(says, "|---|--:|--:|--:|--:|--:|")?;
    row(&VertexHierarchy::bake(mesh)?, says)?;
    row(&TotallyOrderedMesh::bake(mesh)?, says)?;
    row(&Gmesh::bake(mesh)?, says)?;
    match WaveletMesh::bake(mesh) {
        Ok(model) => row(&model, says),
        Err(error) => Ok(writeln!(says, "no wavelets: {error}")?),
    }
}

fn row<S: Stored>(model: &Baked<S>, says: &mut dyn Write) -> Result<(), Box<dyn Error>> {
    let bytes = Arc::new(model.to_bytes()?);
    let compressed = BakeOptions::default().with_compression(Compression::Lz4);
    let packed = Arc::new(model.to_bytes_with(compressed)?);
    let times = [
        time_to_open::<S>(&bytes, Trust::Checked)?,
        time_to_open::<S>(&bytes, Trust::Own)?,
        time_to_open::<S>(&packed, Trust::Checked)?,
    ]
    .map(|time| format!("{time:.2}"));
    writeln!(says, "| {} | {} | {} | {} |", S::KIND, bytes.len(), packed.len(), times.join(" | "))?;
    Ok(())
}
