//! Compressed parts of a document, decoded on opening: what follows reads accessors as if there were no compression.

use std::borrow::Cow;
use std::collections::BTreeSet;

use super::document::Document;
use super::meshopt;
use crate::io::error::ReadError;

/// Most decoded bytes: a multiple of the bytes read, and a constant.
const MOST_PER_BYTE: usize = 64;
const MOST: usize = 1 << 22;

/// Returns the number of bytes that a document may decode to. `bytes`: size of the file.
pub(super) fn most(buffers: &[Cow<'_, [u8]>], bytes: usize) -> usize {
    let given = buffers.iter().fold(bytes, |sum, buffer| sum.saturating_add(buffer.len()));
    given.saturating_mul(MOST_PER_BYTE).saturating_add(MOST)
}

/// What decoding changed.
#[derive(Debug, Clone, Default)]
pub(super) struct Decoded {
    /// Views whose values were rounded: bounds of their accessors may be those of other values.
    pub filtered: BTreeSet<usize>,
    /// Accessors that were given views behind the document's own.
    pub accessors: BTreeSet<usize>,
    /// Meshes and primitives that have these.
    pub primitives: BTreeSet<(usize, usize)>,
    /// Views of their streams.
    pub streams: BTreeSet<usize>,
}

/// Decodes what has no uncompressed form, into buffers behind the others. `json`: text of the document; `bytes`: size of the
/// file.
#[cfg_attr(not(feature = "draco"), allow(unused_variables))]
pub(super) fn decode(
    json: &[u8],
    document: &mut Document,
    buffers: &mut Vec<Cow<'_, [u8]>>,
    bytes: usize,
) -> Result<Decoded, ReadError> {
    let decoded = Decoded { filtered: meshopt::decode(document, buffers, bytes)?, ..Decoded::default() };
    #[cfg(feature = "draco")]
    let decoded = super::draco::decode(json, document, buffers, bytes, decoded)?;
    Ok(decoded)
}
