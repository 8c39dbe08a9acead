//! Checksums that fit: of baked files (docs/format.md) and of messages (docs/wire.md), in sound bytes and in damaged ones.

use twox_hash::XxHash3_64;

/// Length of a baked file's header, and of an entry of its table.
const HEADER: usize = 64;
/// Length of a message's frame.
const FRAME: usize = 32;

fn number<const N: usize>(bytes: &[u8], at: usize) -> Option<usize> {
    let bytes = bytes.get(at..at.checked_add(N)?)?;
    usize::try_from(bytes.iter().rev().fold(0_u64, |number, &byte| number << 8 | u64::from(byte))).ok()
}

fn put(bytes: &mut [u8], at: usize, value: u64) {
    bytes[at..at + 8].copy_from_slice(&value.to_le_bytes());
}

/// Makes the checksums of a baked file fit: of all sections that lie in the bytes, then of header and table. Returns the length
/// that the header tells.
pub fn sections(bytes: &mut [u8]) -> Option<usize> {
    let count = number::<4>(bytes, 28)?;
    let length = number::<8>(bytes, 32)?;
    let table = HEADER.checked_mul(count.checked_add(1)?)?;
    if table > bytes.len() {
        return Some(length);
    }
    for entry in (HEADER..table).step_by(HEADER) {
        let [offset, stored] = [number::<8>(bytes, entry + 16)?, number::<8>(bytes, entry + 24)?];
        let section = offset.checked_add(stored).and_then(|end| bytes.get(offset..end));
        if let Some(sum) = section.map(XxHash3_64::oneshot) {
            put(bytes, entry + 40, sum);
        }
    }
    put(bytes, 40, 0);
    let sum = XxHash3_64::oneshot(&bytes[..table]);
    put(bytes, 40, sum);
    Some(length)
}

/// Makes the checksums of baked files fit that follow each other: a store.
pub fn sections_in_a_row(bytes: &mut [u8]) {
    let mut at = 0;
    while let Some(length) = bytes.get_mut(at..).filter(|rest| !rest.is_empty()).and_then(sections) {
        at = at.saturating_add(length.max(HEADER));
    }
}

/// Cuts bytes into messages by the lengths that they tell. What is left is a message too.
pub fn messages(mut bytes: &[u8]) -> Vec<Vec<u8>> {
    let mut messages = Vec::new();
    while !bytes.is_empty() && messages.len() < 64 {
        let length = number::<4>(bytes, 16).map_or(bytes.len(), |content| content.saturating_add(FRAME));
        let (message, rest) = bytes.split_at(length.min(bytes.len()));
        messages.push(message.to_vec());
        bytes = rest;
    }
    messages
}

/// Makes the length and the checksum of a message fit.
pub fn message(bytes: &mut [u8]) {
    let Some(content) = bytes.len().checked_sub(FRAME) else { return };
    bytes[16..20].copy_from_slice(&(content as u32).to_le_bytes());
    let mix = |word: u64| {
        let product = u128::from(word ^ 0x9e37_79b9_7f4a_7c15) * u128::from(0xd6e8_feb8_6659_fd93_u64);
        (product >> 64) as u64 ^ product as u64
    };
    let words = bytes[..24].chunks(8).chain(bytes[FRAME..].chunks(8));
    let sum = words.fold(bytes.len() as u64, |state, word| {
        let mut padded = [0; 8];
        padded[..word.len()].copy_from_slice(word);
        mix(state ^ u64::from_le_bytes(padded)).rotate_left(1)
    });
    put(bytes, 24, sum);
}
