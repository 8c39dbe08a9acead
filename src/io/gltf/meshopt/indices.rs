//! Mode INDICES: each index as a difference from the last of one of two sequences.
//!
//! ```text
//!     0xd1 | number of each index | 4 bytes
//!     number: bit 0 the sequence, the others the difference, its sign lowest
//! ```

use super::stream::{Fault, HEADER, parts, put, unzigzag};

const VERSION: u8 = 0xd1;
const TAIL: usize = 4;

/// Returns the least number of bytes that a stream of `count` indices has.
pub(super) fn least(count: usize) -> usize {
    count.saturating_add(1 + TAIL)
}

/// Appends the indices of a stream. `stride`: 2 or 4.
pub(super) fn decode(stream: &[u8], count: usize, stride: usize, to: &mut Vec<u8>) -> Result<(), Fault> {
    let (header, mut bytes, _) = parts(stream, TAIL)?;
    if header != VERSION {
        return Err(HEADER);
    }
    let mut last = [0_u32; 2];
    for _ in 0..count {
        let number = bytes.number()?;
        let last = &mut last[(number & 1) as usize];
        *last = last.wrapping_add(unzigzag(number >> 1));
        put(to, *last, stride);
    }
    bytes.end()
}
