//! What a structure is to whoever bakes, loads and draws it: a new one is a room and an `impl`.

use std::ops::ControlFlow;

use crate::mesh::Mesh;
use crate::simplify::{CollapseSequence, OptionError};

use super::{Baked, Extracted, Level, Lod, LodError, LodOptions, Values, Vertex};

/// Told how far a build is, 0 to 1; says whether to go on.
pub type Progress<'a> = &'a mut dyn FnMut(f32) -> ControlFlow<()>;

/// When a vertex comes into use as detail grows.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct VertexRank {
    /// From 0, in the coarsest mesh, to 1, among the last.
    pub share: f32,
    /// How far the surface may be off where it is left out, object units; infinite for vertices of the coarsest mesh.
    pub error: f32,
}

impl VertexRank {
    pub(crate) const COARSEST: Self = Self { share: 0.0, error: f32::INFINITY };

    pub(crate) fn new(share: f32, error: f32) -> Self {
        Self { share, error }
    }

    /// The share of something that comes at a place in an order of so many which doubles from level to level.
    pub(crate) fn share_of(at: usize, count: usize) -> f32 {
        ((1.0 + at as f32).log2() / (1.0 + count as f32).log2()).clamp(0.0, 1.0)
    }
}

/// A multiresolution structure: topology alone, or with the vertices that its bounds are of. Immutable, shared by instances.
pub trait Structure: Sized + Send + Sync + 'static {
    /// The name of its kind, as in baked files: at most 16 printable ASCII characters.
    const KIND: &'static str;

    /// Whether its instances have a choice of triangulations ([`LodOptions::triangulation`]).
    const TRIANGULATIONS: bool = false;

    /// How it is built.
    type Options: Default;
    /// Why it cannot be built.
    type Error: std::error::Error + Send + Sync + 'static;
    /// What instances share besides the structure, made when the first one is.
    type Table: Send + Sync;
    /// A drawn instance with vertices of a type.
    type Instance<V: Vertex>: Lod + 'static;

    /// Builds it from a mesh, with its vertices and where they come from.
    ///
    /// # Errors
    /// The mesh is none of those that the structure can be built from, or `progress` breaks.
    fn build_baked(
        mesh: &Mesh,
        options: &Self::Options,
        progress: Progress<'_>,
    ) -> Result<Baked<Self>, Self::Error>;

    /// The table that instances share.
    ///
    /// # Errors
    /// It would be too large.
    fn table(model: &Baked<Self>) -> Result<Self::Table, LodError>;

    /// A drawn instance, at the coarsest level of detail.
    ///
    /// # Errors
    /// There are not as many values as vertices, or they cannot be mixed and would have to be.
    fn instance<V: Vertex>(
        model: &Baked<Self>,
        values: Values<V>,
        options: &LodOptions,
    ) -> Result<Self::Instance<V>, LodError>;

    /// A level of detail of the whole model. O(n).
    fn level(model: &Baked<Self>, level: Level) -> Extracted;

    /// Vertices, each of which an instance may draw.
    fn vertex_count(&self) -> usize;

    /// Vertices of the full resolution.
    fn finest_vertex_count(&self) -> usize;

    /// Triangles of the full resolution.
    fn triangle_count(&self) -> usize;

    /// Triangles of the coarsest level of detail.
    fn base_triangle_count(&self) -> usize;

    /// The material ids in use, ascending: triangles are drawn in one group for each. Empty where the mesh has none.
    fn materials(&self) -> &[u32];

    /// Smallest and largest corner of the box around the full resolution; `None` without triangles. `vertices` are those of
    /// the model. O(n).
    fn extent(&self, vertices: &Mesh) -> Option<[[f32; 3]; 2]>;

    /// When every vertex comes into use, and what leaving it out can change: to colour or to send by. O(n).
    fn vertex_ranks(&self) -> Vec<VertexRank>;

    /// The vertices that it keeps itself, if it does; else they lie beside it.
    fn own_vertices(&self) -> Option<&Mesh> {
        None
    }

    /// Checks that vertices fit that lie beside it in a file.
    ///
    /// # Errors
    /// They do not.
    fn check_vertices(&self, vertices: &Mesh) -> Result<(), Self::Error>;

    /// Bytes of its arrays, vertices that it keeps not counted.
    fn structure_memory(&self) -> usize;

    /// Builds it from a mesh with default options: [`Structure::build_baked`] in short.
    ///
    /// # Errors
    /// The mesh is none of those that the structure can be built from.
    fn bake(mesh: &Mesh) -> Result<Baked<Self>, Self::Error> {
        Self::bake_with(mesh, &Self::Options::default(), |_| ControlFlow::Continue(()))
    }

    /// Builds it from a mesh with options. `progress` is told how far it is, 0 to 1, and may break.
    ///
    /// # Errors
    /// The mesh is none of those that the structure can be built from, or `progress` breaks.
    fn bake_with(
        mesh: &Mesh,
        options: &Self::Options,
        mut progress: impl FnMut(f32) -> ControlFlow<()>,
    ) -> Result<Baked<Self>, Self::Error> {
        Self::build_baked(mesh, options, &mut progress)
    }
}

/// A structure that is read off a collapse sequence.
pub trait FromSequence: Structure<Error: From<OptionError>> {
    /// Builds it from a mesh and a simplification of it, with its vertices and where they come from.
    ///
    /// # Errors
    /// The sequence belongs to another mesh, does not hold together, or is not one that the structure can be built from; or
    /// `progress` breaks.
    fn bake_sequence(
        mesh: &Mesh,
        sequence: &CollapseSequence,
        options: &Self::Options,
        progress: Progress<'_>,
    ) -> Result<Baked<Self>, Self::Error>;
}
