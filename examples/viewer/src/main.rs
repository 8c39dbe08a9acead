//! The viewer: a window, or pictures and tables without one.

use std::io::Write;
use std::process::ExitCode;
use std::time::Instant;

use clap::Parser;
use multires_viewer::arguments::Arguments;
use multires_viewer::{headless, window};

fn main() -> ExitCode {
    let since = Instant::now();
    let arguments = Arguments::parse();
    // Where nobody reads any more, the pictures are still to be made.
    let say = |line: &str| drop(writeln!(std::io::stdout(), "{line}"));
    let done = if arguments.headless || arguments.bench {
        headless::run(&arguments, since, say)
    } else {
        window::run(arguments, say)
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("error: {failure}");
            ExitCode::from(failure.exit_code())
        }
    }
}
