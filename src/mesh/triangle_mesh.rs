//! [`Mesh`]: validated once, and infallible afterwards.

use glam::Vec3A;

use crate::error::MeshError;
use crate::geometry::array::Array;
use crate::geometry::boxes;

use super::Attribute;

/// Maximum number of vertices, and of triangles, of a [`Mesh`]: 2^30. The number of a corner (3 per triangle), and a
/// vertex index with a flag bit, then fit 32 bits.
pub const MAX_ELEMENTS: usize = 1 << 30;

/// An indexed triangle mesh: positions, triangles, and optional attribute streams, materials and locks.
///
/// Every mesh accepted by [`Mesh::new`] is legal input everywhere in this crate: open borders, non-manifold edges and
/// vertices, clashing orientation, several components, duplicate and degenerate triangles, unused vertices, no
/// triangles at all.
///
/// *Topology apart from values*: triangles index vertices. Vertices at equal positions (-0 equals 0) form a *point*.
/// Vertices of a point with equal attribute values (bit for bit) form a *wedge* ([`Topology`](super::Topology)).
///
/// ```
/// use multires::mesh::{Attribute, Mesh, names};
///
/// let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
/// let mesh = Mesh::new(corners, [[0, 1, 2], [0, 2, 3]])?;
/// let mesh = mesh.with_attribute(Attribute::floats(names::UV, &corners.map(|[x, y, _]| [x, y])))?;
/// assert_eq!(mesh.triangles().len(), 2);
/// assert!(mesh.attribute(names::UV).is_some());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "Parts", into = "Parts"))]
pub struct Mesh {
    pub(super) positions: Array<[f32; 3]>,
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) attributes: Vec<Attribute>,
    pub(super) materials: Vec<u32>,
    pub(super) material_names: Vec<String>,
    pub(super) locks: Vec<bool>,
    pub(super) origin: [f64; 3],
}

impl Mesh {
    /// Builds a mesh from positions (object units) and triangles (vertex indices, counter-clockwise seen from outside).
    /// O(n).
    ///
    /// Vertices at equal positions are a single wedge unless an attribute differs. Where a seam duplicates vertices,
    /// add the differing attribute with [`Mesh::with_attribute`], or use [`Mesh::from_vertices`], which compares whole
    /// vertices.
    ///
    /// ```
    /// use multires::Mesh;
    /// let positions = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    /// let mesh = Mesh::new(positions, [[0, 1, 2]])?;
    /// assert_eq!(mesh.indices(), [0, 1, 2]);
    /// # Ok::<(), multires::MeshError>(())
    /// ```
    ///
    /// # Errors
    /// Reports the first non-finite position, the first index out of range, or an element count beyond
    /// [`MAX_ELEMENTS`].
    pub fn new(
        positions: impl Into<Vec<[f32; 3]>>,
        triangles: impl Into<Vec<[u32; 3]>>,
    ) -> Result<Self, MeshError> {
        let (positions, triangles) = (positions.into(), triangles.into());
        check_positions(&positions)?;
        if triangles.len() > MAX_ELEMENTS {
            let (what, count, limit) = ("triangles", triangles.len(), MAX_ELEMENTS);
            return Err(MeshError::TooMany { what, count, limit });
        }
        let vertices = positions.len();
        for (triangle, corners) in triangles.iter().enumerate() {
            if let Some(&index) = corners.iter().find(|&&c| c as usize >= vertices) {
                return Err(MeshError::IndexOutOfRange { triangle, index, vertices });
            }
        }
        Ok(Self { positions: positions.into(), triangles, ..Self::default() })
    }

    /// Adds an attribute stream.
    ///
    /// # Errors
    /// Fails if the stream's length is not `width * vertices`, its width is not 1 to 16, or its name is taken.
    pub fn with_attribute(mut self, attribute: Attribute) -> Result<Self, MeshError> {
        attribute.check(self.positions.len())?;
        if self.attribute(attribute.name()).is_some() {
            return Err(MeshError::DuplicateAttribute { name: attribute.name().to_owned() });
        }
        self.attributes.push(attribute);
        Ok(self)
    }

    /// Sets all attribute streams.
    ///
    /// # Errors
    /// As [`Mesh::with_attribute`].
    #[cfg(feature = "serde")]
    pub(super) fn with_streams(mut self, attributes: Vec<Attribute>) -> Result<Self, MeshError> {
        // Sorted names: a great many attributes must not cost quadratic time.
        let mut names: Vec<&str> = attributes.iter().map(Attribute::name).collect();
        names.sort_unstable();
        if let Some(twice) = names.windows(2).find(|pair| pair[0] == pair[1]) {
            return Err(MeshError::DuplicateAttribute { name: twice[0].to_owned() });
        }
        attributes.iter().try_for_each(|attribute| attribute.check(self.positions.len()))?;
        self.attributes = attributes;
        Ok(self)
    }

    /// Sets a material id per triangle. An empty vector removes all ids.
    ///
    /// # Errors
    /// Fails if the number of ids is neither 0 nor the number of triangles.
    pub fn with_materials(mut self, materials: impl Into<Vec<u32>>) -> Result<Self, MeshError> {
        let materials = materials.into();
        if !materials.is_empty() {
            check_length("materials", materials.len(), self.triangles.len())?;
        }
        self.materials = materials;
        Ok(self)
    }

    /// Sets the names of material ids: id `i` is called `names[i]`.
    #[must_use]
    pub fn with_material_names(mut self, names: impl Into<Vec<String>>) -> Self {
        self.material_names = names.into();
        self
    }

    /// Sets a lock per vertex. An empty vector removes all locks. A locked vertex, and every vertex at its position, is
    /// never moved nor removed.
    ///
    /// # Errors
    /// Fails if the number of locks is neither 0 nor the number of vertices.
    pub fn with_locks(mut self, locks: impl Into<Vec<bool>>) -> Result<Self, MeshError> {
        let locks = locks.into();
        if !locks.is_empty() {
            check_length("locks", locks.len(), self.positions.len())?;
        }
        self.locks = locks;
        Ok(self)
    }

    /// Sets the origin of the positions, default 0. A vertex lies at `position + origin` in the world, in double
    /// precision.
    ///
    /// Single precision has 24 bits: a mesh in map coordinates keeps its shape only relative to an origin nearby.
    /// Everything derived from a mesh (levels, structures) keeps the origin. Only files use it ([`io`](crate::io), if
    /// the feature is on).
    ///
    /// # Errors
    /// Fails if the origin is not finite.
    pub fn with_origin(mut self, origin: [f64; 3]) -> Result<Self, MeshError> {
        if !origin.iter().all(|x| x.is_finite()) {
            return Err(MeshError::NonFiniteOrigin { origin });
        }
        self.origin = origin;
        Ok(self)
    }

    /// Moves the positions to another origin; vertices keep their places in the world, up to rounding. To compare
    /// meshes of different origins, move both to the same origin.
    ///
    /// # Errors
    /// Fails if the origin is not finite, or lies so far off that a position is not finite.
    pub fn moved_to(&self, origin: [f64; 3]) -> Result<Self, MeshError> {
        let mut moved = self.clone().with_origin(origin)?;
        // Subtract the origins first: both are large, and near each other.
        let by: [f64; 3] = std::array::from_fn(|axis| self.origin[axis] - origin[axis]);
        let place = |p: &[f32; 3]| std::array::from_fn(|axis| (f64::from(p[axis]) + by[axis]) as f32);
        moved.positions = self.positions.iter().map(place).collect();
        match moved.positions.iter().position(|p| !p.iter().all(|x| x.is_finite())) {
            Some(vertex) => Err(MeshError::NonFinitePosition { vertex, position: moved.positions[vertex] }),
            None => Ok(moved),
        }
    }

    /// Takes the origin of `other`, from which this mesh was made.
    pub(crate) fn at_origin_of(mut self, other: &Self) -> Self {
        self.origin = other.origin;
        self
    }

    /// Replaces the values of the attributes: the streams are new, their names stay.
    pub(crate) fn with_attributes(mut self, attributes: Vec<Attribute>) -> Self {
        debug_assert!(attributes.iter().all(|a| a.check(self.positions.len()).is_ok()));
        self.attributes = attributes;
        self
    }

    /// Builds a mesh from parts known to fit together, since they come from another mesh. Origin 0.
    pub(crate) fn from_trusted(
        positions: Vec<[f32; 3]>,
        triangles: Vec<[u32; 3]>,
        attributes: Vec<Attribute>,
        materials: Vec<u32>,
        material_names: Vec<String>,
        locks: Vec<bool>,
    ) -> Self {
        let positions = positions.into();
        Self { positions, triangles, attributes, materials, material_names, locks, origin: [0.0; 3] }
    }

    /// Returns the origin of the positions ([`Mesh::with_origin`]).
    pub fn origin(&self) -> [f64; 3] {
        self.origin
    }

    /// Positions by vertex, object units.
    pub fn positions(&self) -> &[[f32; 3]] {
        &self.positions
    }

    /// Triangles: three vertex indices each.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Vertex indices as a flat slice, as graphics interfaces take them.
    pub fn indices(&self) -> &[u32] {
        self.triangles.as_flattened()
    }

    /// All attribute streams, in the order they were added.
    pub fn attributes(&self) -> &[Attribute] {
        &self.attributes
    }

    /// Finds an attribute by name ([`names`](super::names) lists customary names).
    pub fn attribute(&self, name: &str) -> Option<&Attribute> {
        self.attributes.iter().find(|a| a.name() == name)
    }

    /// Material id per triangle; empty if the mesh has no materials.
    pub fn materials(&self) -> &[u32] {
        &self.materials
    }

    /// Names of the material ids; may be shorter than the ids reach, or empty.
    pub fn material_names(&self) -> &[String] {
        &self.material_names
    }

    /// Lock per vertex; empty if nothing is locked.
    pub fn locks(&self) -> &[bool] {
        &self.locks
    }

    /// Returns `[low, high]`, the bounding box of all vertices used by triangles; `None` without triangles.
    pub fn bounds(&self) -> Option<[[f32; 3]; 2]> {
        self.box_of(self.indices())
    }

    /// Returns the bounding box of `vertices`, which must all exist; `None` if there are none.
    pub(crate) fn box_of(&self, vertices: &[u32]) -> Option<[[f32; 3]; 2]> {
        let used = vertices.iter().map(|&v| Vec3A::from(self.positions[v as usize]));
        boxes::around_any(used).map(|corners| corners.map(Into::into))
    }

    /// Length of the diagonal of [`Mesh::bounds`] in object units; 0 without triangles. Double precision: finite for
    /// every finite box.
    pub fn diagonal(&self) -> f64 {
        self.bounds().map_or(0.0, boxes::diagonal)
    }

    /// Bytes held by this mesh's arrays: positions, triangles, attributes, materials and locks.
    pub fn memory(&self) -> usize {
        size_of_val(&self.positions[..])
            + size_of_val(&self.triangles[..])
            + size_of_val(&self.materials[..])
            + size_of_val(&self.locks[..])
            + self.attributes.iter().map(Attribute::memory).sum::<usize>()
    }
}

/// The fields of a [`Mesh`], so that serde validates on the way in.
#[cfg(feature = "serde")]
#[derive(serde::Serialize, serde::Deserialize)]
struct Parts {
    positions: Vec<[f32; 3]>,
    triangles: Vec<[u32; 3]>,
    attributes: Vec<Attribute>,
    materials: Vec<u32>,
    material_names: Vec<String>,
    locks: Vec<bool>,
    #[serde(default)]
    origin: [f64; 3],
}

#[cfg(feature = "serde")]
impl From<Mesh> for Parts {
    fn from(mesh: Mesh) -> Self {
        let Mesh { positions, triangles, attributes, materials, material_names, locks, origin } = mesh;
        let positions = positions.into_vec();
        Self { positions, triangles, attributes, materials, material_names, locks, origin }
    }
}

#[cfg(feature = "serde")]
impl TryFrom<Parts> for Mesh {
    type Error = MeshError;

    fn try_from(parts: Parts) -> Result<Self, MeshError> {
        Mesh::new(parts.positions, parts.triangles)?
            .with_materials(parts.materials)?
            .with_material_names(parts.material_names)
            .with_locks(parts.locks)?
            .with_origin(parts.origin)?
            .with_streams(parts.attributes)
    }
}

/// Checks that there are not too many positions, and that all are finite.
pub(super) fn check_positions(positions: &[[f32; 3]]) -> Result<(), MeshError> {
    if positions.len() > MAX_ELEMENTS {
        let (what, count, limit) = ("vertices", positions.len(), MAX_ELEMENTS);
        return Err(MeshError::TooMany { what, count, limit });
    }
    match positions.iter().position(|p| !p.iter().all(|x| x.is_finite())) {
        Some(vertex) => Err(MeshError::NonFinitePosition { vertex, position: positions[vertex] }),
        None => Ok(()),
    }
}

pub(super) fn check_length(what: &str, found: usize, expected: usize) -> Result<(), MeshError> {
    if found == expected {
        Ok(())
    } else {
        Err(MeshError::LengthMismatch { what: what.to_owned(), found, expected })
    }
}
