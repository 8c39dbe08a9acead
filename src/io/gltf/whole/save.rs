//! A document to files: .glb with all that it needs, or .gltf with its buffer beside or within it.

use std::ffi::OsStr;
use std::path::{Component, Path, PathBuf};

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use percent_encoding::utf8_percent_encode;
use serde_json::{Value, json};

use crate::io::error::WriteError;
use crate::io::gltf::container::relative;
use crate::io::gltf::write::{IN_URI, glb};
use crate::io::{Format, atomic};

use super::assemble::Assembled;
use super::gltf_document::GltfDocument;
use super::sections::{index, raw, value};

/// Largest picture to embed.
const LARGEST_PICTURE: u64 = 1 << 30;

impl GltfDocument {
    /// Encodes the document as a .glb. Pictures that are files beside the document are embedded, where they are there.
    ///
    /// # Errors
    /// [`WriteError::Unsupported`] for a view that reaches beyond its buffer, and for more than 4 GiB.
    pub fn to_glb(&self) -> Result<Vec<u8>, WriteError> {
        let mut assembled = self.assemble()?;
        self.embed_pictures(&mut assembled);
        assembled.finish(None);
        glb(assembled.sections.text(), &assembled.buffer)
    }

    /// Writes the document as .glb or .gltf; the extension selects. Each file is written atomically.
    ///
    /// A .glb has all pictures within it. A .gltf refers to the pictures where they are, and to a buffer: a file of its own
    /// name with the extension .bin if the document came with a buffer beside it, else text within the document.
    ///
    /// # Errors
    /// See [`WriteError`].
    pub fn write(&self, path: impl AsRef<Path>) -> Result<(), WriteError> {
        let path = path.as_ref();
        let fail = |path: &Path| {
            let path = path.to_owned();
            |source| WriteError::Io { path, source }
        };
        match Format::from_path(path) {
            Some(Format::Glb) => atomic::write(path, &self.to_glb()?).map_err(fail(path)),
            Some(Format::Gltf) => {
                let mut assembled = self.assemble()?;
                self.move_pictures(&mut assembled, path);
                let beside =
                    self.document.buffers.iter().any(|b| b.uri.as_ref().is_some_and(|u| !is_data(u)));
                let name = path.with_extension("bin");
                let name_text = name.file_name().and_then(OsStr::to_str).filter(|_| beside);
                let uri = match name_text {
                    Some(text) => utf8_percent_encode(text, IN_URI).to_string(),
                    None => {
                        let data = BASE64_STANDARD.encode(&assembled.buffer);
                        format!("data:application/octet-stream;base64,{data}")
                    }
                };
                assembled.finish(Some(uri));
                if name_text.is_some() && !assembled.buffer.is_empty() {
                    atomic::write(&name, &assembled.buffer).map_err(fail(&name))?;
                }
                atomic::write(path, &assembled.sections.text()).map_err(fail(path))
            }
            _ => Err(WriteError::UnknownFormat { path: path.to_owned() }),
        }
    }

    /// Calls `change` with each picture that is a file: its element, and its path relative to the document.
    fn pictures(
        &self,
        assembled: &mut Assembled,
        mut change: impl FnMut(&mut Assembled, &mut Value, PathBuf),
    ) {
        let mut images = assembled.sections.array("images");
        let mut is_changed = false;
        for image in &mut images {
            let mut json = value(image);
            let file = json.get("uri").and_then(Value::as_str).filter(|uri| !is_data(uri)).and_then(relative);
            let Some(file) = file else { continue };
            let before = json.clone();
            change(assembled, &mut json, file);
            if json != before {
                *image = raw(&json);
                is_changed = true;
            }
        }
        if is_changed {
            assembled.sections.set_array("images", &images);
        }
    }

    fn embed_pictures(&self, assembled: &mut Assembled) {
        let Some(directory) = &self.directory else { return };
        self.pictures(assembled, |assembled, image, file| {
            let path = directory.join(file);
            let is_readable =
                path.metadata().is_ok_and(|m| m.is_file() && (1..=LARGEST_PICTURE).contains(&m.len()));
            let Some(bytes) = is_readable.then(|| std::fs::read(&path).ok()).flatten() else { return };
            let known = image.get("mimeType").and_then(Value::as_str).map(str::to_owned);
            let Some(kind) = known.or_else(|| kind_of(&path, &bytes)) else { return };
            let buffer = &mut assembled.buffer;
            buffer.resize(buffer.len().next_multiple_of(4), 0);
            let view = json!({ "buffer": 0, "byteOffset": buffer.len(), "byteLength": bytes.len() });
            buffer.extend_from_slice(&bytes);
            assembled.views.push(raw(&view));
            if let Some(members) = image.as_object_mut() {
                members.remove("uri");
            }
            image["mimeType"] = json!(kind);
            image["bufferView"] = json!(assembled.views.len() - 1);
        });
    }

    /// Changes the paths of pictures to lead from the file to be written.
    fn move_pictures(&self, assembled: &mut Assembled, path: &Path) {
        let to = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let Some(from) = &self.directory else { return };
        let [Ok(from), Ok(to)] = [from.canonicalize(), to.canonicalize()] else { return };
        if from == to {
            return;
        }
        self.pictures(assembled, |_, image, file| {
            if let Some(way) = way(&to, &from.join(file)) {
                image["uri"] = json!(utf8_percent_encode(&way, IN_URI).to_string());
            }
        });
    }
}

impl Assembled {
    /// Sets the sections of views and buffers.
    fn finish(&mut self, uri: Option<String>) {
        let Self { sections, views, buffer } = self;
        buffer.resize(buffer.len().next_multiple_of(4), 0);
        sections.set_array("bufferViews", views);
        let mut first = sections.array("buffers").first().map_or(json!({}), |text| value(text));
        if let Some(members) = first.as_object_mut() {
            members.remove("uri");
            members.remove("extensions");
        }
        first["byteLength"] = json!(buffer.len());
        if let Some(uri) = uri {
            first["uri"] = json!(uri);
        }
        let buffers = if buffer.is_empty() { Vec::new() } else { vec![raw(&first)] };
        sections.set_array("buffers", &buffers);
        debug_assert!(views.iter().all(|view| index(value(view).get("buffer")) == Some(0)));
    }
}

fn is_data(uri: &str) -> bool {
    uri.starts_with("data:")
}

/// Returns the media type of a picture, by its first bytes or its extension.
fn kind_of(path: &Path, bytes: &[u8]) -> Option<String> {
    let starts: [(&[u8], &str); 4] = [
        (b"\x89PNG", "image/png"),
        (b"\xff\xd8\xff", "image/jpeg"),
        (b"\xabKTX 20", "image/ktx2"),
        (b"DDS ", "image/vnd-ms.dds"),
    ];
    let known = starts.iter().find(|(start, _)| bytes.starts_with(start)).map(|(_, kind)| *kind);
    let extension = path.extension().and_then(OsStr::to_str).unwrap_or_default().to_ascii_lowercase();
    let kind = known.or(match extension.as_str() {
        "png" => Some("image/png"),
        "jpg" | "jpeg" => Some("image/jpeg"),
        "webp" => Some("image/webp"),
        "avif" => Some("image/avif"),
        _ => None,
    });
    kind.map(str::to_owned)
}

/// Returns the relative path from a folder to a file, both absolute; `None` if there is none, or if it is no text.
fn way(from: &Path, to: &Path) -> Option<String> {
    let (from, to): (Vec<Component>, Vec<Component>) =
        (from.components().collect(), to.components().collect());
    let common = from.iter().zip(&to).take_while(|(a, b)| a == b).count();
    if common == 0 {
        return None;
    }
    let up = std::iter::repeat_n(Some(".."), from.len() - common);
    let down = to[common..].iter().map(|c| c.as_os_str().to_str());
    let steps: Option<Vec<&str>> = up.chain(down).collect();
    steps.map(|steps| steps.join("/"))
}
