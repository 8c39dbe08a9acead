//! The viewer: a window, or pictures and tables without one.

use std::process::ExitCode;
use std::time::Instant;

use clap::Parser;
use multires_viewer::arguments::Arguments;
use multires_viewer::headless;

fn main() -> ExitCode {
    let since = Instant::now();
    let arguments = Arguments::parse();
    let done = headless::run(&arguments, since, |line| println!("{line}"));
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("error: {failure}");
            ExitCode::from(failure.exit_code())
        }
    }
}
