//! A model larger than its memory, flown through: the table "From a file" of docs/results/streaming.md.
//!
//! ```text
//! cargo run --release -p multires-results --bin store [-- MODEL] [--side N] [--cache MIB] [--keep FILE]
//! ```
//!
//! Writes a store of the model, or of a terrain of N x N vertices (default 2,001: eight million triangles), and flies through it in
//! a process of its own, of which the peak of the resident memory is told. Every frame reads at most half a MiB. Each leg of the
//! flight begins with a jump to another place, where the eye stands still until nothing is wanted. Every frame's buffers are
//! checked.

use std::error::Error;
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};
use std::time::Instant;

use multires::mesh::shapes;
use multires::prelude::*;
use multires::stream::store::{Store, StoreLod, StoreOptions, write_store};
use multires::stream::{StreamOptions, StreamVertex};
use multires::view::{ObjectView, look_at};
use multires_results::say;

/// Most bytes read in a frame: 30 MiB/s at 60 frames a second.
const A_FRAME: usize = 1 << 19;
/// Legs of the flight, and frames of a leg.
const LEGS: usize = 6;
const FRAMES: usize = 120;

#[derive(Debug, Default)]
struct Arguments {
    model: Option<PathBuf>,
    side: Option<u32>,
    cache: Option<usize>,
    keep: Option<PathBuf>,
    fly: Option<PathBuf>,
}

fn arguments() -> Option<Arguments> {
    let mut found = Arguments::default();
    let mut given = std::env::args().skip(1);
    while let Some(argument) = given.next() {
        match argument.as_str() {
            "--side" => found.side = Some(given.next()?.parse().ok()?),
            "--cache" => found.cache = Some(given.next()?.parse().ok()?),
            "--keep" => found.keep = Some(given.next()?.into()),
            "--fly" => found.fly = Some(given.next()?.into()),
            flag if flag.starts_with('-') => return None,
            model => found.model = Some(model.into()),
        }
    }
    Some(found)
}

fn main() -> ExitCode {
    let Some(given) = arguments() else {
        eprintln!("usage: store [MODEL] [--side N] [--cache MIB] [--keep FILE] [--fly FILE]");
        return ExitCode::from(2);
    };
    say::to_stdout(|says| match &given.fly {
        Some(file) => fly(file, given.cache.unwrap_or(64) << 20, says),
        None => write_and_fly(&given, says),
    })
}

fn write_and_fly(given: &Arguments, says: &mut dyn Write) -> Result<(), Box<dyn Error>> {
    let mesh = match &given.model {
        Some(path) => multires::io::read(path).map_err(|error| say::name_file(path, &error))?,
        None => shapes::terrain(given.side.unwrap_or(2_001), 1),
    };
    let (vertices, triangles) = (mesh.positions().len(), mesh.triangles().len());
    let start = Instant::now();
    let model = VertexHierarchy::bake(&mesh)?;
    let baked = start.elapsed().as_secs_f64();
    drop(mesh);
    let file = given
        .keep
        .clone()
        .unwrap_or_else(|| std::env::temp_dir().join(format!("multires-{}.store", std::process::id())));
    let options = StoreOptions::default().with_scalars(StreamOptions::default().with_position_bits(Some(20)));
    let start = Instant::now();
    write_store(&model, &options, &mut File::create(&file)?)?;
    let written = start.elapsed().as_secs_f64();
    drop(model);
    let bytes = std::fs::metadata(&file)?.len();
    writeln!(
        says,
        "{triangles} triangles, {vertices} vertices: baked in {baked:.1} s, written in {written:.1} s, {bytes} bytes, {:.1} a vertex",
        bytes as f64 / vertices as f64
    )?;
    says.flush()?;
    let mut child = Command::new(std::env::current_exe()?);
    child.arg("--fly").arg(&file).args(["--cache", &given.cache.unwrap_or(64).to_string()]);
    let done = child.output();
    if given.keep.is_none() {
        std::fs::remove_file(&file)?;
    }
    let done = done?;
    says.write_all(&done.stdout)?;
    match done.status.success() {
        true => Ok(()),
        false => Err(String::from_utf8_lossy(&done.stderr).into_owned().into()),
    }
}

/// Largest resident memory of this process so far, MiB; `None` where the system does not tell.
fn peak_memory() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    Some(line.trim().strip_suffix(" kB")?.trim().parse::<f64>().ok()? / 1024.0)
}

/// A view from a place over the model: around it in a circle for legs, at another place for each leg.
fn view(bounds: [[f32; 3]; 2], leg: usize, frame: usize) -> Result<ObjectView, Box<dyn Error>> {
    let size: [f32; 3] = std::array::from_fn(|axis| bounds[1][axis] - bounds[0][axis]);
    let middle: [f32; 3] = std::array::from_fn(|axis| 0.5 * (bounds[0][axis] + bounds[1][axis]));
    let angle = leg as f32 * 2.4 + frame as f32 * 0.3 / FRAMES as f32;
    let place = |angle: f32, height: f32| {
        let reach = 0.15 + 0.05 * leg as f32;
        [
            middle[0] + reach * size[0] * angle.cos(),
            bounds[0][1] + height * size[1],
            middle[2] + reach * size[2] * angle.sin(),
        ]
    };
    let camera = look_at(place(angle, 0.9), place(angle + 0.3, 0.6), [0.0, 1.0, 0.0]);
    Ok(View::perspective(camera, 60_f32.to_radians(), [1920, 1080])?.with_tolerance_px(1.0).of_world())
}

/// Checks that the buffers are a mesh.
fn check(lod: &dyn Lod) -> Result<(), String> {
    let slots = lod.vertices().map_or(0, <[u32]>::len) as u32;
    let is_fine =
        |t: &[u32; 3]| t.iter().all(|&at| at < slots) && t[0] != t[1] && t[1] != t[2] && t[2] != t[0];
    match lod.triangles(0).iter().all(is_fine) {
        true => Ok(()),
        false => Err("a frame's buffers are no mesh".into()),
    }
}

type Positions = StoreLod<[f32; 3], fn(StreamVertex<'_>) -> [f32; 3]>;

/// Adapts to a view and reads what is wanted. Returns the bytes read, and the time, milliseconds.
fn frame(lod: &mut Positions, file: &mut File, view: &ObjectView) -> Result<(usize, f64), Box<dyn Error>> {
    let start = Instant::now();
    lod.adapt(std::slice::from_ref(view), 1.0 / 60.0);
    let read = lod.fetch(file, A_FRAME)?;
    let time = start.elapsed().as_secs_f64() * 1e3;
    check(lod)?;
    lod.clean();
    Ok((read, time))
}

fn fly(path: &Path, cache: usize, says: &mut dyn Write) -> Result<(), Box<dyn Error>> {
    let mut file = File::open(path)?;
    let start = Instant::now();
    let store = Store::open(&mut file)?;
    let mut lod: Positions = store.instance(cache, &LodOptions::default(), |vertex| vertex.position());
    writeln!(
        says,
        "opened in {:.1} ms, {} pages, header {} bytes, instance {} bytes",
        start.elapsed().as_secs_f64() * 1e3,
        store.page_count(),
        store.memory(),
        lod.memory()
    )?;
    writeln!(
        says,
        "| leg | frames after the jump | their ms | bytes | bytes of the leg | mean frame, ms | worst, ms | triangles | cache, bytes |"
    )?;
    writeln!(says, "|--:|--:|--:|--:|--:|--:|--:|--:|--:|")?;
    let bounds = store.bounds();
    for leg in 0..LEGS {
        let (mut bytes, mut total, mut worst) = (0, 0.0, 0.0_f64);
        let (mut jump, mut still) = (0, 0.0);
        for at in 0.. {
            let (read, time) = frame(&mut lod, &mut file, &view(bounds, leg, 0)?)?;
            bytes += read;
            jump = bytes;
            still += time;
            worst = worst.max(time);
            if lod.wanted().is_empty() {
                write!(says, "| {leg} | {} | {still:.0} | {jump} ", at + 1)?;
                break;
            }
        }
        for at in 0..FRAMES {
            let (read, time) = frame(&mut lod, &mut file, &view(bounds, leg, at)?)?;
            bytes += read;
            total += time;
            worst = worst.max(time);
        }
        writeln!(
            says,
            "| {} | {:.1} | {worst:.1} | {} | {} |",
            bytes - jump,
            total / FRAMES as f64,
            lod.triangles(0).len(),
            lod.cached_bytes()
        )?;
    }
    writeln!(says, "memory of the instance {} bytes", lod.memory())?;
    if let Some(peak) = peak_memory() {
        writeln!(says, "peak of resident memory {peak:.0} MiB, cache {} MiB", cache >> 20)?;
    }
    Ok(())
}
