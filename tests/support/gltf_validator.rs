//! Khronos' validator, where there is one: `MULTIRES_GLTF_VALIDATOR` names a folder in which `npm install gltf-validator`
//! was run.

#![allow(dead_code)]

use std::path::{Path, PathBuf};
use std::process::Command;

/// Prints the errors of each file named, a line each.
const SCRIPT: &str = r#"
const fs = require("fs"), path = require("path"), validator = require("gltf-validator");
(async () => {
  for (const file of process.argv.slice(1)) {
    const external = uri => new Promise((resolve, reject) =>
      fs.readFile(path.resolve(path.dirname(file), decodeURIComponent(uri)), (e, data) => e ? reject(e.toString()) : resolve(data)));
    const report = await validator.validateBytes(new Uint8Array(fs.readFileSync(file)), { uri: file, externalResourceFunction: external, maxIssues: 0 });
    for (const m of report.issues.messages) if (m.severity === 0) console.log(`${file}: ${m.code} ${m.pointer}: ${m.message}`);
  }
})().catch(e => { console.log(`validator: ${e}`); process.exit(1); });
"#;

/// Returns the folder of the validator; `None`, with a word on stderr, where there is none.
pub fn folder(test: &str) -> Option<PathBuf> {
    let folder = std::env::var_os("MULTIRES_GLTF_VALIDATOR").map(PathBuf::from);
    if folder.is_none() {
        eprintln!("{test}: skipping the validator (set MULTIRES_GLTF_VALIDATOR)");
    }
    folder
}

/// Returns the errors of files, one a line; none where there is no validator.
pub fn errors(test: &str, files: &[PathBuf]) -> Vec<String> {
    let Some(folder) = folder(test) else { return Vec::new() };
    let modules = folder.join("node_modules");
    let output = Command::new("node")
        .args(["-e", SCRIPT])
        .args(files.iter().map(|file| Path::new(file).canonicalize().unwrap()))
        .env("NODE_PATH", modules)
        .output()
        .expect("node runs");
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success(), "{text}{}", String::from_utf8_lossy(&output.stderr));
    text.lines().map(str::to_owned).collect()
}
