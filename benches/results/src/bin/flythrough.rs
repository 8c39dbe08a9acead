//! A flight past a model whose triangles follow the view: fine where the camera looks, coarse behind and beside.
//!
//! ```text
//! cargo run --release -p multires-results --bin flythrough                      a model that the crate makes itself
//! cargo run --release -p multires-results --bin flythrough -- FILE [--out DIR] [--path CSV] [--up y|z] [--px N]
//! ```
//!
//! 600 frames of 1920 x 1080 pixels at 60 degrees, from three diagonals away to a tenth and back; at most N pixels (1) of
//! error. Prints every 50th frame, and leaves in `target/flythrough/` (or DIR):
//!
//! | file | what |
//! |---|---|
//! | `frames.csv` | every frame: triangles and vertices drawn, splits tested, done and undone, time, bytes to upload |
//! | `frames.svg` | the same as a chart |
//! | `frames.png` | some frames: what the camera sees, and the same triangles from outside |
//!
//! The pictures are refined for their own size, so that their edges can be seen. A path of one's own has seven columns: the
//! frame, the eye and the target, in diagonals about the middle of the model.

use std::error::Error;
use std::fmt::Write as _;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Instant;

use glam::DVec3;
use multires::hierarchy::{HierarchyLod, HierarchyOptions, VertexHierarchy};
use multires::lod::{Baked, Lod};
use multires::mesh::{Mesh, shapes};
use multires::{Simplifier, io};
use multires_results::chart::Panel;
use multires_results::flight::{Pose, VIEWPORT};
use multires_results::outside::Shot;
use multires_results::say::{grouped, name_file};
use multires_results::sheet::Cell;
use multires_results::{chart, flight, outside, say, sheet};

/// Bytes of a triangle's indices, and of a vertex (position and normal).
const TRIANGLE: usize = 12;
const VERTEX: usize = 24;
/// Flights, to tell the time of each frame by its median.
const FLIGHTS: usize = 9;
/// Pictures are of frames at these shares of the path.
const PICTURED: [f64; 4] = [0.25, 0.42, 0.53, 0.8];
const USAGE: &str = "usage: flythrough [FILE] [--out DIR] [--path CSV] [--up y|z] [--px N]";

struct Arguments {
    model: Option<PathBuf>,
    out: PathBuf,
    path: Option<PathBuf>,
    up: DVec3,
    pixels: f32,
}

/// One frame of the flight.
#[derive(Clone, Copy)]
struct Frame {
    triangles: usize,
    vertices: usize,
    tests: usize,
    splits: usize,
    collapses: usize,
    microseconds: f64,
    bytes: usize,
}

impl Frame {
    const COLUMNS: [&str; 7] =
        ["triangles", "vertices", "tests", "splits", "collapses", "microseconds", "bytes_changed"];

    fn values(&self) -> [f64; 7] {
        let counts =
            [self.triangles, self.vertices, self.tests, self.splits, self.collapses].map(|n| n as f64);
        let [a, b, c, d, e] = counts;
        [a, b, c, d, e, self.microseconds, self.bytes as f64]
    }
}

fn main() -> ExitCode {
    match arguments() {
        Ok(arguments) => say::to_stdout(|says| run(&arguments, says)),
        Err(message) => {
            eprintln!("{message}\n{USAGE}");
            ExitCode::from(2)
        }
    }
}

fn run(arguments: &Arguments, says: &mut impl Write) -> Result<(), Box<dyn Error>> {
    let model = arguments.model.as_deref();
    let mesh = match model {
        None => shapes::demo(),
        Some(path) => io::read(path).map_err(|error| name_file(path, &error))?,
    };
    let poses = match &arguments.path {
        None => flight::approach(arguments.up),
        Some(path) => flight::read(path, arguments.up)?,
    };
    let poses: Vec<Pose> = poses.iter().map(|pose| pose.about(&mesh)).collect();
    let out = &arguments.out;
    std::fs::create_dir_all(out).map_err(|error| name_file(out, &error))?;

    // Build once.
    let start = Instant::now();
    let sequence = Simplifier::new().run(&mesh)?;
    let simplified = start.elapsed();
    let baked = Baked::<VertexHierarchy>::of_sequence(&mesh, &sequence, &HierarchyOptions::default())?;
    let total = start.elapsed();
    let positions = baked.vertices().positions();
    let hierarchy = Arc::clone(baked.structure());
    let name = model.and_then(Path::file_name).map_or("demo".into(), |name| name.to_string_lossy());
    writeln!(
        says,
        "{name}: {} triangles; built in {:.2} s, simplification {:.2} s of it; {} kB, {} bytes a triangle",
        grouped(mesh.triangles().len()),
        total.as_secs_f64(),
        simplified.as_secs_f64(),
        grouped(hierarchy.memory() / 1000),
        hierarchy.memory() / mesh.triangles().len().max(1),
    )?;
    writeln!(says, "{} frames, {} x {}, {} px\n", poses.len(), VIEWPORT[0], VIEWPORT[1], arguments.pixels)?;

    // Every flight is the same but for its time: the median of each frame's.
    let mut frames = fly(&hierarchy, &poses, arguments.pixels)?;
    let others: Result<Vec<_>, _> = (1..FLIGHTS).map(|_| fly(&hierarchy, &poses, arguments.pixels)).collect();
    let others = others?;
    for (number, frame) in frames.iter_mut().enumerate() {
        let mut times: Vec<f64> = others.iter().map(|other| other[number].microseconds).collect();
        times.push(frame.microseconds);
        times.sort_by(f64::total_cmp);
        frame.microseconds = times[FLIGHTS / 2];
    }
    table(&frames, says)?;
    let csv = out.join("frames.csv");
    std::fs::write(&csv, rows(&frames)).map_err(|error| name_file(&csv, &error))?;
    let chart = out.join("frames.svg");
    std::fs::write(&chart, draw(&frames)).map_err(|error| name_file(&chart, &error))?;
    let picture = out.join("frames.png");
    let shots = shots(&hierarchy, positions, &poses, arguments.pixels)?;
    std::fs::write(&picture, sheet::sheet(&shots, &outside::LEGEND).png(4)?)
        .map_err(|error| name_file(&picture, &error))?;
    writeln!(says, "\n{}, {} and {}", csv.display(), chart.display(), picture.display())?;
    Ok(())
}

/// The flight itself: what an engine does every frame, but for upload and drawing.
fn fly(hierarchy: &Arc<VertexHierarchy>, poses: &[Pose], pixels: f32) -> Result<Vec<Frame>, Box<dyn Error>> {
    let mut lod = HierarchyLod::packed(hierarchy.clone());
    let mut frames = Vec::with_capacity(poses.len());
    for pose in poses {
        let view = pose.view(VIEWPORT)?.with_tolerance_px(pixels);
        let start = Instant::now();
        let change = lod.adapt(&[view.of_world()], 1.0 / 60.0);
        let time = start.elapsed();
        let triangles =
            (0..lod.groups()).flat_map(|group| lod.dirty_triangles(group, 0)).map(|range| range.len());
        let vertices = lod.dirty_vertices(0).map(|range| range.len());
        frames.push(Frame {
            triangles: change.triangles,
            vertices: lod.vertices().map_or(0, <[u32]>::len),
            tests: change.cut.tests,
            splits: change.cut.splits,
            collapses: change.cut.collapses,
            microseconds: time.as_secs_f64() * 1e6,
            bytes: TRIANGLE * triangles.sum::<usize>() + VERTEX * vertices.sum::<usize>(),
        });
        lod.clean();
    }
    Ok(frames)
}

/// Some frames with the triangles that a picture of that size asks for.
fn shots(
    hierarchy: &Arc<VertexHierarchy>,
    positions: &[[f32; 3]],
    poses: &[Pose],
    pixels: f32,
) -> Result<Vec<Vec<Cell>>, Box<dyn Error>> {
    let mut lod = HierarchyLod::new(hierarchy.clone());
    let mut shots = Vec::new();
    for share in PICTURED {
        let number = (share * poses.len() as f64) as usize;
        let Some(pose) = poses.get(number) else { continue };
        let view = pose.view(sheet::SIZE.map(|n| n as u32))?.with_tolerance_px(pixels);
        lod.adapt(&[view.of_world()], 1.0 / 60.0);
        let (mut triangles, mut materials) = (Vec::new(), Vec::new());
        for group in 0..lod.groups() {
            triangles.extend_from_slice(lod.triangles(group));
            if let Some(&material) = hierarchy.materials().get(group) {
                materials.resize(triangles.len(), material);
            }
        }
        let captions = [
            format!("frame {number}"),
            format!("{} of {} triangles", grouped(triangles.len()), grouped(hierarchy.triangle_count())),
        ];
        let mesh = Mesh::new(positions, triangles)?.with_materials(materials)?;
        let shot = Shot { mesh, pose: *pose };
        let pictures = [outside::view(&shot, 1.0)?, outside::outside(&shot)?];
        let cells = pictures.into_iter().zip(captions);
        shots.push(cells.map(|(pixels, caption)| Cell { pixels, caption }).collect());
    }
    Ok(shots)
}

fn table(frames: &[Frame], says: &mut impl Write) -> std::io::Result<()> {
    writeln!(says, "   frame  triangles  vertices    tests   splits  collapses        us   kB changed")?;
    let line = |says: &mut dyn Write, name: &str, [a, b, c, d, e, time, bytes]: [f64; 7]| {
        let [a, b, c, d, e] = [a, b, c, d, e].map(|x| grouped(x.round() as usize));
        let kilobytes = bytes / 1000.0;
        writeln!(says, "{name:>8}  {a:>9}  {b:>8}  {c:>7}  {d:>7}  {e:>9}  {time:>8.1}  {kilobytes:>11.1}")
    };
    for (number, frame) in frames.iter().enumerate().step_by(50) {
        line(says, &number.to_string(), frame.values())?;
    }
    writeln!(says)?;
    // The first frame comes from the coarsest mesh: it is told above, and left out below.
    let steady = frames.get(1..).unwrap_or(&[]);
    if steady.is_empty() {
        return Ok(());
    }
    let mut sorted: [Vec<f64>; 7] = std::array::from_fn(|k| steady.iter().map(|f| f.values()[k]).collect());
    let mean = sorted.each_ref().map(|values| values.iter().sum::<f64>() / values.len() as f64);
    sorted.iter_mut().for_each(|values| values.sort_by(f64::total_cmp));
    let at =
        |share: f64| sorted.each_ref().map(|values| values[((values.len() - 1) as f64 * share) as usize]);
    line(says, "mean", mean)?;
    line(says, "median", at(0.5))?;
    line(says, "p99", at(0.99))
}

fn rows(frames: &[Frame]) -> String {
    let mut out = format!("frame,{}\n", Frame::COLUMNS.join(","));
    for (number, frame) in frames.iter().enumerate() {
        let [triangles, vertices, tests, splits, collapses, time, bytes] = frame.values();
        // Writing to a string cannot fail.
        let _ =
            writeln!(out, "{number},{triangles},{vertices},{tests},{splits},{collapses},{time:.2},{bytes}");
    }
    out
}

fn draw(frames: &[Frame]) -> String {
    // Without the first frame, which comes from the coarsest mesh.
    let value = |of: fn(&Frame) -> f64| {
        let first = frames.get(1).or(frames.first());
        first.into_iter().chain(frames.iter().skip(1)).map(of).collect::<Vec<f64>>()
    };
    let blue = "#2f6fb0";
    let panels = [
        Panel {
            title: "triangles drawn",
            lines: vec![("", blue, value(|f| f.triangles as f64))],
            holds: 1.0,
        },
        Panel {
            title: "splits tested, a frame",
            lines: vec![("", blue, value(|f| f.tests as f64))],
            holds: 1.0,
        },
        Panel {
            title: "changes a frame",
            lines: vec![
                ("splits", blue, value(|f| f.splits as f64)),
                ("collapses", "#c8703a", value(|f| f.collapses as f64)),
            ],
            holds: 1.0,
        },
        Panel {
            title: "microseconds a frame",
            lines: vec![("", blue, value(|f| f.microseconds))],
            holds: 0.98,
        },
    ];
    chart::svg(&panels, "frame")
}

fn arguments() -> Result<Arguments, String> {
    let mut all = Arguments {
        model: None,
        out: PathBuf::from("target/flythrough"),
        path: None,
        up: DVec3::Y,
        pixels: 1.0,
    };
    let mut given = std::env::args_os().skip(1);
    while let Some(argument) = given.next() {
        match argument.to_str() {
            Some("--out") => all.out = given.next().ok_or("--out wants a directory")?.into(),
            Some("--path") => all.path = Some(given.next().ok_or("--path wants a file")?.into()),
            Some("--up") => {
                all.up = match given.next().as_ref().and_then(|up| up.to_str()) {
                    Some("y") => DVec3::Y,
                    Some("z") => DVec3::Z,
                    _ => return Err("--up wants y or z".into()),
                }
            }
            Some("--px") => {
                let number = given.next().and_then(|n| n.to_str()?.parse().ok());
                all.pixels = number.filter(|n| *n > 0.0).ok_or("--px wants a number of pixels")?;
            }
            Some(flag) if flag.starts_with('-') => return Err(format!("{flag} is not known")),
            _ if all.model.is_some() => return Err("one file at a time".into()),
            _ => all.model = Some(PathBuf::from(argument)),
        }
    }
    Ok(all)
}
