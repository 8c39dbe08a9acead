//! Reading and writing by extension.

use std::path::Path;

use crate::mesh::Mesh;

use super::{
    Format, GltfTextures, Imported, ReadError, ReadOptions, WriteError, atomic, gltf, obj, off, ply, stl,
};

/// Reads a mesh; the extension selects the format.
///
/// # Errors
/// See [`ReadError`]; every message is a single line naming the place.
///
/// ```
/// use multires::{io, mesh::shapes};
///
/// let path = std::env::temp_dir().join(format!("multires-{}.ply", std::process::id()));
/// io::write(&path, &shapes::icosphere(1))?;
/// let mesh = io::read(&path)?;
/// std::fs::remove_file(&path)?;
/// assert_eq!(mesh.triangles().len(), 80);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
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

/// Writes a mesh as .glb or .gltf that refers to pictures. The pictures are not opened.
///
/// # Errors
/// See [`WriteError`]: also another extension, and pictures on a mesh without texture coordinates.
pub fn write_textured(
    path: impl AsRef<Path>,
    mesh: &Mesh,
    textures: &GltfTextures,
) -> Result<(), WriteError> {
    let path = path.as_ref();
    let bytes = match Format::from_path(path) {
        Some(Format::Glb) => gltf::write(mesh, true, textures),
        Some(Format::Gltf) => gltf::write(mesh, false, textures),
        _ => Err(WriteError::UnknownFormat { path: path.to_owned() }),
    }?;
    atomic::write(path, &bytes).map_err(|source| WriteError::Io { path: path.to_owned(), source })
}

/// Encodes a mesh as the bytes of a file.
///
/// # Errors
/// [`WriteError::Unsupported`] if the format cannot hold the mesh.
///
/// ```
/// use multires::io::{Format, read_bytes, write_bytes};
/// use multires::mesh::shapes;
///
/// let mesh = shapes::icosphere(1);
/// let bytes = write_bytes(Format::Glb, &mesh)?;
/// assert_eq!(read_bytes(Format::Glb, &bytes)?.triangles(), mesh.triangles());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_bytes(format: Format, mesh: &Mesh) -> Result<Vec<u8>, WriteError> {
    match format {
        Format::Obj => Ok(obj::write(mesh)),
        Format::Ply => ply::write(mesh),
        Format::Stl => stl::write(mesh),
        Format::Off => Ok(off::write(mesh)),
        Format::Glb => gltf::write(mesh, true, &GltfTextures::default()),
        Format::Gltf => gltf::write(mesh, false, &GltfTextures::default()),
    }
}
