//! `multires view`: starts the viewer.

use std::ffi::OsString;
use std::path::PathBuf;
use std::process::Command;

use clap::Args;
use serde_json::json;

use crate::output::{Answer, Failure, Run};

/// Name of the viewer's program.
const VIEWER: &str = "multires-viewer";

/// Show a mesh or a baked file in the viewer, where it is installed.
///
/// The viewer is a program of its own, multires-viewer, since it brings a window and a graphics interface: looked for beside
/// this program, then on the path.
#[derive(Args)]
pub struct View {
    /// The mesh file or baked file to show.
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// Arguments of the viewer; see multires-viewer --help.
    #[arg(value_name = "ARGUMENTS", last = true)]
    arguments: Vec<OsString>,
}

impl Run for View {
    fn run(&self) -> Result<Answer, Failure> {
        if !self.file.is_file() {
            return Err(Failure::Input(format!("{}: there is no such file", self.file.display())));
        }
        let name = format!("{VIEWER}{}", std::env::consts::EXE_SUFFIX);
        let beside = std::env::current_exe().ok().map(|own| own.with_file_name(&name));
        let program = beside.filter(|path| path.is_file()).unwrap_or_else(|| PathBuf::from(&name));
        let ended = Command::new(&program).arg(&self.file).args(&self.arguments).status();
        match ended {
            Ok(status) if status.success() => {
                let path = self.file.display().to_string();
                let json = json!({ "command": "view", "input": { "path": path }, "viewer": program.display().to_string() });
                let text = format!("{path}: shown by {}", program.display());
                Ok(Answer { json, text, warnings: Vec::new(), failures: Vec::new() })
            }
            Ok(status) => Err(Failure::Input(format!("{}: {status}", program.display()))),
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => Err(Failure::Input(format!(
                "{VIEWER} is not installed; in the repository of multires: cargo install --path examples/viewer"
            ))),
            Err(error) => Err(Failure::Input(format!("{}: {error}", program.display()))),
        }
    }
}
