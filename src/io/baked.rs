//! The baked container, `.mres`: any structure of this crate behind a header that finds damage before decoding does.
//!
//! ```text
//!     offset  bytes
//!          0      8   89 4D 52 45 53 0D 0A 1A   "MRES" in bytes that any text-mode transfer changes
//!          8      4   format version
//!         12     16   kind of the structure, ASCII, padded with zeros
//!         28      8   length of the payload in bytes
//!         36      8   checksum of all bytes but itself
//!         44          payload: bincode 2, little-endian, fixed-size integers
//! ```
//!
//! All numbers are little-endian. The checksum finds accidents, not forgery: a file with a right checksum may still hold
//! anything, so decoding runs under a limit near the payload's own size, and every structure validates what it is made
//! from.

use std::path::{Path, PathBuf};

use serde::Serialize;
use serde::de::DeserializeOwned;

/// First bytes of a baked file. As in PNG: a byte that is no ASCII, the name, a line end and an end-of-text mark.
const MAGIC: [u8; 8] = *b"\x89MRES\r\n\x1a";
/// Version of the container and of the structures' layout; files of another version are refused.
pub const VERSION: u32 = 3;
/// Bytes of the kind's name.
const KIND: usize = 16;
/// Where length, checksum and payload start.
const LENGTH_AT: usize = 28;
const CHECKSUM_AT: usize = 36;
const PAYLOAD_AT: usize = 44;

/// Why a value could not be baked, or bytes not be a value again.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BakeError {
    /// The operating system refused.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The bytes do not start as a baked file does, or were changed by a transfer in text mode.
    #[error("this is no baked file")]
    NotBaked,
    /// Another version of this crate wrote the file.
    #[error("the file has format version {found}, this is version {expected}")]
    OtherVersion {
        /// The version in the file.
        found: u32,
        /// The version that can be read.
        expected: u32,
    },
    /// The file holds another structure.
    #[error("the file holds a {found:?}, not a {expected:?}")]
    OtherKind {
        /// The kind in the file.
        found: String,
        /// The kind asked for.
        expected: String,
    },
    /// The bytes are not those that were written, or the structure in them is not valid.
    #[error("the file is damaged: {what}")]
    Damaged {
        /// What does not fit.
        what: String,
    },
    /// There are bytes after the end.
    #[error("{bytes} bytes follow the end of the file's content")]
    Trailing {
        /// How many.
        bytes: usize,
    },
    /// The kind's name is not 1 to 16 printable ASCII characters.
    #[error("{kind:?} is no name of a kind: 1 to 16 printable ASCII characters are")]
    BadKind {
        /// The name.
        kind: String,
    },
    /// The value cannot be serialised.
    #[error("the value cannot be written: {what}")]
    Encode {
        /// Why.
        what: String,
    },
}

fn damaged(what: impl ToString) -> BakeError {
    BakeError::Damaged { what: what.to_string() }
}

/// A value as bytes of the baked container. The same value gives the same bytes.
///
/// # Errors
/// The kind is no name of 1 to 16 printable ASCII characters, or the value refuses to be serialised.
pub fn bake<T: Serialize>(kind: &str, value: &T) -> Result<Vec<u8>, BakeError> {
    if kind.is_empty() || kind.len() > KIND || !kind.bytes().all(|b| b.is_ascii_graphic()) {
        return Err(BakeError::BadKind { kind: kind.to_owned() });
    }
    let mut out = Vec::from(MAGIC);
    out.extend_from_slice(&VERSION.to_le_bytes());
    out.extend_from_slice(kind.as_bytes());
    out.resize(PAYLOAD_AT, 0);
    let config = bincode::config::standard().with_fixed_int_encoding();
    bincode::serde::encode_into_std_write(value, &mut out, config)
        .map_err(|e| BakeError::Encode { what: e.to_string() })?;
    let length = (out.len() - PAYLOAD_AT) as u64;
    out[LENGTH_AT..CHECKSUM_AT].copy_from_slice(&length.to_le_bytes());
    let sum = checksum(&out);
    out[CHECKSUM_AT..PAYLOAD_AT].copy_from_slice(&sum.to_le_bytes());
    Ok(out)
}

/// The value that [`bake`] made bytes from.
///
/// # Errors
/// See [`BakeError`]. Damage of any single byte or word and any truncation are found for certain, other accidents but
/// for one in 2^64. Reserves no more than a small multiple of the bytes given.
pub fn unbake<T: DeserializeOwned>(kind: &str, bytes: &[u8]) -> Result<T, BakeError> {
    let found = baked_kind(bytes)?;
    let payload = &bytes[PAYLOAD_AT..];
    let length = u64::from_le_bytes(word(bytes, LENGTH_AT));
    if (payload.len() as u64) < length {
        return Err(damaged(format!("{length} bytes of content are said, {} are there", payload.len())));
    }
    if payload.len() as u64 > length {
        return Err(BakeError::Trailing { bytes: payload.len() - length as usize });
    }
    if checksum(bytes) != u64::from_le_bytes(word(bytes, CHECKSUM_AT)) {
        return Err(damaged("the checksum does not fit"));
    }
    if found != kind {
        return Err(BakeError::OtherKind { found, expected: kind.to_owned() });
    }
    let (value, used) = decode(payload)?;
    match payload.len() - used {
        0 => Ok(value),
        bytes => Err(BakeError::Trailing { bytes }),
    }
}

/// The kind of structure in a baked file; looks at its header alone.
///
/// # Errors
/// The bytes do not start as a baked file of this version does.
pub fn baked_kind(bytes: &[u8]) -> Result<String, BakeError> {
    if bytes.len() < MAGIC.len() || bytes[..MAGIC.len()] != MAGIC {
        return Err(BakeError::NotBaked);
    }
    if bytes.len() < PAYLOAD_AT {
        return Err(damaged(format!("the header has {PAYLOAD_AT} bytes, {} are there", bytes.len())));
    }
    let found = u32::from_le_bytes(word(bytes, 8));
    if found != VERSION {
        return Err(BakeError::OtherVersion { found, expected: VERSION });
    }
    let name = &bytes[12..12 + KIND];
    let end = name.iter().position(|&b| b == 0).unwrap_or(KIND);
    if end == 0 || !name[..end].iter().all(u8::is_ascii_graphic) || name[end..].iter().any(|&b| b != 0) {
        return Err(damaged("the kind is no name"));
    }
    Ok(String::from_utf8_lossy(&name[..end]).into_owned())
}

/// Writes a value to a file, whole or not at all.
///
/// # Errors
/// As [`bake`], or what the system says.
pub fn write_baked<T: Serialize>(path: impl AsRef<Path>, kind: &str, value: &T) -> Result<(), BakeError> {
    let path = path.as_ref();
    let bytes = bake(kind, value)?;
    super::atomic::write(path, &bytes).map_err(|source| BakeError::Io { path: path.to_owned(), source })
}

/// Reads a value from a file.
///
/// # Errors
/// As [`unbake`], or what the system says.
pub fn read_baked<T: DeserializeOwned>(path: impl AsRef<Path>, kind: &str) -> Result<T, BakeError> {
    unbake(kind, &read_bytes(path.as_ref())?)
}

pub(super) fn read_bytes(path: &Path) -> Result<Vec<u8>, BakeError> {
    std::fs::read(path).map_err(|source| BakeError::Io { path: path.to_owned(), source })
}

/// Bytes at a place that is known to exist.
fn word<const N: usize>(bytes: &[u8], at: usize) -> [u8; N] {
    std::array::from_fn(|i| bytes[at + i])
}

/// Decodes under the least limit that the payload fits. Without one, the length of a string is reserved as it is said;
/// sequences are reserved by serde up to a mebibyte and then grow as they are filled.
fn decode<T: DeserializeOwned>(payload: &[u8]) -> Result<(T, usize), BakeError> {
    macro_rules! under_limit {
        ($($bits:literal)*) => {
            match payload.len() {
                $(n if n <= 1 << $bits => {
                    let config = bincode::config::standard().with_fixed_int_encoding().with_limit::<{ 1 << $bits }>();
                    bincode::serde::decode_from_slice(payload, config)
                })*
                _ => {
                    let config = bincode::config::standard().with_fixed_int_encoding().with_limit::<{ usize::MAX / 4 }>();
                    bincode::serde::decode_from_slice(payload, config)
                }
            }
        };
    }
    under_limit!(10 12 14 16 18 20 22 24 26 28 30).map_err(|e| damaged(one_line(&e)))
}

/// What a structure said of its content, or the decoder of the bytes.
fn one_line(error: &bincode::error::DecodeError) -> String {
    let text = match error {
        bincode::error::DecodeError::OtherString(reason) => reason.clone(),
        other => other.to_string(),
    };
    text.replace(['\n', '\r'], " ")
}

/// FNV-1a over little-endian words of 8 bytes instead of single bytes, with the upper half folded into the lower after
/// each, of all bytes but the checksum itself. Each step is a bijection of the state, so damage within one word always
/// shows. Source: Fowler, Noll and Vo, draft-eastlake-fnv.
fn checksum(bytes: &[u8]) -> u64 {
    let step = |state: u64, word: u64| {
        let product = (state ^ word).wrapping_mul(0x0000_0100_0000_01b3);
        product ^ product >> 32
    };
    let mut state = 0xcbf2_9ce4_8422_2325;
    for part in [&bytes[..CHECKSUM_AT], &bytes[PAYLOAD_AT..]] {
        let words = part.chunks_exact(8);
        let (mut last, rest) = ([0; 8], words.remainder());
        state = words.fold(state, |state, bytes| step(state, u64::from_le_bytes(word(bytes, 0))));
        last[..rest.len()].copy_from_slice(rest);
        state = step(state, u64::from_le_bytes(last));
        state = step(state, part.len() as u64);
    }
    state
}
