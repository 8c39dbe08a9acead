//! The structure: levels over one array of vertices, a target for each vertex, triangles of every level.

use std::ops::Range;

use crate::geometry::array::Array;

/// A level of a [`Gmesh`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct GmeshLevel {
    /// Vertices from which the level draws: a prefix of all vertices. With placements that make vertices, some of the prefix
    /// belong to coarser levels only.
    pub vertices: usize,
    /// Triangles drawn.
    pub triangles: usize,
    /// Bound for the error, object units, as defined by the simplifier. Does not fall from level to level.
    pub error: f32,
    /// Enclosed volume, cubic object units; `None` for a surface that is open or not consistently oriented.
    pub volume: Option<f64>,
}

/// A g-mesh: levels of detail that turn into each other by moving vertices. Immutable; see the [module](super).
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "super::GmeshParts", into = "super::GmeshParts"))]
pub struct Gmesh {
    /// At least one, finest first.
    pub(super) levels: Vec<GmeshLevel>,
    /// Per vertex the vertex to which it moves in the last level that draws it; itself where it stays.
    pub(super) targets: Array<u32>,
    /// Corners: all levels of a group, finest first, group by group.
    pub(super) triangles: Array<[u32; 3]>,
    /// Start of every level of every group in `triangles`, and the end: `group * levels + level`.
    pub(super) starts: Array<u32>,
    /// The material ids in use, ascending.
    pub(super) material_ids: Array<u32>,
}

impl Gmesh {
    /// Returns the levels, finest first; at least one.
    pub fn levels(&self) -> &[GmeshLevel] {
        &self.levels
    }

    /// Returns the number of vertices of all levels.
    pub fn vertex_count(&self) -> usize {
        self.targets.len()
    }

    /// Returns the vertex to which each vertex moves in the last level that draws it; itself for a vertex of the coarsest
    /// level.
    pub fn targets(&self) -> &[u32] {
        &self.targets
    }

    /// Returns the material ids in use, ascending; empty where the mesh has no materials.
    pub fn material_ids(&self) -> &[u32] {
        &self.material_ids
    }

    /// Returns the number of groups of triangles: one for each material, at least one.
    pub fn groups(&self) -> usize {
        self.material_ids.len().max(1)
    }

    /// Returns the corners of a group's triangles in all levels, finest level first: an index buffer to upload once. Empty
    /// where there is no such group.
    pub fn index_buffer(&self, group: usize) -> &[[u32; 3]] {
        if group >= self.groups() {
            return &[];
        }
        let count = self.levels.len();
        let [start, end] = [group * count, (group + 1) * count].map(|at| self.starts[at] as usize);
        &self.triangles[start..end]
    }

    /// Returns a level's triangles in [`Gmesh::index_buffer`] of a group. Empty where there is no such level or group.
    #[inline]
    pub fn range(&self, level: usize, group: usize) -> Range<usize> {
        let count = self.levels.len();
        if level >= count || group >= self.groups() {
            return 0..0;
        }
        let base = self.starts[group * count];
        let [start, end] =
            [level, level + 1].map(|level| (self.starts[group * count + level] - base) as usize);
        start..end
    }

    /// Returns the corners of a group's triangles in a level. Empty where there is no such level or group.
    pub fn triangles(&self, level: usize, group: usize) -> &[[u32; 3]] {
        &self.index_buffer(group)[self.range(level, group)]
    }

    /// Returns the finest level with at most this many triangles, or the coarsest.
    pub fn level_within(&self, triangles: usize) -> usize {
        let last = self.levels.len() - 1;
        self.levels.iter().position(|level| level.triangles <= triangles).unwrap_or(last)
    }

    /// Returns the coarsest level with at most this error, object units; the finest if none has, and for NaN.
    pub fn level_of_error(&self, error: f32) -> usize {
        self.levels.iter().rposition(|level| level.error <= error).unwrap_or(0)
    }

    /// Returns the bytes of this structure's arrays, plus two values of `vertex_bytes` (position and attributes: own, and
    /// the target's) for every vertex: the memory of all levels on the graphics card.
    pub fn memory(&self, vertex_bytes: usize) -> usize {
        size_of_val(&self.levels[..])
            + size_of_val(&self.triangles[..])
            + size_of_val(&self.starts[..])
            + size_of_val(&self.material_ids[..])
            + if vertex_bytes == 0 {
                size_of_val(&self.targets[..])
            } else {
                2 * vertex_bytes * self.vertex_count()
            }
    }
}
