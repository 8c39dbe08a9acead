//! PLY, the Stanford polygon format: text or binary of either byte order, with any properties.
//!
//! | file | idea |
//! |---|---|
//! | `header.rs` | the header as elements and typed properties |
//! | `body.rs` | the elements in order; vertices to attributes |
//! | `faces.rs` | faces and strips to triangles, with values by corner |
//! | `source.rs` | values of the body in order, of any encoding |
//! | `read.rs` | a file to a draft |
//! | `write.rs` | a mesh to a file; which property belongs to which attribute |
//!
//! Vertex properties become attributes: `nx ny nz` to `normal`; `s t`, `u v`, `texture_u texture_v` or
//! `texture_s texture_t` to `uv`; `red green blue [alpha]` to `color` (integer types scaled to 0..1); `name_0`,
//! `name_1` and so on to `name`; any other to an attribute of width 1 with its own name. `float` and `double` give
//! float attributes, signed types `Int`, unsigned types `Uint`. `diffuse_red diffuse_green diffuse_blue` stand for
//! `red green blue`.
//!
//! Face properties: `vertex_indices`; `material_index`; the list `texcoord` (UV by corner) to `uv`; `red green blue
//! [alpha]` to `color`, unless vertices have colours. Vertices are split where corners differ (`io/corners.rs`).
//! `texnumber` is left out with a note; other properties are skipped.
//!
//! Text may be broken into lines anywhere. If there are as many rows as entries, extra values of a row are left out.
//!
//! The parser is our own: `ply-rs-bw` rejects text with NaN and names with characters other than letters, misreads a
//! binary body with two properties of equal name, and reserves memory by a list's count (`docs/architecture.md`,
//! Readers).

mod body;
mod faces;
mod header;
mod read;
mod source;
mod write;

pub(super) use read::read;
pub(super) use write::write;
