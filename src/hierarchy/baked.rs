//! Vertex hierarchies behind the common interface of all structures: baking, instances, levels of a whole mesh.

use std::cmp::Reverse;

use crate::adapt::Refinements;
use crate::lod::{
    Baked, Builder, Extracted, FromSequence, Level, LodError, LodOptions, Origins, Progress, Structure,
    Values, Vertex, VertexRank,
};
use crate::mesh::Mesh;
use crate::sequence::CollapseSequence;

use super::{CutSurface, Dependencies, HierarchyError, HierarchyLod, VertexHierarchy};

/// Options for building a hierarchy from a simplification.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub struct HierarchyOptions {
    /// How near cuts stay to meshes seen by the simplifier; default [`Dependencies::None`].
    pub dependencies: Dependencies,
}

impl HierarchyOptions {
    /// Sets the dependencies.
    #[must_use]
    pub fn with_dependencies(mut self, dependencies: Dependencies) -> Self {
        self.dependencies = dependencies;
        self
    }
}

impl FromSequence for VertexHierarchy {
    fn bake_sequence(
        mesh: &Mesh,
        sequence: &CollapseSequence,
        options: &HierarchyOptions,
        progress: Progress<'_>,
    ) -> Result<Baked<Self>, HierarchyError> {
        let built = Self::build_with(mesh, sequence, options.dependencies, progress)?;
        let vertices = sequence.assemble(mesh, &built.vertex_order, Vec::new(), Vec::new());
        let origins = Origins::of_sequence(mesh, sequence, built.vertex_order);
        Ok(Baked::new(built.hierarchy, Some(vertices), origins))
    }
}

impl Structure for VertexHierarchy {
    const KIND: &'static str = "hierarchy";

    type Options = HierarchyOptions;
    type Error = HierarchyError;
    type Table = ();
    type Instance<V: Vertex> = HierarchyLod<V>;

    fn build_baked(
        mesh: &Mesh,
        options: &HierarchyOptions,
        progress: Progress<'_>,
    ) -> Result<Baked<Self>, HierarchyError> {
        Builder::<Self>::new().options(*options).bake_with(mesh, progress)
    }

    fn table(_: &Baked<Self>) -> Result<(), LodError> {
        Ok(())
    }

    fn instance<V: Vertex>(
        model: &Baked<Self>,
        values: Values<V>,
        options: &LodOptions,
    ) -> Result<HierarchyLod<V>, LodError> {
        HierarchyLod::of(model, values, options)
    }

    /// Chooses the splits with the largest errors, as many as fit, and all splits they need.
    fn level(model: &Baked<Self>, level: Level) -> Extracted {
        let of = &**model.structure();
        let mut splits: Vec<u32> = (0..of.split_count() as u32).collect();
        splits.sort_by_key(|&split| (Reverse(of.error(split).to_bits()), split));
        let count = match level {
            Level::Error(error) if error.is_nan() => splits.len(),
            Level::Error(error) => splits.partition_point(|&split| of.error(split) > error),
            Level::Triangles(most) => of.most_splits(&splits, |set| of.triangles_of(set) <= most),
            Level::Vertices(most) => of.most_splits(&splits, |set| of.vertices_of(set) <= most),
            Level::Ratio(ratio) => {
                // The cast maps NaN and negative values to 0.
                let most = (f64::from(ratio) * of.triangle_count() as f64) as usize;
                of.most_splits(&splits, |set| of.triangles_of(set) <= most)
            }
        };
        let set = of.closure(&splits[..count]);
        let surface = CutSurface::at(of, false, |split| set[split as usize]);
        let left_out = (0..set.len() as u32).filter(|&split| !set[split as usize]);
        let error = left_out.map(|split| of.error(split)).fold(0.0, f32::max);
        Extracted::new(of.mesh_of(model.vertices(), &surface), error)
    }

    fn vertex_count(&self) -> usize {
        self.vertex_count()
    }

    fn finest_vertex_count(&self) -> usize {
        self.leaf_count()
    }

    fn triangle_count(&self) -> usize {
        self.triangle_count()
    }

    fn base_triangle_count(&self) -> usize {
        self.base_triangle_count()
    }

    fn materials(&self) -> &[u32] {
        self.materials()
    }

    fn extent(&self, vertices: &Mesh) -> Option<[[f32; 3]; 2]> {
        vertices.box_of(self.triangles.as_flattened())
    }

    fn vertex_ranks(&self) -> Vec<VertexRank> {
        let count = self.split_count();
        let mut ranks = vec![VertexRank::COARSEST; self.vertex_count()];
        for split in 0..count as u32 {
            let rank = VertexRank::new(VertexRank::share_of(split as usize, count), self.error(split));
            self.brings.get(split).iter().for_each(|&vertex| ranks[vertex as usize] = rank);
        }
        ranks
    }

    fn check_vertices(&self, vertices: &Mesh) -> Result<(), HierarchyError> {
        let fits = |what, found, expected| {
            if found == expected { Ok(()) } else { Err(HierarchyError::Length { what, found, expected }) }
        };
        fits("vertices", vertices.positions().len(), self.vertex_count())?;
        fits("triangles beside the hierarchy's", vertices.triangles().len(), 0)
    }

    fn structure_memory(&self) -> usize {
        self.memory()
    }
}

impl VertexHierarchy {
    /// Returns a surface's drawn triangles as a mesh: the used vertices with attributes and locks, and the triangles with
    /// their materials, in the hierarchy's order. Equal cuts give equal meshes. O(vertices + output log output).
    pub(super) fn mesh_of(&self, vertices: &Mesh, surface: &CutSurface) -> Mesh {
        let vertex = |name: u32| surface.vertices().map_or(name, |slots| slots[name as usize]);
        let mut drawn: Vec<(u32, [u32; 3])> = Vec::new();
        for group in 0..surface.groups() {
            let corners = surface.triangles(group).iter().map(|t| t.map(vertex));
            drawn.extend(surface.drawn(group).iter().copied().zip(corners));
        }
        drawn.sort_unstable();
        let ids = &self.materials;
        let material = |&(t, _): &(u32, [u32; 3])| ids[self.group_of(t)];
        let materials = if ids.is_empty() { Vec::new() } else { drawn.iter().map(material).collect() };
        let triangles: Vec<[u32; 3]> = drawn.iter().map(|(_, t)| *t).collect();
        vertices.gather_used(&triangles, materials)
    }

    /// Closes a set of splits under parents and dependencies. Returns a flag per split. O(n).
    fn closure(&self, splits: &[u32]) -> Vec<bool> {
        let mut set = vec![false; self.split_count()];
        let mut stack = splits.to_vec();
        // There may be any number of dependencies, unlike parents.
        while let Some(split) = stack.pop() {
            if !std::mem::replace(&mut set[split as usize], true) {
                stack.extend(self.parents(split).chain(self.dependencies(split)));
            }
        }
        set
    }

    /// Returns the largest `n` for which the closure of the first `n` splits `fits`. `fits` must be monotone: once false,
    /// false for all larger sets.
    fn most_splits(&self, splits: &[u32], fits: impl Fn(&[bool]) -> bool) -> usize {
        let (mut low, mut high) = (0, splits.len());
        while low < high {
            let middle = high - (high - low) / 2;
            if fits(&self.closure(&splits[..middle])) { low = middle } else { high = middle - 1 }
        }
        low
    }

    fn triangles_of(&self, set: &[bool]) -> usize {
        let splits = (0..set.len() as u32).filter(|&split| set[split as usize]);
        self.base_triangle_count() + splits.map(|split| self.owned(split).len()).sum::<usize>()
    }

    /// Number of vertices drawn with a set of splits.
    fn vertices_of(&self, set: &[bool]) -> usize {
        let mut used = vec![false; self.vertex_count()];
        let there = |split: u32| set[split as usize];
        for corners in &self.triangles {
            let [a, b, c] = corners.map(|leaf| self.active(leaf, there));
            if a != b && b != c && c != a {
                [a, b, c].iter().for_each(|&v| used[v as usize] = true);
            }
        }
        used.iter().filter(|used| **used).count()
    }
}
