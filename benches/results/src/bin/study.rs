//! Which metric, which placement, and which measure to trust: Southern's evaluation of simplification repeated.
//!
//! ```text
//! cargo run --release -p multires-results --bin study                            on shapes that the crate makes itself
//! cargo run --release -p multires-results --bin study -- MODEL... [OPTION...]    on yours: .obj .ply .stl .off .glb .gltf
//! ```
//!
//! Simplifies every model with eight metrics and four placements, measures levels of each (distance, volume, triangle
//! shape, differences of pictures, time), and compares: metrics, placements, and the measures with one another.
//!
//! | option | what | default |
//! |---|---|---|
//! | `--out DIR` | where the tables and charts go | `target/study` |
//! | `--steps N` | levels, the model itself among them: (N - m) / N of the triangles | 10 |
//! | `--halving` | each level half the one before instead | |
//! | `--samples N` | samples on each mesh of a distance | 20,000 |
//! | `--views N` | directions that pictures are taken from | 42 |
//! | `--size N` | pixels on a side of a picture | 128 |
//! | `--from FILE` | no models: the `levels.csv` of an earlier run | |
//!
//! Source: Southern, "Quality control tools for interactive rendering of 3D triangle meshes", chapter 4 and appendix B.
//! All that is written is the same for the same input and any number of threads, except for times.

use std::error::Error;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::str::FromStr;

use multires::io;
use multires::mesh::{Mesh, shapes};

use multires_results::study;
use multires_results::study::grid::{self, Schedule};
use multires_results::study::measure::{self, Options};

const USAGE: &str = "usage: study [MODEL...] [--out DIR] [--steps N] [--halving] [--samples N] [--views N] [--size N] \
                     [--from FILE]";

struct Arguments {
    models: Vec<PathBuf>,
    from: Option<PathBuf>,
    out: PathBuf,
    options: Options,
}

fn main() -> ExitCode {
    let arguments = match arguments() {
        Ok(arguments) => arguments,
        Err(message) => {
            say(&format!("{message}\n{USAGE}"));
            return ExitCode::from(2);
        }
    };
    match run(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            say(&format!("error: {error}"));
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let Arguments { models, from, out, options } = arguments;
    std::fs::create_dir_all(out).map_err(|error| about(out, &error))?;
    let mut rows = Vec::new();
    if let Some(file) = from {
        let text = std::fs::read_to_string(file).map_err(|error| about(file, &error))?;
        rows = grid::from_csv(&text).map_err(|error| format!("{}: {error}", file.display()))?;
    } else if models.is_empty() {
        for (name, mesh) in made() {
            rows.extend(
                measure::rows(name, &mesh, options, say).map_err(|error| format!("{name}: {error}"))?,
            );
        }
    }
    for path in models {
        let name = path.file_stem().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
        let mesh = io::read(path).map_err(|error| about(path, &error))?;
        rows.extend(measure::rows(&name, &mesh, options, say).map_err(|error| about(path, &*error))?);
        // What took long to measure is not lost to a later model.
        let levels = out.join("levels.csv");
        std::fs::write(&levels, grid::to_csv(&rows)).map_err(|error| about(&levels, &error))?;
    }
    study::write(&rows, out)?;
    say(&format!("{}: levels.csv, tables.md and the rest", out.display()));
    Ok(())
}

/// Closed shapes, smooth and rough, round and with a handle; and an open one.
fn made() -> [(&'static str, Mesh); 4] {
    [
        ("icosphere", shapes::icosphere(4)),
        ("rock", shapes::rock(6_000, 1)),
        ("torus-knot", shapes::torus_knot(2, 3, 180, 16)),
        ("terrain", shapes::terrain(57, 1)),
    ]
}

fn arguments() -> Result<Arguments, String> {
    let options = Options { views: 42, size: 128, samples: 20_000, steps: 10, schedule: Schedule::Even };
    let mut found = Arguments { models: Vec::new(), from: None, out: PathBuf::from("target/study"), options };
    let mut rest = std::env::args_os().skip(1);
    while let Some(argument) = rest.next() {
        let flag = argument.to_str().filter(|argument| argument.starts_with("--"));
        let Some(flag) = flag else {
            found.models.push(PathBuf::from(argument));
            continue;
        };
        if flag == "--halving" {
            found.options.schedule = Schedule::Halving;
            continue;
        }
        if !["--out", "--from", "--steps", "--samples", "--views", "--size"].contains(&flag) {
            return Err(format!("{flag} is not known"));
        }
        let value = rest.next().ok_or_else(|| format!("{flag} wants something after it"))?;
        let number = || {
            let text = value.to_str().unwrap_or_default();
            usize::from_str(text).map_err(|_| format!("{flag} wants a number, not {text:?}"))
        };
        match flag {
            "--out" => found.out = PathBuf::from(&value),
            "--from" => found.from = Some(PathBuf::from(&value)),
            "--steps" => found.options.steps = number()?,
            "--samples" => found.options.samples = number()?,
            "--views" => found.options.views = number()?,
            _ => found.options.size = number()?,
        }
    }
    if !(2..=100).contains(&found.options.steps) {
        return Err("--steps wants 2 to 100".into());
    }
    if found.from.is_some() && !found.models.is_empty() {
        return Err("--from takes the place of models".into());
    }
    Ok(found)
}

/// Progress and errors. Nobody listening is no reason to stop.
fn say(line: &str) {
    let _ = writeln!(std::io::stderr(), "{line}");
}

/// An error with the file it is about, once.
fn about(path: &Path, error: &dyn Error) -> String {
    let (path, message) = (path.display().to_string(), error.to_string());
    if message.contains(&path) { message } else { format!("{path}: {message}") }
}
