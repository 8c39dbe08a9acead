//! A named stream of per-vertex values: normals, texture coordinates, colours, joints, whatever a file holds.

use std::sync::OnceLock;

use crate::error::MeshError;
use crate::geometry::array::Array;

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
    /// Offsets from the positions to those of a morph target or a pose, 3 floats, object units. Further targets are
    /// `displacement1` and so on. In the costs of collapses each counts as much as the positions.
    pub const DISPLACEMENT: &str = "displacement";

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
#[derive(Clone)]
pub struct Attribute {
    name: String,
    pub(super) width: usize,
    /// The scalars, unless `stored` holds them.
    values: AttributeValues,
    stored: Option<Stored>,
}

/// The type of an attribute's scalars.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Scalar {
    Float,
    Int,
    Uint,
}

/// Scalars within a file, as words.
#[derive(Clone)]
struct Stored {
    scalar: Scalar,
    words: Array<u32>,
    /// A copy, made when first asked for.
    values: OnceLock<AttributeValues>,
}

impl Stored {
    fn copied(&self) -> AttributeValues {
        match self.scalar {
            Scalar::Float => AttributeValues::Float(bytemuck::cast_slice(&self.words).to_vec()),
            Scalar::Int => AttributeValues::Int(bytemuck::cast_slice(&self.words).to_vec()),
            Scalar::Uint => AttributeValues::Uint(self.words.to_vec()),
        }
    }
}

impl Attribute {
    /// Builds an attribute of `width` scalars per vertex. [`Mesh::with_attribute`](super::Mesh::with_attribute) checks
    /// width and length.
    pub fn new(name: impl Into<String>, width: usize, values: AttributeValues) -> Self {
        Self { name: name.into(), width, values, stored: None }
    }

    /// Builds an attribute whose scalars lie within a file.
    #[cfg(feature = "io")]
    pub(crate) fn stored(name: String, width: usize, scalar: Scalar, words: Array<u32>) -> Self {
        let stored = Some(Stored { scalar, words, values: OnceLock::new() });
        Self { name, width, values: AttributeValues::Uint(Vec::new()), stored }
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

    /// The scalars, `width` per vertex. If they lie within a baked file, the first call copies them: O(n).
    /// [`Attribute::as_floats`] does not.
    pub fn values(&self) -> &AttributeValues {
        match &self.stored {
            Some(stored) => stored.values.get_or_init(|| stored.copied()),
            None => &self.values,
        }
    }

    /// Returns the scalars for writing.
    pub(super) fn values_mut(&mut self) -> &mut AttributeValues {
        if let Some(stored) = self.stored.take() {
            self.values = stored.copied();
        }
        &mut self.values
    }

    /// Returns the type of the scalars.
    pub(crate) fn scalar(&self) -> Scalar {
        match (&self.stored, &self.values) {
            (Some(stored), _) => stored.scalar,
            (None, AttributeValues::Float(_)) => Scalar::Float,
            (None, AttributeValues::Int(_)) => Scalar::Int,
            (None, AttributeValues::Uint(_)) => Scalar::Uint,
        }
    }

    /// Returns the scalars if they are floats.
    pub fn as_floats(&self) -> Option<&[f32]> {
        (self.scalar() == Scalar::Float).then(|| bytemuck::cast_slice(self.all_words()))
    }

    /// Returns the scalars for writing if they are floats.
    pub(crate) fn floats_mut(&mut self) -> Option<&mut [f32]> {
        match self.values_mut() {
            AttributeValues::Float(values) => Some(values),
            _ => None,
        }
    }

    /// Number of scalars.
    pub(super) fn len(&self) -> usize {
        self.all_words().len()
    }

    /// Bytes held by the scalars.
    pub fn memory(&self) -> usize {
        4 * self.len()
    }

    /// The raw words of all vertices.
    pub(crate) fn all_words(&self) -> &[u32] {
        match &self.stored {
            Some(stored) => &stored.words,
            None => self.values.words(),
        }
    }

    /// The raw words of one vertex.
    pub(crate) fn words(&self, vertex: u32) -> &[u32] {
        let start = vertex as usize * self.width;
        &self.all_words()[start..start + self.width]
    }

    /// Copies the values of the vertices in `order`, which must all exist. O(output).
    pub(crate) fn gather(&self, order: &[u32]) -> Self {
        fn rows<T: bytemuck::Pod>(words: &[u32], width: usize, order: &[u32]) -> Vec<T> {
            let values: &[T] = bytemuck::cast_slice(words);
            order.iter().flat_map(|&v| &values[v as usize * width..][..width]).copied().collect()
        }
        let words = self.all_words();
        let values = match self.scalar() {
            Scalar::Float => AttributeValues::Float(rows(words, self.width, order)),
            Scalar::Int => AttributeValues::Int(rows(words, self.width, order)),
            Scalar::Uint => AttributeValues::Uint(rows(words, self.width, order)),
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
        let more = vertices * self.width;
        match self.values_mut() {
            AttributeValues::Float(v) => v.reserve_exact(more),
            AttributeValues::Int(v) => v.reserve_exact(more),
            AttributeValues::Uint(v) => v.reserve_exact(more),
        }
    }

    /// Appends a vertex of zeros.
    pub(super) fn push_row(&mut self) {
        let length = self.len() + self.width;
        match self.values_mut() {
            AttributeValues::Float(v) => v.resize(length, 0.0),
            AttributeValues::Int(v) => v.resize(length, 0),
            AttributeValues::Uint(v) => v.resize(length, 0),
        }
    }

    /// Copies the values of vertex `from` to vertex `to`.
    pub(super) fn copy_row(&mut self, from: u32, to: u32) {
        let [from, to] = [from, to].map(|v| v as usize * self.width);
        let row = from..from + self.width;
        match self.values_mut() {
            AttributeValues::Float(v) => v.copy_within(row, to),
            AttributeValues::Int(v) => v.copy_within(row, to),
            AttributeValues::Uint(v) => v.copy_within(row, to),
        }
    }

    /// Returns a scalar of any type as `f64`.
    pub(super) fn scalar_at(&self, at: usize) -> f64 {
        let word = self.all_words()[at];
        match self.scalar() {
            Scalar::Float => f64::from(f32::from_bits(word)),
            Scalar::Int => f64::from(word as i32),
            Scalar::Uint => f64::from(word),
        }
    }

    /// Stores a scalar in the attribute's type; integers are rounded.
    pub(super) fn set_scalar(&mut self, at: usize, scalar: f64) {
        match self.values_mut() {
            AttributeValues::Float(v) => v[at] = scalar as f32,
            AttributeValues::Int(v) => v[at] = scalar.round() as i32,
            AttributeValues::Uint(v) => v[at] = scalar.round() as u32,
        }
    }

    pub(super) fn check(&self, vertices: usize) -> Result<(), MeshError> {
        if !(1..=16).contains(&self.width) {
            return Err(MeshError::AttributeWidth { name: self.name.clone(), width: self.width });
        }
        super::triangle_mesh::check_length(&self.name, self.len(), vertices * self.width)
    }
}

impl std::fmt::Debug for Attribute {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { name, width, .. } = self;
        f.debug_struct("Attribute")
            .field("name", name)
            .field("width", width)
            .field("values", self.values())
            .finish()
    }
}

impl PartialEq for Attribute {
    fn eq(&self, other: &Self) -> bool {
        let [a, b] = [self, other].map(|attribute| (&attribute.name, attribute.width, attribute.scalar()));
        let equal = || match (self.as_floats(), other.as_floats()) {
            (Some(a), Some(b)) => a == b,
            _ => self.all_words() == other.all_words(),
        };
        a == b && equal()
    }
}

/// The fields of an [`Attribute`], as serde knows them.
#[cfg(feature = "serde")]
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(rename = "Attribute")]
struct Parts<V> {
    name: String,
    width: usize,
    values: V,
}

#[cfg(feature = "serde")]
impl serde::Serialize for Attribute {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        Parts { name: self.name.clone(), width: self.width, values: self.values() }.serialize(serializer)
    }
}

#[cfg(feature = "serde")]
impl<'de> serde::Deserialize<'de> for Attribute {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let Parts { name, width, values } = Parts::<AttributeValues>::deserialize(deserializer)?;
        Ok(Self::new(name, width, values))
    }
}
