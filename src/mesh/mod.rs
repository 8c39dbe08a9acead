//! What comes in: positions, triangles, attribute streams, and what can be known about them.
//!
//! | file | idea |
//! |---|---|
//! | `mod.rs` | [`Mesh`], validated once and infallible afterwards |
//! | `attribute.rs` | [`Attribute`], a named stream of per-vertex values |
//! | `blend.rs` | what a vertex between two others carries |
//! | `creases.rs` | [`Creases`]: normals from the triangles, smooth up to an angle |
//! | `topology.rs` | [`Topology`]: which vertices share a position, and which are the same wedge |
//! | `tolerances.rs` | [`Tolerances`]: up to which differences wedges are one |
//! | `adjacency.rs` | [`Adjacency`]: the corners around every point, in flat arrays |
//! | `edges.rs` | [`Edges`]: every edge once, with the half-edges along it |
//! | `gather.rs` | a mesh of some vertices of another |
//! | `midpoints.rs` | vertices in the middle of two others, and normals from the triangles |
//! | `near.rs` | positions that nearly coincide: [`Mesh::welded`] |
//! | `report.rs` | [`Report`]: counts, borders, non-manifold parts |
//! | `vertices.rs` | a mesh from the vertex and index buffers that an engine draws |
//! | `shapes/` | [`shapes`]: procedural meshes for tests, demos and the quickstart |

mod adjacency;
mod attribute;
mod blend;
mod creases;
pub(crate) mod crossing;
mod edges;
mod gather;
mod midpoints;
mod near;
mod report;
pub mod shapes;
mod tolerances;
mod topology;
mod vertices;

pub use adjacency::Adjacency;
pub use attribute::{Attribute, AttributeValues, names};
pub use creases::{Creases, NormalWeights};
pub use edges::Edges;
pub(crate) use near::{border_twins, rounding};
pub use report::Report;
pub use tolerances::Tolerances;
pub use topology::Topology;
pub use vertices::Index;
pub(crate) use vertices::{check_folded, folded};

pub(crate) use blend::Blender;
pub(crate) use gather::Used;

use glam::Vec3A;

use crate::error::MeshError;

/// Most vertices, and most triangles, that a [`Mesh`] holds: 2^30, so that three corners a triangle and one flag
/// bit a vertex still fit 32 bits.
pub const MAX_ELEMENTS: usize = 1 << 30;

/// Stands for "none" in every index array of this crate.
pub(crate) const NONE: u32 = u32::MAX;

/// An indexed triangle mesh: positions, triangles, and optional streams of values.
///
/// Anything that passes [`Mesh::new`] is legal input everywhere in this crate: open borders, non-manifold edges and
/// vertices, clashing orientation, several components, duplicate and degenerate triangles, vertices that no triangle
/// uses, and no triangles at all.
///
/// *Topology apart from values*: triangles index vertices; vertices that share a position (bit for bit) are one
/// *point*, and those that share all attribute values too are one *wedge* ([`Topology`]).
#[derive(Debug, Clone, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "Parts", into = "Parts"))]
pub struct Mesh {
    positions: Vec<[f32; 3]>,
    triangles: Vec<[u32; 3]>,
    attributes: Vec<Attribute>,
    materials: Vec<u32>,
    material_names: Vec<String>,
    locks: Vec<bool>,
    origin: [f64; 3],
}

impl Mesh {
    /// A mesh from positions (object units) and triangles (vertex indices, counter-clockwise seen from outside), for those who
    /// have both apart. Vertices at the same position are one unless an attribute tells them apart: where a seam duplicates
    /// vertices, say so by [`Mesh::with_attribute`], or take [`Mesh::from_vertices`], which compares whole vertices.
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
    /// The first non-finite position, index out of range, or element count beyond [`MAX_ELEMENTS`]. O(n).
    pub fn new(
        positions: impl Into<Vec<[f32; 3]>>,
        triangles: impl Into<Vec<[u32; 3]>>,
    ) -> Result<Self, MeshError> {
        let (positions, triangles) = (positions.into(), triangles.into());
        for (what, count) in [("vertices", positions.len()), ("triangles", triangles.len())] {
            if count > MAX_ELEMENTS {
                return Err(MeshError::TooMany { what, count, limit: MAX_ELEMENTS });
            }
        }
        if let Some(vertex) = positions.iter().position(|p| !p.iter().all(|x| x.is_finite())) {
            return Err(MeshError::NonFinitePosition { vertex, position: positions[vertex] });
        }
        let vertices = positions.len();
        for (triangle, corners) in triangles.iter().enumerate() {
            if let Some(&index) = corners.iter().find(|&&c| c as usize >= vertices) {
                return Err(MeshError::IndexOutOfRange { triangle, index, vertices });
            }
        }
        Ok(Self { positions, triangles, ..Self::default() })
    }

    /// The same mesh with one more attribute stream.
    ///
    /// # Errors
    /// The stream's length is not `width * vertices`, its width is not 1 to 16, or its name is taken.
    pub fn with_attribute(mut self, attribute: Attribute) -> Result<Self, MeshError> {
        attribute.check(self.positions.len())?;
        if self.attribute(attribute.name()).is_some() {
            return Err(MeshError::DuplicateAttribute { name: attribute.name().to_owned() });
        }
        self.attributes.push(attribute);
        Ok(self)
    }

    /// The same mesh with a material id per triangle (an empty vector: none).
    ///
    /// # Errors
    /// As many ids as triangles are needed.
    pub fn with_materials(mut self, materials: impl Into<Vec<u32>>) -> Result<Self, MeshError> {
        let materials = materials.into();
        if !materials.is_empty() {
            check_length("materials", materials.len(), self.triangles.len())?;
        }
        self.materials = materials;
        Ok(self)
    }

    /// The same mesh with names for its material ids: id `i` is called `names[i]`.
    #[must_use]
    pub fn with_material_names(mut self, names: impl Into<Vec<String>>) -> Self {
        self.material_names = names.into();
        self
    }

    /// The same mesh with a lock per vertex (an empty vector: none). A locked vertex is never moved nor removed, nor
    /// is any vertex at its position.
    ///
    /// # Errors
    /// As many locks as vertices are needed.
    pub fn with_locks(mut self, locks: impl Into<Vec<bool>>) -> Result<Self, MeshError> {
        let locks = locks.into();
        if !locks.is_empty() {
            check_length("locks", locks.len(), self.positions.len())?;
        }
        self.locks = locks;
        Ok(self)
    }

    /// The same mesh whose positions are said to be relative to a point: `position + origin` is where a vertex lies in the
    /// world, in double precision. Default: 0. Single precision has 24 bits, so a mesh in map coordinates keeps its shape
    /// only beside an origin of its own. What is made of a mesh (levels, structures) keeps its origin; nothing but files
    /// looks at it ([`io`](crate::io), where that feature is on).
    ///
    /// # Errors
    /// An origin that is not finite.
    pub fn with_origin(mut self, origin: [f64; 3]) -> Result<Self, MeshError> {
        if !origin.iter().all(|x| x.is_finite()) {
            return Err(MeshError::NonFiniteOrigin { origin });
        }
        self.origin = origin;
        Ok(self)
    }

    /// The same places relative to another origin: to compare meshes of different origins, move one to the other's.
    ///
    /// # Errors
    /// An origin that is not finite, or one so far off that a position is not.
    pub fn moved_to(&self, origin: [f64; 3]) -> Result<Self, MeshError> {
        let mut moved = self.clone().with_origin(origin)?;
        for (vertex, position) in moved.positions.iter_mut().enumerate() {
            for axis in 0..3 {
                // The difference first: both are large, and near each other.
                position[axis] = (f64::from(position[axis]) + (self.origin[axis] - origin[axis])) as f32;
            }
            if !position.iter().all(|x| x.is_finite()) {
                return Err(MeshError::NonFinitePosition { vertex, position: *position });
            }
        }
        Ok(moved)
    }

    /// The same mesh relative to another one's origin, from which it was made.
    pub(crate) fn at_origin_of(mut self, other: &Self) -> Self {
        self.origin = other.origin;
        self
    }

    /// The same with other values of the same attributes.
    pub(crate) fn with_attributes(mut self, attributes: Vec<Attribute>) -> Self {
        debug_assert!(attributes.iter().all(|a| a.check(self.positions.len()).is_ok()));
        self.attributes = attributes;
        self
    }

    /// A mesh from parts that are known to fit together: made from another mesh's.
    pub(crate) fn from_trusted(
        positions: Vec<[f32; 3]>,
        triangles: Vec<[u32; 3]>,
        attributes: Vec<Attribute>,
        materials: Vec<u32>,
        material_names: Vec<String>,
        locks: Vec<bool>,
    ) -> Self {
        Self { positions, triangles, attributes, materials, material_names, locks, origin: [0.0; 3] }
    }

    /// What positions are relative to ([`Mesh::with_origin`]).
    pub fn origin(&self) -> [f64; 3] {
        self.origin
    }

    /// Positions in object units, one per vertex.
    pub fn positions(&self) -> &[[f32; 3]] {
        &self.positions
    }

    /// Vertex indices, one triple per triangle.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The vertex indices as one flat slice, as graphics interfaces take them.
    pub fn indices(&self) -> &[u32] {
        self.triangles.as_flattened()
    }

    /// All attribute streams, in the order they were added.
    pub fn attributes(&self) -> &[Attribute] {
        &self.attributes
    }

    /// The attribute of that name (see [`names`] for the customary ones).
    pub fn attribute(&self, name: &str) -> Option<&Attribute> {
        self.attributes.iter().find(|a| a.name() == name)
    }

    /// Material id per triangle; empty where the mesh has no materials.
    pub fn materials(&self) -> &[u32] {
        &self.materials
    }

    /// Names of the material ids; may be shorter than the ids reach, or empty.
    pub fn material_names(&self) -> &[String] {
        &self.material_names
    }

    /// Lock per vertex; empty where nothing is locked.
    pub fn locks(&self) -> &[bool] {
        &self.locks
    }

    /// Smallest and largest corner of the box around all vertices that a triangle uses; `None` without triangles.
    pub fn bounds(&self) -> Option<[[f32; 3]; 2]> {
        self.box_of(self.indices())
    }

    /// The box around some vertices, which all exist.
    pub(crate) fn box_of(&self, vertices: &[u32]) -> Option<[[f32; 3]; 2]> {
        let mut used = vertices.iter().map(|&v| Vec3A::from(self.positions[v as usize]));
        let first = used.next()?;
        let (low, high) = used.fold((first, first), |(low, high), p| (low.min(p), high.max(p)));
        Some([low.into(), high.into()])
    }

    /// Length of the diagonal of [`Mesh::bounds`] in object units; 0 without triangles. In double precision, so that
    /// boxes of any finite size have a finite diagonal.
    pub fn diagonal(&self) -> f64 {
        self.bounds().map_or(0.0, |[low, high]| {
            (0..3).map(|i| (f64::from(high[i]) - f64::from(low[i])).powi(2)).sum::<f64>().sqrt()
        })
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

/// What a mesh is made of, to let serde validate on the way in.
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
        Self { positions, triangles, attributes, materials, material_names, locks, origin }
    }
}

#[cfg(feature = "serde")]
impl TryFrom<Parts> for Mesh {
    type Error = MeshError;

    fn try_from(parts: Parts) -> Result<Self, MeshError> {
        let mut mesh = Mesh::new(parts.positions, parts.triangles)?
            .with_materials(parts.materials)?
            .with_material_names(parts.material_names)
            .with_locks(parts.locks)?
            .with_origin(parts.origin)?;
        // Names in order, so that very many of them do not cost the square of their number.
        let mut names: Vec<&str> = parts.attributes.iter().map(Attribute::name).collect();
        names.sort_unstable();
        if let Some(twice) = names.windows(2).find(|pair| pair[0] == pair[1]) {
            return Err(MeshError::DuplicateAttribute { name: twice[0].to_owned() });
        }
        parts.attributes.iter().try_for_each(|attribute| attribute.check(mesh.positions.len()))?;
        mesh.attributes = parts.attributes;
        Ok(mesh)
    }
}

fn check_length(what: &str, found: usize, expected: usize) -> Result<(), MeshError> {
    if found == expected {
        Ok(())
    } else {
        Err(MeshError::LengthMismatch { what: what.to_owned(), found, expected })
    }
}
