//! A mesh to the columns of primitives, in the types that the file has for them.
//!
//! A value that is as it was read is written as it was stored: what is read as `x / 255` is rounded back to `x`.

use gltf_json::accessor::ComponentType;

use crate::io::error::WriteError;
use crate::io::gltf::accessor::{Shape, one};
use crate::io::gltf::normals::LENGTH_SLACK;
use crate::mesh::{AttributeValues, Mesh, names};

/// The values of an accessor.
#[derive(Debug, Clone)]
pub(super) struct Column {
    /// The accessor that is replaced.
    pub old: Option<usize>,
    pub shape: Shape,
    pub count: usize,
    /// Elements, each `stride` bytes.
    pub bytes: Vec<u8>,
    /// Of a column that is mostly zeros: the elements that `bytes` holds.
    pub sparse: Option<Vec<u32>>,
    pub stride: usize,
    /// Least and largest stored components.
    pub range: Option<[Vec<f64>; 2]>,
    pub is_index: bool,
}

/// What a column is made from.
#[derive(Debug, Clone)]
pub(super) struct Source {
    /// The mesh's attribute; `None` for positions.
    pub name: Option<String>,
    pub old: usize,
    pub shape: Shape,
    /// Whether the old accessor stores nothing but what differs from 0, as morph targets of faces do.
    pub is_sparse: bool,
}

impl Column {
    /// Makes a column of the vertices in `order`; `None` if the mesh lacks the attribute.
    pub fn vertices(mesh: &Mesh, source: &Source, order: &[u32]) -> Option<Self> {
        let (name, old, shape) = (source.name.as_deref(), source.old, source.shape);
        let mut rows = match name {
            None => Rows::new(mesh.positions().as_flattened(), 3, shape.width, order),
            Some(name) => {
                let attribute = mesh.attribute(name)?;
                match attribute.values() {
                    AttributeValues::Float(v) => Rows::new(v, attribute.width(), shape.width, order),
                    AttributeValues::Int(v) => Rows::new(v, attribute.width(), shape.width, order),
                    AttributeValues::Uint(v) => Rows::new(v, attribute.width(), shape.width, order),
                }
            }
        };
        match name {
            Some(names::NORMAL) => rows.values.chunks_exact_mut(shape.width).for_each(unit),
            Some(names::TANGENT) => rows.values.chunks_exact_mut(shape.width).for_each(tangent),
            _ => {}
        }
        let keeps_sum = name.is_some_and(|name| names::is_set_of(name, names::WEIGHTS));
        let is_position = name.is_none_or(|name| names::is_set_of(name, names::DISPLACEMENT));
        let column = rows.encode(old, shape, keeps_sum, is_position);
        Some(if source.is_sparse { column.thinned() } else { column })
    }

    /// Leaves out zeros, where that takes less room.
    fn thinned(self) -> Self {
        let elements = || self.bytes.chunks_exact(self.stride);
        let places: Vec<u32> =
            (0..).zip(elements()).filter(|(_, e)| e.iter().any(|&b| b != 0)).map(|(i, _)| i).collect();
        let is_tight = self.stride == self.shape.component.size() * self.shape.width;
        // An accessor must replace at least one element.
        if !is_tight || places.is_empty() || places.len() * (self.stride + 4) >= self.bytes.len() {
            return self;
        }
        let bytes = places.iter().flat_map(|&i| &self.bytes[i as usize * self.stride..][..self.stride]);
        Self { bytes: bytes.copied().collect(), sparse: Some(places), ..self }
    }

    /// Makes a column of indices, in the type of the old ones if they fit.
    pub fn indices(indices: &[u32], vertices: usize, old: Option<(usize, Shape)>) -> Self {
        // The largest number of each type means "restart", and is no index (glTF 2.0, 3.7.2.1).
        let wide = vertices > 65_535;
        let component = match old.map(|(_, shape)| shape.component) {
            Some(ComponentType::U32) => ComponentType::U32,
            Some(ComponentType::U8) if vertices <= 255 => ComponentType::U8,
            _ if wide => ComponentType::U32,
            _ => ComponentType::U16,
        };
        let stride = component.size();
        let mut bytes = Vec::with_capacity(stride * indices.len());
        indices.iter().for_each(|i| bytes.extend_from_slice(&i.to_le_bytes()[..stride]));
        let shape = Shape { component, normalized: false, width: 1 };
        let (old, count) = (old.map(|(old, _)| old), indices.len());
        Self { old, shape, count, bytes, sparse: None, stride, range: None, is_index: true }
    }
}

/// Values of vertices, `width` each.
struct Rows {
    values: Vec<f64>,
    width: usize,
}

impl Rows {
    /// Gathers the first `width` of `own` values of each vertex; 0 where there are fewer.
    fn new<T: Copy + Into<f64>>(values: &[T], own: usize, width: usize, order: &[u32]) -> Self {
        let mut gathered = vec![0.0; width * order.len()];
        for (row, &v) in gathered.chunks_exact_mut(width).zip(order) {
            let from = &values[v as usize * own..][..own];
            row.iter_mut().zip(from).for_each(|(to, &from)| *to = from.into());
        }
        Self { values: gathered, width }
    }

    fn encode(&self, old: usize, shape: Shape, keeps_sum: bool, is_position: bool) -> Column {
        let size = shape.component.size();
        let stride = (size * shape.width).next_multiple_of(4);
        let count = self.values.len() / self.width;
        let mut bytes = Vec::with_capacity(stride * count);
        let mut range = [vec![f64::INFINITY; shape.width], vec![f64::NEG_INFINITY; shape.width]];
        let mut stored = vec![0.0; shape.width];
        for row in self.values.chunks_exact(self.width) {
            for (to, &value) in stored.iter_mut().zip(row) {
                *to = store(value, shape);
            }
            if keeps_sum && shape.normalized {
                keep_sum(row, &mut stored, one(shape.component));
            }
            for (i, &value) in stored.iter().enumerate() {
                range[0][i] = range[0][i].min(value);
                range[1][i] = range[1][i].max(value);
                put(&mut bytes, value, shape.component);
            }
            bytes.resize(bytes.len().next_multiple_of(stride), 0);
        }
        let range = is_position.then_some(range);
        Column { old: Some(old), shape, count, bytes, sparse: None, stride, range, is_index: false }
    }
}

/// Returns the stored component of a value.
fn store(value: f64, shape: Shape) -> f64 {
    let scale = if shape.normalized { one(shape.component) } else { 1.0 };
    let (low, high) = match shape.component {
        ComponentType::F32 => return value,
        ComponentType::I8 => (-128.0, 127.0),
        ComponentType::U8 => (0.0, 255.0),
        ComponentType::I16 => (-32_768.0, 32_767.0),
        ComponentType::U16 => (0.0, 65_535.0),
        ComponentType::U32 => (0.0, 4_294_967_295.0),
    };
    let low = if shape.normalized && low < 0.0 { -high } else { low };
    // NaN becomes 0.
    (value * scale).round().clamp(low, high).max(low)
}

/// Makes stored weights sum to exactly `whole` if the weights sum to 1: the largest takes the difference of rounding.
fn keep_sum(weights: &[f64], stored: &mut [f64], whole: f64) {
    if (weights.iter().sum::<f64>() - 1.0).abs() > 0.01 {
        return;
    }
    let off = whole - stored.iter().sum::<f64>();
    let largest = (0..stored.len()).fold(0, |most, i| if stored[i] > stored[most] { i } else { most });
    stored[largest] = (stored[largest] + off).clamp(0.0, whole);
}

fn put(bytes: &mut Vec<u8>, value: f64, component: ComponentType) {
    match component {
        ComponentType::F32 => bytes.extend_from_slice(&(value as f32).to_le_bytes()),
        ComponentType::I8 => bytes.push(value as i8 as u8),
        ComponentType::U8 => bytes.push(value as u8),
        ComponentType::I16 => bytes.extend_from_slice(&(value as i16).to_le_bytes()),
        ComponentType::U16 => bytes.extend_from_slice(&(value as u16).to_le_bytes()),
        ComponentType::U32 => bytes.extend_from_slice(&(value as u32).to_le_bytes()),
    }
}

/// Scales the first three values to length 1, unless their length is near 1. Values of no length become the z axis.
fn unit(row: &mut [f64]) {
    let Some(direction) = row.first_chunk_mut::<3>() else { return };
    let length = direction.iter().map(|x| x * x).sum::<f64>().sqrt();
    if (length - 1.0).abs() <= f64::from(LENGTH_SLACK) {
        return;
    }
    if length > 1e-30 && length.is_finite() {
        direction.iter_mut().for_each(|x| *x /= length);
    } else {
        *direction = [0.0, 0.0, 1.0];
    }
}

/// Makes a tangent of length 1, with a handedness of 1 or -1.
fn tangent(row: &mut [f64]) {
    unit(row);
    if let Some(hand) = row.get_mut(3) {
        *hand = if *hand < 0.0 { -1.0 } else { 1.0 };
    }
}

/// The primitives of a mesh, encoded.
#[derive(Debug, Clone, Default)]
pub(super) struct Encoded {
    pub columns: Vec<Column>,
    /// Primitives with triangles: index in the old mesh, semantics with columns (targets: by number), column of the indices.
    pub primitives: Vec<EncodedPrimitive>,
}

#[derive(Debug, Clone)]
pub(super) struct EncodedPrimitive {
    pub primitive: usize,
    pub attributes: Vec<(String, usize)>,
    /// Each target's semantics with columns.
    pub targets: Vec<Vec<(String, usize)>>,
    pub indices: usize,
}

/// A primitive to encode.
pub(super) struct Layout {
    pub primitive: usize,
    /// First primitive with equal accessors.
    pub first_like: usize,
    pub attributes: Vec<(String, Source)>,
    pub targets: Vec<Vec<(String, Source)>>,
    pub indices: Option<(usize, Shape)>,
}

impl Encoded {
    /// Encodes a mesh whose material ids are indices of primitives. Primitives without triangles are left out.
    pub fn new(mesh: &Mesh, layouts: &[Layout]) -> Result<Self, WriteError> {
        let refused = |what: String| WriteError::Unsupported { format: "glTF", what };
        let Some(only) = layouts.first() else {
            return Err(refused("triangles in a mesh that has no surface".to_owned()));
        };
        // Triangles of each layout.
        let mut triangles: Vec<Vec<u32>> = vec![Vec::new(); layouts.len()];
        for (t, _) in mesh.triangles().iter().enumerate() {
            let id = mesh.materials().get(t).map_or(only.primitive, |&id| id as usize);
            let place = layouts.binary_search_by_key(&id, |layout| layout.primitive);
            let place =
                place.map_err(|_| refused(format!("material id {id}, which is no primitive's index")))?;
            triangles[place].push(t as u32);
        }
        if mesh.triangles().is_empty() {
            return Err(refused("a mesh without triangles".to_owned()));
        }
        let mut encoded = Self::default();
        let mut number = vec![u32::MAX; mesh.positions().len()];
        for (i, layout) in layouts.iter().enumerate() {
            if layout.first_like != layout.primitive {
                continue;
            }
            // Primitives that share their vertices.
            let group: Vec<usize> =
                (i..layouts.len()).filter(|&j| layouts[j].first_like == layout.primitive).collect();
            let mut order = Vec::new();
            for &t in group.iter().flat_map(|&j| &triangles[j]) {
                for v in mesh.triangles()[t as usize] {
                    if number[v as usize] == u32::MAX {
                        number[v as usize] = order.len() as u32;
                        order.push(v);
                    }
                }
            }
            if order.is_empty() {
                continue;
            }
            let columns = encoded.vertices(mesh, layout, &order);
            for j in group.into_iter().filter(|&j| !triangles[j].is_empty()) {
                let corners = triangles[j].iter().flat_map(|&t| mesh.triangles()[t as usize]);
                let indices: Vec<u32> = corners.map(|v| number[v as usize]).collect();
                encoded.columns.push(Column::indices(&indices, order.len(), layouts[j].indices));
                let (attributes, targets) = columns.clone();
                let (primitive, indices) = (layouts[j].primitive, encoded.columns.len() - 1);
                encoded.primitives.push(EncodedPrimitive { primitive, attributes, targets, indices });
            }
            order.iter().for_each(|&v| number[v as usize] = u32::MAX);
        }
        encoded.primitives.sort_by_key(|p| p.primitive);
        Ok(encoded)
    }

    /// Adds the columns of a primitive's vertices; returns them by semantic.
    fn vertices(&mut self, mesh: &Mesh, layout: &Layout, order: &[u32]) -> Semantics {
        let mut add = |list: &[(String, Source)]| -> Vec<(String, usize)> {
            let columns = list.iter().filter_map(|(semantic, source)| {
                self.columns.push(Column::vertices(mesh, source, order)?);
                Some((semantic.clone(), self.columns.len() - 1))
            });
            columns.collect()
        };
        (add(&layout.attributes), layout.targets.iter().map(|target| add(target)).collect())
    }
}

/// Columns of attributes, and of each target.
type Semantics = (Vec<(String, usize)>, Vec<Vec<(String, usize)>>);
