//! Measures simplifiers, and what follows a view, beside each other, on the same meshes, in the same run.
//!
//! ```text
//! multires-peers simplify MODEL... [--generated] [--grid N] [--percent 50,25,10,5,2,1]
//!                         [--runs 7] [--warmups 2] [--only NAME] [--out DIR] [--json]
//! multires-peers fly [MODEL...] [--path CSV] [--tolerance 1] [--subdivide N] [--still-path] [--optimal]
//!                    [--dependencies none,adjacent,neighbours] [--rounds 5] [--json]
//! multires-peers game MODEL... [--generated] [--percent 50,25,10] [--only NAME,...] [--runs 1] [--samples 40000]
//!                     [--weights NORMAL,SLIDE,COLOUR] [--out DIR] [--view 0] [--json]
//! multires-peers reach FOLDER... [--percent 5] [--least 200] [--json]
//! multires-peers codec MODEL...
//! ```
//!
//! | file | idea |
//! |---|---|
//! | `main.rs` | the arguments |
//! | `contender.rs` | who takes part: **add a simplifier here** |
//! | `simplify.rs` | interleaved runs, medians, table and JSON |
//! | `clock.rs` | CPU time of this thread and of the process |
//! | `fly.rs` | frames along a path: cluster selection beside vertex hierarchies |
//! | `fly_options.rs`, `fly_report.rs` | its arguments, its tables |
//! | `game/` | models with seams, materials and cards: what they look like afterwards, and how far down they go |
//! | `codec.rs` | bytes of a whole mesh: a codec beside a stream of splits |
//! | `clod.rs` | meshoptimizer's cluster hierarchy and its selection |
//! | `path.rs` | where the eye goes |
//! | `statistics.rs` | medians and percentiles |
//! | `input.rs`, `subdivide.rs` | meshes from files and from formulas, welded; larger ones from small ones |
//!
//! Exit status: 0, 1 for bad input, 2 for wrong usage.

mod clock;
mod clod;
mod codec;
mod contender;
mod fly;
mod fly_options;
mod fly_report;
mod game;
mod input;
mod path;
mod simplify;
mod statistics;
mod subdivide;

use std::error::Error;
use std::path::PathBuf;
use std::process::ExitCode;

const USAGE: &str =
    "usage: multires-peers simplify MODEL... [--generated] [--grid N] [--percent 50,25,10,5,2,1]
                               [--runs 7] [--warmups 2] [--only NAME] [--out DIR] [--json]
       multires-peers fly [MODEL...] [--path CSV] [--tolerance 1] [--subdivide N] [--still-path] [--optimal]
                          [--dependencies none,adjacent,neighbours] [--rounds 5] [--json]
       multires-peers game MODEL... [--generated] [--percent 50,25,10] [--only NAME,...] [--runs 1]
                           [--samples 40000] [--weights NORMAL,SLIDE,COLOUR] [--out DIR] [--view 0]
                           [--json]
       multires-peers reach FOLDER... [--percent 5] [--least 200] [--json]
       multires-peers codec MODEL...";

/// What to measure, and how often.
struct Options {
    models: Vec<PathBuf>,
    generated: bool,
    grid: u32,
    percents: Vec<f64>,
    runs: usize,
    warmups: usize,
    only: Vec<String>,
    out: Option<PathBuf>,
    json: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            models: Vec::new(),
            generated: false,
            grid: 1024,
            percents: vec![50.0, 25.0, 10.0, 5.0, 2.0, 1.0],
            runs: 7,
            warmups: 2,
            only: Vec::new(),
            out: None,
            json: false,
        }
    }
}

/// What was asked for.
enum Command {
    Simplify(Options),
    Fly(fly_options::Options),
    Game(game::Options),
    Reach(game::reach::Options),
    Codec(Vec<PathBuf>),
}

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1);
    let command = match arguments.next().as_deref() {
        Some("simplify") => parse(arguments).map(Command::Simplify),
        Some("fly") => fly_options::Options::parse(arguments).map(Command::Fly),
        Some("game") => game::Options::parse(arguments).map(Command::Game),
        Some("reach") => game::reach::Options::parse(arguments).map(Command::Reach),
        Some("codec") => match arguments.map(PathBuf::from).collect::<Vec<_>>() {
            models if models.is_empty() => Err("name at least one model".to_owned()),
            models => Ok(Command::Codec(models)),
        },
        Some("--help" | "-h") => {
            println!("{USAGE}");
            return ExitCode::SUCCESS;
        }
        Some(other) => Err(format!("there is no command {other:?}")),
        None => Err("a command is needed".to_owned()),
    };
    let result = match command {
        Ok(Command::Simplify(options)) => run(&options),
        Ok(Command::Fly(options)) => fly::run(&options),
        Ok(Command::Game(options)) => game::run(&options),
        Ok(Command::Reach(options)) => game::reach::run(&options),
        Ok(Command::Codec(models)) => {
            read_all(&models).and_then(|inputs| codec::run(&inputs, &[10, 12, 14, 16]))
        }
        Err(reason) => {
            eprintln!("multires-peers: {reason}\n{USAGE}");
            return ExitCode::from(2);
        }
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(reason) => {
            eprintln!("multires-peers: {reason}");
            ExitCode::FAILURE
        }
    }
}

fn read_all(models: &[PathBuf]) -> Result<Vec<input::Input>, Box<dyn Error>> {
    let read = |path: &PathBuf| input::read(path).map_err(|e| format!("{}: {e}", path.display()).into());
    models.iter().map(read).collect()
}

fn run(options: &Options) -> Result<(), Box<dyn Error>> {
    let mut inputs = read_all(&options.models)?;
    if options.generated {
        inputs.extend(input::generated(options.grid)?);
    }
    simplify::run(&inputs, options)
}

fn parse(mut arguments: impl Iterator<Item = String>) -> Result<Options, String> {
    let mut options = Options::default();
    while let Some(argument) = arguments.next() {
        let mut value = || arguments.next().ok_or_else(|| format!("{argument} needs a value"));
        match argument.as_str() {
            "--generated" => options.generated = true,
            "--grid" => options.grid = number(&argument, &value()?, 1..=4096)?,
            "--runs" => options.runs = number(&argument, &value()?, 1..=1_000_000)?,
            "--warmups" => options.warmups = number(&argument, &value()?, 0..=1_000_000)?,
            "--percent" => {
                options.percents = value()?
                    .split(',')
                    .map(|p| number(&argument, p, 0.0..=100.0))
                    .collect::<Result<_, _>>()?;
            }
            "--only" => options.only.push(value()?),
            "--out" => options.out = Some(value()?.into()),
            "--json" => options.json = true,
            unknown if unknown.starts_with('-') => return Err(format!("there is no option {unknown}")),
            model => options.models.push(model.into()),
        }
    }
    if options.models.is_empty() && !options.generated {
        return Err("name at least one model, or --generated".to_owned());
    }
    contender::check_names(&options.only)?;
    Ok(options)
}

pub(crate) fn number<T: std::str::FromStr + PartialOrd + std::fmt::Display>(
    option: &str,
    text: &str,
    range: std::ops::RangeInclusive<T>,
) -> Result<T, String> {
    let value: Option<T> = text.parse().ok();
    value.filter(|v| range.contains(v)).ok_or_else(|| {
        format!("{option} takes numbers from {} to {}, not {text:?}", range.start(), range.end())
    })
}
