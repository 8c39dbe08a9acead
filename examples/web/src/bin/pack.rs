//! Makes the npm package `multires-web`, in `target/web/npm`.

use std::path::Path;
use std::process::ExitCode;

use clap::Parser;
use multires_web_viewer::bindings::{Bindings, copy_all, root, target_folder};

/// Most bytes of the library, plain and compressed.
const MOST: [usize; 2] = [1_500_000, 600_000];

/// Makes the npm package.
#[derive(Parser)]
struct Arguments {
    /// Makes it in less time, and larger: for tests
    #[arg(long)]
    quick: bool,
}

fn main() -> ExitCode {
    match pack(&target_folder().join("web/npm"), Arguments::parse().quick) {
        Ok(told) => {
            println!("{told}");
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn pack(to: &Path, quick: bool) -> Result<String, String> {
    let package = "multires-web";
    let told =
        Bindings { package, profile: "web", feature: "", to, name: "multires", most: MOST, quick }.make()?;
    copy_all(&root().join("multires-web/npm"), to)?;
    for licence in ["LICENSE-MIT", "LICENSE-APACHE"] {
        std::fs::copy(root().join(licence), to.join(licence))
            .map_err(|error| format!("{licence}: {error}"))?;
    }
    Ok(told)
}
