//! Many files: each for itself, several at a time, a line a file, failures at the end.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Instant;

use multires::io::Format;
use serde_json::{Value, json};

use super::Simplify;
use crate::output::{Answer, Failure, Table};
use crate::workers;

/// Simplifies files into a folder, which is made where it is missing.
pub fn run(command: &Simplify, inputs: &[PathBuf], folder: &Path) -> Result<Answer, Failure> {
    let start = Instant::now();
    let outputs = outputs(command, inputs, folder)?;
    std::fs::create_dir_all(folder)
        .map_err(|error| Failure::Input(format!("{}: {error}", folder.display())))?;
    let results = workers::each(inputs.len(), |i| command.one(&inputs[i], &outputs[i]));
    let seconds = start.elapsed().as_secs_f64();
    let (mut table, mut warnings, mut done, mut failed) =
        (Table::default(), Vec::new(), Vec::new(), Vec::new());
    for (input, result) in inputs.iter().zip(results) {
        match result {
            Ok(answer) => {
                table.row(&input.display().to_string(), line(&answer.json));
                warnings.extend(answer.warnings.into_iter().map(|w| format!("{}: {w}", input.display())));
                done.push(answer.json);
            }
            Err(Failure::Usage(reason)) => return Err(Failure::Usage(reason)),
            Err(Failure::Input(reason)) => {
                let path = input.display().to_string();
                let reason = if reason.starts_with(&path) { reason } else { format!("{path}: {reason}") };
                failed.push(reason);
            }
        }
    }
    table.row("files", format!("{} done, {} failed, in {seconds:.3} seconds", done.len(), failed.len()));
    let json = json!({
        "command": "simplify",
        "files": done,
        "failures": failed,
        "seconds": seconds,
        "warnings": warnings,
    });
    Ok(Answer { json, text: table.text(), warnings, failures: failed })
}

/// Returns a line about a file.
fn line(json: &Value) -> String {
    let number = |value: &Value| value.as_u64().unwrap_or(0);
    let before = number(&json["input"]["triangles"]);
    let levels = json["levels"].as_array();
    let after: Vec<String> = match levels {
        Some(levels) => levels
            .iter()
            .map(|l| {
                number(l.get("output").unwrap_or(l).get("triangles").unwrap_or(&Value::Null)).to_string()
            })
            .collect(),
        None => vec![number(&json["output"]["triangles"]).to_string()],
    };
    let error = json["error_percent"].as_f64().map(|p| format!(", error {p:.4} %"));
    format!("{before} -> {} triangles{}", after.join(", "), error.unwrap_or_default())
}

/// Returns the files to write; refuses two of the same name.
fn outputs(command: &Simplify, inputs: &[PathBuf], folder: &Path) -> Result<Vec<PathBuf>, Failure> {
    let mut of: BTreeMap<PathBuf, &PathBuf> = BTreeMap::new();
    let mut outputs = Vec::with_capacity(inputs.len());
    for input in inputs {
        let name =
            input.file_name().ok_or_else(|| Failure::Usage(format!("{}: no file", input.display())))?;
        let mut output = folder.join(name);
        if let Some(format) = &command.format {
            output.set_extension(format);
        }
        if command.format.is_some() && Format::from_path(&output).is_none() {
            return Err(Failure::Usage("--format: none of obj, ply, stl, off, glb, gltf".to_owned()));
        }
        if let Some(other) = of.insert(output.clone(), input) {
            let (other, input) = (other.display(), input.display());
            return Err(Failure::Usage(format!(
                "{other} and {input} would both be written as {}",
                output.display()
            )));
        }
        outputs.push(output);
    }
    Ok(outputs)
}
