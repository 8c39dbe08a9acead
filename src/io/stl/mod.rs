//! STL: triangles without indices, binary or text.
//!
//! | file | idea |
//! |---|---|
//! | `mod.rs` | text or binary |
//! | `text.rs`, `binary.rs` | a file to a draft |
//! | `write.rs` | a mesh to a file |
//!
//! Vertices at exactly equal positions (after rounding to single precision, with -0 equal to 0) are welded, numbered by
//! first appearance. Face normals, attribute bytes and solids' names are not kept. A file is binary if its size matches
//! its count, for any start of its header. Otherwise it is text if it starts with `solid` or `facet` and contains
//! `facet` or `endsolid`, unless it begins with bytes that no text has, and its count fits; else binary.
//!
//! Text: keywords in any case; `endfacet`, `endloop` and `endsolid` in one word or two; `end` alone; decimal commas and
//! commas between numbers, with a note. Binary: a count of 0 or 0xffffffff stands for all triangles that are there,
//! with a note.
//!
//! The parser is our own: `stl_io` reads only the first solid of a text, in single precision, and rejects unnamed
//! solids, normals of NaN and facets of more than three corners (`docs/architecture.md`, Readers).

mod binary;
mod text;
mod write;

use super::draft::Draft;
use super::error::ReadError;
use super::text::{Words, without_mark};
pub(super) use write::write;

/// Bytes at the start of a file in which control characters tell a binary header.
const HEAD: usize = 1024;

/// Reads a whole file. O(n) in its size.
pub(super) fn read(bytes: &[u8]) -> Result<Draft, ReadError> {
    let fit = binary::fit(bytes);
    let is_control = |&b: &u8| b < b' ' && !(9..=13).contains(&b);
    let has_control = bytes[..bytes.len().min(HEAD)].iter().any(is_control);
    let is_binary = match fit {
        binary::Fit::Exact => true,
        binary::Fit::Some => has_control || !is_text(bytes),
        binary::Fit::None => !is_text(bytes),
    };
    if is_binary { binary::read(bytes) } else { text::read(without_mark(bytes)) }
}

/// Tests if the bytes start with `solid` or `facet` and contain the keyword `facet` or `endsolid`.
fn is_text(bytes: &[u8]) -> bool {
    let is = |word: &[u8], keyword: &str| word.eq_ignore_ascii_case(keyword.as_bytes());
    let starts = |word: &[u8]| is(word, "solid") || is(word, "facet");
    let speaks = |word: &[u8]| is(word, "facet") || is(word, "endsolid") || is(word, "end");
    let mut words = Words::new(without_mark(bytes), 1);
    words.next().is_some_and(starts) && words.any(speaks)
}
