//! A structure with its vertices and their origins: baked, loaded, and shared by instances.

use std::sync::{Arc, OnceLock};

use crate::adapt::Blend;
use crate::error::MeshError;
use crate::mesh::Mesh;
use crate::sequence::CollapseSequence;

use super::{Extracted, FromSequence, Level, LodError, LodOptions, Origins, Structure, Values, Vertex};

/// A structure, its vertices (positions, attributes, locks, names of materials) in the structure's order, and their origins.
/// Immutable; clones share everything.
///
/// Made by [`Structure::bake`], by [`Baked::of_sequence`] and from files, which are checked ([`Baked::from_bytes`], serde).
/// Duplicates and vertices used by no triangle are left out, except in a base mesh on which wavelets were built.
///
/// ```
/// use multires::{Level, Structure, mesh::shapes, tom::TotallyOrderedMesh};
///
/// let mesh = shapes::icosphere(3);
/// let model = TotallyOrderedMesh::bake(&mesh)?;
/// let level = model.level(Level::Ratio(0.25));
/// assert!(level.mesh.triangles().len() <= mesh.triangles().len() / 4);
/// let values = model.arrange(mesh.positions())?; // an engine's values, in the order of the model
/// assert_eq!(values.len(), model.vertices().positions().len());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Baked<S: Structure> {
    structure: Arc<S>,
    shared: Arc<Shared<S>>,
}

struct Shared<S: Structure> {
    /// Empty if the structure holds its vertices itself.
    vertices: Mesh,
    origins: Origins,
    table: OnceLock<Result<S::Table, LodError>>,
}

impl<S: Structure> Clone for Baked<S> {
    fn clone(&self) -> Self {
        Self { structure: Arc::clone(&self.structure), shared: Arc::clone(&self.shared) }
    }
}

impl<S: Structure> std::fmt::Debug for Baked<S> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (vertices, triangles) = (self.structure.vertex_count(), self.structure.triangle_count());
        write!(f, "Baked({}: {vertices} vertices, {triangles} triangles)", S::KIND)
    }
}

impl<S: Structure + PartialEq> PartialEq for Baked<S> {
    fn eq(&self, other: &Self) -> bool {
        self.structure == other.structure
            && self.shared.vertices == other.shared.vertices
            && self.shared.origins == other.shared.origins
    }
}

impl<S: FromSequence> Baked<S> {
    /// Builds the structure from an existing simplification of `mesh`. O(n log n).
    ///
    /// # Errors
    /// The sequence belongs to another mesh, does not hold together, or is of a kind the structure cannot be built from.
    pub fn of_sequence(
        mesh: &Mesh,
        sequence: &CollapseSequence,
        options: &S::Options,
    ) -> Result<Self, S::Error> {
        S::bake_sequence(mesh, sequence, options, &mut |_| std::ops::ControlFlow::Continue(()))
    }
}

impl<S: Structure> Baked<S> {
    /// Makes a model of a structure and its vertices, `None` if the structure holds them itself.
    pub(crate) fn new(structure: S, vertices: Option<Mesh>, origins: Origins) -> Self {
        let vertices = vertices.unwrap_or_default();
        let shared = Shared { vertices, origins, table: OnceLock::new() };
        Self { structure: Arc::new(structure), shared: Arc::new(shared) }
    }

    /// Returns the model with other vertices, as many, in the same order.
    #[cfg(feature = "stream")]
    pub(crate) fn with_vertices(&self, vertices: Mesh) -> Self {
        let shared = Shared { vertices, origins: self.shared.origins.clone(), table: OnceLock::new() };
        Self { structure: Arc::clone(&self.structure), shared: Arc::new(shared) }
    }

    /// Returns the structure, shared with all instances.
    pub fn structure(&self) -> &Arc<S> {
        &self.structure
    }

    /// Returns the vertices in the structure's order: positions, attributes, locks, and the names of materials. Has no
    /// triangles: the structure holds them.
    pub fn vertices(&self) -> &Mesh {
        self.structure.own_vertices().unwrap_or(&self.shared.vertices)
    }

    /// Returns the origins of the vertices.
    pub fn origins(&self) -> &Origins {
        &self.shared.origins
    }

    /// Returns the smallest and largest corner of the box around the full resolution; `None` without triangles. O(n).
    pub fn bounds(&self) -> Option<[[f32; 3]; 2]> {
        self.structure.extent(self.vertices())
    }

    /// Puts values of the input's vertices, of any type, into the structure's order, to be drawn by instances. O(n).
    ///
    /// # Errors
    /// As [`Origins::arrange`]: the number of values is not the number of input vertices; the structure has vertices not in the
    /// input (call [`Baked::arrange_blended`] then); values differ at vertices that the mesh does not tell apart.
    pub fn arrange<V: Vertex>(&self, values: &[V]) -> Result<Values<V>, MeshError> {
        self.shared.origins.arrange(values).map(Values::from)
    }

    /// Puts values of the input's vertices into the structure's order, and mixes values for vertices not in the input. Calls
    /// `place` with the structure's position for every vertex that lies elsewhere than in the input: mixed vertices, and
    /// vertices moved to close a crack. Instances may mix the values too ([`Values::with_blending`]).
    ///
    /// # Errors
    /// The number of values is not the number of input vertices, or values differ at vertices that the mesh does not tell
    /// apart.
    pub fn arrange_blended<V: Vertex + Blend>(
        &self,
        values: &[V],
        place: impl FnMut(&mut V, [f32; 3]),
    ) -> Result<Values<V>, MeshError> {
        let arranged = self.shared.origins.arrange_blended(values, self.vertices().positions(), place)?;
        Ok(Values::from(arranged).with_blending())
    }

    /// Makes values from the model's own vertices: calls `value` with each index into [`Baked::vertices`]. O(n).
    pub fn values<V: Vertex>(&self, value: impl FnMut(usize) -> V) -> Values<V> {
        Values::from((0..self.structure.vertex_count()).map(value).collect::<Vec<V>>())
    }

    /// Makes a drawn instance, at the coarsest level of detail.
    ///
    /// # Errors
    /// The number of values is not the number of vertices, or they would have to be mixed and cannot be.
    pub fn instance<V: Vertex>(
        &self,
        values: impl Into<Values<V>>,
        options: &LodOptions,
    ) -> Result<S::Instance<V>, LodError> {
        let values = values.into();
        values.check(self.structure.vertex_count())?;
        S::instance(self, values, options)
    }

    /// Returns a level of detail of the whole model as a mesh: the finest within a count, or the coarsest within an error.
    /// O(n).
    pub fn level(&self, level: Level) -> Extracted {
        S::level(self, level)
    }

    /// Returns the data shared by instances besides the structure, made at the first call.
    ///
    /// # Errors
    /// The data would be too large.
    pub fn table(&self) -> Result<&S::Table, LodError> {
        self.shared.table.get_or_init(|| S::table(self)).as_ref().map_err(LodError::clone)
    }

    /// Returns the bytes of structure and vertices, without origins and instances.
    pub fn memory(&self) -> usize {
        self.vertices().memory() + self.structure.structure_memory()
    }

    /// Returns the bytes of the full resolution as a plain indexed mesh, to compare with [`Baked::memory`].
    pub fn plain_memory(&self) -> usize {
        let vertices = self.vertices();
        let attributes: usize = vertices.attributes().iter().map(|a| size_of::<f32>() * a.width()).sum();
        let lock = usize::from(!vertices.locks().is_empty());
        let material = if self.structure.materials().is_empty() { 0 } else { size_of::<u32>() };
        (size_of::<[f32; 3]>() + attributes + lock) * self.structure.finest_vertex_count()
            + (size_of::<[u32; 3]>() + material) * self.structure.triangle_count()
    }
}

/// The fields written, in this order.
#[cfg(feature = "serde")]
#[derive(serde::Serialize)]
struct Written<'a, S> {
    vertices: &'a Mesh,
    structure: &'a S,
    origins: &'a Origins,
}

#[cfg(feature = "serde")]
impl<S: Structure + serde::Serialize> serde::Serialize for Baked<S> {
    fn serialize<Z: serde::Serializer>(&self, serializer: Z) -> Result<Z::Ok, Z::Error> {
        let Shared { vertices, origins, .. } = &*self.shared;
        Written { vertices, structure: &*self.structure, origins }.serialize(serializer)
    }
}

/// The fields of a file, each valid by itself.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
struct Read<S> {
    vertices: Mesh,
    structure: S,
    origins: Origins,
}

#[cfg(feature = "serde")]
impl<'de, S: Structure + serde::Deserialize<'de>> serde::Deserialize<'de> for Baked<S> {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        use serde::de::Error;
        let Read { vertices, structure, origins } = Read::<S>::deserialize(deserializer)?;
        Self::checked(structure, Some(vertices), origins).map_err(D::Error::custom)
    }
}

#[cfg(feature = "serde")]
impl<S: Structure> Baked<S> {
    /// Makes a model of the parts of a file, each valid by itself, if there are as many vertices and origins as needed.
    pub(super) fn checked(structure: S, vertices: Option<Mesh>, origins: Origins) -> Result<Self, String> {
        if let Some(vertices) = &vertices {
            structure.check_vertices(vertices).map_err(|error| error.to_string())?;
        }
        let (found, expected) = (origins.len(), structure.vertex_count());
        if found != expected {
            return Err(format!("there are {found} origins where {expected} are needed"));
        }
        Ok(Self::new(structure, vertices, origins))
    }
}
