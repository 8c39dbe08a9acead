//! Output and end of a command: text or a JSON object on stdout, warnings and reasons on stderr.
//!
//! Nothing here panics on a closed stream: a reader may stop early without an error.

use std::io::{self, Write};
use std::path::Path;
use std::process::ExitCode;

use serde_json::{Value, json};

/// A command with its arguments.
pub trait Run {
    /// Runs the command.
    ///
    /// # Errors
    /// Names who is at fault, and why. Nothing was written then.
    fn run(&self) -> Result<Answer, Failure>;
}

/// Findings or work of a command.
pub struct Answer {
    /// For programs: an object.
    pub json: Value,
    /// For people: lines, without the last line end.
    pub text: String,
    /// A line each, printed on stderr in both cases.
    pub warnings: Vec<String>,
    /// Files that could not be worked on, among others that could; a line each, printed on stderr. With any the exit code is 1.
    pub failures: Vec<String>,
}

/// Why a command did nothing.
pub enum Failure {
    /// A file cannot be read, used or written: exit code 1.
    Input(String),
    /// The arguments do not fit together: exit code 2.
    Usage(String),
}

impl Failure {
    /// Makes a failure with a file at fault.
    pub fn input(reason: impl ToString) -> Self {
        Self::Input(reason.to_string())
    }

    /// Names the file at fault, if it is a file.
    pub fn about(self, path: &Path) -> Self {
        match self {
            Self::Input(reason) => Self::Input(format!("{}: {reason}", path.display())),
            usage => usage,
        }
    }
}

/// Prints an answer.
pub fn answer(answer: &Answer, json: bool) -> ExitCode {
    for warning in &answer.warnings {
        complain("warning", warning);
    }
    let text = if json { answer.json.to_string() } else { answer.text.clone() };
    let code = if answer.failures.is_empty() { ExitCode::SUCCESS } else { ExitCode::FAILURE };
    let said = say(&text);
    answer.failures.iter().for_each(|failure| complain("error", failure));
    match said {
        Ok(()) => code,
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => code,
        Err(error) => {
            complain("error", &format!("standard output: {error}"));
            ExitCode::FAILURE
        }
    }
}

/// Prints why nothing was done.
pub fn failure(reason: &str, json: bool) -> ExitCode {
    complain("error", reason);
    if json {
        let _ = say(&json!({ "error": one_line(reason) }).to_string());
    }
    ExitCode::FAILURE
}

/// Prints an error of the arguments, or the help or version.
pub fn usage(error: &clap::Error, json: bool) -> ExitCode {
    let _ = error.print();
    if json && error.use_stderr() {
        let text = error.to_string();
        let reason = text.lines().next().unwrap_or_default();
        let _ = say(&json!({ "error": reason.strip_prefix("error: ").unwrap_or(reason) }).to_string());
    }
    ExitCode::from(if error.use_stderr() { 2 } else { 0 })
}

fn say(text: &str) -> io::Result<()> {
    let mut out = io::stdout().lock();
    writeln!(out, "{text}")?;
    out.flush()
}

/// Prints a line on stderr. If stderr is closed, there is nobody to tell.
fn complain(kind: &str, reason: &str) {
    let _ = writeln!(io::stderr().lock(), "{kind}: {}", one_line(reason));
}

/// Replaces control characters by blanks: paths and names from files may hold anything.
fn one_line(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
}

/// A table of labels and values, aligned.
#[derive(Default)]
pub struct Table {
    lines: Vec<String>,
}

impl Table {
    /// Adds a row.
    pub fn row(&mut self, label: &str, value: impl std::fmt::Display) -> &mut Self {
        self.lines.push(one_line(&format!("{label:<20} {value}")));
        self
    }

    /// Adds lines as they are.
    pub fn block(&mut self, text: impl std::fmt::Display) -> &mut Self {
        self.lines.push(text.to_string());
        self
    }

    /// Returns all lines.
    pub fn text(&self) -> String {
        self.lines.join("\n")
    }
}

/// Returns a length in percent of another; `None` (in JSON: null) if the result is not finite.
pub fn percent(part: f64, whole: f64) -> Option<f64> {
    Some(100.0 * part / whole).filter(|p| p.is_finite())
}

/// Formats an error bound for people.
pub fn error_text(error: f64, percent: Option<f64>) -> String {
    match percent {
        Some(percent) => format!("{error:.6} ({percent:.4} % of the diagonal)"),
        None => format!("{error:.6}"),
    }
}
