//! Reading and writing files.
//!
//! ```text
//!     bytes --> reader of a format --> Draft (f64) --> origin moved, rounded --> Mesh
//!     Mesh  --> writer of a format --> bytes --> temporary file --> renamed over the old one
//! ```
//!
//! | file | idea |
//! |---|---|
//! | `mod.rs` | [`read`] and [`write`](write()) by extension |
//! | `obj.rs`, `ply/`, `stl.rs`, `off.rs`, `gltf/` | a format each; its head tells what is kept and how it is parsed |
//! | `draft.rs` | output of readers: a mesh before rounding |
//! | `text.rs` | lines, words and numbers |
//! | `polygon.rs` | polygons to triangles |
//! | `atomic.rs` | [`atomic`]: atomic writes of files |
//! | `baked.rs` | [`bake`] and [`unbake`]: any structure in a checked container |
//! | `model.rs` | [`read_model`]: a baked model of any structure; for a known structure: [`Baked::read`](crate::Baked::read) |
//! | `error.rs` | errors of reading and writing |
//!
//! No file makes a reader panic, run for long, or reserve more than a multiple of the file's size: every declared count
//! is checked against the bytes present.

pub mod atomic;
mod baked;
mod draft;
mod error;
mod gltf;
mod model;
mod obj;
mod off;
mod ply;
mod polygon;
mod stl;
mod text;

use std::fmt;
use std::path::Path;

pub use baked::{BakeError, VERSION as BAKED_VERSION, bake, baked_kind, read_baked, unbake, write_baked};
pub use error::{Place, ReadError, WriteError};
pub use model::{StoredModel, read_model, unbake_model};

use crate::mesh::Mesh;

/// A mesh file format.
///
/// | | positions | triangles | attributes | materials |
/// |---|---|---|---|---|
/// | OBJ | exact | exact | `color`, `uv`, `normal` | ids and names |
/// | PLY | exact | exact | all | ids and names |
/// | STL | exact, welded | exact | none | none |
/// | OFF | exact | exact | `color`, `uv`, `normal` | none |
/// | glTF | exact | exact, grouped by material | all up to width 4 | ids and names |
///
/// The table lists the data written, and restored on reading. Files leave out the attribute `vertex`. Only the baked
/// container keeps locks.
///
/// Positions are written in world coordinates: the mesh's [`origin`](Mesh::origin) is added in double precision. If the
/// origin is not zero, text has the digits needed, PLY has doubles, STL is text, and glTF moves its node.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Format {
    /// Wavefront OBJ, `.obj`.
    Obj,
    /// Stanford polygon format, `.ply`; read as text and binary, written as little-endian binary.
    Ply,
    /// Stereolithography, `.stl`; read as text and binary, written as binary, or as text if the origin is not zero.
    Stl,
    /// Object file format, `.off`; read as text and binary, written as text.
    Off,
    /// glTF 2.0 in a single file, `.glb`.
    Glb,
    /// glTF 2.0 as JSON, `.gltf`; written with an embedded buffer.
    Gltf,
}

impl Format {
    /// Returns the format of a path's extension, ignoring case.
    pub fn from_path(path: impl AsRef<Path>) -> Option<Self> {
        let extension = path.as_ref().extension()?.to_str()?.to_ascii_lowercase();
        Some(match extension.as_str() {
            "obj" => Self::Obj,
            "ply" => Self::Ply,
            "stl" => Self::Stl,
            "off" => Self::Off,
            "glb" => Self::Glb,
            "gltf" => Self::Gltf,
            _ => return None,
        })
    }

    /// Returns the customary extension, without a dot.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Obj => "obj",
            Self::Ply => "ply",
            Self::Stl => "stl",
            Self::Off => "off",
            Self::Glb => "glb",
            Self::Gltf => "gltf",
        }
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.extension())
    }
}

/// Origin of a mesh being read, chosen while its coordinates are in double precision.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[non_exhaustive]
pub enum SceneOrigin {
    /// Keeps the file's coordinates, unless single precision would round them by more than 1e-6 of the diagonal: then a
    /// point near the middle.
    #[default]
    Automatic,
    /// Keeps the file's coordinates.
    Keep,
    /// The middle of the box around all vertices used by triangles.
    Center,
    /// A point in the file's coordinates.
    At([f64; 3]),
}

/// Options for reading a file.
#[derive(Debug, Clone, Default, PartialEq)]
#[non_exhaustive]
pub struct ReadOptions {
    /// Origin of the mesh; by default moved only if needed. Single precision has 24 bits: a mesh with details of
    /// centimetres in map coordinates of kilometres keeps its shape only if its origin is moved.
    pub origin: SceneOrigin,
}

impl ReadOptions {
    /// Sets the choice of the origin.
    #[must_use]
    pub fn with_origin(mut self, origin: SceneOrigin) -> Self {
        self.origin = origin;
        self
    }
}

/// A mesh read from a file, with notes about the reading.
#[derive(Debug, Clone, Default, PartialEq)]
#[non_exhaustive]
pub struct Imported {
    /// The mesh.
    pub mesh: Mesh,
    /// Offset subtracted from the file's coordinates, equal to [`Mesh::origin`]. Writers add it again.
    pub origin: [f64; 3],
    /// Content skipped or assumed by the reader, a line each; empty for a clean file.
    pub notes: Vec<String>,
}

/// Reads a mesh; the extension selects the format.
///
/// # Errors
/// See [`ReadError`]; every message is a single line naming the place.
pub fn read(path: impl AsRef<Path>) -> Result<Mesh, ReadError> {
    Ok(read_with(path, &ReadOptions::default())?.mesh)
}

/// Reads a mesh with options; returns notes about the reading.
///
/// # Errors
/// Errors of [`read`].
pub fn read_with(path: impl AsRef<Path>, options: &ReadOptions) -> Result<Imported, ReadError> {
    let path = path.as_ref();
    let format = Format::from_path(path).ok_or_else(|| ReadError::UnknownFormat { path: path.to_owned() })?;
    let bytes = std::fs::read(path).map_err(|source| ReadError::Io { path: path.to_owned(), source })?;
    parse(format, &bytes, path.parent(), options)
}

/// Reads a mesh from bytes. glTF documents must have their buffers embedded.
///
/// # Errors
/// Errors of [`read`].
pub fn read_bytes(format: Format, bytes: &[u8]) -> Result<Mesh, ReadError> {
    Ok(read_bytes_with(format, bytes, &ReadOptions::default())?.mesh)
}

/// Reads a mesh from bytes with options; returns notes about the reading.
///
/// # Errors
/// Errors of [`read`].
pub fn read_bytes_with(format: Format, bytes: &[u8], options: &ReadOptions) -> Result<Imported, ReadError> {
    parse(format, bytes, None, options)
}

fn parse(
    format: Format,
    bytes: &[u8],
    directory: Option<&Path>,
    options: &ReadOptions,
) -> Result<Imported, ReadError> {
    let draft = match format {
        Format::Obj => obj::read(bytes),
        Format::Ply => ply::read(bytes),
        Format::Stl => stl::read(bytes),
        Format::Off => off::read(bytes),
        Format::Glb | Format::Gltf => gltf::read(bytes, directory),
    }?;
    draft.finish(options)
}

/// Writes a mesh; the extension selects the format. [`Format`] lists the data kept by each format. The write is atomic
/// ([`atomic::write`]).
///
/// # Errors
/// See [`WriteError`].
pub fn write(path: impl AsRef<Path>, mesh: &Mesh) -> Result<(), WriteError> {
    let path = path.as_ref();
    let format =
        Format::from_path(path).ok_or_else(|| WriteError::UnknownFormat { path: path.to_owned() })?;
    let bytes = write_bytes(format, mesh)?;
    atomic::write(path, &bytes).map_err(|source| WriteError::Io { path: path.to_owned(), source })
}

/// Encodes a mesh as the bytes of a file.
///
/// # Errors
/// [`WriteError::Unsupported`] if the format cannot hold the mesh.
pub fn write_bytes(format: Format, mesh: &Mesh) -> Result<Vec<u8>, WriteError> {
    match format {
        Format::Obj => Ok(obj::write(mesh)),
        Format::Ply => ply::write(mesh),
        Format::Stl => stl::write(mesh),
        Format::Off => Ok(off::write(mesh)),
        Format::Glb => gltf::write(mesh, true),
        Format::Gltf => gltf::write(mesh, false),
    }
}
