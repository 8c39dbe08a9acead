//! Every level of detail of a model: built once, walked from fine to coarse, written and drawn side by side.
//!
//! ```text
//! cargo run --release --example quickstart --features io                      a model that the crate makes itself
//! cargo run --release --example quickstart --features io -- FILE [--out DIR]  yours: .obj .ply .stl .off .glb .gltf
//! ```
//!
//! Prints a table of the levels, and leaves them as PLY files and as one picture in `target/quickstart/`.

#[path = "../src/bin/multires/canvas.rs"]
mod canvas;
#[path = "../src/bin/multires/lettering.rs"]
mod lettering;
#[path = "support/picture.rs"]
mod picture;
#[path = "support/say.rs"]
mod say;

use std::error::Error;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};

use multires::mesh::shapes;
use multires::simplify::StopReason;
use multires::tom::{Resolution, TotallyOrderedMesh};
use multires::{Level, Simplifier, io};
use picture::Shown;
use say::{grouped, name_file};

/// Levels are in the picture where their error is at most this share of the diagonal.
const PICTURED: f64 = 0.05;

/// Pixels that a level is rendered in.
const PIXELS: usize = 308;
/// The levels shown, in percent of the triangles.
const PERCENTS: [f32; 10] = [100.0, 50.0, 25.0, 10.0, 5.0, 2.0, 1.0, 0.5, 0.2, 0.1];
/// Times that an extraction is repeated for its median.
const REPEATS: usize = 15;
const USAGE: &str = "usage: quickstart [FILE] [--out DIR]";

fn main() -> ExitCode {
    let (model, out) = match arguments() {
        Ok(arguments) => arguments,
        Err(message) => {
            eprintln!("{message}\n{USAGE}");
            return ExitCode::from(2);
        }
    };
    say::to_stdout(|says| run(model.as_deref(), &out, says))
}

fn run(model: Option<&Path>, out: &Path, says: &mut impl Write) -> Result<(), Box<dyn Error>> {
    let mesh = match model {
        None => shapes::demo(),
        Some(path) => io::read(path).map_err(|error| name_file(path, &error))?,
    };
    let name = model.and_then(Path::file_name).map_or("demo".into(), |name| name.to_string_lossy());
    let diagonal = mesh.diagonal();
    writeln!(
        says,
        "{name}: {} triangles, {} vertices, diagonal {diagonal:.4}",
        grouped(mesh.triangles().len()),
        grouped(mesh.positions().len()),
    )?;

    // Build once: every collapse down to the base mesh, then all levels in one order of vertices and triangles.
    let start = Instant::now();
    let sequence = Simplifier::new().run(&mesh)?;
    let simplified = start.elapsed();
    let built = TotallyOrderedMesh::build(&mesh, &sequence)?;
    let total = start.elapsed();
    let tom = built.tom;

    let report = sequence.report();
    let why = match report.stop {
        StopReason::NothingLegal => "no legal collapse is left",
        _ => "a target was reached",
    };
    writeln!(
        says,
        "built in {}: {} collapses in {}, down to {} triangles ({why})",
        seconds(total),
        grouped(report.steps),
        seconds(simplified),
        grouped(report.triangles)
    )?;
    let plain = 24 * tom.vertex_count() + 12 * tom.triangle_count();
    writeln!(
        says,
        "all levels in {} kB, {:.1} % of the plain mesh (positions and normals, 32-bit indices)\n",
        grouped(tom.memory(24) / 1000),
        100.0 * tom.memory(24) as f64 / plain.max(1) as f64
    )?;

    writeln!(says, "     %   triangles    vertices         error   % of diagonal   extraction")?;
    std::fs::create_dir_all(out).map_err(|error| name_file(out, &error))?;
    let (mut indices, mut levels) = (Vec::new(), Vec::new());
    for percent in PERCENTS {
        // Every frame: pick a level, take its indices, upload, draw.
        let resolution = tom.at(Level::Ratio(percent / 100.0));
        let time = median(|| tom.fill_indices(resolution, &mut indices));

        // The sequence knows the same levels, and measured how far the input lies from each.
        let steps = sequence.steps_for_triangles(resolution.triangles());
        let error = sequence.error_after(steps);
        writeln!(
            says,
            "{percent:6.1}  {:>10}  {:>10}  {:>12}  {:>14}  {:>8.1} us",
            grouped(resolution.triangles()),
            grouped(resolution.vertices()),
            significant(f64::from(error)),
            if diagonal > 0.0 { format!("{:.4}", 100.0 * f64::from(error) / diagonal) } else { "-".into() },
            time.as_secs_f64() * 1e6,
        )?;
        let level = sequence.extract(&mesh, steps);
        io::write(out.join(format!("level-{percent}.ply")), &level)?;
        if f64::from(error) <= PICTURED * diagonal {
            let caption = caption(percent, resolution);
            levels.push(Shown { caption, mesh: level, colours: None, edges: 1.0 });
        }
        if resolution == tom.coarsest() {
            writeln!(says, "        the base mesh: nothing is coarser")?;
            break;
        }
    }

    let file = out.join("levels.png");
    std::fs::write(&file, picture::sheet(&mesh, PIXELS, &levels)?.png(6)?)
        .map_err(|error| name_file(&file, &error))?;
    writeln!(
        says,
        "\n{}: the levels within {} % of the diagonal; all of them as PLY beside it",
        file.display(),
        100.0 * PICTURED
    )?;
    Ok(())
}

fn caption(percent: f32, resolution: Resolution) -> String {
    format!("{percent} %   {} triangles", grouped(resolution.triangles()))
}

fn arguments() -> Result<(Option<PathBuf>, PathBuf), String> {
    let (mut model, mut out) = (None, PathBuf::from("target/quickstart"));
    let mut arguments = std::env::args_os().skip(1);
    while let Some(argument) = arguments.next() {
        match argument.to_str() {
            Some("--out") => out = arguments.next().ok_or("--out wants a directory")?.into(),
            Some(flag) if flag.starts_with('-') => return Err(format!("{flag} is not known")),
            _ if model.is_some() => return Err("one file at a time".into()),
            _ => model = Some(PathBuf::from(argument)),
        }
    }
    Ok((model, out))
}

/// The median time of some runs.
fn median(mut work: impl FnMut()) -> Duration {
    let mut times: Vec<Duration> = (0..REPEATS)
        .map(|_| {
            let start = Instant::now();
            work();
            start.elapsed()
        })
        .collect();
    times.sort_unstable();
    times[REPEATS / 2]
}

fn seconds(time: Duration) -> String {
    format!("{:.2} s", time.as_secs_f64())
}

/// Four significant digits, or zero.
fn significant(x: f64) -> String {
    if x == 0.0 {
        return "0".into();
    }
    let decimals = (3 - x.abs().log10().floor() as i32).max(0) as usize;
    if decimals < 9 { format!("{x:.decimals$}") } else { format!("{x:.3e}") }
}
