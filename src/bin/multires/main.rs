//! The command line: one command a file, dispatched here.
//!
//! ```text
//!     arguments --> command --> Answer or Failure --> text or one JSON object on stdout, exit code
//! ```
//!
//! | file | idea |
//! |---|---|
//! | `info.rs`, `simplify.rs`, `build.rs`, `extract.rs`, `adapt.rs`, `fly.rs`, `measure.rs` | one command each: its arguments, what it does, its answer |
//! | `paint.rs` | a mesh coloured by its distance from another, as a mesh and as a picture |
//! | `lettering.rs` | captions in pictures |
//! | `rules.rs` | how to simplify: what `simplify` and `build` have in common; `advice.rs`: what would get further |
//! | `model.rs` | what is looked at: what `adapt` and `fly` know of structures that follow the view |
//! | `camera.rs` | how to look: what `adapt` and `fly` have in common |
//! | `path.rs` | camera paths as text |
//! | `files.rs` | what is read and written, checked before the work starts |
//! | `output.rs` | [`Answer`](output::Answer), [`Failure`](output::Failure), exit codes |
//! | `progress.rs` | a bar on stderr, where that is a terminal |

mod adapt;
mod advice;
mod build;
mod camera;
mod canvas;
mod extract;
mod facts;
mod files;
mod fly;
mod info;
mod lettering;
mod measure;
mod model;
mod output;
mod paint;
mod path;
mod progress;
mod rules;
mod simplify;

use std::process::ExitCode;

use clap::{CommandFactory, Parser, Subcommand};

use output::{Failure, Run};

/// Multiresolution triangle meshes: look at them, simplify them, bake all levels of detail into one file, take any level,
/// or what a view asks for, out again, and measure how far two meshes differ.
///
/// Mesh files are .obj, .ply, .stl, .off, .glb and .gltf, baked ones .mres. Exit codes: 0 done, 1 bad input (one line
/// on stderr says why), 2 bad usage. An output file is written whole or not at all.
#[derive(Parser)]
#[command(name = "multires", version)]
struct Cli {
    /// Answer with one JSON object on stdout; where something is wrong it has the one key "error".
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
