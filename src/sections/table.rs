//! Header and table of a baked file.
//!
//! ```text
//!     header, offset  bytes                       entry, offset  bytes
//!                  0      8   magic number                    0     16   name, ASCII, padded with zeros
//!                  8      4   format version                 16      8   offset in the file
//!                 12     16   kind, ASCII, zeros             24      8   length in the file
//!                 28      4   number of sections             32      8   length of the array
//!                 32      8   length of the file             40      8   checksum of the section's bytes in the file
//!                 40      8   checksum                       48      4   size of an element
//!                 48     16   0                              52      4   codec: 0 none, 1 LZ4
//!                                                            56      8   0
//! ```
//!
//! The header's checksum covers header and table, with its own eight bytes as 0. Sections follow the table in order, each at
//! the next multiple of 64 bytes, with zeros between them; the file ends with the last.

use twox_hash::XxHash3_64;

use super::BakeError;

/// First bytes of a baked file. As in PNG: a non-ASCII byte, the name, a line end and an end-of-file mark (Ctrl-Z).
pub(crate) const MAGIC: [u8; 8] = *b"\x89MRES\r\n\x1a";
/// Version written, of the container and of the structures' sections.
pub(crate) const VERSION: u32 = 4;
/// Length of the header, and of an entry of the table; sections start at multiples of it.
pub(crate) const HEADER: usize = 64;
/// Length of a kind's and of a section's name.
pub(crate) const KIND: usize = 16;
/// Codec of a section that is the array itself.
pub(super) const PLAIN: u32 = 0;
/// Codec of `codec.rs`.
pub(super) const LZ4: u32 = 1;
/// Most sections of a file.
const MOST_SECTIONS: usize = 1 << 16;
/// Most bytes of an array for a byte of a compressed section: what a hostile file may reserve. LZ4 alone allows 255.
pub(super) const MOST_EXPANSION: u64 = 32;

/// Computes the checksum of bytes: XXH3, 64 bits, seed 0.
pub(super) fn checksum(bytes: &[u8]) -> u64 {
    XxHash3_64::oneshot(bytes)
}

/// Rounds up to a multiple of 64.
pub(super) fn aligned(length: usize) -> usize {
    length.next_multiple_of(HEADER)
}

/// A section as the table has it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Entry {
    pub name: String,
    pub offset: usize,
    pub stored: usize,
    pub plain: usize,
    pub checksum: u64,
    pub element: usize,
    pub codec: u32,
}

impl Entry {
    pub fn range(&self) -> std::ops::Range<usize> {
        self.offset..self.offset + self.stored
    }
}

/// A section of a baked file, for people and programs that look into files.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct SectionInfo {
    /// Name of the section, as docs/format.md lists them.
    pub name: String,
    /// Offset in the file, bytes.
    pub offset: usize,
    /// Length in the file, bytes.
    pub stored: usize,
    /// Length of the array, bytes; equal to `stored` unless compressed.
    pub plain: usize,
    /// Size of an element, bytes.
    pub element: usize,
    /// Whether the section is compressed.
    pub compressed: bool,
}

/// Whether a name is 1 to 16 printable ASCII characters.
pub(crate) fn is_kind(name: &str) -> bool {
    !name.is_empty() && name.len() <= KIND && name.bytes().all(|b| b.is_ascii_graphic())
}

fn put(bytes: &mut [u8], at: usize, value: &[u8]) {
    bytes[at..at + value.len()].copy_from_slice(value);
}

/// Returns bytes at an offset known to exist.
fn word<const N: usize>(bytes: &[u8], at: usize) -> [u8; N] {
    std::array::from_fn(|i| bytes[at + i])
}

fn number(bytes: &[u8], at: usize) -> Result<usize, BakeError> {
    let number = u64::from_le_bytes(word(bytes, at));
    usize::try_from(number).map_err(|_| BakeError::damaged(format!("no address reaches byte {number}")))
}

fn small(bytes: &[u8], at: usize) -> u32 {
    u32::from_le_bytes(word(bytes, at))
}

fn name_of(bytes: &[u8]) -> Option<String> {
    let end = bytes.iter().position(|&b| b == 0).unwrap_or(KIND);
    let is_name =
        end > 0 && bytes[..end].iter().all(u8::is_ascii_graphic) && bytes[end..].iter().all(|&b| b == 0);
    is_name.then(|| String::from_utf8_lossy(&bytes[..end]).into_owned())
}

/// Writes header and table in front of sections. `length` is the file's.
pub(super) fn encode(kind: &str, entries: &[Entry], length: usize) -> Vec<u8> {
    let mut bytes = vec![0; HEADER * (1 + entries.len())];
    put(&mut bytes, 0, &MAGIC);
    put(&mut bytes, 8, &VERSION.to_le_bytes());
    put(&mut bytes, 12, kind.as_bytes());
    put(&mut bytes, 28, &(entries.len() as u32).to_le_bytes());
    put(&mut bytes, 32, &(length as u64).to_le_bytes());
    for (entry, bytes) in entries.iter().zip(bytes[HEADER..].chunks_exact_mut(HEADER)) {
        put(bytes, 0, entry.name.as_bytes());
        put(bytes, 16, &(entry.offset as u64).to_le_bytes());
        put(bytes, 24, &(entry.stored as u64).to_le_bytes());
        put(bytes, 32, &(entry.plain as u64).to_le_bytes());
        put(bytes, 40, &entry.checksum.to_le_bytes());
        put(bytes, 48, &(entry.element as u32).to_le_bytes());
        put(bytes, 52, &entry.codec.to_le_bytes());
    }
    let sum = checksum(&bytes);
    put(&mut bytes, 40, &sum.to_le_bytes());
    bytes
}

/// Returns the format version of a baked file.
pub(crate) fn version_of(bytes: &[u8]) -> Result<u32, BakeError> {
    if bytes.len() < MAGIC.len() || bytes[..MAGIC.len()] != MAGIC {
        return Err(BakeError::NotBaked);
    }
    if bytes.len() < 28 {
        return Err(BakeError::damaged(format!("the header has {HEADER} bytes, {} are there", bytes.len())));
    }
    Ok(small(bytes, 8))
}

/// Returns the kind in the header of a file of any version.
pub(crate) fn kind_of(bytes: &[u8]) -> Result<String, BakeError> {
    version_of(bytes)?;
    name_of(&bytes[12..28]).ok_or_else(|| BakeError::damaged("the kind is no name"))
}

/// Reads and checks header and table. O(sections).
pub(super) fn decode(bytes: &[u8]) -> Result<Vec<Entry>, BakeError> {
    let found = version_of(bytes)?;
    if found != VERSION {
        return Err(BakeError::OtherVersion { found, expected: VERSION });
    }
    let missing = |what: &str, needed: usize| {
        BakeError::damaged(format!("{what} has {needed} bytes, {} are there", bytes.len()))
    };
    if bytes.len() < HEADER {
        return Err(missing("the header", HEADER));
    }
    let (count, length) = (small(bytes, 28) as usize, number(bytes, 32)?);
    if bytes.len() > length {
        return Err(BakeError::Trailing { bytes: bytes.len() - length });
    }
    if bytes.len() < length {
        return Err(missing("the file", length));
    }
    let table = HEADER * (1 + count.min(MOST_SECTIONS));
    if count > MOST_SECTIONS || table > length {
        return Err(BakeError::damaged(format!("there is no room for {count} sections")));
    }
    let mut head = bytes[..table].to_vec();
    put(&mut head, 40, &[0; 8]);
    if checksum(&head) != u64::from_le_bytes(word(bytes, 40)) {
        return Err(BakeError::damaged("the checksum of header and table does not fit"));
    }
    kind_of(bytes)?;
    let mut entries = Vec::with_capacity(count);
    let mut end = table;
    for bytes in head[HEADER..].chunks_exact(HEADER) {
        let name =
            name_of(&bytes[..KIND]).ok_or_else(|| BakeError::damaged("the name of a section is none"))?;
        let wrong = |what: &str| BakeError::damaged(format!("section {name:?}: {what}"));
        let [offset, stored, plain] = [number(bytes, 16)?, number(bytes, 24)?, number(bytes, 32)?];
        let (element, codec) = (small(bytes, 48) as usize, small(bytes, 52));
        if offset != aligned(end) {
            return Err(wrong("it does not follow the section before it"));
        }
        end = offset
            .checked_add(stored)
            .filter(|&end| end <= length)
            .ok_or_else(|| wrong("it ends beyond the file"))?;
        let is_sized = match codec {
            PLAIN => plain == stored,
            LZ4 => plain as u64 <= MOST_EXPANSION.saturating_mul(stored as u64),
            // Of a later version, and an error if asked for.
            _ => true,
        };
        if !is_sized || element == 0 || !plain.is_multiple_of(element) {
            return Err(wrong("its lengths do not fit"));
        }
        let checksum = u64::from_le_bytes(word(bytes, 40));
        entries.push(Entry { name, offset, stored, plain, checksum, element, codec });
    }
    if end != length {
        return Err(BakeError::damaged("the file does not end with its last section"));
    }
    let mut names: Vec<&str> = entries.iter().map(|entry| &*entry.name).collect();
    names.sort_unstable();
    match names.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => Err(BakeError::damaged(format!("there are two sections {:?}", pair[0]))),
        None => Ok(entries),
    }
}

/// Lists the sections of a baked file.
pub(crate) fn section_infos(bytes: &[u8]) -> Result<Vec<SectionInfo>, BakeError> {
    let info = |entry: Entry| {
        let Entry { name, offset, stored, plain, element, codec, .. } = entry;
        SectionInfo { name, offset, stored, plain, element, compressed: codec != PLAIN }
    };
    Ok(decode(bytes)?.into_iter().map(info).collect())
}
