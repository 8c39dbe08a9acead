//! [`Structure`] for totally ordered meshes: baking, instances, levels of detail as meshes.

use std::sync::Arc;

use crate::lod::{
    Baked, Builder, Extracted, FromSequence, Level, LodError, LodOptions, Origins, Progress, Structure,
    Values, Vertex, VertexRank,
};
use crate::mesh::Mesh;
use crate::sequence::CollapseSequence;

use super::{Resolution, TomError, TomLod, TomSteps, TotallyOrderedMesh};

/// Options for building a totally ordered mesh from a simplification. There are none yet.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub struct TomOptions {}

/// A [`Builder`] of totally ordered meshes: simplifies a mesh, then puts it in order.
pub type TomBuilder<M = crate::simplify::metric::Quadric> = Builder<TotallyOrderedMesh, M>;

impl FromSequence for TotallyOrderedMesh {
    fn bake_sequence(
        mesh: &Mesh,
        sequence: &CollapseSequence,
        _: &TomOptions,
        progress: Progress<'_>,
    ) -> Result<Baked<Self>, TomError> {
        let mut stage =
            |share: f32| if progress(share).is_break() { Err(TomError::Cancelled) } else { Ok(()) };
        stage(0.0)?;
        let built = Self::build(mesh, sequence)?;
        stage(0.7)?;
        let mut order = built.vertex_order;
        order.truncate(built.tom.vertex_count());
        let vertices = sequence.assemble(mesh, &order, Vec::new(), Vec::new());
        stage(1.0)?;
        Ok(Baked::new(built.tom, Some(vertices), Origins::of_sequence(mesh, sequence, order)))
    }
}

impl Structure for TotallyOrderedMesh {
    const KIND: &'static str = "tom";

    type Options = TomOptions;
    type Error = TomError;
    type Table = Arc<TomSteps>;
    type Instance<V: Vertex> = TomLod<V>;

    fn build_baked(
        mesh: &Mesh,
        options: &TomOptions,
        progress: Progress<'_>,
    ) -> Result<Baked<Self>, TomError> {
        Builder::<Self>::new().options(*options).bake_with(mesh, progress)
    }

    fn table(model: &Baked<Self>) -> Result<Arc<TomSteps>, LodError> {
        let steps = TomSteps::by_material(Arc::clone(model.structure()));
        steps.map(Arc::new).map_err(|error| LodError::Table { what: error.to_string() })
    }

    fn instance<V: Vertex>(
        model: &Baked<Self>,
        values: Values<V>,
        options: &LodOptions,
    ) -> Result<TomLod<V>, LodError> {
        TomLod::of(model, values, options)
    }

    fn level(model: &Baked<Self>, level: Level) -> Extracted {
        let resolution = model.structure().at(level);
        Extracted::new(model.mesh_at(resolution), resolution.error())
    }

    fn vertex_count(&self) -> usize {
        self.vertex_count()
    }

    fn finest_vertex_count(&self) -> usize {
        self.vertex_count()
    }

    fn triangle_count(&self) -> usize {
        self.triangle_count()
    }

    fn base_triangle_count(&self) -> usize {
        self.coarsest().triangles()
    }

    fn materials(&self) -> &[u32] {
        self.material_ids()
    }

    fn extent(&self, vertices: &Mesh) -> Option<[[f32; 3]; 2]> {
        vertices.box_of(self.triangles.as_flattened())
    }

    fn vertex_ranks(&self) -> Vec<VertexRank> {
        let base = self.base_vertices as usize;
        let count = self.vertex_count() - base;
        let rank = |vertex: usize| {
            let Some(at) = vertex.checked_sub(base) else { return VertexRank::COARSEST };
            // The bound of the finest resolution known to lack the vertex.
            let above = self.error_marks.partition_point(|mark| mark.vertices as usize <= vertex);
            let error = above.checked_sub(1).map_or(0.0, |mark| self.error_marks[mark].error);
            VertexRank::new(VertexRank::share_of(at, count), error)
        };
        (0..self.vertex_count()).map(rank).collect()
    }

    fn check_vertices(&self, vertices: &Mesh) -> Result<(), TomError> {
        let fits = |what, found, expected| {
            if found == expected { Ok(()) } else { Err(TomError::Length { what, found, expected }) }
        };
        fits("vertices", vertices.positions().len(), self.vertex_count())?;
        fits("triangles beside the ordered ones", vertices.triangles().len(), 0)
    }

    fn structure_memory(&self) -> usize {
        self.memory(0)
    }
}

impl Baked<TotallyOrderedMesh> {
    /// Returns a resolution as a mesh: its vertices in use, in the total order, with attributes and locks, and its
    /// triangles with their materials. O(vertices + output).
    pub fn mesh_at(&self, resolution: Resolution) -> Mesh {
        let tom = &**self.structure();
        let mut indices = Vec::new();
        tom.fill_indices(resolution, &mut indices);
        let triangles: &[[u32; 3]] = bytemuck::cast_slice(&indices);
        let materials = match tom.material_ids[..] {
            [] => Vec::new(),
            [one] => vec![one; triangles.len()],
            ref ids => tom.material_of[..triangles.len()].iter().map(|&m| ids[m as usize]).collect(),
        };
        self.vertices().gather_used(triangles, materials)
    }
}
