//! The command line: a command a file, dispatched here.
//!
//! ```text
//!     arguments --> command --> Answer or Failure --> text or one JSON object on stdout, exit code
//! ```
//!
//! | file | idea |
//! |---|---|
//! | `info.rs`, `simplify/`, `build.rs`, `extract.rs`, `adapt.rs`, `fly.rs`, `measure.rs`, `remesh.rs`, `view.rs` | a command each |
//! | `manual.rs` | completions of shells, the manual |
//! | `paint.rs` | a mesh coloured by its distance from another, as a mesh and as a picture |
//! | `lettering.rs` | captions in pictures |
//! | `batches.rs` | arguments about batches, and the list of what each left |
//! | `rules.rs` | how to simplify: arguments common to `simplify` and `build`; `advice.rs`: options to get further |
//! | `prepare.rs` | attributes to drop and positions to weld: arguments common to these and `remesh` |
//! | `model.rs` | a baked model of any structure, and how it is drawn |
//! | `camera.rs` | how to look: arguments common to `adapt` and `fly` |
//! | `path.rs` | camera paths as text |
//! | `files.rs` | reading and writing, checked before the work starts |
//! | `output.rs` | [`Answer`](output::Answer), [`Failure`](output::Failure), exit codes |
//! | `workers.rs` | work on all cores |
//! | `progress.rs` | a bar on stderr, if it is a terminal |

mod adapt;
mod advice;
mod bake;
mod batches;
mod build;
mod camera;
mod canvas;
mod extract;
mod facts;
mod files;
mod fly;
mod info;
mod lettering;
mod manual;
mod measure;
mod model;
mod output;
mod paint;
mod path;
mod prepare;
mod progress;
mod remesh;
mod rules;
mod simplify;
mod view;
mod workers;

use std::process::ExitCode;

use clap::{CommandFactory, Parser, Subcommand};

use output::{Failure, Run};

/// Multiresolution triangle meshes: look at them, simplify them, bake all levels of detail into one file, take any level out
/// again, or the mesh a view asks for, and measure how far two meshes differ.
///
/// Mesh files are .obj, .ply, .stl, .off, .glb and .gltf, baked files .mres. Exit codes: 0 done, 1 bad input (a line on stderr
/// says why), 2 bad usage. An output file is written whole or not at all.
#[derive(Parser)]
#[command(name = "multires", version)]
struct Cli {
    /// Answer with a JSON object on stdout; after a failure its only key is "error".
    #[arg(long, global = true)]
    json: bool,
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Info(info::Info),
    Simplify(simplify::Simplify),
    Build(build::Build),
    Extract(extract::Extract),
    Adapt(adapt::Adapt),
    Fly(fly::Fly),
    Measure(measure::Measure),
    Remesh(remesh::Remesh),
    View(view::View),
    Completions(manual::Completions),
    Man(manual::Man),
}

fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => return output::usage(&error, std::env::args_os().any(|a| a == "--json")),
    };
    let command: &dyn Run = match &cli.command {
        Command::Info(command) => command,
        Command::Simplify(command) => command,
        Command::Build(command) => command,
        Command::Extract(command) => command,
        Command::Adapt(command) => command,
        Command::Fly(command) => command,
        Command::Measure(command) => command,
        Command::Remesh(command) => command,
        Command::View(command) => command,
        Command::Completions(command) => command,
        Command::Man(command) => command,
    };
    match command.run() {
        Ok(answer) => output::answer(&answer, cli.json),
        Err(Failure::Input(reason)) => output::failure(&reason, cli.json),
        Err(Failure::Usage(reason)) => {
            let error = Cli::command().error(clap::error::ErrorKind::ValueValidation, reason);
            output::usage(&error, cli.json)
        }
    }
}
