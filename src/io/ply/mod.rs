//! PLY, the Stanford polygon format: text or binary of either byte order, with any properties.
//!
//! | file | idea |
//! |---|---|
//! | `header.rs` | the header as elements and typed properties |
//! | `body.rs` | the elements' values to a mesh |
//! | `read.rs` | a file to a draft |
//! | `write.rs` | a mesh to a file; which property belongs to which attribute |
//!
//! Vertex properties become attributes: `nx ny nz` to `normal`; `s t`, `u v`, `texture_u texture_v` or
//! `texture_s texture_t` to `uv`; `red green blue [alpha]` to `color` (integer types scaled to 0..1); `name_0`,
//! `name_1` and so on to `name`; any other to an attribute of width 1 with its own name. `float` and `double` give
//! float attributes, signed types `Int`, unsigned types `Uint`.
//!
//! The parser is our own: `ply-rs-bw` rejects text with NaN and names with characters other than letters, misreads a
//! binary body with two properties of equal name, and reserves memory by a list's count (`docs/architecture.md`,
//! Readers).

mod body;
mod header;
mod read;
mod write;

pub(super) use read::read;
pub(super) use write::write;
