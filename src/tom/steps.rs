//! The corners rewritten by every step: the table by which cursors move.
//!
//! ```text
//!     vertex v = base, base + 1, ...    moves   the corners that hold v while it is active and take its substitute
//!                                               when its group goes, in triangles that outlive the group
//! ```
//!
//! A vanishing triangle keeps its place at the end of the index buffer and its corners. When the triangle comes back,
//! the corners are right. So this table is all a move needs. All cursors of a mesh share it, and a cursor is little more
//! than its index buffer.

use std::sync::Arc;

use crate::mesh::NONE;

use super::{MaterialRange, TomError, TotallyOrderedMesh};

/// A totally ordered mesh with the corners rewritten by every step. Immutable; share it between [`TomCursor`]s.
///
/// [`TomCursor`]: super::TomCursor
///
/// ```
/// use multires::tom::{TomCursor, TomSteps, TotallyOrderedMesh};
/// use multires::{Level, Structure, mesh::shapes};
///
/// let model = TotallyOrderedMesh::bake(&shapes::icosphere(3))?;
/// let steps = TomSteps::new(model.structure().clone())?;
/// let mut cursor = TomCursor::new(steps.into());
/// cursor.seek(model.structure().at(Level::Ratio(0.5)));
/// assert_eq!(cursor.indices().len(), 3 * cursor.resolution().triangles());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct TomSteps {
    tom: Arc<TotallyOrderedMesh>,
    /// Start of each vertex's moves, from the first vertex after the base, and the end of the last.
    move_start: Vec<u32>,
    /// Places in the index buffer, vertex by vertex.
    moves: Vec<u32>,
    /// Place of each triangle in the index buffer; empty where it is the triangle's own number.
    place: Vec<u32>,
    /// Range of each material, with no triangles drawn.
    empty_ranges: Vec<MaterialRange>,
}

/// Most moves a corner of a triangle, on average. Meshes have one or two.
const MOST_MOVES: u64 = 64;
/// Moves that any mesh may have.
const FREE_MOVES: u64 = 1 << 20;
/// Most hops a move, on average.
const HOPS: u64 = 4;

impl TomSteps {
    /// Makes the table for cursors with a single range in the index buffer, whatever the materials. O(moves), 3 to 4 a
    /// vertex.
    ///
    /// # Errors
    /// There are more than 64 moves a corner, and more than a million: a mesh made so that long chains of substitutes hang on
    /// every triangle. Extraction still works.
    pub fn new(tom: impl Into<Arc<TotallyOrderedMesh>>) -> Result<Self, TomError> {
        Self::build(tom.into(), false)
    }

    /// Makes the table for cursors with a range per material in the index buffer, to be drawn by a call each.
    ///
    /// # Errors
    /// There are more than 64 moves a corner, and more than a million: a mesh made so that long chains of substitutes hang on
    /// every triangle. Extraction still works.
    pub fn by_material(tom: impl Into<Arc<TotallyOrderedMesh>>) -> Result<Self, TomError> {
        Self::build(tom.into(), true)
    }

    /// Returns the mesh.
    pub fn tom(&self) -> &Arc<TotallyOrderedMesh> {
        &self.tom
    }

    /// Returns the bytes of the mesh's and this table's own arrays: on closed meshes about 28 a vertex for the mesh and
    /// 16 to 20 for the table.
    pub fn memory(&self) -> usize {
        self.tom.memory(0)
            + size_of_val(&self.move_start[..])
            + size_of_val(&self.moves[..])
            + size_of_val(&self.place[..])
            + size_of_val(&self.empty_ranges[..])
    }

    /// Returns the places in the index buffer that hold `vertex` when its group becomes active.
    pub(super) fn moves(&self, vertex: u32) -> &[u32] {
        let at = (vertex - self.tom.base_vertices) as usize;
        &self.moves[self.move_start[at] as usize..self.move_start[at + 1] as usize]
    }

    /// Returns the place of a triangle in the index buffer.
    pub(super) fn place(&self, triangle: u32) -> u32 {
        self.place.get(triangle as usize).copied().unwrap_or(triangle)
    }

    /// Returns the bytes of the table alone.
    pub fn table_memory(&self) -> usize {
        self.memory() - self.tom.memory(0)
    }

    /// Returns the number of a triangle's range.
    pub(super) fn range_of(&self, triangle: u32) -> usize {
        if self.empty_ranges.len() > 1 { self.tom.material_of[triangle as usize] as usize } else { 0 }
    }

    pub(super) fn empty_ranges(&self) -> &[MaterialRange] {
        &self.empty_ranges
    }

    fn build(tom: Arc<TotallyOrderedMesh>, by_material: bool) -> Result<Self, TomError> {
        let (place, empty_ranges) = layout(&tom, by_material);
        let group_first = group_firsts(&tom);

        let base = tom.base_vertices;
        let mut total = 0u64;
        let mut move_start = vec![0u32; tom.substitute.len() - base as usize + 1];
        let limit = (MOST_MOVES * 3 * tom.triangles.len() as u64).clamp(FREE_MOVES, u64::from(u32::MAX));
        let fits = each_move(&tom, &group_first, limit, |vertex, _| {
            total += 1;
            move_start[(vertex - base) as usize + 1] += 1;
        });
        if !fits || total > limit {
            return Err(TomError::TooManyMoves { count: total, limit });
        }
        for i in 1..move_start.len() {
            move_start[i] += move_start[i - 1];
        }
        let mut next = move_start.clone();
        let mut moves = vec![0; total as usize];
        each_move(&tom, &group_first, limit, |vertex, corner| {
            let slot = &mut next[(vertex - base) as usize];
            let triangle = place.get((corner / 3) as usize).copied().unwrap_or(corner / 3);
            moves[*slot as usize] = 3 * triangle + corner % 3;
            *slot += 1;
        });
        Ok(Self { tom, move_start, moves, place, empty_ranges })
    }
}

/// Lays out the triangles in the index buffer. Returns their places and the ranges.
fn layout(tom: &TotallyOrderedMesh, by_material: bool) -> (Vec<u32>, Vec<MaterialRange>) {
    if !by_material || tom.material_of.is_empty() {
        let material = if by_material { tom.material_ids.first().copied() } else { None };
        return (Vec::new(), vec![MaterialRange { material: material.unwrap_or(NONE), start: 0, count: 0 }]);
    }
    let mut next = vec![0u32; tom.material_ids.len() + 1];
    for &m in &tom.material_of {
        next[m as usize + 1] += 1;
    }
    for m in 1..next.len() {
        next[m] += next[m - 1];
    }
    let ranges = tom.material_ids.iter().zip(&next);
    let ranges =
        ranges.map(|(&material, &first)| MaterialRange { material, start: 3 * first, count: 0 }).collect();
    let places = tom.material_of.iter().map(|&m| {
        let place = &mut next[m as usize];
        *place += 1;
        *place - 1
    });
    (places.collect(), ranges)
}

/// Returns the first vertex of every vertex's group; 0 for base vertices.
fn group_firsts(tom: &TotallyOrderedMesh) -> Vec<u32> {
    let mut first = 0;
    let firsts = (0..tom.substitute.len() as u32).map(|v| {
        if v >= tom.base_vertices && !tom.is_joined(v) {
            first = v;
        }
        first
    });
    firsts.collect()
}

/// Calls `f(vertex, corner)` for every move, by corner. Returns false, and ends, where that would take far more hops along chains
/// than `limit` moves need.
fn each_move(tom: &TotallyOrderedMesh, group_first: &[u32], limit: u64, mut f: impl FnMut(u32, u32)) -> bool {
    let mut hops = 0;
    for triangle in 0..tom.triangles.len() {
        let end = match tom.walk_to_end(triangle, || hops += 1) {
            NONE => 0,
            last => group_first[last as usize],
        };
        for (k, &corner) in tom.triangles[triangle].iter().enumerate() {
            let mut v = corner;
            // The triangle outlives the group that starts at `first`.
            while group_first[v as usize] > end {
                f(v, 3 * triangle as u32 + k as u32);
                let first = group_first[v as usize];
                while v >= first {
                    v = tom.substitute[v as usize];
                    hops += 1;
                }
            }
        }
        if hops > HOPS * limit {
            return false;
        }
    }
    true
}
