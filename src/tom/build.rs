//! From a collapse sequence to the total order: number vertices by reverse removal, sort triangles by when they vanish.

use crate::geometry::array::Array;
use crate::geometry::lists::prefix_sum;
use crate::mesh::{Mesh, NONE};
use crate::sequence::CollapseSequence;
use crate::sequence::collapse_forest::CollapseForest;

use super::{ErrorMark, TomError, TotallyOrderedMesh};

/// Most error marks of a mesh.
pub(super) const MOST_MARKS: usize = 1024;
/// Vertices between error marks, unless this makes the marks too few or too many.
const MARK_STRIDE: usize = 128;
/// Error marks wanted even for a small mesh.
const FEW_MARKS: usize = 16;

/// A totally ordered mesh, and the input vertex and triangle at each place of its order.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct TomBuild {
    /// The structure.
    pub tom: TotallyOrderedMesh,
    /// Input vertex at each place of the new order: a permutation of all input vertices. The structure refers to the
    /// first [`TotallyOrderedMesh::vertex_count`] only. Duplicates follow (the sequence's
    /// [aliases](CollapseSequence::aliases)), then vertices used by no triangle. Neither need be uploaded.
    pub vertex_order: Vec<u32>,
    /// Input triangle at each place of the new order, degenerate triangles left out.
    pub triangle_order: Vec<u32>,
}

impl TotallyOrderedMesh {
    /// Builds the structure from a mesh and its simplification by endpoint placement.
    ///
    /// Base vertices keep the input's order, and so do triangles that vanish in the same step. Degenerate triangles are
    /// left out, duplicate vertices folded. O((vertices + triangles) log vertices). To get vertices and their origins
    /// too, call [`Baked::of_sequence`](crate::lod::Baked::of_sequence).
    ///
    /// # Errors
    /// The sequence makes new vertices, belongs to another mesh, or does not hold together.
    pub fn build(mesh: &Mesh, sequence: &CollapseSequence) -> Result<TomBuild, TomError> {
        if !sequence.new_vertices().is_empty() {
            return Err(TomError::NewVertices { count: sequence.new_vertices().len() });
        }
        let collapse_forest = CollapseForest::new(mesh, sequence)?;
        let base_vertices = collapse_forest.roots;
        let removed = &collapse_forest.removed[..collapse_forest.real as usize];
        let mut joined = vec![0u64; removed.len().div_ceil(64)];
        for v in base_vertices as usize + 1..removed.len() {
            joined[v / 64] |= u64::from(removed[v] == removed[v - 1]) << (v % 64);
        }
        if joined.iter().all(|&word| word == 0) {
            joined = Vec::new();
        }

        let ends: Vec<u32> = mesh.triangles().iter().map(|&t| collapse_forest.end(t)).collect();
        let (triangle_order, left) = sort_by_end(&ends, sequence.len());
        let triangles = triangle_order
            .iter()
            .map(|&t| mesh.triangles()[t as usize].map(|v| collapse_forest.folded(v)))
            .collect();

        let (mut material_of, mut material_ids) = (Vec::new(), Vec::new());
        if !mesh.materials().is_empty() {
            let of: Vec<u32> = triangle_order.iter().map(|&t| mesh.materials()[t as usize]).collect();
            material_ids.clone_from(&of);
            material_ids.sort_unstable();
            material_ids.dedup();
            if material_ids.len() > 1 {
                // Every id is in the list, so either answer is its place.
                let place = |id| material_ids.binary_search(id).unwrap_or_else(|at| at) as u32;
                material_of = of.iter().map(place).collect();
            }
        }

        let mut tom = Self {
            substitute: (0..collapse_forest.real).map(|v| collapse_forest.parent(v)).collect(),
            joined: joined.into(),
            base_vertices,
            triangles,
            error_marks: Array::default(),
            material_of: material_of.into(),
            material_ids: material_ids.into(),
        };
        tom.error_marks = error_marks(&collapse_forest, sequence).into();
        debug_assert_eq!(tom.validate(), Ok(()));
        debug_assert_eq!(left as usize, tom.triangles_at(base_vertices) as usize);
        Ok(TomBuild { tom, vertex_order: collapse_forest.order, triangle_order })
    }
}

/// Sorts the non-degenerate triangles, last vanishing first, in input order where they vanish together. Returns them
/// and the number of triangles that never vanish.
fn sort_by_end(ends: &[u32], steps: usize) -> (Vec<u32>, u32) {
    let bucket = |end: u32| if end == NONE { 0 } else { steps + 1 - end as usize };
    let mut start = vec![0u32; steps + 2];
    for &end in ends.iter().filter(|&&end| end != 0) {
        start[bucket(end) + 1] += 1;
    }
    prefix_sum(&mut start);
    let base = start[1];
    let mut order = vec![0; start.last().map_or(0, |&n| n as usize)];
    for (t, &end) in ends.iter().enumerate().filter(|&(_, &end)| end != 0) {
        let place = &mut start[bucket(end)];
        order[*place as usize] = t as u32;
        *place += 1;
    }
    (order, base)
}

/// Returns error bounds at group boundaries, base first. A mark's bound holds for all finer resolutions, since bounds
/// fall.
fn error_marks(collapse_forest: &CollapseForest, sequence: &CollapseSequence) -> Vec<ErrorMark> {
    let (base, real) = (collapse_forest.roots as usize, collapse_forest.real as usize);
    let span = real - base;
    let stride = MARK_STRIDE.min(span.div_ceil(FEW_MARKS)).max(span.div_ceil(MOST_MARKS - 1)).max(1);
    // Half of the marks evenly spaced, half where coarse levels follow each other fast: a mark every `vertices / share`
    // there.
    let (even, budget) = (2 * stride, span as f64 / stride as f64 / 2.0);
    let dense = |share: usize| share as f64 * ((share * even) as f64 / base.max(1) as f64).max(1.0).ln();
    let share = (1..=16).rev().find(|&share| dense(share) <= budget).unwrap_or(0);
    let mut marks: Vec<ErrorMark> = Vec::new();
    let mut next = base;
    // The boundary below vertex v is the level just after the step that removes v.
    for v in base..real {
        let removed = collapse_forest.removed[v];
        let first = v == base || removed != collapse_forest.removed[v - 1];
        if first && v >= next {
            marks.push(ErrorMark { vertices: v as u32, error: sequence.error_after(removed as usize) });
            next = v + v.checked_div(share).map_or(stride, |dense| dense.clamp(1, even));
        }
    }
    if marks.is_empty() && real > 0 {
        marks.push(ErrorMark { vertices: base as u32, error: 0.0 });
    }
    marks
}
