//! Atomic writes: a temporary file beside the target, made durable, then renamed over the target.

use std::collections::BTreeSet;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

use super::temporary_name::Writer;

/// Most links followed from a path, as many as Linux follows.
const MOST_LINKS: usize = 40;
/// Most directories remembered as cleaned.
const MOST_CLEANED: usize = 1024;

/// Writes `bytes` to `path`. After an error no temporary file is left, and an existing file is unchanged.
///
/// Follows symbolic links and keeps them; creates the file that a link leads to, if there is none. Keeps the permissions of
/// an existing file. Writes directly to a path that is not a regular file (a terminal, a pipe, the null device).
///
/// A killed process leaves its temporary file. The next process that writes into the same directory removes it: on Linux
/// at once, elsewhere when it is a day old. Temporary files of running processes stay.
///
/// # Errors
/// Errors of the operating system; more than 40 links in a row.
pub fn write(path: impl AsRef<Path>, bytes: &[u8]) -> io::Result<()> {
    write_with(path, |file| file.write_all(bytes))
}

/// Writes a file like [`write()`], calling `fill` to write the content.
///
/// # Errors
/// Errors of `fill` or of the operating system; more than 40 links in a row.
pub fn write_with(path: impl AsRef<Path>, fill: impl FnOnce(&mut File) -> io::Result<()>) -> io::Result<()> {
    let path = path.as_ref();
    let old = fs::metadata(path).ok();
    if old.as_ref().is_some_and(|m| !m.is_file() && !m.is_dir()) {
        return fill(&mut OpenOptions::new().write(true).open(path)?);
    }
    let target = if old.is_some() { fs::canonicalize(path)? } else { end_of_links(path)? };
    clean_once(parent(&target));
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

/// Returns the path that a chain of symbolic links leads to, whether or not there is a file.
fn end_of_links(path: &Path) -> io::Result<PathBuf> {
    let mut path = path.to_owned();
    for _ in 0..MOST_LINKS {
        match fs::read_link(&path) {
            Ok(target) => path = parent(&path).join(target),
            // Not a link, or nothing there.
            Err(_) => return Ok(path),
        }
    }
    Err(io::Error::other(format!("more than {MOST_LINKS} symbolic links in a row")))
}

fn parent(path: &Path) -> &Path {
    path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Removes temporary files that killed processes left in a directory, once in a directory and process: listing a directory
/// before each of many writes would take quadratic time.
fn clean_once(directory: &Path) {
    static CLEANED: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());
    let Ok(directory) = fs::canonicalize(directory) else { return };
    {
        let Ok(mut cleaned) = CLEANED.lock() else { return };
        if !cleaned.insert(directory.clone()) {
            return;
        }
        if cleaned.len() > MOST_CLEANED {
            cleaned.clear();
        }
    }
    let Ok(entries) = fs::read_dir(&directory) else { return };
    for entry in entries.filter_map(Result::ok) {
        if entry.file_name().to_str().and_then(Writer::of_file).is_some_and(|writer| {
            entry.metadata().is_ok_and(|file| file.is_file() && writer.has_abandoned(&file))
        }) {
            // Another process may have removed it.
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// A file deleted on drop, unless renamed.
struct Temporary {
    path: PathBuf,
}

impl Temporary {
    /// Creates a file in the directory of `target`, under an unused name.
    fn beside(target: &Path) -> io::Result<(Self, File)> {
        static NEXT: AtomicU64 = AtomicU64::new(0);
        let of = target.file_name().ok_or(io::Error::from(io::ErrorKind::InvalidInput))?;
        let this = Writer::this();
        loop {
            let path = parent(target).join(this.name_for(of, NEXT.fetch_add(1, Ordering::Relaxed)));
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
