//! Baked models to and from bytes and files, with the structure known at compile time or read from the file.
//!
//! | bytes | arrays |
//! |---|---|
//! | borrowed ([`Baked::from_bytes`]) | copied |
//! | shared ([`Baked::from_shared`]): a memory map, a vector, a static | used in place where aligned |
//! | a file ([`Baked::read`]) | read into memory once, used in place there |
//!
//! Compressed arrays are always copied.

use std::path::Path;
use std::sync::Arc;

use super::baked::{baked_kind, baked_version, open, read_bytes, write_bytes};
use super::baked_3;
use crate::geometry::array::SharedBytes;
use crate::gmesh::Gmesh;
use crate::hierarchy::VertexHierarchy;
use crate::lod::{Baked, Model, Stored, Structure, Vertex};
use crate::sections::{BakeError, BakeOptions, OpenOptions, Reader, Sections, Writer};
use crate::tom::TotallyOrderedMesh;
use crate::wavelet::WaveletMesh;

impl<S: Stored> Baked<S> {
    /// Encodes the model in the baked container: [`Baked::to_bytes_with`] default options. Equal models give equal bytes.
    ///
    /// # Errors
    /// None for structures of this crate.
    pub fn to_bytes(&self) -> Result<Vec<u8>, BakeError> {
        self.to_bytes_with(BakeOptions::default())
    }

    /// Encodes the model in the baked container. Equal models and equal options give equal bytes. O(n).
    ///
    /// # Errors
    /// None for structures of this crate.
    pub fn to_bytes_with(&self, options: BakeOptions) -> Result<Vec<u8>, BakeError> {
        let mut writer = Writer::new(options);
        self.write_sections(&mut writer)?;
        writer.finish(S::KIND)
    }

    /// Decodes a model from the bytes of [`Baked::to_bytes`]. Checks and copies them: O(n).
    ///
    /// # Errors
    /// See [`BakeError`]; [`BakeError::OtherKind`] if the bytes hold another structure.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, BakeError> {
        if baked_version(bytes)? == baked_3::VERSION {
            return baked_3::unbake(S::KIND, bytes);
        }
        open(S::KIND, bytes, Reader::new(bytes, OpenOptions::default()), Self::read_sections)
    }

    /// Opens a model within bytes that anything holds: a memory map, a vector, a static. The model's arrays lie in the
    /// bytes: nothing is copied but compressed sections, small values, locks, and arrays whose address is not a multiple of their
    /// alignment (at most 8; sections start at multiples of 64, see [`Aligned`](super::Aligned)). O(n) if checked;
    /// O(sections) if [trusted](crate::io::Trust::Own). Of wavelet meshes the connectivity is built anew: O(n) either way.
    ///
    /// The bytes must not change while the model lives. If they do (another process writes to a mapped file), what is drawn
    /// is undefined, and calls may panic.
    ///
    /// ```
    /// use std::sync::Arc;
    ///
    /// use multires::io::OpenOptions;
    /// use multires::lod::Baked;
    /// use multires::{Structure, VertexHierarchy, mesh::shapes};
    ///
    /// let file = VertexHierarchy::bake(&shapes::icosphere(3))?.to_bytes()?; // or memmap2::Mmap
    /// let model = Baked::<VertexHierarchy>::from_shared(Arc::new(file), OpenOptions::default())?;
    /// assert_eq!(model.structure().triangle_count(), 1280);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// See [`BakeError`]; [`BakeError::OtherKind`] if the bytes hold another structure.
    pub fn from_shared(
        bytes: Arc<dyn AsRef<[u8]> + Send + Sync>,
        options: OpenOptions,
    ) -> Result<Self, BakeError> {
        Self::within(&bytes, options)
    }

    fn within(shared: &SharedBytes, options: OpenOptions) -> Result<Self, BakeError> {
        let bytes = (**shared).as_ref();
        if baked_version(bytes)? == baked_3::VERSION {
            return baked_3::unbake(S::KIND, bytes);
        }
        open(S::KIND, bytes, Reader::shared(shared, options), Self::read_sections)
    }

    /// Writes the model to a file atomically.
    ///
    /// # Errors
    /// Errors of [`Baked::to_bytes`] and of the operating system.
    pub fn write(&self, path: impl AsRef<Path>) -> Result<(), BakeError> {
        self.write_with(path, BakeOptions::default())
    }

    /// Writes the model to a file atomically.
    ///
    /// # Errors
    /// Errors of [`Baked::to_bytes_with`] and of the operating system.
    pub fn write_with(&self, path: impl AsRef<Path>, options: BakeOptions) -> Result<(), BakeError> {
        write_bytes(path.as_ref(), &self.to_bytes_with(options)?)
    }

    /// Reads a file into memory and opens the model within. To map the file instead: [`Baked::from_shared`].
    ///
    /// # Errors
    /// Errors of [`Baked::from_shared`] and of the operating system.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, BakeError> {
        Self::read_with(path, OpenOptions::default())
    }

    /// Reads a file into memory and opens the model within.
    ///
    /// # Errors
    /// Errors of [`Baked::from_shared`] and of the operating system.
    pub fn read_with(path: impl AsRef<Path>, options: OpenOptions) -> Result<Self, BakeError> {
        Self::from_shared(Arc::new(read_bytes(path.as_ref())?), options)
    }
}

/// A model of any structure, writable to bytes and files.
pub trait StoredModel<V: Vertex>: Model<V> {
    /// Encodes the model: [`Baked::to_bytes_with`].
    ///
    /// # Errors
    /// Errors of [`Baked::to_bytes_with`].
    fn to_bytes_with(&self, options: BakeOptions) -> Result<Vec<u8>, BakeError>;

    /// Encodes the model: [`Baked::to_bytes`].
    ///
    /// # Errors
    /// Errors of [`Baked::to_bytes`].
    fn to_bytes(&self) -> Result<Vec<u8>, BakeError> {
        self.to_bytes_with(BakeOptions::default())
    }

    /// Writes the model to a file: [`Baked::write_with`].
    ///
    /// # Errors
    /// Errors of [`Baked::write_with`].
    fn write_with(&self, path: &Path, options: BakeOptions) -> Result<(), BakeError> {
        write_bytes(path, &self.to_bytes_with(options)?)
    }

    /// Writes the model to a file: [`Baked::write`].
    ///
    /// # Errors
    /// Errors of [`Baked::write`].
    fn write(&self, path: &Path) -> Result<(), BakeError> {
        self.write_with(path, BakeOptions::default())
    }
}

impl<S: Stored, V: Vertex> StoredModel<V> for Baked<S> {
    fn to_bytes_with(&self, options: BakeOptions) -> Result<Vec<u8>, BakeError> {
        self.to_bytes_with(options)
    }
}

/// Opens a model of the kind named in its bytes. The only list of all structures.
macro_rules! open_any {
    ($kind:expr, $open:ident $arguments:tt, $($structure:ty),+) => {
        match $kind.as_str() {
            $(<$structure as Structure>::KIND => Box::new(Baked::<$structure>::$open $arguments?),)+
            _ => {
                let expected = [$(<$structure as Structure>::KIND),+].join(" or ");
                return Err(BakeError::OtherKind { found: $kind, expected });
            }
        }
    };
    ($kind:expr, $open:ident $arguments:tt) => {
        open_any!($kind, $open $arguments, VertexHierarchy, TotallyOrderedMesh, WaveletMesh, Gmesh)
    };
}

/// Decodes a baked model of any structure, drawn with vertices of type `V`: [`Baked::from_bytes`].
///
/// # Errors
/// Errors of [`Baked::from_bytes`]; [`BakeError::OtherKind`] if the bytes hold no structure of this crate.
pub fn unbake_model<V: Vertex>(bytes: &[u8]) -> Result<Box<dyn StoredModel<V>>, BakeError> {
    let kind = baked_kind(bytes)?;
    Ok(open_any!(kind, from_bytes(bytes)))
}

/// Opens a baked model of any structure within shared bytes, drawn with vertices of type `V`: [`Baked::from_shared`].
///
/// # Errors
/// Errors of [`Baked::from_shared`]; [`BakeError::OtherKind`] if the bytes hold no structure of this crate.
pub fn open_model<V: Vertex>(
    bytes: Arc<dyn AsRef<[u8]> + Send + Sync>,
    options: OpenOptions,
) -> Result<Box<dyn StoredModel<V>>, BakeError> {
    let kind = baked_kind((*bytes).as_ref())?;
    Ok(open_any!(kind, within(&bytes, options)))
}

/// Reads a baked model of any structure from a file, drawn with vertices of type `V`.
///
/// # Errors
/// Errors of [`open_model`] and of the operating system.
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
    read_model_with(path, OpenOptions::default())
}

/// Reads a baked model of any structure from a file, drawn with vertices of type `V`.
///
/// # Errors
/// Errors of [`open_model`] and of the operating system.
pub fn read_model_with<V: Vertex>(
    path: impl AsRef<Path>,
    options: OpenOptions,
) -> Result<Box<dyn StoredModel<V>>, BakeError> {
    open_model(Arc::new(read_bytes(path.as_ref())?), options)
}
