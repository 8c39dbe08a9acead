//! Baked models to and from bytes and files, with the structure known at compile time or read from the file.

use std::path::Path;

use serde::Serialize;
use serde::de::DeserializeOwned;

use super::baked::{BakeError, bake, baked_kind, read_bytes, unbake, write_baked};
use crate::gmesh::Gmesh;
use crate::hierarchy::VertexHierarchy;
use crate::lod::{Baked, Model, Structure, Vertex};
use crate::tom::TotallyOrderedMesh;
use crate::wavelet::WaveletMesh;

impl<S: Structure + Serialize + DeserializeOwned> Baked<S> {
    /// Encodes the model in the baked container. Equal models give equal bytes.
    ///
    /// # Errors
    /// Serialising the model fails; never for structures of this crate.
    pub fn to_bytes(&self) -> Result<Vec<u8>, BakeError> {
        bake(S::KIND, self)
    }

    /// Decodes a model from the bytes of [`Baked::to_bytes`].
    ///
    /// # Errors
    /// See [`BakeError`]; [`BakeError::OtherKind`] if the bytes hold another structure.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, BakeError> {
        unbake(S::KIND, bytes)
    }

    /// Writes the model to a file atomically.
    ///
    /// # Errors
    /// Errors of [`Baked::to_bytes`] and of the operating system.
    pub fn write(&self, path: impl AsRef<Path>) -> Result<(), BakeError> {
        write_baked(path, S::KIND, self)
    }

    /// Reads a model from a file.
    ///
    /// # Errors
    /// Errors of [`Baked::from_bytes`] and of the operating system.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, BakeError> {
        Self::from_bytes(&read_bytes(path.as_ref())?)
    }
}

/// A model of any structure, writable to bytes and files.
pub trait StoredModel<V: Vertex>: Model<V> {
    /// Encodes the model: [`Baked::to_bytes`].
    ///
    /// # Errors
    /// Errors of [`Baked::to_bytes`].
    fn to_bytes(&self) -> Result<Vec<u8>, BakeError>;

    /// Writes the model to a file: [`Baked::write`].
    ///
    /// # Errors
    /// Errors of [`Baked::write`].
    fn write(&self, path: &Path) -> Result<(), BakeError>;
}

impl<S: Structure + Serialize + DeserializeOwned, V: Vertex> StoredModel<V> for Baked<S> {
    fn to_bytes(&self) -> Result<Vec<u8>, BakeError> {
        self.to_bytes()
    }

    fn write(&self, path: &Path) -> Result<(), BakeError> {
        self.write(path)
    }
}

/// Decodes a model of the kind named in its bytes. The only list of all structures.
macro_rules! unbake_any {
    ($kind:expr, $bytes:expr, $($structure:ty),+) => {
        match $kind.as_str() {
            $(<$structure as Structure>::KIND => Box::new(Baked::<$structure>::from_bytes($bytes)?),)+
            _ => {
                let expected = [$(<$structure as Structure>::KIND),+].join(" or ");
                return Err(BakeError::OtherKind { found: $kind, expected });
            }
        }
    };
}

/// Decodes a baked model of any structure, drawn with vertices of type `V`.
///
/// # Errors
/// Errors of [`unbake`]; [`BakeError::OtherKind`] if the bytes hold no structure of this crate.
pub fn unbake_model<V: Vertex>(bytes: &[u8]) -> Result<Box<dyn StoredModel<V>>, BakeError> {
    let kind = baked_kind(bytes)?;
    Ok(unbake_any!(kind, bytes, VertexHierarchy, TotallyOrderedMesh, WaveletMesh, Gmesh))
}

/// Reads a baked model of any structure from a file, drawn with vertices of type `V`.
///
/// # Errors
/// Errors of [`unbake_model`] and of the operating system.
///
/// ```
/// use multires::{LodOptions, Structure, hierarchy::VertexHierarchy, io, mesh::shapes};
///
/// let path = std::env::temp_dir().join(format!("multires-{}.mres", std::process::id()));
/// let mesh = shapes::icosphere(2);
/// VertexHierarchy::bake(&mesh)?.write(&path)?;
/// let model = io::read_model::<[f32; 3]>(&path)?; // of any structure
/// std::fs::remove_file(&path)?;
/// let values = model.origins().arrange(mesh.positions())?.into();
/// let lod = model.instance(&values, &LodOptions::default())?;
/// assert_eq!(lod.groups(), 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn read_model<V: Vertex>(path: impl AsRef<Path>) -> Result<Box<dyn StoredModel<V>>, BakeError> {
    unbake_model(&read_bytes(path.as_ref())?)
}
