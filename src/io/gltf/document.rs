//! The geometric part of a document.
//!
//! Meshes, accessors, views and buffers are structures of `gltf-json`. Its indices are checked at every use. (It keeps
//! the low 32 bits of an index: an index beyond 2^32 names another element.) Scenes and nodes are our own structures:
//! `gltf-json` stores transforms in single precision, so a mesh on a map would lose its place before the origin is
//! moved, and rejects scenes without nodes. All content other than geometry is skipped, so an unknown animation,
//! texture or extension does not make a mesh unreadable.

use std::collections::BTreeMap;

use gltf_json::validation::USize64;
use gltf_json::{Accessor, Asset, Buffer, Mesh, buffer};
use serde::Deserialize;
use serde::de::IgnoredAny;

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
    pub buffer_views: Vec<buffer::View>,
    pub buffers: Vec<Buffer>,
    pub extensions_required: Vec<String>,
    /// Counted only.
    pub skins: Vec<IgnoredAny>,
    pub animations: Vec<IgnoredAny>,
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
