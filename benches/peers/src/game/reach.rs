//! How far down every model of a folder goes when 5 % of its triangles are asked for.

use std::error::Error;
use std::path::{Path, PathBuf};

use multires::mesh::Mesh;
use multires::quality::{DistanceOptions, Surface};
use multires::simplify::{Simplifier, StopReason, Target};
use serde_json::{Value, json};

use super::validity;
use crate::clock::timed;
use crate::number;

/// What to measure.
pub(crate) struct Options {
    folders: Vec<PathBuf>,
    percent: f64,
    least: usize,
    json: bool,
}

impl Options {
    pub(crate) fn parse(mut arguments: impl Iterator<Item = String>) -> Result<Self, String> {
        let mut options = Self { folders: Vec::new(), percent: 5.0, least: 200, json: false };
        while let Some(argument) = arguments.next() {
            let mut value = || arguments.next().ok_or_else(|| format!("{argument} needs a value"));
            match argument.as_str() {
                "--percent" => options.percent = number(&argument, &value()?, 0.0..=100.0)?,
                "--least" => options.least = number(&argument, &value()?, 0..=usize::MAX)?,
                "--json" => options.json = true,
                unknown if unknown.starts_with('-') => return Err(format!("there is no option {unknown}")),
                folder => options.folders.push(folder.into()),
            }
        }
        if options.folders.is_empty() {
            return Err("name at least one folder or model".to_owned());
        }
        Ok(options)
    }
}

/// One model.
struct Row {
    name: String,
    triangles: usize,
    target: usize,
    left: usize,
    stop: StopReason,
    /// Maximum two-sided distance and reported error, percent of the diagonal.
    max: f64,
    reported: f64,
    flipped: usize,
    invalid: usize,
    ms: f64,
    /// The rule that refused most of what is left, where it is stuck.
    rule: String,
}

pub(crate) fn run(options: &Options) -> Result<(), Box<dyn Error>> {
    let mut files = Vec::new();
    for folder in &options.folders {
        collect(folder, &mut files)?;
    }
    files.sort();
    let mut rows = Vec::new();
    for path in &files {
        // Files that cannot be read are not models.
        let Ok(mesh) = multires::io::read(path) else { continue };
        if mesh.triangles().len() < options.least.max(1) {
            continue;
        }
        let name = name_of(path);
        let Some(row) = measure(&name, &mesh, options.percent)? else { continue };
        if !options.json {
            row.print(rows.is_empty());
        }
        rows.push(row);
    }
    let short: Vec<&Row> = rows.iter().filter(|row| !row.good()).collect();
    if options.json {
        let all: Vec<Value> = rows.iter().map(Row::json).collect();
        println!("{}", json!({ "percent": options.percent, "rows": all, "short": short.len() }));
    } else {
        println!(
            "\n{} models, {} short of {} % or with attributes that are not valid",
            rows.len(),
            short.len(),
            options.percent
        );
    }
    Ok(())
}

fn name_of(path: &Path) -> String {
    let parts: Vec<_> = path.components().rev().take(2).map(|c| c.as_os_str().to_string_lossy()).collect();
    parts.iter().rev().map(|part| &**part).collect::<Vec<_>>().join("/")
}

fn collect(path: &Path, files: &mut Vec<PathBuf>) -> Result<(), Box<dyn Error>> {
    if !path.is_dir() {
        files.push(path.to_owned());
        return Ok(());
    }
    for entry in std::fs::read_dir(path).map_err(|e| format!("{}: {e}", path.display()))? {
        let path = entry?.path();
        let kind = path.extension().map(|e| e.to_string_lossy().to_lowercase());
        if path.is_dir()
            || kind.is_some_and(|kind| ["obj", "ply", "stl", "off", "gltf", "glb"].contains(&&*kind))
        {
            collect(&path, files)?;
        }
    }
    Ok(())
}

/// Nothing for a mesh without a surface.
fn measure(name: &str, mesh: &Mesh, percent: f64) -> Result<Option<Row>, Box<dyn Error>> {
    let Ok(surface) = Surface::new(mesh) else { return Ok(None) };
    let target = (mesh.triangles().len() as f64 * percent / 100.0).floor() as usize;
    let mut simplifier = Simplifier::new().target(Target::Triangles(target));
    let (sequence, [ms, _]) = timed(|| simplifier.run(mesh));
    let sequence = sequence?;
    let level = sequence.extract_fitted(mesh, sequence.len());
    let report = sequence.report();
    let max = match Surface::new(&level) {
        Ok(level) => {
            surface.distance(&level, &DistanceOptions::default().with_samples(20_000))?.hausdorff_percent()
        }
        Err(_) => f64::INFINITY,
    };
    let rule = report.refusals.iter().max_by_key(|refusal| refusal.standing);
    let rule = rule
        .filter(|rule| rule.standing > 0)
        .map_or_else(String::new, |rule| format!("{} {}", rule.oracle, rule.standing));
    Ok(Some(Row {
        name: name.to_owned(),
        triangles: mesh.triangles().len(),
        target,
        left: level.triangles().len(),
        stop: report.stop,
        max,
        reported: 100.0 * f64::from(report.error) / mesh.diagonal(),
        flipped: validity::flipped(&surface, &level),
        invalid: validity::invalid_vertices(mesh, &level),
        ms,
        rule,
    }))
}

impl Row {
    fn good(&self) -> bool {
        self.left <= self.target && self.flipped == 0 && self.invalid == 0
    }

    fn print(&self, first: bool) {
        if first {
            println!(
                "{:<40} {:>9} {:>8} {:>6} {:>8} {:>10} {:>5} {:>5} {:>8}  stuck by",
                "model", "triangles", "left", "%", "max %", "reported %", "flip", "bad", "ms"
            );
        }
        println!(
            "{:<40} {:>9} {:>8} {:>6.1} {:>8.3} {:>10.3} {:>5} {:>5} {:>8.0}  {}{}",
            self.name,
            self.triangles,
            self.left,
            100.0 * self.left as f64 / self.triangles as f64,
            self.max,
            self.reported,
            self.flipped,
            self.invalid,
            self.ms,
            if self.left > self.target { format!("{:?} ", self.stop) } else { String::new() },
            self.rule
        );
    }

    fn json(&self) -> Value {
        json!({
            "model": self.name,
            "triangles": self.triangles,
            "target": self.target,
            "left": self.left,
            "stop": format!("{:?}", self.stop),
            "max": if self.max.is_finite() { json!(self.max) } else { Value::Null },
            "reported": self.reported,
            "flipped": self.flipped,
            "invalid": self.invalid,
            "ms": self.ms,
            "rule": self.rule,
        })
    }
}
