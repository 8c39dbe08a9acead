//! The container of a document: GLB chunks, data URIs, files beside the document.
//!
//! The GLB parser is our own: `gltf` rejects unknown chunks (glTF 2.0, 4.4.3: readers must ignore them), and subtracts
//! from lengths without checking them.

use std::borrow::Cow;
use std::collections::BTreeSet;
use std::fs::File;
use std::io::Read;
use std::path::{Component, Path, PathBuf};

use base64::Engine;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use percent_encoding::percent_decode_str;

use super::document::{Document, size};
use crate::io::error::ReadError;

/// Splits a GLB file (glTF 2.0, 4.4) into its JSON and its binary chunk; skips further chunks.
pub(super) fn chunks(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), ReadError> {
    let word = |at: usize| {
        let found = bytes.get(at..).and_then(|rest| rest.first_chunk::<4>());
        found
            .map(|&b| u32::from_le_bytes(b))
            .ok_or_else(|| ReadError::truncated(format!("the GLB file ends at byte {at}")))
    };
    if word(4)? != 2 {
        return Err(ReadError::unsupported(format!("GLB version {}", word(4)?)));
    }
    let length = word(8)? as usize;
    if length > bytes.len() {
        return Err(ReadError::truncated(format!(
            "the GLB file says {length} bytes, {} are there",
            bytes.len()
        )));
    }
    let chunk = |at: usize| -> Result<(&[u8], u32, usize), ReadError> {
        let (size, kind, start) = (word(at)? as usize, word(at + 4)?, at + 8);
        let content = bytes[..length].get(start..).and_then(|rest| rest.get(..size));
        let content = content
            .ok_or_else(|| ReadError::truncated(format!("the GLB chunk of {size} bytes at byte {at}")))?;
        Ok((content, kind, start + size))
    };
    let (json, kind, mut at) = chunk(12)?;
    if kind != u32::from_le_bytes(*b"JSON") {
        return Err(ReadError::byte(16, "the first GLB chunk is not JSON"));
    }
    while at + 8 <= length {
        let (content, kind, end) = chunk(at)?;
        if kind == u32::from_le_bytes(*b"BIN\0") {
            return Ok((json, Some(content)));
        }
        at = end;
    }
    Ok((json, None))
}

/// Returns the bytes of all buffers: the binary chunk, data URIs, and files beside the document. Never opens images.
///
/// A buffer without bytes is empty if its views have a compressed form: without a URI, or marked as a fallback and not there.
pub(super) fn buffers<'a>(
    document: &Document,
    chunk: Option<&'a [u8]>,
    directory: Option<&Path>,
) -> Result<Vec<Cow<'a, [u8]>>, ReadError> {
    let mut all = Vec::with_capacity(document.buffers.len());
    let mut files = BTreeSet::new();
    let compressed = document.buffer_views.iter().filter(|view| view.compressed().is_some());
    let compressed: BTreeSet<usize> = compressed.map(|view| view.buffer.value()).collect();
    for (i, buffer) in document.buffers.iter().enumerate() {
        let bytes = match &buffer.uri {
            None => match chunk.filter(|_| i == 0) {
                Some(chunk) => Cow::Borrowed(chunk),
                None if buffer.is_fallback() || compressed.contains(&i) => {
                    all.push(Cow::Borrowed(&[][..]));
                    continue;
                }
                None if i == 0 => {
                    return Err(ReadError::invalid("buffer 0 has no uri, and there is no binary chunk"));
                }
                None => return Err(ReadError::invalid(format!("buffer {i} has no uri"))),
            },
            Some(uri) => Cow::Owned(match uri.strip_prefix("data:") {
                Some(data) => decode_data(data)
                    .ok_or_else(|| ReadError::invalid(format!("buffer {i} has a damaged data URI")))?,
                None => match read_file(i, uri, size(buffer.byte_length), directory, &mut files) {
                    Err(_) if buffer.is_fallback() => {
                        all.push(Cow::Borrowed(&[][..]));
                        continue;
                    }
                    read => read?,
                },
            }),
        };
        if bytes.len() < size(buffer.byte_length) {
            let what = format!("buffer {i} says {} bytes, {} are there", buffer.byte_length.0, bytes.len());
            return Err(ReadError::truncated(what));
        }
        all.push(bytes);
    }
    Ok(all)
}

/// Most bytes of a file beside a document: what a GLB file can hold.
const MOST: usize = u32::MAX as usize;

/// Resolves a URI to a path below the document's directory, as written in the document; `None` for all other URIs.
pub(super) fn relative(uri: &str) -> Option<PathBuf> {
    let text = percent_decode_str(uri).decode_utf8().ok()?;
    let stays = |c: Component| matches!(c, Component::Normal(_) | Component::CurDir);
    if text.contains(':') || !Path::new(&*text).components().all(stays) {
        return None;
    }
    let path: PathBuf = Path::new(&*text).components().filter(|c| *c != Component::CurDir).collect();
    (!path.as_os_str().is_empty()).then_some(path)
}

/// Reads a file in the document's directory or below it; rejects paths elsewhere, and all that is no regular file: pipes
/// and devices may have no end. Each file is read once: a document naming a file repeatedly would multiply its size.
fn read_file(
    i: usize,
    uri: &str,
    length: usize,
    directory: Option<&Path>,
    files: &mut BTreeSet<PathBuf>,
) -> Result<Vec<u8>, ReadError> {
    let unresolved =
        || ReadError::unsupported(format!("buffer {i} is at {uri:?}, which is no file beside the document"));
    let relative = relative(uri).ok_or_else(unresolved)?;
    let path = directory.ok_or_else(unresolved)?.join(&relative);
    if !files.insert(relative) {
        return Err(ReadError::unsupported(format!("buffer {i} is the same file as another, {uri:?}")));
    }
    let fail = |source| ReadError::Io { path: path.clone(), source };
    // Asked before opening: to open a pipe waits for a writer.
    let there = std::fs::metadata(&path).map_err(fail)?;
    if !there.is_file() {
        return Err(ReadError::unsupported(format!("buffer {i} is at {uri:?}, which is no regular file")));
    }
    if length > MOST {
        return Err(ReadError::too_large(format!("buffer {i} says {length} bytes, more than {MOST}")));
    }
    let file = File::open(&path).map_err(fail)?;
    // The buffer's declared length bounds the bytes read; the file's length bounds the memory reserved.
    let mut bytes = Vec::new();
    let expected = length.min(usize::try_from(there.len()).unwrap_or(usize::MAX));
    bytes.try_reserve_exact(expected).map_err(|_| {
        ReadError::too_large(format!("buffer {i} of {expected} bytes does not fit in memory"))
    })?;
    file.take(length as u64).read_to_end(&mut bytes).map_err(fail)?;
    Ok(bytes)
}

/// Decodes the text after `data:`; base64 only (RFC 4648, section 4), as glTF requires, with or without padding.
pub(super) fn decode_data(data: &str) -> Option<Vec<u8>> {
    let config = GeneralPurposeConfig::new()
        .with_decode_padding_mode(DecodePaddingMode::Indifferent)
        .with_decode_allow_trailing_bits(true);
    let (kind, text) = data.split_once(',')?;
    let engine = GeneralPurpose::new(&base64::alphabet::STANDARD, config);
    kind.ends_with(";base64").then(|| engine.decode(text).ok())?
}
