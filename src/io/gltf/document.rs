//! The container of glTF 2.0: GLB chunks, the geometric part of the JSON, and the buffers.
//!
//! Meshes, accessors, views and buffers are structures of `gltf-json`. Its indices are checked at every use. (It keeps
//! the low 32 bits of an index: an index beyond 2^32 names another element.) Scenes and nodes are our own structures:
//! `gltf-json` stores transforms in single precision, so a mesh on a map would lose its place before the origin is
//! moved, and rejects scenes without nodes. All content other than geometry is skipped, so an unknown animation,
//! texture or extension does not make a mesh unreadable.
//!
//! The GLB parser is our own: `gltf` rejects unknown chunks (glTF 2.0, 4.4.3: readers must ignore them), and subtracts
//! from lengths without checking them.

use std::borrow::Cow;
use std::collections::BTreeSet;
use std::path::{Component, Path, PathBuf};

use base64::Engine;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use gltf_json::validation::USize64;
use gltf_json::{Accessor, Asset, Buffer, Mesh, buffer};
use percent_encoding::percent_decode_str;
use serde::Deserialize;

use crate::io::error::ReadError;

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct Document {
    pub asset: Option<Asset>,
    pub scene: Option<usize>,
    pub scenes: Vec<Scene>,
    pub nodes: Vec<Node>,
    pub meshes: Vec<Mesh>,
    pub materials: Vec<Named>,
    pub accessors: Vec<Accessor>,
    pub buffer_views: Vec<buffer::View>,
    pub buffers: Vec<Buffer>,
    pub extensions_required: Vec<String>,
}

/// A material: only its name is used.
#[derive(Debug, Deserialize)]
pub(super) struct Named {
    #[serde(default)]
    pub name: String,
}

#[derive(Debug, Deserialize)]
pub(super) struct Scene {
    #[serde(default)]
    pub nodes: Vec<usize>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Node {
    pub mesh: Option<usize>,
    #[serde(default)]
    pub children: Vec<usize>,
    /// Boxed, since most nodes have no matrix.
    pub matrix: Option<Box<[f64; 16]>>,
    pub translation: Option<[f64; 3]>,
    pub rotation: Option<[f64; 4]>,
    pub scale: Option<[f64; 3]>,
}

/// Converts a size or offset of a document, to be checked against the bytes present.
pub(super) fn size(value: USize64) -> usize {
    usize::try_from(value.0).unwrap_or(usize::MAX)
}

/// Extensions replacing buffers by their own encoding.
const COMPRESSED: [&str; 3] =
    ["KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression"];

/// Parses the document of a .gltf or .glb file; returns it with the binary chunk of a .glb file.
pub(super) fn parse(bytes: &[u8]) -> Result<(Document, Option<&[u8]>), ReadError> {
    let (json, chunk) = if bytes.starts_with(b"glTF") { chunks(bytes)? } else { (bytes, None) };
    let json = crate::io::text::without_mark(json);
    let document: Document =
        serde_json::from_slice(json).map_err(|e| ReadError::invalid(format!("the glTF document: {e}")))?;
    match &document.asset {
        Some(asset) if asset.version.starts_with("2.") => {}
        Some(asset) => return Err(ReadError::unsupported(format!("glTF version {:?}", asset.version))),
        None => return Err(ReadError::invalid("the glTF document has no asset version")),
    }
    match document.extensions_required.iter().find(|e| COMPRESSED.contains(&e.as_str())) {
        Some(name) => Err(ReadError::unsupported(format!("the glTF extension {name}"))),
        None => Ok((document, chunk)),
    }
}

/// Splits a GLB file (glTF 2.0, 4.4) into its JSON and its binary chunk; skips further chunks.
fn chunks(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), ReadError> {
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
pub(super) fn buffers<'a>(
    document: &Document,
    chunk: Option<&'a [u8]>,
    directory: Option<&Path>,
) -> Result<Vec<Cow<'a, [u8]>>, ReadError> {
    let mut all = Vec::with_capacity(document.buffers.len());
    let mut files = BTreeSet::new();
    for (i, buffer) in document.buffers.iter().enumerate() {
        let bytes = match &buffer.uri {
            None if i == 0 => {
                let chunk = chunk
                    .ok_or_else(|| ReadError::invalid("buffer 0 has no uri, and there is no binary chunk"))?;
                Cow::Borrowed(chunk)
            }
            None => return Err(ReadError::invalid(format!("buffer {i} has no uri"))),
            Some(uri) => Cow::Owned(match uri.strip_prefix("data:") {
                Some(data) => decode_data(data)
                    .ok_or_else(|| ReadError::invalid(format!("buffer {i} has a damaged data URI")))?,
                None => read_file(i, uri, size(buffer.byte_length), directory, &mut files)?,
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

/// Reads a file in the document's directory or below it; rejects paths elsewhere. Each file is read once: a document
/// naming a file repeatedly would multiply its size.
fn read_file(
    i: usize,
    uri: &str,
    length: usize,
    directory: Option<&Path>,
    files: &mut BTreeSet<PathBuf>,
) -> Result<Vec<u8>, ReadError> {
    use std::io::Read;
    let unresolved =
        || ReadError::unsupported(format!("buffer {i} is at {uri:?}, which is no file beside the document"));
    let relative = percent_decode_str(uri).decode_utf8().map_err(|_| unresolved())?;
    let stays = |c: Component| matches!(c, Component::Normal(_) | Component::CurDir);
    if relative.contains(':') || !Path::new(&*relative).components().all(stays) {
        return Err(unresolved());
    }
    let relative: PathBuf = Path::new(&*relative).components().filter(|c| *c != Component::CurDir).collect();
    let path = directory.ok_or_else(unresolved)?.join(&relative);
    if !files.insert(relative) {
        return Err(ReadError::unsupported(format!("buffer {i} is the same file as another, {uri:?}")));
    }
    let fail = |source| ReadError::Io { path: path.clone(), source };
    let file = std::fs::File::open(&path).map_err(fail)?;
    // The buffer's declared length bounds the bytes read; the file's length bounds the memory reserved.
    let there = file.metadata().map_err(fail)?.len();
    let mut bytes = Vec::with_capacity(length.min(usize::try_from(there).unwrap_or(usize::MAX)));
    file.take(length as u64).read_to_end(&mut bytes).map_err(fail)?;
    Ok(bytes)
}

/// Decodes the text after `data:`; base64 only (RFC 4648, section 4), as glTF requires, with or without padding.
fn decode_data(data: &str) -> Option<Vec<u8>> {
    let config = GeneralPurposeConfig::new()
        .with_decode_padding_mode(DecodePaddingMode::Indifferent)
        .with_decode_allow_trailing_bits(true);
    let (kind, text) = data.split_once(',')?;
    let engine = GeneralPurpose::new(&base64::alphabet::STANDARD, config);
    kind.ends_with(";base64").then(|| engine.decode(text).ok())?
}
