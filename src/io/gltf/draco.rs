//! `KHR_draco_mesh_compression`: primitives whose vertices and triangles are a stream of Draco, decoded on opening by
//! `draco-core` (feature `draco`).
//!
//! ```text
//!     primitive --> { view, attributes: semantic -> number in the stream } --> points, faces
//!     accessor without view --> view of a further buffer, in the accessor's type
//! ```
//!
//! A primitive is decoded only if its accessors have no views: uncompressed bytes are exact. Each accessor is given the
//! first stream that has it. A point of the stream is a vertex; the accessor's count becomes the number of points.
//!
//! Memory: all streams together may decode to `64 * bytes + 4 MiB`, which `draco-core` is told as a limit: a stream does not
//! bound its own result.

use std::borrow::Cow;
use std::collections::BTreeMap;

use draco_core::{DataType, DecodeLimits, DecoderBuffer, Mesh, MeshDecoder, PointAttribute, PointIndex};
use gltf_json::Index;
use gltf_json::accessor::{ComponentType, GenericComponentType};
use gltf_json::buffer::Stride;
use gltf_json::mesh::Mode;
use gltf_json::validation::{Checked, USize64};
use serde::Deserialize;

use super::decoded::{Decoded, most};
use super::document::{Document, View, size};
use crate::io::error::ReadError;

/// What is read of a document besides [`Document`].
#[derive(Deserialize)]
struct Extended {
    #[serde(default)]
    meshes: Vec<Primitives>,
}

#[derive(Deserialize)]
struct Primitives {
    #[serde(default)]
    primitives: Vec<Primitive>,
}

#[derive(Deserialize)]
struct Primitive {
    #[serde(default)]
    attributes: BTreeMap<String, usize>,
    indices: Option<usize>,
    extensions: Option<Extensions>,
}

#[derive(Deserialize)]
struct Extensions {
    #[serde(rename = "KHR_draco_mesh_compression")]
    draco: Option<Draco>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Draco {
    buffer_view: usize,
    #[serde(default)]
    attributes: BTreeMap<String, u32>,
}

/// Decodes the primitives whose accessors have no views. `json`: text of the document; `bytes`: size of the file.
pub(super) fn decode(
    json: &[u8],
    document: &mut Document,
    buffers: &mut Vec<Cow<'_, [u8]>>,
    bytes: usize,
    mut decoded: Decoded,
) -> Result<Decoded, ReadError> {
    let name = b"KHR_draco_mesh_compression";
    if !json.windows(name.len()).any(|word| word == name) {
        return Ok(decoded);
    }
    let own = document.buffer_views.len();
    let extended: Extended =
        serde_json::from_slice(json).map_err(|e| ReadError::invalid(format!("the glTF document: {e}")))?;
    let behind = u32::try_from(buffers.len()).unwrap_or(u32::MAX);
    let mut made = Made { behind, bytes: Vec::new(), left: most(buffers, bytes) };
    for (m, mesh) in extended.meshes.iter().enumerate() {
        for (p, primitive) in mesh.primitives.iter().enumerate() {
            let Some(draco) = primitive.extensions.as_ref().and_then(|e| e.draco.as_ref()) else { continue };
            let fail = |what: String| {
                ReadError::invalid(format!("mesh {m}, primitive {p}, Draco compression: {what}"))
            };
            let lacks = |accessor: usize| {
                document
                    .accessors
                    .get(accessor)
                    .is_some_and(|a| a.buffer_view.is_none() && a.sparse.is_none())
            };
            let named: Vec<(usize, u32)> = draco
                .attributes
                .iter()
                .filter_map(|(semantic, &number)| Some((*primitive.attributes.get(semantic)?, number)))
                .filter(|&(accessor, _)| lacks(accessor))
                .collect();
            let indices = primitive.indices.filter(|&accessor| lacks(accessor));
            if named.is_empty() && indices.is_none() {
                continue;
            }
            let typed = document.meshes.get(m).and_then(|mesh| mesh.primitives.get(p));
            if !typed.is_some_and(|p| p.mode == Checked::Valid(Mode::Triangles)) {
                return Err(fail("no list of triangles".to_owned()));
            }
            let stream = view(document, buffers, draco.buffer_view);
            let stream =
                stream.ok_or_else(|| fail(format!("buffer view {} is not there", draco.buffer_view)))?;
            let mesh = made.mesh(stream).map_err(fail)?;
            for (accessor, number) in named {
                let attribute = mesh.attribute_by_unique_id(number);
                let attribute = attribute.ok_or_else(|| fail(format!("there is no attribute {number}")))?;
                made.vertices(document, accessor, &mesh, attribute).map_err(fail)?;
                decoded.accessors.insert(accessor);
            }
            if let Some(accessor) = indices {
                made.indices(document, accessor, &mesh).map_err(fail)?;
                decoded.accessors.insert(accessor);
            }
            decoded.streams.insert(draco.buffer_view);
            decoded.primitives.insert((m, p));
        }
    }
    if !made.bytes.is_empty() {
        buffers.push(Cow::Owned(made.bytes));
    }
    decoded.filtered.extend(own..document.buffer_views.len());
    Ok(decoded)
}

/// Returns the bytes of a view.
fn view<'a>(document: &Document, buffers: &'a [Cow<'_, [u8]>], view: usize) -> Option<&'a [u8]> {
    let found = document.buffer_views.get(view)?;
    let buffer = buffers.get(found.buffer.value())?;
    buffer.get(found.byte_offset.map_or(0, size)..)?.get(..size(found.byte_length))
}

/// The further buffer.
struct Made {
    /// Its index.
    behind: u32,
    bytes: Vec<u8>,
    /// Bytes that may still be decoded.
    left: usize,
}

impl Made {
    fn mesh(&mut self, stream: &[u8]) -> Result<Mesh, String> {
        let left = self.left as u64;
        let limits = DecodeLimits::default().with_max_points(left / 4).with_max_faces(left / 12);
        let mut bytes = DecoderBuffer::new(stream).with_limits(limits.with_max_decoded_bytes(left));
        let mut mesh = Mesh::new();
        let decoded = MeshDecoder::new().decode(&mut bytes, &mut mesh);
        decoded.map_err(|e| e.to_string().lines().next().unwrap_or_default().to_owned())?;
        Ok(mesh)
    }

    /// Counts decoded bytes, and appends that many zeros; returns their place.
    fn grow(&mut self, count: usize, stride: usize) -> Result<usize, String> {
        let length = count.checked_mul(stride).filter(|&length| length <= self.left);
        let length = length.ok_or("more bytes than its file may have")?;
        self.left -= length;
        let start = self.bytes.len().next_multiple_of(4);
        self.bytes.resize(start + length, 0);
        Ok(start)
    }

    /// Gives an accessor a view of its own, from `start` to the end.
    fn lead(
        &self,
        document: &mut Document,
        accessor: usize,
        start: usize,
        stride: Option<usize>,
        count: usize,
    ) {
        let view = Index::new(document.buffer_views.len() as u32);
        let length = self.bytes.len() - start;
        document.buffer_views.push(View::new(Index::new(self.behind), start, length, stride.map(Stride)));
        let accessor = &mut document.accessors[accessor];
        accessor.buffer_view = Some(view);
        accessor.byte_offset = None;
        accessor.count = USize64::from(count);
    }

    fn vertices(
        &mut self,
        document: &mut Document,
        accessor: usize,
        mesh: &Mesh,
        attribute: &PointAttribute,
    ) -> Result<(), String> {
        let found = &document.accessors[accessor];
        let (Checked::Valid(component), Checked::Valid(kind)) = (found.component_type, found.type_) else {
            return Err(format!("accessor {accessor} is of a type that glTF does not have"));
        };
        let (component, width) = (component.0, kind.multiplicity());
        if usize::from(attribute.num_components()) != width {
            return Err(format!("accessor {accessor} has elements of another width"));
        }
        let stride = (component.size() * width).next_multiple_of(4);
        let start = self.grow(mesh.num_points(), stride)?;
        let from = usize::try_from(attribute.byte_stride()).unwrap_or(0);
        let data = attribute.buffer().data();
        let size = attribute.data_type().byte_length();
        for (point, to) in self.bytes[start..].chunks_exact_mut(stride).enumerate() {
            let value = attribute.mapped_index(PointIndex(point as u32)).0 as usize;
            let element = value.checked_mul(from).and_then(|at| data.get(at..)?.get(..size * width));
            let element = element.ok_or_else(|| format!("point {point} has no value"))?;
            for (c, to) in to.chunks_exact_mut(component.size()).take(width).enumerate() {
                let value = value_of(attribute.data_type(), &element[size * c..size * (c + 1)]);
                put(to, component, value.ok_or("values of 64 bits")?);
            }
        }
        self.lead(document, accessor, start, Some(stride), mesh.num_points());
        Ok(())
    }

    fn indices(&mut self, document: &mut Document, accessor: usize, mesh: &Mesh) -> Result<(), String> {
        let found = &mut document.accessors[accessor];
        let mut component = match found.component_type {
            Checked::Valid(component) => component.0,
            Checked::Invalid => ComponentType::U32,
        };
        let most = match component {
            ComponentType::U8 => 255,
            ComponentType::U16 => 65_535,
            _ => usize::MAX,
        };
        if mesh.num_points() > most || !matches!(component, ComponentType::U8 | ComponentType::U16) {
            component = ComponentType::U32;
        }
        found.component_type = Checked::Valid(GenericComponentType(component));
        let count = mesh.faces().as_flattened().len();
        let start = self.grow(count, component.size())?;
        let corners = mesh.faces().as_flattened().iter();
        for (to, corner) in self.bytes[start..].chunks_exact_mut(component.size()).zip(corners) {
            to.copy_from_slice(&corner.0.to_le_bytes()[..component.size()]);
        }
        self.lead(document, accessor, start, None, count);
        Ok(())
    }
}

/// Returns a value of the stream; `None` for integers of 64 bits.
fn value_of(kind: DataType, bytes: &[u8]) -> Option<f64> {
    let mut word = [0; 8];
    word[..bytes.len()].copy_from_slice(bytes);
    let low = u64::from_le_bytes(word) as u32;
    Some(match kind {
        DataType::Int8 => f64::from(low as i8),
        DataType::Int16 => f64::from(low as i16),
        DataType::Int32 => f64::from(low as i32),
        DataType::Uint8 | DataType::Uint16 | DataType::Uint32 | DataType::Bool => f64::from(low),
        DataType::Float32 => f64::from(f32::from_bits(low)),
        DataType::Float64 => f64::from_le_bytes(word),
        _ => return None,
    })
}

fn put(to: &mut [u8], component: ComponentType, value: f64) {
    match component {
        ComponentType::F32 => to.copy_from_slice(&(value as f32).to_le_bytes()),
        ComponentType::I8 => to.copy_from_slice(&(value as i8).to_le_bytes()),
        ComponentType::U8 => to.copy_from_slice(&(value as u8).to_le_bytes()),
        ComponentType::I16 => to.copy_from_slice(&(value as i16).to_le_bytes()),
        ComponentType::U16 => to.copy_from_slice(&(value as u16).to_le_bytes()),
        ComponentType::U32 => to.copy_from_slice(&(value as u32).to_le_bytes()),
    }
}
