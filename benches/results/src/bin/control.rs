//! Charts of docs/results/control.md: a crowd under a bias, a street under stress. Tables of docs/performance.md: batches
//! against linear order, memory of a g-mesh.
//!
//! ```text
//! cargo run --release -p multires-results --bin control [-- --out DIR]
//! cargo run --release -p multires-results --bin control -- --batches MODEL... [--samples N]
//! ```
//!
//! The first leaves `bias.svg`, `stress.svg` and the numbers as `bias.csv` and `stress.csv` in `target/control/` (or DIR), and
//! prints the memory of the crowd's g-mesh. The card is simulated, so the bytes are the same on every machine. The second prints
//! for each level of a g-mesh the reported error and the mean distance (by samples, 300,000 a mesh), as multiples of what linear
//! order has at as many triangles.

#[path = "../../../../examples/support/crowd.rs"]
mod crowd;

use std::error::Error;
use std::fmt::Write as _;
use std::io::Write;
use std::path::Path;
use std::process::ExitCode;

use multires::control::Stairs;
use multires::gmesh::{GmeshBuilder, Morph, Partition};
use multires::mesh::shapes;
use multires::prelude::*;
use multires::quality::{DistanceOptions, Surface};
use multires_results::chart::{Panel, svg};
use multires_results::say;

const USAGE: &str = "usage: control [--out DIR] | --batches MODEL... [--samples N]";
/// Levels of a g-mesh compared with linear order.
const COMPARED: usize = 6;
/// Bytes of a vertex with position, normal and texture coordinates.
const VERTEX: usize = 32;
const COLOURS: [&str; 3] = ["#8a919c", "#2563c9", "#c9432a"];

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let samples = |n: &String| n.parse::<usize>().ok();
    match &arguments[..] {
        [] => say::to_stdout(|says| run(Path::new("target/control"), says)),
        [flag, out] if flag == "--out" => say::to_stdout(|says| run(Path::new(out), says)),
        [flag, models @ .., samples_flag, n]
            if flag == "--batches" && samples_flag == "--samples" && !models.is_empty() =>
        {
            let Some(samples) = samples(n) else { return usage() };
            say::to_stdout(|says| models.iter().try_for_each(|model| batches(model, samples, says)))
        }
        [flag, models @ ..] if flag == "--batches" && is_list(models) => {
            say::to_stdout(|says| models.iter().try_for_each(|model| batches(model, 300_000, says)))
        }
        _ => usage(),
    }
}

/// Holds for at least one name and no flag.
fn is_list(models: &[String]) -> bool {
    !models.is_empty() && models.iter().all(|model| !model.starts_with('-'))
}

fn usage() -> ExitCode {
    eprintln!("{USAGE}");
    ExitCode::from(2)
}

fn run(out: &Path, says: &mut impl Write) -> Result<(), Box<dyn Error>> {
    std::fs::create_dir_all(out)?;
    bias(out, says)?;
    stress(out, says)
}

fn bias(out: &Path, says: &mut impl Write) -> Result<(), Box<dyn Error>> {
    let simplifier = Gmesh::simplifier().target(Target::Triangles(200));
    let model = GmeshBuilder::new().simplifier(simplifier).bake(&shapes::rock(10_000, 5))?;
    let stairs = Stairs::of_gmesh(model.structure(), &Partition::by_error(model.structure()))?;
    memory(model.structure(), says)?;
    let tolerance = stairs.largest_step();
    let names = ["no control", "0.01 a frame", "0.1 a frame"];
    let mut panels = Vec::new();
    let mut csv = "path,frame,uncontrolled,slow,quick,bias_slow,bias_quick\n".to_owned();
    let titles = ["Circle: thousands of triangles drawn", "Through the middle: thousands of triangles drawn"];
    for ((name, path, wanted), title) in crowd::PATHS.into_iter().zip(titles) {
        let runs = [None, Some(0.01), Some(0.1)].map(|change| crowd::biased(&stairs, path, change, wanted));
        let frames = runs[0].iter().zip(&runs[1]).zip(&runs[2]).enumerate();
        for (frame, (((free, _), (slowly, slow)), (quickly, quick))) in frames {
            writeln!(csv, "{name},{frame},{free},{slowly},{quickly},{slow:.4},{quick:.4}")?;
        }
        for (run, name) in runs.iter().zip(names) {
            let outside = |from: usize| {
                run.iter().skip(from).filter(|frame| frame.0.abs_diff(wanted) > tolerance).count()
            };
            let above = run.iter().filter(|frame| frame.0 > wanted + tolerance).count();
            writeln!(
                says,
                "{title}, {wanted} wanted, within {tolerance}; {name}: {} frames outside after the tenth, {above} above",
                outside(10)
            )?;
        }
        let lines = runs.iter().zip(names).zip(COLOURS).map(|((run, name), colour)| {
            (name, colour, run.iter().map(|frame| frame.0 as f64 * 1e-3).collect())
        });
        panels.push(Panel { title, lines: lines.collect(), holds: 1.0 });
    }
    std::fs::write(out.join("bias.csv"), csv)?;
    std::fs::write(out.join("bias.svg"), svg(&panels, "frame"))?;
    Ok(())
}

/// Prints the memory of all levels with their targets, as a multiple of the finest level alone.
fn memory(gmesh: &Gmesh, says: &mut impl Write) -> Result<(), Box<dyn Error>> {
    let levels = gmesh.levels();
    let (vertices, triangles) = (levels[0].vertices, levels[0].triangles);
    let all: usize = levels.iter().map(|level| level.triangles).sum();
    let ratio = |index: usize| {
        // Indices of 12 bytes a triangle are counted by the structure.
        let own = gmesh.memory(VERTEX) - 12 * all + 3 * index * all;
        own as f64 / (VERTEX * vertices + 3 * index * triangles) as f64
    };
    writeln!(
        says,
        "g-mesh of {triangles} triangles, {} levels, {VERTEX} bytes a vertex: {:.2} times the plain mesh, {:.2} with 16-bit indices",
        levels.len(),
        ratio(4),
        ratio(2)
    )?;
    Ok(())
}

/// Prints how far the levels of a matching are from the model, as multiples of linear order's.
fn batches(model: &str, samples: usize, says: &mut impl Write) -> Result<(), Box<dyn Error>> {
    let mesh = multires::io::read(model).map_err(|error| say::name_file(Path::new(model), &error))?;
    let baked = Gmesh::bake(&mesh)?;
    let linear = Simplifier::new().run(&mesh)?;
    let original = Surface::new(&mesh)?;
    let options = DistanceOptions::default().with_samples(samples);
    writeln!(says, "{model}\nlevel  triangles  share  largest     mean")?;
    let levels = baked.structure().levels();
    for (level, facts) in levels.iter().enumerate().take(COMPARED + 1).skip(1) {
        let steps = linear.steps_for_triangles(facts.triangles);
        let mean = |of: &Mesh| -> Result<f64, Box<dyn Error>> {
            Ok(original.distance(&Surface::new(of)?, &options)?.mean())
        };
        let own = mean(&baked.mesh_at(Morph { level, share: 0.0 }))?;
        writeln!(
            says,
            "{level:>5}  {:>9}  {:>5.3}  {:>7.2}  {:>7.2}",
            say::grouped(facts.triangles),
            facts.triangles as f64 / levels[level - 1].triangles as f64,
            facts.error / linear.error_after(steps),
            own / mean(&linear.extract(&mesh, steps))?,
        )?;
    }
    Ok(())
}

fn stress(out: &Path, says: &mut impl Write) -> Result<(), Box<dyn Error>> {
    let street = TotallyOrderedMesh::bake(&shapes::rock(crowd::STRESSED[1] as u32, 6))?;
    let tom = street.structure();
    let frames = crowd::stressed(|asked| tom.at(Level::Triangles(asked)).triangles());
    let mut csv = "frame,complexity,drawn,load,stress\n".to_owned();
    for (number, frame) in frames.iter().enumerate() {
        let crowd::Stressed { complexity, drawn, load, stress } = frame;
        writeln!(csv, "{number},{complexity},{drawn},{load:.4},{stress:.4}")?;
    }
    let line = |of: fn(&crowd::Stressed) -> f64| frames.iter().map(of).collect::<Vec<f64>>();
    let panel = |title, values| Panel { title, lines: vec![("", COLOURS[1], values)], holds: 1.0 };
    let panels = [
        panel(
            "Thousands of triangles in view, at full resolution",
            line(|frame| frame.complexity as f64 * 1e-3),
        ),
        panel("Thousands of triangles drawn", line(|frame| frame.drawn as f64 * 1e-3)),
        panel("Load", line(|frame| frame.load)),
        panel("Stress", line(|frame| frame.stress)),
    ];
    std::fs::write(out.join("stress.csv"), csv)?;
    std::fs::write(out.join("stress.svg"), svg(&panels, "frame"))?;
    let above = frames.iter().filter(|frame| frame.load > 1.0).count();
    let most = frames.iter().map(|frame| frame.load).fold(0.0, f64::max);
    writeln!(says, "stress: {above} of {} frames above a load of 1, at most {most:.2}", frames.len())?;
    Ok(())
}
