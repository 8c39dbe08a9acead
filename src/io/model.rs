//! Baked models to and from bytes and files, of a structure that one knows or of whatever is in the file.

use std::path::Path;

use serde::Serialize;
use serde::de::DeserializeOwned;

use super::baked::{BakeError, bake, baked_kind, read_bytes, unbake, write_baked};
use crate::hierarchy::VertexHierarchy;
use crate::lod::{Baked, Model, Structure, Vertex};
use crate::tom::TotallyOrderedMesh;
use crate::wavelet::WaveletMesh;

impl<S: Structure + Serialize + DeserializeOwned> Baked<S> {
    /// The model in the baked container. The same model gives the same bytes.
    ///
    /// # Errors
    /// The model refuses to be serialised, which none of this crate does.
    pub fn to_bytes(&self) -> Result<Vec<u8>, BakeError> {
        bake(S::KIND, self)
    }

    /// The model that [`Baked::to_bytes`] made bytes from.
    ///
    /// # Errors
    /// See [`BakeError`]; also where the bytes hold another structure.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, BakeError> {
        unbake(S::KIND, bytes)
    }

    /// Writes the model to a file, whole or not at all.
    ///
    /// # Errors
    /// What the system says.
    pub fn write(&self, path: impl AsRef<Path>) -> Result<(), BakeError> {
        write_baked(path, S::KIND, self)
    }

    /// Reads a model from a file.
    ///
    /// # Errors
    /// As [`Baked::from_bytes`], or what the system says.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, BakeError> {
        Self::from_bytes(&read_bytes(path.as_ref())?)
    }
}

/// A model that can be written, whatever its structure.
pub trait StoredModel<V: Vertex>: Model<V> {
    /// [`Baked::to_bytes`].
    ///
    /// # Errors
    /// Those of [`Baked::to_bytes`].
    fn to_bytes(&self) -> Result<Vec<u8>, BakeError>;

    /// [`Baked::write`].
    ///
    /// # Errors
    /// Those of [`Baked::write`].
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

/// Makes a model of the kind that its bytes name: here, and nowhere else, are all structures listed.
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

/// A baked model of whatever structure, drawn with vertices of type `V`.
///
/// # Errors
/// As [`unbake`]; also where the bytes hold none of this crate's structures.
pub fn unbake_model<V: Vertex>(bytes: &[u8]) -> Result<Box<dyn StoredModel<V>>, BakeError> {
    let kind = baked_kind(bytes)?;
    Ok(unbake_any!(kind, bytes, VertexHierarchy, TotallyOrderedMesh, WaveletMesh))
}

/// The same from a file.
///
/// # Errors
/// As [`unbake_model`], or what the system says.
pub fn read_model<V: Vertex>(path: impl AsRef<Path>) -> Result<Box<dyn StoredModel<V>>, BakeError> {
    unbake_model(&read_bytes(path.as_ref())?)
}
