//! The pictures of a glTF file: base colours and normals that its materials name, inside the file or beside it.

#[cfg(feature = "program")]
use std::path::Path;

use serde_json::Value;

use super::texture::Texture;

/// Magic number of a .glb, and the kinds of its chunks.
const GLB: &[u8] = b"glTF";
const JSON: u32 = 0x4E4F_534A;
const BINARY: u32 = 0x004E_4942;

/// What a file's first material with each picture names.
#[derive(Debug, Default)]
pub(super) struct Pictures {
    pub base_colour: Option<Texture>,
    /// In tangent space: `127.5 (n + 1)`, green up.
    pub normals: Option<Texture>,
    /// Why a picture that is named cannot be had.
    pub warnings: Vec<String>,
}

impl Pictures {
    /// Reads the pictures of a glTF file; of other files there are none. PNG only.
    #[cfg(feature = "program")]
    pub fn read(path: &Path) -> Self {
        let mut pictures = Self::default();
        let is = |extension: &str| path.extension().is_some_and(|own| own.eq_ignore_ascii_case(extension));
        if is("gltf") || is("glb") {
            let read =
                |path: &Path| std::fs::read(path).map_err(|error| format!("{}: {error}", path.display()));
            std::fs::read(path)
                .map_err(|error| error.to_string())
                .and_then(|bytes| pictures.take(&bytes, &|name| read(&path.with_file_name(name))))
                .unwrap_or_else(|reason| pictures.warnings.push(format!("no pictures: {reason}")));
        }
        pictures
    }

    /// Reads the pictures inside a glTF file in memory; those beside it are named as lost.
    pub fn of(bytes: &[u8]) -> Self {
        let mut pictures = Self::default();
        let beside = |name: &str| Err(format!("{name} lies beside the file"));
        pictures
            .take(bytes, &beside)
            .unwrap_or_else(|reason| pictures.warnings.push(format!("no pictures: {reason}")));
        pictures
    }

    fn take(&mut self, bytes: &[u8], beside: &Beside<'_>) -> Result<(), String> {
        let (document, binary) = parts(bytes).ok_or("the document is damaged")?;
        let document: Value = serde_json::from_slice(document).map_err(|error| error.to_string())?;
        let materials = document["materials"].as_array().map_or(&[][..], Vec::as_slice);
        let named = |texture: fn(&Value) -> &Value| {
            let index = materials.iter().find_map(|material| texture(material)["index"].as_u64());
            index.map(|index| picture(beside, &document, binary, index))
        };
        let base_colour = named(|material| &material["pbrMetallicRoughness"]["baseColorTexture"]);
        let normals = named(|material| &material["normalTexture"]);
        let warnings = &mut self.warnings;
        let mut found = |what: &str, picture: Option<Result<Texture, String>>| {
            picture?.map_err(|reason| warnings.push(format!("no {what}: {reason}"))).ok()
        };
        self.base_colour = found("base colours", base_colour);
        self.normals = found("normal map", normals);
        Ok(())
    }
}

/// Reads a file beside the document, by name.
type Beside<'a> = dyn Fn(&str) -> Result<Vec<u8>, String> + 'a;

/// Returns the picture of a texture of the document.
fn picture(beside: &Beside<'_>, document: &Value, binary: &[u8], texture: u64) -> Result<Texture, String> {
    let source = document["textures"][texture as usize]["source"].as_u64();
    let image = &document["images"][source.ok_or("the texture has no picture")? as usize];
    let picture = match image["uri"].as_str() {
        Some(uri) if uri.starts_with("data:") => return Err("pictures in data URIs are not read".to_owned()),
        Some(uri) => beside(&String::from_utf8_lossy(&decoded(uri)))?,
        None => embedded(document, image, binary).ok_or("the picture is not in the file")?.to_vec(),
    };
    Texture::from_png(&picture)
}

/// Returns the document and the binary chunk of a file.
fn parts(bytes: &[u8]) -> Option<(&[u8], &[u8])> {
    if !bytes.starts_with(GLB) {
        return Some((bytes, &[]));
    }
    let (mut document, mut binary) = (None, None);
    let mut rest = bytes.get(12..)?;
    while let Some((head, body)) = rest.split_first_chunk::<8>() {
        let [length, kind] = [&head[..4], &head[4..]].map(|word| word.try_into().map(u32::from_le_bytes));
        let (chunk, next) = body.split_at_checked(length.ok()? as usize)?;
        match kind.ok()? {
            JSON => document = document.or(Some(chunk)),
            BINARY => binary = binary.or(Some(chunk)),
            _ => {}
        }
        rest = next;
    }
    Some((document?, binary.unwrap_or(&[])))
}

/// Returns the bytes of a picture in the binary chunk.
fn embedded<'a>(document: &Value, image: &Value, binary: &'a [u8]) -> Option<&'a [u8]> {
    let view = &document["bufferViews"][image["bufferView"].as_u64()? as usize];
    let start = view["byteOffset"].as_u64().unwrap_or(0) as usize;
    binary.get(start..start.checked_add(view["byteLength"].as_u64()? as usize)?)
}

/// Returns a URI with `%xx` as bytes.
fn decoded(uri: &str) -> Vec<u8> {
    let bytes = uri.as_bytes();
    let mut out = Vec::with_capacity(bytes.len());
    let mut at = 0;
    while at < bytes.len() {
        let escaped = uri.get(at + 1..at + 3).filter(|_| bytes[at] == b'%');
        match escaped.and_then(|digits| u8::from_str_radix(digits, 16).ok()) {
            Some(byte) => {
                out.push(byte);
                at += 3;
            }
            None => {
                out.push(bytes[at]);
                at += 1;
            }
        }
    }
    out
}
