//! Files of format version 3, still read: the whole value by serde and bincode.
//!
//! ```text
//!     offset  bytes
//!          0      8   magic number
//!          8      4   format version, 3
//!         12     16   kind of the structure, ASCII, padded with zeros
//!         28      8   length of the payload in bytes
//!         36      8   checksum of all bytes but itself
//!         44          payload: bincode 2, little-endian, fixed-size integers
//! ```

use serde::de::DeserializeOwned;

use crate::sections::{self, BakeError};

/// The format version.
pub(super) const VERSION: u32 = 3;
/// Offsets of length, checksum and payload.
const LENGTH_AT: usize = 28;
const CHECKSUM_AT: usize = 36;
const PAYLOAD_AT: usize = 44;

/// Decodes a value from a file whose version is known.
pub(super) fn unbake<T: DeserializeOwned>(kind: &str, bytes: &[u8]) -> Result<T, BakeError> {
    if bytes.len() < PAYLOAD_AT {
        let there = bytes.len();
        return Err(BakeError::damaged(format!("the header has {PAYLOAD_AT} bytes, {there} are there")));
    }
    let found = sections::kind_of(bytes)?;
    let payload = &bytes[PAYLOAD_AT..];
    let length = u64::from_le_bytes(word(bytes, LENGTH_AT));
    if (payload.len() as u64) < length {
        let there = payload.len();
        return Err(BakeError::damaged(format!("{length} bytes of content are said, {there} are there")));
    }
    if payload.len() as u64 > length {
        return Err(BakeError::Trailing { bytes: payload.len() - length as usize });
    }
    if checksum(bytes) != u64::from_le_bytes(word(bytes, CHECKSUM_AT)) {
        return Err(BakeError::damaged("the checksum does not fit"));
    }
    if found != kind {
        return Err(BakeError::OtherKind { found, expected: kind.to_owned() });
    }
    sections::decode(payload)
}

/// Returns bytes at an offset known to exist.
fn word(bytes: &[u8], at: usize) -> [u8; 8] {
    std::array::from_fn(|i| bytes[at + i])
}

/// Computes FNV-1a over little-endian words of 8 bytes instead of single bytes, folding the upper half into the lower
/// after each word. Covers all bytes but the checksum. Source: Fowler, Noll and Vo, draft-eastlake-fnv.
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
