//! A named stream of per-vertex values: normals, texture coordinates, colours, joints, whatever a file holds.

use crate::error::MeshError;

/// Customary attribute names. Attributes of any other name are carried along too.
pub mod names {
    /// Unit normals, 3 floats.
    pub const NORMAL: &str = "normal";
    /// First set of texture coordinates, 2 floats. Further sets are `uv1`, `uv2` and so on.
    pub const UV: &str = "uv";
    /// Colours, 3 or 4 floats, 0 to 1. Further sets are `color1` and so on.
    pub const COLOR: &str = "color";
    /// Tangents, 4 floats: direction and handedness.
    pub const TANGENT: &str = "tangent";
    /// Skin joints, 4 unsigned integers. Further sets are `joints1` and so on.
    pub const JOINTS: &str = "joints";
    /// Skin weights, 4 floats. Further sets are `weights1` and so on.
    pub const WEIGHTS: &str = "weights";

    /// The lowest vertex equal to each vertex, 1 unsigned integer.
    /// [`Mesh::from_vertices`](crate::mesh::Mesh::from_vertices) adds it to tell vertices at equal positions apart. In
    /// levels the numbers are still the numbers of the input's vertices. Files leave it out.
    pub const VERTEX: &str = "vertex";

    /// Whether `name` is `first`, or `first` followed by digits: `uv`, `uv1`, `uv2` and so on.
    pub fn is_set_of(name: &str, first: &str) -> bool {
        name.strip_prefix(first).is_some_and(|number| number.bytes().all(|c| c.is_ascii_digit()))
    }
}

/// The scalars of an attribute: `width` per vertex, vertex by vertex.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum AttributeValues {
    /// Values that may be blended (normals, coordinates, colours).
    Float(Vec<f32>),
    /// Signed labels that may only be copied.
    Int(Vec<i32>),
    /// Unsigned labels that may only be copied (joints, ids).
    Uint(Vec<u32>),
}

impl AttributeValues {
    /// Number of scalars.
    pub fn len(&self) -> usize {
        match self {
            Self::Float(v) => v.len(),
            Self::Int(v) => v.len(),
            Self::Uint(v) => v.len(),
        }
    }

    /// Whether there are no scalars.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The raw 32-bit words, for bit-for-bit comparison.
    pub(crate) fn words(&self) -> &[u32] {
        match self {
            Self::Float(v) => bytemuck::cast_slice(v),
            Self::Int(v) => bytemuck::cast_slice(v),
            Self::Uint(v) => v,
        }
    }
}

/// A named stream of values, `width` scalars per vertex.
///
/// ```
/// use multires::mesh::{Attribute, shapes};
///
/// let mesh = shapes::icosphere(1);
/// let heat: Vec<[f32; 1]> = mesh.positions().iter().map(|p| [p[1]]).collect();
/// let mesh = mesh.with_attribute(Attribute::floats("heat", &heat))?;
/// let heat = mesh.attribute("heat").and_then(|heat| heat.as_floats());
/// assert_eq!(heat.map(<[f32]>::len), Some(mesh.positions().len()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Attribute {
    name: String,
    pub(super) width: usize,
    pub(super) values: AttributeValues,
}

impl Attribute {
    /// Builds an attribute of `width` scalars per vertex. [`Mesh::with_attribute`](super::Mesh::with_attribute) checks
    /// width and length.
    pub fn new(name: impl Into<String>, width: usize, values: AttributeValues) -> Self {
        Self { name: name.into(), width, values }
    }

    /// Builds a float attribute from an array of `WIDTH` floats per vertex.
    pub fn floats<const WIDTH: usize>(name: impl Into<String>, values: &[[f32; WIDTH]]) -> Self {
        Self::new(name, WIDTH, AttributeValues::Float(values.as_flattened().to_vec()))
    }

    /// Builds a float attribute of `WIDTH` floats per vertex from vertices of any type.
    ///
    /// ```
    /// use multires::mesh::{Attribute, names};
    /// let vertices = [([0.0, 0.0, 0.0], [0.0, 1.0]), ([1.0, 0.0, 0.0], [1.0, 1.0])];
    /// let uv = Attribute::of(names::UV, &vertices, |(_, uv)| *uv);
    /// assert_eq!(uv.as_floats(), Some([0.0, 1.0, 1.0, 1.0].as_slice()));
    /// ```
    pub fn of<V, const WIDTH: usize>(
        name: impl Into<String>,
        vertices: &[V],
        value: impl Fn(&V) -> [f32; WIDTH],
    ) -> Self {
        Self::new(name, WIDTH, AttributeValues::Float(vertices.iter().flat_map(value).collect()))
    }

    /// The name, unique in its mesh.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Scalars per vertex, 1 to 16.
    pub fn width(&self) -> usize {
        self.width
    }

    /// The scalars, `width` per vertex.
    pub fn values(&self) -> &AttributeValues {
        &self.values
    }

    /// Returns the scalars if they are floats.
    pub fn as_floats(&self) -> Option<&[f32]> {
        match &self.values {
            AttributeValues::Float(values) => Some(values),
            _ => None,
        }
    }

    /// Returns the scalars for writing if they are floats.
    pub(crate) fn floats_mut(&mut self) -> Option<&mut [f32]> {
        match &mut self.values {
            AttributeValues::Float(values) => Some(values),
            _ => None,
        }
    }

    /// Bytes held by the scalars.
    pub fn memory(&self) -> usize {
        4 * self.values.len()
    }

    /// The raw words of one vertex.
    pub(crate) fn words(&self, vertex: u32) -> &[u32] {
        let start = vertex as usize * self.width;
        &self.values.words()[start..start + self.width]
    }

    /// Copies the values of the vertices in `order`, which must all exist. O(output).
    pub(crate) fn gather(&self, order: &[u32]) -> Self {
        fn rows<T: Copy>(values: &[T], width: usize, order: &[u32]) -> Vec<T> {
            order.iter().flat_map(|&v| &values[v as usize * width..][..width]).copied().collect()
        }
        let values = match &self.values {
            AttributeValues::Float(v) => AttributeValues::Float(rows(v, self.width, order)),
            AttributeValues::Int(v) => AttributeValues::Int(rows(v, self.width, order)),
            AttributeValues::Uint(v) => AttributeValues::Uint(rows(v, self.width, order)),
        };
        Self::new(self.name.clone(), self.width, values)
    }

    /// Scales a blended normal or tangent to unit length. Values of other attributes stay as they are.
    pub(crate) fn normalise_direction(&self, value: &mut [f32]) {
        if !matches!(self.name.as_str(), names::NORMAL | names::TANGENT) || self.width < 3 {
            return;
        }
        let length = value[..3].iter().map(|x| x * x).sum::<f32>().sqrt();
        if length > 1e-12 && (length - 1.0).abs() > 1e-5 {
            value[..3].iter_mut().for_each(|x| *x /= length);
        }
    }

    /// Reserves room for `vertices` more vertices.
    pub(super) fn reserve(&mut self, vertices: usize) {
        match &mut self.values {
            AttributeValues::Float(v) => v.reserve_exact(vertices * self.width),
            AttributeValues::Int(v) => v.reserve_exact(vertices * self.width),
            AttributeValues::Uint(v) => v.reserve_exact(vertices * self.width),
        }
    }

    /// Appends a vertex of zeros.
    pub(super) fn push_row(&mut self) {
        let length = self.values.len() + self.width;
        match &mut self.values {
            AttributeValues::Float(v) => v.resize(length, 0.0),
            AttributeValues::Int(v) => v.resize(length, 0),
            AttributeValues::Uint(v) => v.resize(length, 0),
        }
    }

    /// Copies the values of vertex `from` to vertex `to`.
    pub(super) fn copy_row(&mut self, from: u32, to: u32) {
        let [from, to] = [from, to].map(|v| v as usize * self.width);
        match &mut self.values {
            AttributeValues::Float(v) => v.copy_within(from..from + self.width, to),
            AttributeValues::Int(v) => v.copy_within(from..from + self.width, to),
            AttributeValues::Uint(v) => v.copy_within(from..from + self.width, to),
        }
    }

    /// Returns a scalar of any type as `f64`.
    pub(super) fn scalar(&self, at: usize) -> f64 {
        match &self.values {
            AttributeValues::Float(v) => f64::from(v[at]),
            AttributeValues::Int(v) => f64::from(v[at]),
            AttributeValues::Uint(v) => f64::from(v[at]),
        }
    }

    /// Stores a scalar in the attribute's type; integers are rounded.
    pub(super) fn set_scalar(&mut self, at: usize, scalar: f64) {
        match &mut self.values {
            AttributeValues::Float(v) => v[at] = scalar as f32,
            AttributeValues::Int(v) => v[at] = scalar.round() as i32,
            AttributeValues::Uint(v) => v[at] = scalar.round() as u32,
        }
    }

    pub(super) fn check(&self, vertices: usize) -> Result<(), MeshError> {
        if !(1..=16).contains(&self.width) {
            return Err(MeshError::AttributeWidth { name: self.name.clone(), width: self.width });
        }
        super::triangle_mesh::check_length(&self.name, self.values.len(), vertices * self.width)
    }
}
