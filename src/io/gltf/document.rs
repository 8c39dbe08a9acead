//! The geometric part of a document.
//!
//! Meshes and accessors are structures of `gltf-json`. Its indices are checked at every use. (It keeps the low 32 bits of
//! an index: an index beyond 2^32 names another element.) Scenes, nodes, views and buffers are our own structures:
//! `gltf-json` stores transforms in single precision, so a mesh on a map would lose its place before the origin is
//! moved, rejects scenes without nodes, and drops extensions of views. All content other than geometry is skipped, so an
//! unknown animation, texture or extension does not make a mesh unreadable.

use std::collections::BTreeMap;

use gltf_json::buffer::Stride;
use gltf_json::validation::USize64;
use gltf_json::{Accessor, Asset, Index, Mesh, buffer};
use serde::Deserialize;
use serde::de::IgnoredAny;
use serde_json::value::RawValue;

use super::container::chunks;
use super::extensions;
use crate::io::error::ReadError;

#[derive(Debug, Clone, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct Document {
    pub asset: Option<Asset>,
    pub scene: Option<usize>,
    pub scenes: Vec<Scene>,
    pub nodes: Vec<Node>,
    pub meshes: Vec<Mesh>,
    pub materials: Vec<Named>,
    pub accessors: Vec<Accessor>,
    pub buffer_views: Vec<View>,
    pub buffers: Vec<Buffer>,
    pub extensions_required: Vec<String>,
    /// Counted only.
    pub skins: Vec<IgnoredAny>,
    pub animations: Vec<IgnoredAny>,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Buffer {
    pub uri: Option<String>,
    #[serde(default)]
    pub byte_length: USize64,
    extensions: Option<Box<BufferExtensions>>,
}

#[derive(Debug, Clone, Deserialize)]
struct BufferExtensions {
    #[serde(rename = "EXT_meshopt_compression")]
    ext: Option<Fallback>,
    #[serde(rename = "KHR_meshopt_compression")]
    khr: Option<Fallback>,
}

#[derive(Debug, Clone, Deserialize)]
struct Fallback {
    #[serde(default)]
    fallback: bool,
}

impl Buffer {
    /// Tests if all views of the buffer have a compressed form, by its own word.
    pub fn is_fallback(&self) -> bool {
        let extensions = self.extensions.iter();
        extensions.flat_map(|e| [&e.ext, &e.khr]).flatten().any(|extension| extension.fallback)
    }
}

#[derive(Debug, Clone, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct View {
    pub buffer: Index<buffer::Buffer>,
    pub byte_length: USize64,
    pub byte_offset: Option<USize64>,
    pub byte_stride: Option<Stride>,
    /// Boxed, since most views have no extensions.
    extensions: Option<Box<ViewExtensions>>,
}

#[derive(Debug, Clone, Deserialize)]
struct ViewExtensions {
    #[serde(rename = "EXT_meshopt_compression")]
    ext: Option<Box<RawValue>>,
    #[serde(rename = "KHR_meshopt_compression")]
    khr: Option<Box<RawValue>>,
}

impl View {
    #[cfg(feature = "draco")]
    pub fn new(
        buffer: Index<buffer::Buffer>,
        start: usize,
        length: usize,
        byte_stride: Option<Stride>,
    ) -> Self {
        let (byte_offset, byte_length) = (Some(USize64::from(start)), USize64::from(length));
        Self { buffer, byte_length, byte_offset, byte_stride, extensions: None }
    }

    /// Returns the compressed form, as text: it is parsed where it is needed.
    pub fn compressed(&self) -> Option<&RawValue> {
        let extensions = self.extensions.as_ref()?;
        extensions.khr.as_deref().or(extensions.ext.as_deref())
    }
}

/// A material: only its name is used.
#[derive(Debug, Clone, Deserialize)]
pub(super) struct Named {
    #[serde(default)]
    pub name: String,
}

#[derive(Debug, Clone, Deserialize)]
pub(super) struct Scene {
    #[serde(default)]
    pub nodes: Vec<usize>,
}

#[derive(Debug, Clone, Deserialize)]
pub(super) struct Node {
    pub mesh: Option<usize>,
    pub skin: Option<usize>,
    #[serde(default)]
    pub children: Vec<usize>,
    /// Boxed, since most nodes have no matrix.
    pub matrix: Option<Box<[f64; 16]>>,
    pub translation: Option<[f64; 3]>,
    pub rotation: Option<[f64; 4]>,
    pub scale: Option<[f64; 3]>,
    /// Boxed, since most nodes have no extensions.
    pub extensions: Option<Box<NodeExtensions>>,
}

/// The extensions of nodes that place meshes.
#[derive(Debug, Clone, Deserialize)]
pub(super) struct NodeExtensions {
    #[serde(rename = "EXT_mesh_gpu_instancing")]
    pub instancing: Option<Instancing>,
}

/// `EXT_mesh_gpu_instancing`: accessors of `TRANSLATION`, `ROTATION`, `SCALE` and attributes of the application's own.
#[derive(Debug, Clone, Deserialize)]
pub(super) struct Instancing {
    #[serde(default)]
    pub attributes: BTreeMap<String, usize>,
}

/// Converts a size or offset of a document, to be checked against the bytes present.
pub(super) fn size(value: USize64) -> usize {
    usize::try_from(value.0).unwrap_or(usize::MAX)
}

/// Returns the JSON text of a .gltf or .glb file, and the binary chunk of a .glb file.
pub(super) fn open(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), ReadError> {
    let (json, chunk) = if bytes.starts_with(b"glTF") { chunks(bytes)? } else { (bytes, None) };
    Ok((crate::io::text::without_mark(json), chunk))
}

/// Parses the text of a document; refuses other versions, and required extensions that are not known.
pub(super) fn parse(json: &[u8]) -> Result<Document, ReadError> {
    let document: Document =
        serde_json::from_slice(json).map_err(|e| ReadError::invalid(format!("the glTF document: {e}")))?;
    match &document.asset {
        Some(asset) if asset.version.starts_with("2.") => {}
        Some(asset) => return Err(ReadError::unsupported(format!("glTF version {:?}", asset.version))),
        None => return Err(ReadError::invalid("the glTF document has no asset version")),
    }
    extensions::check_required(&document.extensions_required)?;
    Ok(document)
}
