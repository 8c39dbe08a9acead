//! `EXT_meshopt_compression` and `KHR_meshopt_compression`: buffer views stored compressed, decoded once on opening.
//!
//! ```text
//!     view --> { buffer, range, stride, count, mode, filter } --> codec --> filter --> bytes of a further buffer
//! ```
//!
//! | file | idea |
//! |---|---|
//! | `attributes.rs` | values: bytes as differences from the element before |
//! | `triangles.rs` | lists of triangles: a byte where an edge is shared with a recent triangle |
//! | `indices.rs` | other indices: differences from one of two earlier ones |
//! | `filters.rs` | normals, rotations, floats and colours out of shorter forms |
//! | `stream.rs` | bytes read in order |
//!
//! Source: the appendices "Bitstream" and "Filters" of both extensions (KhronosGroup/glTF, `extensions/2.0`). Either name may
//! use any version, mode and filter.
//!
//! A view is decoded only if its own buffer has no bytes: uncompressed bytes are exact. The decoders are written here,
//! since no kept crate has them without C++.
//!
//! Memory: a stream is refused if its bytes are fewer than its count takes at least. All views together may take
//! `64 * bytes + 4 MiB`, since views may share a stream.

mod attributes;
mod filters;
mod indices;
mod stream;
mod triangles;

use std::borrow::Cow;
use std::collections::BTreeSet;

use gltf_json::Index;
use gltf_json::validation::USize64;
use serde::Deserialize;

use super::decoded::most;
use super::document::{Document, size};
use crate::io::error::ReadError;
use filters::Filter;
use stream::Fault;

/// The extension of a view, as written.
#[derive(Debug, Clone, Deserialize)]
#[serde(rename_all = "camelCase")]
struct Compressed {
    buffer: usize,
    #[serde(default)]
    byte_offset: usize,
    byte_length: usize,
    byte_stride: usize,
    count: usize,
    mode: String,
    filter: Option<String>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Mode {
    Attributes,
    Triangles,
    Indices,
}

/// A stream that was checked against the document: codec, bytes, and layout of the decoded elements.
struct Stream<'a> {
    view: usize,
    bytes: &'a [u8],
    mode: Mode,
    filter: Filter,
    stride: usize,
    count: usize,
}

/// Decodes the views whose buffers have no bytes, into a buffer behind the others, and leads the views there. Returns the
/// views with a filter: bounds of their accessors may be those of other values. `bytes`: size of the file. O(n) in the
/// decoded bytes.
pub(super) fn decode(
    document: &mut Document,
    buffers: &mut Vec<Cow<'_, [u8]>>,
    bytes: usize,
) -> Result<BTreeSet<usize>, ReadError> {
    let most = most(buffers, bytes);
    let mut streams = Vec::new();
    let mut total = 0_usize;
    for (i, view) in document.buffer_views.iter().enumerate() {
        let Some(text) = view.compressed() else { continue };
        if buffers.get(view.buffer.value()).is_some_and(|own| !own.is_empty()) {
            continue;
        }
        let found = serde_json::from_str(text.get());
        let found: Compressed =
            found.map_err(|e| ReadError::invalid(format!("buffer view {i}, meshopt compression: {e}")))?;
        let stream = found.stream(i, buffers)?;
        let length = stream.length()?;
        if length != size(view.byte_length) {
            return Err(ReadError::invalid(format!(
                "buffer view {i} says {} bytes, its compressed form {length}",
                view.byte_length.0
            )));
        }
        total = total.saturating_add(length.next_multiple_of(4));
        streams.push(stream);
    }
    if total > most {
        return Err(ReadError::too_large(format!("{total} decoded bytes in a file of {bytes}")));
    }
    if streams.is_empty() {
        return Ok(BTreeSet::new());
    }
    let filtered = streams.iter().filter(|stream| stream.filter != Filter::None);
    let filtered = filtered.map(|stream| stream.view).collect();
    let mut decoded = Vec::new();
    let reserved = decoded.try_reserve_exact(total);
    reserved.map_err(|_| ReadError::too_large(format!("{total} decoded bytes do not fit in memory")))?;
    let mut places = Vec::with_capacity(streams.len());
    for stream in &streams {
        places.push((stream.view, decoded.len()));
        stream.decode(&mut decoded).map_err(|fault| {
            ReadError::invalid(format!("buffer view {}, meshopt compression: {fault}", stream.view))
        })?;
        decoded.resize(decoded.len().next_multiple_of(4), 0);
    }
    let behind = u32::try_from(buffers.len())
        .map_err(|_| ReadError::too_large(format!("{} buffers", buffers.len())))?;
    for (view, start) in places {
        let view = &mut document.buffer_views[view];
        view.buffer = Index::new(behind);
        view.byte_offset = Some(USize64::from(start));
    }
    buffers.push(Cow::Owned(decoded));
    Ok(filtered)
}

impl Compressed {
    fn stream<'a>(&self, view: usize, buffers: &'a [Cow<'_, [u8]>]) -> Result<Stream<'a>, ReadError> {
        let unknown = |what: &str, name: &str| {
            ReadError::unsupported(format!("buffer view {view}, meshopt compression: {what} {name:?}"))
        };
        let mode = match self.mode.as_str() {
            "ATTRIBUTES" => Mode::Attributes,
            "TRIANGLES" => Mode::Triangles,
            "INDICES" => Mode::Indices,
            name => return Err(unknown("the mode", name)),
        };
        let name = self.filter.as_deref().unwrap_or("NONE");
        let filter = Filter::named(name).ok_or_else(|| unknown("the filter", name))?;
        let stride = self.byte_stride;
        let is_stride = match mode {
            Mode::Attributes => {
                (4..=256).contains(&stride) && stride.is_multiple_of(4) && filter.takes(stride)
            }
            Mode::Triangles | Mode::Indices => stride == 2 || stride == 4,
        };
        let is_fit = match mode {
            Mode::Attributes => true,
            Mode::Triangles => filter == Filter::None && self.count.is_multiple_of(3),
            Mode::Indices => filter == Filter::None,
        };
        if !is_stride || !is_fit {
            return Err(ReadError::invalid(format!(
                "buffer view {view}, meshopt compression: {} elements of {stride} bytes, which {} of the filter {name} cannot be",
                self.count, self.mode
            )));
        }
        let range = buffers.get(self.buffer).and_then(|b| b.get(self.byte_offset..)?.get(..self.byte_length));
        let bytes = range.ok_or_else(|| {
            ReadError::invalid(format!(
                "the compressed form of buffer view {view} reaches beyond buffer {}",
                self.buffer
            ))
        })?;
        Ok(Stream { view, bytes, mode, filter, stride, count: self.count })
    }
}

impl Stream<'_> {
    /// Returns the number of decoded bytes. Refuses a count for which the stream is too short.
    fn length(&self) -> Result<usize, ReadError> {
        let least = match self.mode {
            Mode::Attributes => attributes::least(self.bytes, self.count, self.stride),
            Mode::Triangles => triangles::least(self.count),
            Mode::Indices => indices::least(self.count),
        };
        let length = self.count.checked_mul(self.stride).filter(|_| least <= self.bytes.len());
        length.ok_or_else(|| {
            ReadError::truncated(format!(
                "buffer view {} has {} elements in {} compressed bytes",
                self.view,
                self.count,
                self.bytes.len()
            ))
        })
    }

    /// Appends the decoded elements.
    fn decode(&self, to: &mut Vec<u8>) -> Result<(), Fault> {
        let start = to.len();
        match self.mode {
            Mode::Attributes => attributes::decode(self.bytes, self.count, self.stride, to)?,
            Mode::Triangles => triangles::decode(self.bytes, self.count, self.stride, to)?,
            Mode::Indices => indices::decode(self.bytes, self.count, self.stride, to)?,
        }
        self.filter.apply(&mut to[start..], self.stride);
        Ok(())
    }
}
