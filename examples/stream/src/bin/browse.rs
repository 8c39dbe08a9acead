//! Looks at a model that `serve` serves, with a scripted camera and without a window.
//!
//! ```text
//! cargo run --release -p multires-stream-example --bin browse [-- --address HOST:PORT] [--script approach|detail]
//!         [--triangles N] [--pixels N] [--journal FILE] [--every SECONDS] [--out DIR]
//! cargo run --release -p multires-stream-example --bin browse -- figures [FILE] [--rate BYTES_PER_SECOND] [--delay MS] [--out DIR]
//! ```
//!
//! Leaves `browse-*.png`, a picture every so many seconds, and `browse.svg`, a chart over time, in `target/stream/` (or DIR). With
//! `--journal`, a viewer that was killed goes on where it was. `figures` needs no server and no network: it makes the pictures and
//! charts of docs/results/streaming.md on a simulated line.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args, Parser, Subcommand};
use multires::stream::ClientOptions;
use multires_stream_example::browser::Browser;
use multires_stream_example::camera::{Detail, Script};
use multires_stream_example::figures::Figures;
use multires_stream_example::simulated::Line;
use multires_stream_example::tour::{Tour, TourOptions};
use multires_stream_example::{AnyError, line, model};

/// Looks at a model over TCP, or on a simulated line.
#[derive(Debug, Parser)]
#[command(args_conflicts_with_subcommands = true)]
struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,
    #[command(flatten)]
    live: Live,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Makes the files of docs/results/streaming.md: server and client on a simulated line.
    Figures(Simulation),
}

/// Options of a client on TCP.
#[derive(Debug, Args)]
struct Live {
    /// Address of the server.
    #[arg(long, default_value = "127.0.0.1:7878")]
    address: String,
    /// Course of the camera.
    #[arg(long, default_value = "approach")]
    script: Script,
    /// Most triangles drawn; default: no limit.
    #[arg(long)]
    triangles: Option<usize>,
    /// Largest error on a screen of 1280 x 720 pixels.
    #[arg(long, default_value_t = 1.0)]
    pixels: f32,
    /// Seconds between two pictures; 0 for none.
    #[arg(long, default_value_t = 2.0)]
    every: f64,
    /// File of all packets, by which a viewer that was killed resumes.
    #[arg(long)]
    journal: Option<PathBuf>,
    #[command(flatten)]
    common: Common,
}

/// Options of the simulated line.
#[derive(Debug, Args)]
struct Simulation {
    /// Mesh or baked vertex hierarchy; default: a model that the crate makes.
    file: Option<PathBuf>,
    /// Bytes a second.
    #[arg(long, default_value_t = 10_000.0)]
    rate: f64,
    /// Milliseconds from one end to the other.
    #[arg(long, default_value_t = 50)]
    delay: u64,
    /// Bits of each coordinate of a position, 1 to 31.
    #[arg(long, default_value_t = 12)]
    bits: u32,
    #[command(flatten)]
    common: Common,
}

/// Options of both.
#[derive(Debug, Args)]
struct Common {
    /// Folder for pictures and charts.
    #[arg(long, default_value = "target/stream")]
    out: PathBuf,
    /// Detail that the camera comes close to: a point in shares of the model's box.
    #[arg(long, value_delimiter = ',', value_name = "X,Y,Z", allow_hyphen_values = true)]
    detail: Option<Vec<f64>>,
    /// Direction from the detail to the eye.
    #[arg(long, value_delimiter = ',', value_name = "X,Y,Z", allow_hyphen_values = true)]
    from: Option<Vec<f64>>,
    /// Distance from the detail to the eye, diagonals.
    #[arg(long)]
    near: Option<f64>,
}

impl Common {
    fn detail(&self) -> Result<Detail, AnyError> {
        let three = |option, given: &Option<Vec<f64>>, default| match given.as_deref() {
            None => Ok(default),
            Some(&[x, y, z]) if [x, y, z].iter().all(|x| x.is_finite()) => Ok([x, y, z]),
            Some(_) => Err(format!("{option} takes three numbers, as 0.5,0.5,1")),
        };
        let default = Detail::default();
        let near = self.near.unwrap_or(default.near);
        if !(near > 0.0 && near.is_finite()) {
            return Err("--near must be above 0".into());
        }
        let at = three("--detail", &self.detail, default.at)?;
        Ok(Detail { at, from: three("--from", &self.from, default.from)?, near })
    }
}

#[tokio::main]
async fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let end = match &arguments.command {
        Some(Command::Figures(simulation)) => figures(simulation),
        None => browse(&arguments.live).await,
    };
    match end {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn figures(options: &Simulation) -> Result<(), AnyError> {
    let Simulation { file, rate, delay, bits, common } = options;
    if !(*rate >= 1.0 && rate.is_finite()) {
        return Err("--rate must be at least 1".into());
    }
    let detail = common.detail()?;
    let line = Line { rate: *rate, delay: delay.saturating_mul(1_000) };
    let server = model::server(&model::open(file.as_deref())?, *bits)?;
    let mut says = std::io::stdout().lock();
    write!(says, "{}: ", model::name(file.as_deref()))?;
    Figures::new(server, &detail, line)?.make(&common.out, &mut says)
}

async fn browse(options: &Live) -> Result<(), AnyError> {
    let Live { address, script, triangles, pixels, every, journal, common } = options;
    let out = common.out.clone();
    std::fs::create_dir_all(&out).map_err(|error| format!("{}: {error}", out.display()))?;
    let mut browser = Browser::open(ClientOptions::default(), *triangles, journal.as_deref())?;
    let received = browser.received();
    if received.journal_packets > 0 {
        println!(
            "the journal has {} packets, {} bytes: {} triangles",
            received.journal_packets,
            received.journal_bytes,
            browser.triangles()
        );
    }
    let chart = out.join("browse.svg");
    let (script, pixels, every) = (*script, *pixels, *every);
    let mut tour = Tour::new(TourOptions { script, detail: common.detail()?, pixels, every, out });
    line::run(&mut browser, address, &mut tour).await?;
    let received = browser.received();
    println!(
        "received {} bytes in {} packets, sent {} bytes; {}; {} triangles of {}",
        received.bytes,
        received.packets,
        received.requested,
        if received.streams == 0 { "resumed" } else { "a new stream" },
        browser.triangles(),
        browser.client().full_triangles()
    );
    tour.chart(&chart)?;
    println!("pictures and {}", chart.display());
    Ok(())
}
