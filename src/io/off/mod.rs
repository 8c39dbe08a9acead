//! OFF, the object file format of Geomview: text or binary, with vertex normals, colours and texture coordinates.
//!
//! | file | idea |
//! |---|---|
//! | `header.rs` | the first word and the counts |
//! | `layout.rs` | what a vertex has, and in which order |
//! | `settle.rs` | which values a vertex has that the first word leaves open |
//! | `text.rs` | rows, or words in sequence, to a draft |
//! | `colors.rs` | range of colours; colours of faces |
//! | `binary.rs` | words of 4 bytes of either byte order to a draft |
//! | `write.rs` | a mesh to text |
//!
//! The first word is `[ST][C][N][4]OFF` in any case and order, and may be missing or glued to the first count
//! (`OFF8 12 0`). The count of edges may be missing. Each vertex has `x y z [w] [nx ny nz] [r g b [a]] [s t]`; `w`
//! divides `x y z`. Files by MeshLab have the colour before the normal: where both are given, the values tell the
//! order. Under a word without `C` and `N`, three or four more values are a colour, or a normal if one is negative.
//! Colours are divided by 255 if all components are integers and one is above 1. Colours of faces become `color`,
//! unless vertices have colours: vertices are split where faces differ (`io/corners.rs`). Indices into a colour map are
//! left out with a note. `nOFF` is read if its dimension is 3. Comments start with `#`.
//!
//! Binary files (`OFF BINARY`) are big-endian as by Geomview, or little-endian without colours of faces as by
//! pmp-library: the reading that fits the file's size is taken.
//!
//! Written as text, read back to equal bits: `normal`, `color` and `uv` with the vertices; no other attributes, no
//! materials.
//!
//! The parser is our own: `off-rs` reads neither binary files nor normals and texture coordinates.

mod binary;
mod colors;
mod header;
mod layout;
mod settle;
mod text;
mod write;

use super::draft::Draft;
use super::error::ReadError;
use super::text::without_mark;
use header::Body;
pub(super) use write::write;

/// Reads a whole file. O(n) in its size; counts are checked against the bytes present.
pub(super) fn read(bytes: &[u8]) -> Result<Draft, ReadError> {
    let bytes = without_mark(bytes);
    let header = header::read(bytes)?;
    match header.body {
        Body::Binary(at) => binary::read(bytes, at, header.layout),
        Body::Text { rest, line, counts } => text::read(rest, line, counts, header.layout),
    }
}
