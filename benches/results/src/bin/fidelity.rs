//! How far levels of detail lie from their model: the error that the sequence reports beside the measured distance.
//!
//! ```text
//! cargo run --release -p multires-results --bin fidelity -- MODEL... [--samples N]
//! ```
//!
//! All in percent of the model's diagonal. `reported` is what the sequence says of the level; `out` and `back` are the
//! largest distances from the model to the level and the other way, `mean` the mean of both directions, by samples of
//! equal area (300,000 a mesh), corners and edges.

use std::error::Error;
use std::io::Write;
use std::path::Path;
use std::process::ExitCode;

use multires::quality::{DistanceOptions, Surface};
use multires::{Mesh, Simplifier, io};
use multires_results::say;

/// The levels measured, in percent of the triangles.
const PERCENTS: [usize; 6] = [50, 25, 10, 5, 2, 1];

fn main() -> ExitCode {
    let (mut models, mut samples) = (Vec::new(), 300_000);
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--samples" => match arguments.next().and_then(|n| n.parse().ok()) {
                Some(n) => samples = n,
                None => return usage(),
            },
            flag if flag.starts_with('-') => return usage(),
            _ => models.push(argument),
        }
    }
    if models.is_empty() {
        return usage();
    }
    say::to_stdout(|says| {
        models.iter().try_for_each(|model| {
            let mesh = io::read(model).map_err(|error| say::name_file(Path::new(model), &error))?;
            table(model, &mesh, samples, says)
        })
    })
}

fn usage() -> ExitCode {
    eprintln!("usage: fidelity MODEL... [--samples N]");
    ExitCode::from(2)
}

fn table(model: &str, mesh: &Mesh, samples: usize, says: &mut impl Write) -> Result<(), Box<dyn Error>> {
    let sequence = Simplifier::new().run(mesh)?;
    let original = Surface::new(mesh)?;
    let options = DistanceOptions::default().with_samples(samples);
    writeln!(says, "{model}\n kept %  triangles   reported        out       back       mean")?;
    for percent in PERCENTS {
        let steps = sequence.steps_for_triangles(mesh.triangles().len() * percent / 100);
        let level = sequence.extract(mesh, steps);
        let measured = original.distance(&Surface::new(&level)?, &options)?;
        let of_diagonal = |x: f64| 100.0 * x / measured.diagonal;
        writeln!(
            says,
            "{percent:>7}  {:>9}   {:>8.4}   {:>8.4}   {:>8.4}   {:>8.4}",
            say::grouped(level.triangles().len()),
            of_diagonal(f64::from(sequence.error_after(steps))),
            of_diagonal(measured.forward.max),
            of_diagonal(measured.backward.max),
            of_diagonal(measured.mean()),
        )?;
    }
    Ok(())
}
