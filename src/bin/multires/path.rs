//! Camera paths as text: `#` comments, a header line, then frame, eye x y z, target x y z, with commas.

use std::path::Path;

use crate::camera::Point;
use crate::output::Failure;

/// A frame of a path.
pub struct Pose {
    pub frame: u64,
    pub eye: Point,
    pub target: Point,
}

/// Reads a path; refuses an empty path.
pub fn read(path: &Path) -> Result<Vec<Pose>, Failure> {
    let at = |what: String| Failure::Input(format!("{}: {what}", path.display()));
    let bytes = std::fs::read(path).map_err(|error| at(error.to_string()))?;
    let text = std::str::from_utf8(&bytes).map_err(|error| at(format!("no text: {error}")))?;
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut poses = Vec::new();
    let mut first = true;
    for (i, line) in text.lines().enumerate() {
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        // The header names the columns; a path without a header starts with a number.
        let is_header =
            std::mem::take(&mut first) && line.split(',').all(|name| name.trim().parse::<f64>().is_err());
        if !is_header {
            poses.push(pose(line).map_err(|what| at(format!("line {}: {what}", i + 1)))?);
        }
    }
    if poses.is_empty() { Err(at("there are no frames".to_owned())) } else { Ok(poses) }
}

fn pose(line: &str) -> Result<Pose, String> {
    let mut fields = line.split(',').map(str::trim);
    let frame = fields.next().unwrap_or_default();
    let frame = frame.parse().map_err(|_| format!("{frame:?} is no number of a frame"))?;
    let mut numbers = [0.0; 6];
    for (number, name) in
        numbers.iter_mut().zip(["eye x", "eye y", "eye z", "target x", "target y", "target z"])
    {
        let field = fields.next().ok_or_else(|| format!("there is no {name}"))?;
        let parsed = field.parse::<f64>().ok().filter(|x| x.is_finite());
        *number = parsed.ok_or_else(|| format!("{field:?} is no number for {name}"))?;
    }
    if fields.next().is_some() {
        return Err("there are more than 7 columns".to_owned());
    }
    let [a, b, c, d, e, f] = numbers;
    Ok(Pose { frame, eye: [a, b, c], target: [d, e, f] })
}
