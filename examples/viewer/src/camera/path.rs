//! Camera paths as text: `#` comments, a header line, then frame, eye x y z, target x y z, with commas.
//!
//! Places are in diagonals of the model's box from its centre, as those of `multires fly`, so that one path fits every model.

use std::fmt::Write as _;
use std::path::Path as FilePath;

use multires::io::atomic;

use super::Pose;

/// Most frames that are read or recorded: ten hours at 60 a second.
const MOST: usize = 60 * 3600 * 10;

/// Why a path could not be read or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PathError {
    /// The file cannot be read or written.
    #[error("{path}: {source}")]
    Io {
        /// The file.
        path: String,
        /// What the system says.
        source: std::io::Error,
    },
    /// A line that is no frame.
    #[error("line {line}: {what}")]
    Line {
        /// Its number, from 1.
        line: usize,
        /// What is wrong with it.
        what: String,
    },
    /// No frames at all.
    #[error("there are no frames")]
    Empty,
    /// Too many frames.
    #[error("there are more than {MOST} frames")]
    TooMany,
}

/// One frame of a path, in diagonals from the centre.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathFrame {
    /// Its number.
    pub frame: u64,
    /// The eye.
    pub eye: [f64; 3],
    /// What it looks at.
    pub target: [f64; 3],
}

/// Frames in order.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Path {
    frames: Vec<PathFrame>,
}

/// A box's centre and diagonal, which paths are measured in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Unit {
    pub centre: [f64; 3],
    pub diagonal: f64,
}

impl Path {
    /// Reads a path.
    ///
    /// # Errors
    /// The file cannot be read, or is no path.
    pub fn read(path: impl AsRef<FilePath>) -> Result<Self, PathError> {
        let path = path.as_ref();
        let text = std::fs::read_to_string(path)
            .map_err(|source| PathError::Io { path: path.display().to_string(), source })?;
        Self::parse(&text)
    }

    /// A path from its text.
    ///
    /// # Errors
    /// The first line that is no frame; no frames, or too many.
    pub fn parse(text: &str) -> Result<Self, PathError> {
        let mut frames = Vec::new();
        let mut first = true;
        for (i, line) in text.trim_start_matches('\u{feff}').lines().enumerate() {
            let line = line.trim();
            if line.is_empty() || line.starts_with('#') {
                continue;
            }
            // The header names the columns; a path without one starts with a number.
            if std::mem::take(&mut first) && line.split(',').all(|name| name.trim().parse::<f64>().is_err()) {
                continue;
            }
            if frames.len() == MOST {
                return Err(PathError::TooMany);
            }
            frames.push(frame(line).map_err(|what| PathError::Line { line: i + 1, what })?);
        }
        if frames.is_empty() { Err(PathError::Empty) } else { Ok(Self { frames }) }
    }

    /// The frames.
    pub fn frames(&self) -> &[PathFrame] {
        &self.frames
    }

    /// Records one more pose of a scene with that centre and diagonal; `false` where there are too many.
    pub fn record(&mut self, pose: &Pose, centre: [f64; 3], diagonal: f64) -> bool {
        let unit = Unit { centre, diagonal };
        let fits = self.frames.len() < MOST && diagonal > 0.0 && pose.is_finite();
        if fits {
            let frame = self.frames.len() as u64;
            self.frames.push(PathFrame {
                frame,
                eye: unit.inward(pose.eye),
                target: unit.inward(pose.target),
            });
        }
        fits
    }

    /// The pose of an entry in a scene with that centre and diagonal; `None` beyond the last.
    pub fn pose(&self, entry: usize, centre: [f64; 3], diagonal: f64, up: [f64; 3]) -> Option<Pose> {
        let unit = Unit { centre, diagonal };
        let frame = self.frames.get(entry)?;
        Some(Pose { eye: unit.outward(frame.eye), target: unit.outward(frame.target), up })
    }

    /// The path as text, which [`Path::parse`] reads.
    pub fn text(&self) -> String {
        let mut text =
            String::from("# in diagonals of the model's box, from its centre\nframe,ex,ey,ez,tx,ty,tz\n");
        for PathFrame { frame, eye: [a, b, c], target: [d, e, f] } in &self.frames {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{frame},{a:.9},{b:.9},{c:.9},{d:.9},{e:.9},{f:.9}");
        }
        text
    }

    /// Writes the path, whole or not at all.
    ///
    /// # Errors
    /// What the system says.
    pub fn write(&self, path: impl AsRef<FilePath>) -> Result<(), PathError> {
        let path = path.as_ref();
        atomic::write(path, self.text().as_bytes())
            .map_err(|source| PathError::Io { path: path.display().to_string(), source })
    }
}

impl Unit {
    fn inward(&self, p: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|i| (p[i] - self.centre[i]) / self.diagonal)
    }

    fn outward(&self, p: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|i| self.centre[i] + self.diagonal * p[i])
    }
}

fn frame(line: &str) -> Result<PathFrame, String> {
    let mut fields = line.split(',').map(str::trim);
    let number = fields.next().unwrap_or_default();
    let number = number.parse().map_err(|_| format!("{number:?} is no number of a frame"))?;
    let mut places = [0.0; 6];
    for (place, name) in places.iter_mut().zip(["ex", "ey", "ez", "tx", "ty", "tz"]) {
        let field = fields.next().ok_or_else(|| format!("there is no {name}"))?;
        let parsed = field.parse::<f64>().ok().filter(|x| x.is_finite());
        *place = parsed.ok_or_else(|| format!("{field:?} is no number for {name}"))?;
    }
    if fields.next().is_some() {
        return Err("there are more than 7 columns".to_owned());
    }
    let [a, b, c, d, e, f] = places;
    Ok(PathFrame { frame: number, eye: [a, b, c], target: [d, e, f] })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_recorded_comes_back() {
        let (centre, diagonal, up) = ([1.0, -2.0, 3.0], 4.0, [0.0, 1.0, 0.0]);
        let mut path = Path::default();
        for i in 0..5 {
            let pose = Pose { eye: [f64::from(i), 0.5, 2.0], target: centre, up };
            assert!(path.record(&pose, centre, diagonal));
        }
        let back = Path::parse(&path.text()).unwrap();
        assert_eq!(back.frames().len(), 5);
        for i in 0..5 {
            let pose = back.pose(i, centre, diagonal, up).unwrap();
            assert!((pose.eye[0] - i as f64).abs() < 1e-6 && (pose.eye[1] - 0.5).abs() < 1e-6);
        }
        assert_eq!(back.pose(5, centre, diagonal, up), None);
    }

    #[test]
    fn bad_lines_are_named() {
        assert!(matches!(Path::parse("# nothing\n\n"), Err(PathError::Empty)));
        let error = Path::parse("frame,ex,ey,ez,tx,ty,tz\n0,0,0,1,0,0,0\n1,0,0,nan,0,0,0").unwrap_err();
        assert_eq!(error.to_string(), "line 3: \"nan\" is no number for ez");
        assert!(Path::parse("0,1,2,3,4,5").is_err());
        assert!(Path::parse("0,1,2,3,4,5,6,7").is_err());
    }
}
