//! Charts of docs/results/control.md: a crowd under a bias, a street under stress.
//!
//! ```text
//! cargo run --release -p multires-results --bin control [-- --out DIR]
//! ```
//!
//! Leaves `bias.svg`, `stress.svg` and the numbers as `bias.csv` and `stress.csv` in `target/control/` (or DIR). The card is
//! simulated, so the bytes are the same on every machine.

#[path = "../../../../examples/support/crowd.rs"]
mod crowd;

use std::error::Error;
use std::fmt::Write as _;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use multires::control::Stairs;
use multires::gmesh::{GmeshBuilder, Partition};
use multires::mesh::shapes;
use multires::prelude::*;
use multires_results::chart::{Panel, svg};
use multires_results::say;

const USAGE: &str = "usage: control [--out DIR]";
const COLOURS: [&str; 3] = ["#8a919c", "#2563c9", "#c9432a"];

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let out = match &arguments[..] {
        [] => PathBuf::from("target/control"),
        [flag, out] if flag == "--out" => PathBuf::from(out),
        _ => {
            eprintln!("{USAGE}");
            return ExitCode::from(2);
        }
    };
    say::to_stdout(|says| run(&out, says))
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
