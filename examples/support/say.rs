//! What examples print, and how they end: a reader that goes away (`| head`) ends them without a word.

use std::error::Error;
use std::io::{self, ErrorKind, StdoutLock, Write};
use std::process::ExitCode;

/// Runs with standard output at hand. Where writing to it fails because nobody reads any more, that is the end and no failure;
/// any other error is told.
pub fn to_stdout(run: impl FnOnce(&mut StdoutLock<'_>) -> Result<(), Box<dyn Error>>) -> ExitCode {
    let mut out = io::stdout().lock();
    match run(&mut out).and_then(|()| Ok(out.flush()?)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            let gone = error.downcast_ref::<io::Error>().is_some_and(|e| e.kind() == ErrorKind::BrokenPipe);
            if gone {
                return ExitCode::SUCCESS;
            }
            // Standard error may be gone too: then there is nobody to tell.
            let _ = writeln!(io::stderr(), "error: {error}");
            ExitCode::FAILURE
        }
    }
}

/// With a comma at every thousand.
pub fn grouped(number: usize) -> String {
    let digits = number.to_string();
    let mut out = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            out.push(',');
        }
        out.push(digit);
    }
    out
}

/// An error with the file it is about, once.
pub fn name_file(path: &std::path::Path, error: &dyn Error) -> String {
    let (path, message) = (path.display().to_string(), error.to_string());
    if message.contains(&path) { message } else { format!("{path}: {message}") }
}
