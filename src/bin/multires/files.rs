//! Reads and writes files: reasons name the file, and outputs are checked before the work starts.

use std::path::Path;

use multires::io::{self, BakeError, Format, Imported, ReadError, ReadOptions};
use multires::mesh::Mesh;
use serde_json::{Value, json};

use crate::output::Failure;

/// Reads a mesh file.
pub fn read_mesh(path: &Path) -> Result<Imported, Failure> {
    io::read_with(path, &ReadOptions::default()).map_err(|error| match error {
        ReadError::Io { .. } | ReadError::UnknownFormat { .. } => Failure::input(error),
        _ => Failure::Input(format!("{}: {error}", path.display())),
    })
}

/// Makes a reason naming the file once.
pub fn baked(path: &Path, error: &BakeError) -> Failure {
    match error {
        BakeError::Io { .. } => Failure::input(error),
        _ => Failure::Input(format!("{}: {error}", path.display())),
    }
}

/// Checks a mesh file to be written: its format can be written, its place exists.
pub fn check_mesh_output(path: &Path) -> Result<(), Failure> {
    if Format::from_path(path).is_none() {
        return Err(Failure::Usage(format!(
            "{}: the extension is none of .obj, .ply, .stl, .off, .glb, .gltf",
            path.display()
        )));
    }
    check_place(path)
}

/// Checks a file to be written with a required extension: `mres`, `ply`, `png`.
pub fn check_output(path: &Path, extension: &str) -> Result<(), Failure> {
    if path.extension().is_none_or(|e| !e.eq_ignore_ascii_case(extension)) {
        return Err(Failure::Usage(format!("{}: the extension is not .{extension}", path.display())));
    }
    check_place(path)
}

/// Checks a place to be written to, before the work rather than after it.
pub fn check_place(path: &Path) -> Result<(), Failure> {
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if path.is_dir() {
        Err(Failure::Input(format!("{}: is a folder", path.display())))
    } else if !folder.is_dir() {
        Err(Failure::Input(format!("{}: there is no such folder", folder.display())))
    } else {
        Ok(())
    }
}

/// Writes bytes, all of them or none.
pub fn write_bytes(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    io::atomic::write(path, bytes).map_err(|error| Failure::Input(format!("{}: {error}", path.display())))
}

/// Writes a mesh, whole or not at all.
pub fn write_mesh(path: &Path, mesh: &Mesh) -> Result<(), Failure> {
    io::write(path, mesh).map_err(|error| match error {
        io::WriteError::Io { .. } | io::WriteError::UnknownFormat { .. } => Failure::input(error),
        _ => Failure::Input(format!("{}: {error}", path.display())),
    })
}

/// Returns the bytes of a file; 0 if they are unknown.
pub fn size(path: &Path) -> u64 {
    std::fs::metadata(path).map_or(0, |m| m.len())
}

/// Describes a file and its mesh, for JSON.
pub fn describe(path: &Path, mesh: &Mesh) -> Value {
    json!({
        "path": path.display().to_string(),
        "bytes": size(path),
        "vertices": mesh.positions().len(),
        "triangles": mesh.triangles().len(),
    })
}

/// Describes a file and its mesh, for people.
pub fn describe_text(path: &Path, mesh: &Mesh) -> String {
    let (vertices, triangles) = (mesh.positions().len(), mesh.triangles().len());
    format!("{}: {vertices} vertices, {triangles} triangles", path.display())
}
