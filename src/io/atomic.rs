//! Atomic writes: a temporary file beside the target, made durable, then renamed over the target.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

/// Writes `bytes` to `path`. After an error no temporary file is left, and an existing file is unchanged.
///
/// Follows a symbolic link and keeps it. Keeps the permissions of an existing file. Writes directly to a path that is
/// not a regular file (a terminal, a pipe, the null device).
///
/// # Errors
/// Errors of the operating system.
pub fn write(path: impl AsRef<Path>, bytes: &[u8]) -> io::Result<()> {
    write_with(path, |file| file.write_all(bytes))
}

/// Writes a file like [`write()`], calling `fill` to write the content.
///
/// # Errors
/// Errors of `fill` or of the operating system.
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
    // The rename is durable once the directory is synced. Where directories cannot be opened, syncing is skipped.
    if let Ok(directory) = File::open(parent(&target)) {
        let _ = directory.sync_all();
    }
    Ok(())
}

fn parent(path: &Path) -> &Path {
    path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// A file deleted on drop, unless renamed.
struct Temporary {
    path: PathBuf,
}

impl Temporary {
    /// Creates a file in the directory of `target`, under an unused name.
    fn beside(target: &Path) -> io::Result<(Self, File)> {
        static NEXT: AtomicU64 = AtomicU64::new(0);
        let name = target.file_name().ok_or(io::Error::from(io::ErrorKind::InvalidInput))?;
        loop {
            let unique = format!(".{}.{}.tmp", std::process::id(), NEXT.fetch_add(1, Ordering::Relaxed));
            // Long names are cut: the temporary name fits where the target's name fits.
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
