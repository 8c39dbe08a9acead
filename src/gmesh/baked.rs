//! [`Structure`] for g-meshes: baking, instances, levels of detail as meshes.

use std::sync::Arc;

use crate::adapt::Blend;
use crate::geometry::boxes;
use crate::lod::{
    Baked, Builder, Extracted, FromSequence, Level, LodError, LodOptions, Origins, Progress, Structure,
    Values, Vertex, VertexRank,
};
use crate::mesh::{Blender, Mesh};
use crate::sequence::CollapseSequence;
use crate::simplify::{Independence, Order, Simplifier};

use super::instance::Table;
use super::{Gmesh, GmeshError, GmeshLod, GmeshOptions, Morph};

/// A [`Builder`] of g-meshes: simplifies a mesh in batches that nearly halve it, and makes a level of each.
///
/// ```
/// use multires::gmesh::{Gmesh, GmeshBuilder};
/// use multires::lod::FromSequence;
/// use multires::{Target, mesh::shapes};
///
/// // Down to 200 triangles.
/// let simplifier = Gmesh::simplifier().target(Target::Triangles(200));
/// let rock = GmeshBuilder::new().simplifier(simplifier).bake(&shapes::rock(10_000, 1))?;
/// assert!((5..=8).contains(&(rock.structure().levels().len() - 1)));
/// # Ok::<(), multires::gmesh::GmeshError>(())
/// ```
pub type GmeshBuilder<M = crate::simplify::metric::Quadric> = Builder<Gmesh, M>;

impl FromSequence for Gmesh {
    /// Returns a simplifier in batches of independent merges, each of which nearly halves the mesh.
    fn simplifier() -> Simplifier {
        Simplifier::new().order(Order::Batched).independence(Independence::Matching)
    }

    fn bake_sequence(
        mesh: &Mesh,
        sequence: &CollapseSequence,
        options: &GmeshOptions,
        progress: Progress<'_>,
    ) -> Result<Baked<Self>, GmeshError> {
        let mut stage =
            |share: f32| if progress(share).is_break() { Err(GmeshError::Cancelled) } else { Ok(()) };
        stage(0.0)?;
        let built = Self::build(mesh, sequence, options)?;
        stage(0.8)?;
        let vertices = sequence.assemble(mesh, &built.vertex_order, Vec::new(), Vec::new());
        stage(1.0)?;
        let origins = Origins::of_sequence(mesh, sequence, built.vertex_order);
        Ok(Baked::new(built.gmesh, Some(vertices), origins))
    }
}

impl Structure for Gmesh {
    const KIND: &'static str = "gmesh";

    type Options = GmeshOptions;
    type Error = GmeshError;
    type Table = Arc<Table>;
    type Instance<V: Vertex> = GmeshLod<V>;

    fn build_baked(
        mesh: &Mesh,
        options: &GmeshOptions,
        progress: Progress<'_>,
    ) -> Result<Baked<Self>, GmeshError> {
        Builder::<Self>::new().options(*options).bake_with(mesh, progress)
    }

    fn table(model: &Baked<Self>) -> Result<Arc<Table>, LodError> {
        Ok(Arc::new(Table::new(model)))
    }

    fn instance<V: Vertex>(
        model: &Baked<Self>,
        values: Values<V>,
        options: &LodOptions,
    ) -> Result<GmeshLod<V>, LodError> {
        GmeshLod::of(model, values, options)
    }

    fn level(model: &Baked<Self>, level: Level) -> Extracted {
        let gmesh = model.structure();
        let level = gmesh.level(level);
        Extracted::new(model.mesh_at(Morph { level, share: 0.0 }), gmesh.levels()[level].error)
    }

    fn vertex_count(&self) -> usize {
        self.vertex_count()
    }

    fn finest_vertex_count(&self) -> usize {
        let mut used = vec![false; self.vertex_count()];
        let finest = (0..self.groups()).flat_map(|group| self.triangles(0, group).as_flattened());
        finest.for_each(|&v| used[v as usize] = true);
        used.iter().filter(|&&used| used).count()
    }

    fn triangle_count(&self) -> usize {
        self.levels()[0].triangles
    }

    fn base_triangle_count(&self) -> usize {
        self.levels().last().map_or(0, |level| level.triangles)
    }

    fn materials(&self) -> &[u32] {
        self.material_ids()
    }

    fn extent(&self, vertices: &Mesh) -> Option<[[f32; 3]; 2]> {
        let corners = (0..self.groups()).flat_map(|group| self.triangles(0, group).as_flattened());
        boxes::around_any(corners.map(|&v| vertices.positions()[v as usize]))
    }

    fn vertex_ranks(&self) -> Vec<VertexRank> {
        let coarsest = self.levels().last().map_or(0, |level| level.vertices);
        let count = self.vertex_count() - coarsest;
        let rank = |vertex: usize| {
            let Some(at) = vertex.checked_sub(coarsest) else { return VertexRank::COARSEST };
            // The first level without the vertex.
            let without = self.levels().partition_point(|level| level.vertices > vertex);
            VertexRank::new(VertexRank::share_of(at, count), self.levels()[without].error)
        };
        (0..self.vertex_count()).map(rank).collect()
    }

    fn morph_targets(&self) -> &[u32] {
        self.targets()
    }

    fn check_vertices(&self, vertices: &Mesh) -> Result<(), GmeshError> {
        let fits = |what, found, expected| {
            if found == expected { Ok(()) } else { Err(GmeshError::Length { what, found, expected }) }
        };
        fits("vertices", vertices.positions().len(), self.vertex_count())?;
        fits("triangles beside the levels", vertices.triangles().len(), 0)
    }

    fn structure_memory(&self) -> usize {
        self.memory(0)
    }
}

impl Gmesh {
    /// Returns the level within a count, ratio or error: the finest within a count or ratio, the coarsest within an error.
    fn level(&self, level: Level) -> usize {
        let last = self.levels().len() - 1;
        match level {
            Level::Triangles(count) => self.level_within(count),
            Level::Vertices(count) => {
                self.levels().iter().position(|level| level.vertices <= count).unwrap_or(last)
            }
            Level::Error(error) => self.level_of_error(error),
            Level::Ratio(ratio) => {
                // The cast takes NaN and negative ratios to 0; beyond 1 all is drawn.
                self.level_within((f64::from(ratio) * self.triangle_count() as f64) as usize)
            }
        }
    }
}

impl Baked<Gmesh> {
    /// Returns a state as a mesh: the vertices in use, moving vertices on their way, with attributes and locks, and the level's
    /// triangles with their materials. O(vertices + output).
    pub fn mesh_at(&self, morph: Morph) -> Mesh {
        let gmesh = &**self.structure();
        let Morph { level, share } = gmesh.clamped(morph);
        let (mut triangles, mut materials) = (Vec::new(), Vec::new());
        for group in 0..gmesh.groups() {
            triangles.extend_from_slice(gmesh.triangles(level, group));
            if let Some(&id) = gmesh.material_ids().get(group) {
                materials.resize(triangles.len(), id);
            }
        }
        if share == 0.0 {
            return self.vertices().gather_used(&triangles, materials);
        }
        self.moved(level, share).gather_used(&triangles, materials)
    }

    /// Returns all vertices, with the moving vertices of a level on their way.
    fn moved(&self, level: usize, share: f32) -> Mesh {
        let gmesh = &**self.structure();
        let moving = gmesh.moving(level);
        let vertices = self.vertices();
        let mut positions = vertices.positions().to_vec();
        let mut blender = Blender::new(vertices.attributes(), moving.len());
        for vertex in moving.clone() {
            let target = gmesh.targets()[vertex];
            positions[vertex] = positions[vertex].blend(&vertices.positions()[target as usize], share);
            blender.push([vertex as u32, target], share);
        }
        // Behind all vertices lie the moved ones, in order.
        let (count, first) = (vertices.positions().len(), moving.start);
        let order: Vec<u32> =
            (0..count).map(|v| if moving.contains(&v) { count + v - first } else { v } as u32).collect();
        let attributes = blender.finish().iter().map(|attribute| attribute.gather(&order)).collect();
        let (names, locks) = (vertices.material_names().to_vec(), vertices.locks().to_vec());
        Mesh::from_trusted(positions, Vec::new(), attributes, Vec::new(), names, locks).at_origin_of(vertices)
    }
}
