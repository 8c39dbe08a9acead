//! Real models, where there are any: in the folder that `MULTIRES_MODELS` names, `../shared/models` by default.

#![allow(dead_code)]

use std::path::{Path, PathBuf};

/// The folder, be it there or not.
fn folder() -> PathBuf {
    let given = std::env::var_os("MULTIRES_MODELS").map(PathBuf::from);
    given.unwrap_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/models"))
}

/// The folder; `None`, with a word on stderr, where it is not there.
pub fn all(test: &str) -> Option<PathBuf> {
    let folder = folder();
    if !folder.is_dir() {
        eprintln!("{test}: skipping: no models in {} (set MULTIRES_MODELS)", folder.display());
        return None;
    }
    Some(folder)
}

/// A file or folder in it; `None`, with a word on stderr, where it is not there.
pub fn find(test: &str, name: &str) -> Option<PathBuf> {
    let path = folder().join(name);
    if !path.exists() {
        eprintln!("{test}: skipping {name}: no {} (set MULTIRES_MODELS)", path.display());
        return None;
    }
    Some(path)
}

/// A model of it; `None`, with a word on stderr, where it is not there.
#[cfg(feature = "io")]
pub fn read(test: &str, name: &str) -> Option<multires::mesh::Mesh> {
    find(test, name).map(|path| multires::io::read(path).unwrap())
}
