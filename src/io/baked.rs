//! The baked container, `.mres`: a header, a table, and sections with checksums (`sections/`, docs/format.md).
//!
//! **Promise.** Files of version 4 are read by all later versions of this crate, as long as its major version is 0 or as
//! CHANGELOG says. A change that older versions cannot read has another version number; they refuse such a file with
//! [`BakeError::OtherVersion`]. Sections that a version does not know are left alone. Files of version 3 are read too, by
//! copy.

use std::path::Path;

use serde::Serialize;
use serde::de::DeserializeOwned;

use super::baked_3;
use crate::sections::{self, BakeError, BakeOptions, OpenOptions, Reader, SectionInfo, Writer};

/// Format version of files written.
pub const VERSION: u32 = sections::VERSION;
/// Name of the section of [`bake`].
const VALUE: &str = "value";

/// Encodes a value of any type as a single section of the baked container. Equal values give equal bytes.
///
/// # Errors
/// `kind` is not 1 to 16 printable ASCII characters, or serialising the value fails.
pub fn bake<T: Serialize>(kind: &str, value: &T) -> Result<Vec<u8>, BakeError> {
    if !sections::is_kind(kind) {
        return Err(BakeError::BadKind { kind: kind.to_owned() });
    }
    let mut writer = Writer::new(BakeOptions::default());
    writer.meta(VALUE, value)?;
    writer.finish(kind)
}

/// Decodes a value from the bytes of [`bake`].
///
/// # Errors
/// See [`BakeError`]. Damage is missed with a probability of 2^-64. Reserves at most a small multiple of the length of
/// `bytes`.
pub fn unbake<T: DeserializeOwned>(kind: &str, bytes: &[u8]) -> Result<T, BakeError> {
    if baked_version(bytes)? == baked_3::VERSION {
        return baked_3::unbake(kind, bytes);
    }
    open(kind, bytes, Reader::new(bytes, OpenOptions::default()), |reader| reader.meta(VALUE))
}

/// Reads a file of the current version, if it is of the kind. `read` reads its sections; a single value is read as such.
pub(super) fn open<T: DeserializeOwned>(
    kind: &str,
    bytes: &[u8],
    reader: Result<Reader<'_>, BakeError>,
    read: impl FnOnce(&Reader<'_>) -> Result<T, BakeError>,
) -> Result<T, BakeError> {
    let reader = reader?;
    let found = sections::kind_of(bytes)?;
    if found != kind {
        return Err(BakeError::OtherKind { found, expected: kind.to_owned() });
    }
    if reader.has(VALUE) { reader.meta(VALUE) } else { read(&reader) }
}

/// Returns the kind of structure in a baked file; reads only the header.
///
/// # Errors
/// The bytes do not start with the header of a baked file of a version that this crate reads.
pub fn baked_kind(bytes: &[u8]) -> Result<String, BakeError> {
    baked_version(bytes)?;
    sections::kind_of(bytes)
}

/// Returns the format version of a baked file; reads only the header.
///
/// # Errors
/// The bytes do not start with the header of a baked file of a version that this crate reads.
pub fn baked_version(bytes: &[u8]) -> Result<u32, BakeError> {
    let found = sections::version_of(bytes)?;
    if (baked_3::VERSION..=VERSION).contains(&found) {
        return Ok(found);
    }
    Err(BakeError::OtherVersion { found, expected: VERSION })
}

/// Lists the sections of a baked file, in their order; none for a file of version 3. Reads header and table, and checks
/// them.
///
/// # Errors
/// The bytes are no baked file of a version that this crate reads, or header or table are damaged.
pub fn baked_sections(bytes: &[u8]) -> Result<Vec<SectionInfo>, BakeError> {
    if baked_version(bytes)? == baked_3::VERSION { Ok(Vec::new()) } else { sections::section_infos(bytes) }
}

/// Bakes a value and writes it to a file atomically.
///
/// # Errors
/// Errors of [`bake`] and of the operating system.
pub fn write_baked<T: Serialize>(path: impl AsRef<Path>, kind: &str, value: &T) -> Result<(), BakeError> {
    write_bytes(path.as_ref(), &bake(kind, value)?)
}

/// Reads a value from a file.
///
/// # Errors
/// Errors of [`unbake`] and of the operating system.
pub fn read_baked<T: DeserializeOwned>(path: impl AsRef<Path>, kind: &str) -> Result<T, BakeError> {
    unbake(kind, &read_bytes(path.as_ref())?)
}

pub(super) fn write_bytes(path: &Path, bytes: &[u8]) -> Result<(), BakeError> {
    super::atomic::write(path, bytes).map_err(|source| BakeError::Io { path: path.to_owned(), source })
}

pub(super) fn read_bytes(path: &Path) -> Result<Vec<u8>, BakeError> {
    std::fs::read(path).map_err(|source| BakeError::Io { path: path.to_owned(), source })
}

/// Bytes at an address that is a multiple of 64, for files within the program: all their sections are then used in place.
///
/// ```
/// use std::sync::Arc;
///
/// use multires::io::Aligned;
/// # use multires::{Structure, VertexHierarchy, io::OpenOptions, lod::Baked, mesh::shapes};
///
/// // static FILE: &Aligned<[u8]> = &Aligned(*include_bytes!("rock.mres"));
/// static FILE: &Aligned<[u8]> = &Aligned(*b"\x89MRES\r\n\x1a");
/// assert_eq!(FILE.0.as_ptr() as usize % 64, 0);
/// let model = Baked::<VertexHierarchy>::from_shared(Arc::new(FILE), OpenOptions::default());
/// assert!(model.is_err()); // the magic number alone is no file
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(C, align(64))]
pub struct Aligned<T: ?Sized>(pub T);

impl AsRef<[u8]> for Aligned<[u8]> {
    fn as_ref(&self) -> &[u8] {
        &self.0
    }
}

impl<const N: usize> AsRef<[u8]> for Aligned<[u8; N]> {
    fn as_ref(&self) -> &[u8] {
        &self.0
    }
}
