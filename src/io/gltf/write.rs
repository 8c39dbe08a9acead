//! Writing glTF 2.0: a single node at the mesh's origin, a single mesh, a primitive for each material, all primitives
//! sharing the vertices.
//!
//! Triangles keep their order within a material. Attributes without a glTF semantic are written as `_name`. Integers
//! are written as 16 bits, or as floats if floats hold them exactly. Locks are not written. Vertices of a mesh without
//! triangles are written as points.

use std::collections::BTreeMap;

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, utf8_percent_encode};
use serde_json::{Value, json};

use crate::io::error::WriteError;
use crate::mesh::{Attribute, AttributeValues, Mesh, names};

use super::semantics::semantic;

/// Most materials: each takes an entry in the document, with or without a name.
const MAX_MATERIALS: u32 = 1 << 16;

/// Characters of a relative path that a URI has as they are.
pub(super) const IN_URI: &AsciiSet =
    &NON_ALPHANUMERIC.remove(b'/').remove(b'.').remove(b'-').remove(b'_').remove(b'~');

/// Pictures that a glTF file refers to, for all its materials: paths relative to the file, with `/` between folders. The
/// files are not opened.
#[derive(Debug, Clone, Default, PartialEq)]
#[non_exhaustive]
pub struct GltfTextures {
    /// Base colours, `baseColorTexture`. Default: none.
    pub base_colour: Option<String>,
    /// Normals in tangent space, `normalTexture`. Default: none.
    pub normal: Option<String>,
}

impl GltfTextures {
    /// Sets the picture of base colours.
    #[must_use]
    pub fn with_base_colour(mut self, path: impl Into<String>) -> Self {
        self.base_colour = Some(path.into());
        self
    }

    /// Sets the picture of normals.
    #[must_use]
    pub fn with_normal(mut self, path: impl Into<String>) -> Self {
        self.normal = Some(path.into());
        self
    }
}

/// Encodes a mesh as a .glb, or as a .gltf with an embedded buffer.
pub(in crate::io) fn write(
    mesh: &Mesh,
    binary: bool,
    textures: &GltfTextures,
) -> Result<Vec<u8>, WriteError> {
    let mut file = File::default();
    if !mesh.positions().is_empty() {
        file.mesh(mesh)?;
        file.textures(mesh, textures)?;
    }
    let File { mut buffer, mut document, .. } = file;
    document["asset"] = json!({ "version": "2.0", "generator": "multires" });
    document["scene"] = json!(0);
    if document.get("scenes").is_none() {
        document["scenes"] = json!([{}]);
    }
    if !buffer.is_empty() {
        buffer.resize(buffer.len().next_multiple_of(4), 0);
        document["buffers"] = json!([{ "byteLength": buffer.len() }]);
    }
    if binary {
        return glb(document.to_string().into_bytes(), &buffer);
    }
    if !buffer.is_empty() {
        document["buffers"][0]["uri"] =
            json!(format!("data:application/octet-stream;base64,{}", BASE64_STANDARD.encode(&buffer)));
    }
    Ok(document.to_string().into_bytes())
}

fn unsupported(what: String) -> WriteError {
    WriteError::Unsupported { format: "glTF", what }
}

#[derive(Default)]
struct File {
    buffer: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
    document: Value,
}

impl File {
    fn mesh(&mut self, mesh: &Mesh) -> Result<(), WriteError> {
        let mut attributes = BTreeMap::new();
        let bytes = bytemuck::cast_slice(mesh.positions());
        let position = self.accessor(bytes, 12, 34_962, 5126, mesh.positions().len(), "VEC3");
        let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
        for p in mesh.positions() {
            for axis in 0..3 {
                low[axis] = low[axis].min(p[axis]);
                high[axis] = high[axis].max(p[axis]);
            }
        }
        self.accessors[position]["min"] = json!(low.map(f64::from));
        self.accessors[position]["max"] = json!(high.map(f64::from));
        attributes.insert("POSITION".to_owned(), position);
        // The `vertex` attribute (identity of the caller's vertices) is not written.
        for attribute in mesh.attributes().iter().filter(|a| a.name() != names::VERTEX) {
            let semantic = semantic_of(attribute);
            let accessor = self.attribute(attribute, mesh.positions().len())?;
            if attributes.insert(semantic.clone(), accessor).is_some() {
                return Err(unsupported(format!("two attributes called {semantic}")));
            }
        }

        let (materials, order) = by_material(mesh);
        let wide = mesh.positions().len() > 65_535;
        let mut primitives = Vec::with_capacity(materials.len());
        for (material, range) in materials {
            let indices = order[range].iter().flat_map(|&t| mesh.triangles()[t as usize]);
            let count = 3 * indices.size_hint().0.max(1);
            let mut bytes = Vec::with_capacity(4 * count);
            for index in indices {
                let word = index.to_le_bytes();
                bytes.extend_from_slice(if wide { &word } else { &word[..2] });
            }
            let (kind, size) = if wide { (5125, 4) } else { (5123, 2) };
            let length = bytes.len() / size;
            let indices = self.accessor(&bytes, size, 34_963, kind, length, "SCALAR");
            let mut primitive = json!({ "attributes": attributes, "indices": indices });
            if let Some(id) = material {
                primitive["material"] = json!(id);
            }
            primitives.push(primitive);
        }
        if primitives.is_empty() {
            primitives.push(json!({ "attributes": attributes, "mode": 0 }));
        }
        self.document = json!({
            "accessors": std::mem::take(&mut self.accessors),
            "bufferViews": std::mem::take(&mut self.views),
            "meshes": [{ "primitives": primitives }],
            "nodes": [{ "mesh": 0 }],
            "scenes": [{ "nodes": [0] }],
        });
        if mesh.origin() != [0.0; 3] {
            self.document["nodes"][0]["translation"] = json!(mesh.origin());
        }
        if let Some(&most) = mesh.materials().iter().max() {
            if most >= MAX_MATERIALS {
                return Err(unsupported(format!("material id {most}, more than {MAX_MATERIALS} materials")));
            }
            let name = |id: usize| match mesh.material_names().get(id) {
                Some(name) => json!({ "name": name }),
                None => json!({}),
            };
            let count = mesh.material_names().len().max(most as usize + 1);
            self.document["materials"] = (0..count).map(name).collect();
        }
        Ok(())
    }

    /// Adds the pictures to every material; primitives without a material get one.
    fn textures(&mut self, mesh: &Mesh, textures: &GltfTextures) -> Result<(), WriteError> {
        let pictures = [("baseColorTexture", &textures.base_colour), ("normalTexture", &textures.normal)];
        let pictures: Vec<(&str, &String)> =
            pictures.into_iter().filter_map(|(slot, path)| Some((slot, path.as_ref()?))).collect();
        if pictures.is_empty() || mesh.triangles().is_empty() {
            return Ok(());
        }
        if mesh.attribute(names::UV).is_none_or(|uv| uv.width() != 2 || uv.as_floats().is_none()) {
            return Err(unsupported("pictures on a mesh without texture coordinates".to_owned()));
        }
        let document = &mut self.document;
        if mesh.materials().is_empty() {
            document["materials"] = json!([{}]);
            document["meshes"][0]["primitives"][0]["material"] = json!(0);
        }
        // Linear, with mipmaps; repeating, which an atlas does not use.
        document["samplers"] = json!([{ "magFilter": 9729, "minFilter": 9987 }]);
        let image =
            |(_, path): &(&str, &String)| json!({ "uri": utf8_percent_encode(path, IN_URI).to_string() });
        document["images"] = pictures.iter().map(image).collect();
        document["textures"] = (0..pictures.len()).map(|i| json!({ "sampler": 0, "source": i })).collect();
        for material in document["materials"].as_array_mut().into_iter().flatten() {
            // Not metal, as materials are by default.
            material["pbrMetallicRoughness"] = json!({ "metallicFactor": 0.0 });
            for (i, (slot, _)) in pictures.iter().enumerate() {
                let texture = json!({ "index": i });
                match *slot {
                    "baseColorTexture" => material["pbrMetallicRoughness"][*slot] = texture,
                    _ => material[*slot] = texture,
                }
            }
        }
        Ok(())
    }

    /// Appends bytes to the buffer, `size` bytes an element, and adds their view and accessor; returns the accessor's
    /// index.
    fn accessor(
        &mut self,
        bytes: &[u8],
        size: usize,
        target: u32,
        component: u32,
        count: usize,
        shape: &str,
    ) -> usize {
        self.buffer.resize(self.buffer.len().next_multiple_of(4), 0);
        let mut view = json!({
            "buffer": 0, "byteOffset": self.buffer.len(), "byteLength": bytes.len(), "target": target,
        });
        if target == 34_962 {
            view["byteStride"] = json!(size);
        }
        self.buffer.extend_from_slice(bytes);
        self.views.push(view);
        let view = self.views.len() - 1;
        self.accessors
            .push(json!({ "bufferView": view, "componentType": component, "count": count, "type": shape }));
        self.accessors.len() - 1
    }

    fn attribute(&mut self, attribute: &Attribute, vertices: usize) -> Result<usize, WriteError> {
        let (name, width) = (attribute.name(), attribute.width());
        let shape = match width {
            1 => "SCALAR",
            2 => "VEC2",
            3 => "VEC3",
            4 => "VEC4",
            _ => return Err(unsupported(format!("attribute {name:?} of width {width}"))),
        };
        let (low, high) = match attribute.values() {
            AttributeValues::Float(values) => {
                let bytes = bytemuck::cast_slice(values);
                return Ok(self.accessor(bytes, 4 * width, 34_962, 5126, vertices, shape));
            }
            AttributeValues::Int(values) => range(values.iter().map(|&x| i64::from(x))),
            AttributeValues::Uint(values) => range(values.iter().map(|&x| i64::from(x))),
        };
        let is_signed = matches!(attribute.values(), AttributeValues::Int(_));
        let at = |i: usize| match attribute.values() {
            AttributeValues::Float(values) => values[i] as i64,
            AttributeValues::Int(values) => i64::from(values[i]),
            AttributeValues::Uint(values) => i64::from(values[i]),
        };
        let (component, size) = match (is_signed, low, high) {
            (true, -0x8000.., ..=0x7fff) => (5122, 2),
            (false, _, ..=0xffff) => (5123, 2),
            // Joints must be integers; other attributes may become floats of equal value.
            (_, -0x0100_0000.., ..=0x0100_0000) if semantic_of(attribute).starts_with('_') => (5126, 4),
            _ => return Err(unsupported(format!("attribute {name:?} with values from {low} to {high}"))),
        };
        let stride = (size * width).next_multiple_of(4);
        let mut bytes = Vec::with_capacity(stride * vertices);
        for vertex in 0..vertices {
            for i in vertex * width..(vertex + 1) * width {
                match component {
                    5126 => bytes.extend_from_slice(&(at(i) as f32).to_le_bytes()),
                    _ => bytes.extend_from_slice(&(at(i) as u16).to_le_bytes()),
                }
            }
            bytes.resize((vertex + 1) * stride, 0);
        }
        Ok(self.accessor(&bytes, stride, 34_962, component, vertices, shape))
    }
}

fn range(values: impl Iterator<Item = i64>) -> (i64, i64) {
    values.fold((0, 0), |(low, high), x| (low.min(x), high.max(x)))
}

/// Returns the glTF semantic for the attribute's name and type, else `_name`.
fn semantic_of(attribute: &Attribute) -> String {
    let own = || format!("_{}", attribute.name());
    let known = semantic(attribute.name(), attribute.width()).map(|s| s.to_string());
    let is_right =
        |s: &String| s.starts_with("JOINTS_") == matches!(attribute.values(), AttributeValues::Uint(_));
    let is_float = attribute.as_floats().is_some();
    known.filter(|s| is_right(s) && (is_float || s.starts_with("JOINTS_"))).unwrap_or_else(own)
}

/// Runs of triangles of equal material, in order of first appearance.
type Runs = Vec<(Option<u32>, std::ops::Range<usize>)>;

fn by_material(mesh: &Mesh) -> (Runs, Vec<u32>) {
    let count = mesh.triangles().len();
    let mut order: Vec<u32> = (0..count as u32).collect();
    if mesh.materials().is_empty() {
        let runs = if count == 0 { Vec::new() } else { vec![(None, 0..count)] };
        return (runs, order);
    }
    let mut first: BTreeMap<u32, u32> = BTreeMap::new();
    for (t, &id) in mesh.materials().iter().enumerate() {
        first.entry(id).or_insert(t as u32);
    }
    let id = |t: u32| mesh.materials()[t as usize];
    let rank: Vec<u32> =
        mesh.materials().iter().map(|id| first.get(id).copied().unwrap_or_default()).collect();
    order.sort_by_key(|&t| rank[t as usize]);
    let mut start = 0;
    let runs = order.chunk_by(|&a, &b| id(a) == id(b)).map(|run| {
        let range = start..start + run.len();
        start = range.end;
        (Some(id(run[0])), range)
    });
    (runs.collect(), order)
}

/// Joins the text of a document and its buffer to a .glb.
pub(super) fn glb(mut json: Vec<u8>, buffer: &[u8]) -> Result<Vec<u8>, WriteError> {
    json.resize(json.len().next_multiple_of(4), b' ');
    let chunk = if buffer.is_empty() { 0 } else { 8 + buffer.len() };
    let length = 20 + json.len() + chunk;
    let word = |n: usize| u32::try_from(n).map_err(|_| unsupported(format!("{n} bytes in a GLB file")));
    let mut out = Vec::with_capacity(length);
    out.extend_from_slice(b"glTF");
    for value in [2, word(length)?, word(json.len())?] {
        out.extend_from_slice(&value.to_le_bytes());
    }
    out.extend_from_slice(b"JSON");
    out.extend_from_slice(&json);
    if chunk > 0 {
        out.extend_from_slice(&word(buffer.len())?.to_le_bytes());
        out.extend_from_slice(b"BIN\0");
        out.extend_from_slice(buffer);
    }
    Ok(out)
}
