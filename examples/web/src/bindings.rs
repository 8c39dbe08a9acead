//! From a package to what a browser loads: built for it, bound, measured.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

use flate2::Compression;
use flate2::write::GzEncoder;
use wasm_bindgen_cli_support::Bindgen;

/// What is made of a package.
pub struct Bindings<'a> {
    /// Name of the package.
    pub package: &'a str,
    /// The profile that it is built with.
    pub profile: &'a str,
    /// Its feature; none if empty.
    pub feature: &'a str,
    /// Folder that it goes to.
    pub to: &'a Path,
    /// What it is called there.
    pub name: &'a str,
    /// Most bytes of the program, plain and compressed.
    pub most: [usize; 2],
    /// Builds in less time, by a profile of its own: larger than `most` allows, for tests.
    pub quick: bool,
}

/// The profile of quick builds.
const QUICK: &str = "web-quick";

impl Bindings<'_> {
    /// Builds the package for browsers, and writes `name.js` and `name_bg.wasm` to the folder. Returns a line that tells the sizes.
    ///
    /// # Errors
    /// What failed, in a line: the build, a file, or the program is larger than it may be.
    pub fn make(&self) -> Result<String, String> {
        let profile = if self.quick { QUICK } else { self.profile };
        let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
        let target = ["--target", "wasm32-unknown-unknown"];
        let built = Command::new(cargo)
            .current_dir(root())
            .args([
                "build",
                "--package",
                self.package,
                "--lib",
                "--profile",
                profile,
                "--features",
                self.feature,
            ])
            .args(target)
            .status()
            .map_err(|error| format!("cargo: {error}"))?;
        if !built.success() {
            return Err(format!(
                "{} was not built; it takes `rustup target add {}`",
                self.package, target[1]
            ));
        }
        let library = self.package.replace('-', "_");
        let file = format!("wasm32-unknown-unknown/{profile}/{library}.wasm");
        let library = target_folder().join(file);
        std::fs::create_dir_all(self.to).map_err(|error| at(self.to, &error))?;
        Bindgen::new()
            .input_path(&library)
            .web(true)
            .and_then(|bindgen| {
                bindgen.typescript(false).remove_name_section(true).out_name(self.name).generate(self.to)
            })
            .map_err(|error| format!("{}: {error:#}", library.display()))?;
        let wasm = self.to.join(format!("{}_bg.wasm", self.name));
        let bytes = std::fs::read(&wasm).map_err(|error| at(&wasm, &error))?;
        let sizes = [bytes.len(), compressed(&bytes).len()];
        let told = format!("{}: {} bytes, {} compressed", wasm.display(), sizes[0], sizes[1]);
        if !self.quick && (sizes[0] > self.most[0] || sizes[1] > self.most[1]) {
            return Err(format!("{told}: more than {} and {}", self.most[0], self.most[1]));
        }
        Ok(told)
    }
}

/// Copies all files of a folder to another.
///
/// # Errors
/// A file cannot be read or written.
pub fn copy_all(from: &Path, to: &Path) -> Result<(), String> {
    for file in std::fs::read_dir(from).map_err(|error| at(from, &error))? {
        let file = file.map_err(|error| at(from, &error))?;
        let to = to.join(file.file_name());
        std::fs::copy(file.path(), &to).map_err(|error| at(&to, &error))?;
    }
    Ok(())
}

fn at(path: &Path, error: &std::io::Error) -> String {
    format!("{}: {error}", path.display())
}

/// The folder of the workspace.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The folder of build outputs.
pub fn target_folder() -> PathBuf {
    std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), PathBuf::from)
}

/// The bytes as servers send them.
pub fn compressed(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    // Writing to memory does not fail.
    let _ = encoder.write_all(bytes);
    encoder.finish().unwrap_or_default()
}
