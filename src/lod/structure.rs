//! The interface of a structure for baking, loading and drawing. A new structure is a module and an `impl`.

use std::ops::ControlFlow;

use crate::mesh::Mesh;
use crate::sequence::CollapseSequence;
use crate::simplify::{OptionError, Simplifier};

use super::{Baked, Extracted, Level, Lod, LodError, LodOptions, Values, Vertex};

/// A callback on progress: gets the share of a build done, 0 to 1, and returns whether to go on.
pub type Progress<'a> = &'a mut dyn FnMut(f32) -> ControlFlow<()>;

/// When a vertex comes into use as detail grows.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct VertexRank {
    /// Rank from 0, in the coarsest mesh, to 1, among the last vertices.
    pub share: f32,
    /// Bound for the error of the surface without the vertex, object units; infinite for vertices of the coarsest mesh.
    pub error: f32,
}

impl VertexRank {
    pub(crate) const COARSEST: Self = Self { share: 0.0, error: f32::INFINITY };

    pub(crate) fn new(share: f32, error: f32) -> Self {
        Self { share, error }
    }

    /// Returns the share of place `at` in an order of `count` places, doubling from level to level: a ratio of logarithms.
    pub(crate) fn share_of(at: usize, count: usize) -> f32 {
        ((1.0 + at as f32).log2() / (1.0 + count as f32).log2()).clamp(0.0, 1.0)
    }
}

/// A multiresolution structure: topology alone, or with the vertices of its bounds. Immutable, shared by instances.
///
/// ```
/// use multires::mesh::{Mesh, shapes};
/// use multires::{Level, Structure, hierarchy::VertexHierarchy, tom::TotallyOrderedMesh};
///
/// fn halved<S: Structure>(mesh: &Mesh) -> Option<usize> {
///     Some(S::bake(mesh).ok()?.level(Level::Ratio(0.5)).mesh.triangles().len())
/// }
///
/// let mesh = shapes::icosphere(3);
/// for triangles in [halved::<TotallyOrderedMesh>(&mesh), halved::<VertexHierarchy>(&mesh)] {
///     assert!(triangles.is_some_and(|triangles| triangles <= 640));
/// }
/// ```
pub trait Structure: Sized + Send + Sync + 'static {
    /// Name of the structure's kind, as in baked files: at most 16 printable ASCII characters.
    const KIND: &'static str;

    /// Set if instances have a choice of triangulations ([`LodOptions::triangulation`]).
    const TRIANGULATIONS: bool = false;

    /// Options of building the structure.
    type Options: Default;
    /// Why the structure cannot be built.
    type Error: std::error::Error + Send + Sync + 'static;
    /// Data shared by instances besides the structure, made with the first instance.
    type Table: Send + Sync;
    /// A drawn instance with vertices of type `V`.
    type Instance<V: Vertex>: Lod + 'static;

    /// Builds the structure from a mesh, with its vertices and their origins.
    ///
    /// # Errors
    /// The structure cannot be built from this mesh, or `progress` breaks.
    fn build_baked(
        mesh: &Mesh,
        options: &Self::Options,
        progress: Progress<'_>,
    ) -> Result<Baked<Self>, Self::Error>;

    /// Makes the data shared by instances.
    ///
    /// # Errors
    /// The data would be too large.
    fn table(model: &Baked<Self>) -> Result<Self::Table, LodError>;

    /// Makes a drawn instance, at the coarsest level of detail.
    ///
    /// # Errors
    /// The number of values is not the number of vertices, or they would have to be mixed and cannot be.
    fn instance<V: Vertex>(
        model: &Baked<Self>,
        values: Values<V>,
        options: &LodOptions,
    ) -> Result<Self::Instance<V>, LodError>;

    /// Returns a level of detail of the whole model. O(n).
    fn level(model: &Baked<Self>, level: Level) -> Extracted;

    /// Returns the number of vertices, each of which an instance may draw.
    fn vertex_count(&self) -> usize;

    /// Returns the number of vertices of the full resolution.
    fn finest_vertex_count(&self) -> usize;

    /// Returns the number of triangles of the full resolution.
    fn triangle_count(&self) -> usize;

    /// Returns the number of triangles of the coarsest level of detail.
    fn base_triangle_count(&self) -> usize;

    /// Returns the material ids in use, ascending. Triangles are drawn in a group for each id. Empty if the mesh has none.
    fn materials(&self) -> &[u32];

    /// Returns the smallest and largest corner of the box around the full resolution; `None` without triangles. `vertices`
    /// are the model's. O(n).
    fn extent(&self, vertices: &Mesh) -> Option<[[f32; 3]; 2]>;

    /// Returns when every vertex comes into use, and the error of leaving it out: to colour or to send by. O(n).
    fn vertex_ranks(&self) -> Vec<VertexRank>;

    /// Returns the target of each vertex in a vertex shader ([`Lod::morph`]); empty if the structure has none.
    fn morph_targets(&self) -> &[u32] {
        &[]
    }

    /// Returns the vertices held by the structure itself; `None` if they lie beside it.
    fn own_vertices(&self) -> Option<&Mesh> {
        None
    }

    /// Checks the vertices lying beside the structure in a file.
    ///
    /// # Errors
    /// The vertices do not fit the structure.
    fn check_vertices(&self, vertices: &Mesh) -> Result<(), Self::Error>;

    /// Returns the bytes of its arrays, without vertices it holds.
    fn structure_memory(&self) -> usize;

    /// Builds the structure from a mesh with default options: [`Structure::build_baked`] in short.
    ///
    /// # Errors
    /// The structure cannot be built from this mesh.
    fn bake(mesh: &Mesh) -> Result<Baked<Self>, Self::Error> {
        Self::bake_with(mesh, &Self::Options::default(), |_| ControlFlow::Continue(()))
    }

    /// Builds the structure from a mesh with options. Calls `progress` with the share done, 0 to 1; it may break.
    ///
    /// # Errors
    /// The structure cannot be built from this mesh, or `progress` breaks.
    fn bake_with(
        mesh: &Mesh,
        options: &Self::Options,
        mut progress: impl FnMut(f32) -> ControlFlow<()>,
    ) -> Result<Baked<Self>, Self::Error> {
        Self::build_baked(mesh, options, &mut progress)
    }
}

/// A structure built from a collapse sequence.
pub trait FromSequence: Structure<Error: From<OptionError>> {
    /// Returns the simplifier suited to the structure, used by [`Structure::bake`] and [`Builder`](super::Builder).
    fn simplifier() -> Simplifier {
        Simplifier::new()
    }

    /// Builds the structure from a mesh and its simplification, with its vertices and their origins.
    ///
    /// # Errors
    /// The sequence belongs to another mesh, does not hold together, or is of a kind the structure cannot be built from; or
    /// `progress` breaks.
    fn bake_sequence(
        mesh: &Mesh,
        sequence: &CollapseSequence,
        options: &Self::Options,
        progress: Progress<'_>,
    ) -> Result<Baked<Self>, Self::Error>;
}
