//! A baked model of any structure: for programs to draw files without knowing their structure.

use std::any::Any;

use crate::mesh::Mesh;

use super::{
    Baked, Extracted, Level, Lod, LodError, LodOptions, Origins, Structure, Values, Vertex, VertexRank,
};

/// A [`Baked`] model of unknown structure, drawn with vertices of type `V`. Read by [`io::read_model`](crate::io::read_model).
#[cfg_attr(not(feature = "io"), allow(rustdoc::broken_intra_doc_links))]
pub trait Model<V: Vertex>: Any + Send + Sync {
    /// Returns the name of the structure's kind.
    fn kind(&self) -> &'static str;

    /// Returns [`Structure::TRIANGULATIONS`].
    fn has_triangulations(&self) -> bool;

    /// Returns [`Baked::vertices`].
    fn vertices(&self) -> &Mesh;

    /// Returns [`Baked::origins`].
    fn origins(&self) -> &Origins;

    /// Returns [`Baked::bounds`].
    fn bounds(&self) -> Option<[[f32; 3]; 2]>;

    /// Returns the number of vertices, each of which an instance may draw.
    fn vertex_count(&self) -> usize;

    /// Returns the number of vertices of the full resolution.
    fn finest_vertex_count(&self) -> usize;

    /// Returns the numbers of triangles of the full resolution and of the coarsest level of detail.
    fn triangle_counts(&self) -> [usize; 2];

    /// Returns the material ids in use, ascending; empty if there are none.
    fn materials(&self) -> &[u32];

    /// Returns [`Structure::vertex_ranks`].
    fn vertex_ranks(&self) -> Vec<VertexRank>;

    /// Returns [`Structure::morph_targets`].
    fn morph_targets(&self) -> &[u32];

    /// Returns [`Baked::memory`].
    fn memory(&self) -> usize;

    /// Returns [`Baked::plain_memory`].
    fn plain_memory(&self) -> usize;

    /// Makes a drawn instance: [`Baked::instance`].
    ///
    /// # Errors
    /// As [`Baked::instance`].
    fn instance(&self, values: &Values<V>, options: &LodOptions) -> Result<Box<dyn Lod>, LodError>;

    /// Returns a level of detail as a mesh: [`Baked::level`].
    fn level(&self, level: Level) -> Extracted;

    /// Returns the [`Baked`] model itself, to be downcast to a known structure.
    fn as_any(&self) -> &dyn Any;
}

impl<S: Structure, V: Vertex> Model<V> for Baked<S> {
    fn kind(&self) -> &'static str {
        S::KIND
    }

    fn has_triangulations(&self) -> bool {
        S::TRIANGULATIONS
    }

    fn vertices(&self) -> &Mesh {
        self.vertices()
    }

    fn origins(&self) -> &Origins {
        self.origins()
    }

    fn bounds(&self) -> Option<[[f32; 3]; 2]> {
        self.bounds()
    }

    fn vertex_count(&self) -> usize {
        self.structure().vertex_count()
    }

    fn finest_vertex_count(&self) -> usize {
        self.structure().finest_vertex_count()
    }

    fn triangle_counts(&self) -> [usize; 2] {
        [self.structure().triangle_count(), self.structure().base_triangle_count()]
    }

    fn materials(&self) -> &[u32] {
        self.structure().materials()
    }

    fn vertex_ranks(&self) -> Vec<VertexRank> {
        self.structure().vertex_ranks()
    }

    fn morph_targets(&self) -> &[u32] {
        self.structure().morph_targets()
    }

    fn memory(&self) -> usize {
        self.memory()
    }

    fn plain_memory(&self) -> usize {
        self.plain_memory()
    }

    fn instance(&self, values: &Values<V>, options: &LodOptions) -> Result<Box<dyn Lod>, LodError> {
        Ok(Box::new(self.instance(values.clone(), options)?))
    }

    fn level(&self, level: Level) -> Extracted {
        self.level(level)
    }

    fn as_any(&self) -> &dyn Any {
        self
    }
}
