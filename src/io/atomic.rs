//! Files that are whole or not there: written beside their place, made durable, and renamed over it.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

/// Puts `bytes` at `path`. On any error nothing is left behind, and a file that was there before is untouched.
///
/// A symbolic link is followed and stays; permissions of an existing file are kept. What is there but is no regular file
/// (a terminal, a pipe, the null device) is written to directly.
///
/// # Errors
/// Whatever the system says.
pub fn write(path: impl AsRef<Path>, bytes: &[u8]) -> io::Result<()> {
    write_with(path, |file| file.write_all(bytes))
}

/// As [`write()`], with a closure that writes the content.
///
/// # Errors
/// What `fill` or the system says.
pub fn write_with(path: impl AsRef<Path>, fill: impl FnOnce(&mut File) -> io::Result<()>) -> io::Result<()> {
    let path = path.as_ref();
    let old = fs::metadata(path).ok();
    if old.as_ref().is_some_and(|m| !m.is_file() && !m.is_dir()) {
        return fill(&mut OpenOptions::new().write(true).open(path)?);
    }
    let target = if old.is_some() { fs::canonicalize(path)? } else { path.to_owned() };
    let (temporary, mut file) = Temporary::beside(&target)?;
    fill(&mut file)?;
    if let Some(old) = old.filter(fs::Metadata::is_file) {
        file.set_permissions(old.permissions())?;
    }
    file.sync_all()?;
    drop(file);
    fs::rename(&temporary.path, &target)?;
    std::mem::forget(temporary);
    // The rename is durable once the directory is; where directories cannot be opened there is nothing to do.
    if let Ok(directory) = File::open(parent(&target)) {
        let _ = directory.sync_all();
    }
    Ok(())
}

fn parent(path: &Path) -> &Path {
    path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// A file that goes away unless it is renamed.
struct Temporary {
    path: PathBuf,
}

impl Temporary {
    /// A new file in the same directory, under a name that nothing has.
    fn beside(target: &Path) -> io::Result<(Self, File)> {
        static NEXT: AtomicU64 = AtomicU64::new(0);
        let name = target.file_name().ok_or(io::Error::from(io::ErrorKind::InvalidInput))?;
        loop {
            let unique = format!(".{}.{}.tmp", std::process::id(), NEXT.fetch_add(1, Ordering::Relaxed));
            // Long names are cut, so that the temporary one is not too long where the target's is not.
            let mut hidden = String::from(".");
            hidden.extend(name.to_string_lossy().chars().take(40));
            let path = parent(target).join(hidden + &unique);
            match OpenOptions::new().write(true).create_new(true).open(&path) {
                Ok(file) => return Ok((Self { path }, file)),
                Err(e) if e.kind() == io::ErrorKind::AlreadyExists => {}
                Err(e) => return Err(e),
            }
        }
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.path);
    }
}
