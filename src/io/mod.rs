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
//! | `obj.rs`, `ply/`, `stl.rs`, `off.rs`, `gltf/` | one format each, what it keeps and what reads it at its head |
//! | `draft.rs` | what readers fill: a mesh before rounding |
//! | `text.rs` | lines, words and numbers |
//! | `polygon.rs` | polygons to triangles |
//! | `atomic.rs` | [`atomic`]: files that are whole or not there |
//! | `baked.rs` | [`bake`] and [`unbake`]: any structure in a checked container |
//! | `model.rs` | [`read_model`]: a baked model of whatever structure; [`Baked::read`](crate::Baked::read) where one knows |
//! | `error.rs` | what can be wrong |
//!
//! No file makes a reader panic, run for long, or reserve more than a multiple of its own size: every count is compared
//! with the bytes that are there.

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
/// This is what is written, and what comes back when it is read. Locks are only kept by the baked container.
///
/// Positions are written where they lie in the world: with the mesh's [`origin`](Mesh::origin) added in double precision.
/// Where there is one, text has as many digits as that takes, PLY has doubles, STL is text, and glTF moves its node.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Format {
    /// Wavefront OBJ, `.obj`.
    Obj,
    /// Stanford polygon format, `.ply`; read as text and binary, written as little-endian binary.
    Ply,
    /// Stereolithography, `.stl`; read as text and binary, written as binary, or as text where there is an origin.
    Stl,
    /// Object file format, `.off`; read as text and binary, written as text.
    Off,
    /// glTF 2.0 in one file, `.glb`.
    Glb,
    /// glTF 2.0 as JSON, `.gltf`; written with its buffer inside.
    Gltf,
}

impl Format {
    /// The format that a path's extension names, in any case.
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

    /// The customary extension, without a dot.
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

/// Where the origin of a mesh is put while its coordinates are still in double precision.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[non_exhaustive]
pub enum SceneOrigin {
    /// Coordinates stay as the file has them, unless single precision would round them by more than 1e-6 of the diagonal:
    /// then a point near the middle.
    #[default]
    Automatic,
    /// Coordinates stay as the file has them.
    Keep,
    /// The middle of the box around all vertices that a triangle uses.
    Center,
    /// A point in the file's coordinates.
    At([f64; 3]),
}

/// How to read a file.
#[derive(Debug, Clone, Default, PartialEq)]
#[non_exhaustive]
pub struct ReadOptions {
    /// Where to put the origin; by default it is moved only where it must be. Single precision has 24 bits, so a mesh of
    /// centimetres in map coordinates of kilometres keeps its shape only when its origin is moved.
    pub origin: SceneOrigin,
}

impl ReadOptions {
    /// Puts the origin elsewhere.
    #[must_use]
    pub fn with_origin(mut self, origin: SceneOrigin) -> Self {
        self.origin = origin;
        self
    }
}

/// A mesh as it was read, and what there is to know about it.
#[derive(Debug, Clone, Default, PartialEq)]
#[non_exhaustive]
pub struct Imported {
    /// The mesh.
    pub mesh: Mesh,
    /// What was subtracted from the file's coordinates, as [`Mesh::origin`] says too. Writers add it again.
    pub origin: [f64; 3],
    /// What a reader left out or took for granted, one line each; empty for a clean file.
    pub notes: Vec<String>,
}

/// Reads a mesh; the extension names the format.
///
/// # Errors
/// See [`ReadError`]; every message is one line and names the place.
pub fn read(path: impl AsRef<Path>) -> Result<Mesh, ReadError> {
    Ok(read_with(path, &ReadOptions::default())?.mesh)
}

/// Reads a mesh with options, and tells what was done.
///
/// # Errors
/// As [`read`].
pub fn read_with(path: impl AsRef<Path>, options: &ReadOptions) -> Result<Imported, ReadError> {
    let path = path.as_ref();
    let format = Format::from_path(path).ok_or_else(|| ReadError::UnknownFormat { path: path.to_owned() })?;
    let bytes = std::fs::read(path).map_err(|source| ReadError::Io { path: path.to_owned(), source })?;
    parse(format, &bytes, path.parent(), options)
}

/// Reads a mesh from bytes. glTF documents must have their buffers inside.
///
/// # Errors
/// As [`read`].
pub fn read_bytes(format: Format, bytes: &[u8]) -> Result<Mesh, ReadError> {
    Ok(read_bytes_with(format, bytes, &ReadOptions::default())?.mesh)
}

/// Reads a mesh from bytes with options, and tells what was done.
///
/// # Errors
/// As [`read`].
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

/// Writes a mesh; the extension names the format. What the format keeps is told at [`Format`]. The file is written whole
/// or not at all ([`atomic::write`]).
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

/// A mesh as the bytes of a file.
///
/// # Errors
/// [`WriteError::Unsupported`] where the format cannot hold the mesh.
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
