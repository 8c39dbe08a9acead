//! The baked container, `.mres`: any structure of this crate behind a header for detecting damage before decoding.
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
//! All numbers are little-endian. The checksum detects accidents, not forgery: a file with a valid checksum may hold
//! any bytes. So decoding runs under a limit near the payload's size, and every structure validates its input.

use std::path::{Path, PathBuf};

use serde::Serialize;
use serde::de::DeserializeOwned;

/// First bytes of a baked file. As in PNG: a non-ASCII byte, the name, a line end and an end-of-file mark (Ctrl-Z).
const MAGIC: [u8; 8] = *b"\x89MRES\r\n\x1a";
/// Version of the container and of the structures' layout. Files of another version are rejected.
pub const VERSION: u32 = 3;
/// Length of the kind's name, bytes.
const KIND: usize = 16;
/// Offsets of length, checksum and payload.
const LENGTH_AT: usize = 28;
const CHECKSUM_AT: usize = 36;
const PAYLOAD_AT: usize = 44;

/// Error of [`bake`], [`unbake`] and their file versions.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BakeError {
    /// The operating system reported an error.
    #[error("{}: {source}", path.display())]
    Io {
        /// Path of the file.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// The bytes do not start with the magic number of a baked file, or a transfer in text mode changed them.
    #[error("this is no baked file")]
    NotBaked,
    /// The file has another format version.
    #[error("the file has format version {found}, this is version {expected}")]
    OtherVersion {
        /// Version in the file.
        found: u32,
        /// Version supported.
        expected: u32,
    },
    /// The file holds another kind of structure.
    #[error("the file holds a {found:?}, not a {expected:?}")]
    OtherKind {
        /// Kind in the file.
        found: String,
        /// Kind requested.
        expected: String,
    },
    /// The bytes differ from the bytes written, or the structure is not valid.
    #[error("the file is damaged: {what}")]
    Damaged {
        /// Description of the damage.
        what: String,
    },
    /// Bytes follow the end of the content.
    #[error("{bytes} bytes follow the end of the file's content")]
    Trailing {
        /// Number of extra bytes.
        bytes: usize,
    },
    /// The kind's name is not 1 to 16 printable ASCII characters.
    #[error("{kind:?} is no name of a kind: 1 to 16 printable ASCII characters are")]
    BadKind {
        /// Name given.
        kind: String,
    },
    /// The value cannot be serialised.
    #[error("the value cannot be written: {what}")]
    Encode {
        /// Reason.
        what: String,
    },
}

fn damaged(what: impl ToString) -> BakeError {
    BakeError::Damaged { what: what.to_string() }
}

/// Encodes a value as bytes of the baked container. Equal values give equal bytes.
///
/// # Errors
/// `kind` is not 1 to 16 printable ASCII characters, or serialising the value fails.
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

/// Decodes a value from the bytes of [`bake`].
///
/// # Errors
/// See [`BakeError`]. Always detects a damaged byte, a damaged 8-byte word of the checksum's input, and truncation;
/// misses other damage with probability 2^-64. Reserves at most a small multiple of the length of `bytes`.
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

/// Returns the kind of structure in a baked file; reads only the header.
///
/// # Errors
/// The bytes do not start with the header of a baked file of this version.
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

/// Bakes a value and writes it to a file atomically.
///
/// # Errors
/// Errors of [`bake`] and of the operating system.
pub fn write_baked<T: Serialize>(path: impl AsRef<Path>, kind: &str, value: &T) -> Result<(), BakeError> {
    let path = path.as_ref();
    let bytes = bake(kind, value)?;
    super::atomic::write(path, &bytes).map_err(|source| BakeError::Io { path: path.to_owned(), source })
}

/// Reads a value from a file.
///
/// # Errors
/// Errors of [`unbake`] and of the operating system.
pub fn read_baked<T: DeserializeOwned>(path: impl AsRef<Path>, kind: &str) -> Result<T, BakeError> {
    unbake(kind, &read_bytes(path.as_ref())?)
}

pub(super) fn read_bytes(path: &Path) -> Result<Vec<u8>, BakeError> {
    std::fs::read(path).map_err(|source| BakeError::Io { path: path.to_owned(), source })
}

/// Returns bytes at an offset known to exist.
fn word<const N: usize>(bytes: &[u8], at: usize) -> [u8; N] {
    std::array::from_fn(|i| bytes[at + i])
}

/// Decodes under the smallest limit that fits the payload. Without a limit, bincode would reserve a string's declared
/// length. Serde reserves up to a mebibyte for a sequence and then grows it as it fills.
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

/// Returns the error message of the structure, or of the decoder, as a single line.
fn one_line(error: &bincode::error::DecodeError) -> String {
    let text = match error {
        bincode::error::DecodeError::OtherString(reason) => reason.clone(),
        other => other.to_string(),
    };
    text.replace(['\n', '\r'], " ")
}

/// Computes FNV-1a over little-endian words of 8 bytes instead of single bytes, folding the upper half into the lower
/// after each word. Covers all bytes but the checksum. Each step is a bijection of the state, so damage within a single
/// word is always detected. Source: Fowler, Noll and Vo, draft-eastlake-fnv.
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
