//! Edges of the base faces: which sides share an edge, and which edges are seams.

use crate::mesh::{Edges, NONE};
use crate::wavelet::WaveletError;

use super::MOST_ALONG;

/// Identifies the edge of a side, with the side as `3 * face + side`. Sides along the same edge have equal keys: the edge
/// between their points and the number of the midpoint.
pub(super) type EdgeKey = ([u32; 2], u32);

/// Returns the keys of all sides of the base faces, sorted.
pub(super) fn edge_keys(points: &[[u32; 3]], midpoints: &[[u32; 3]]) -> Vec<EdgeKey> {
    let point_count = points.as_flattened().iter().max().map_or(0, |&max| max as usize + 1);
    let by_ends = Edges::new(points, point_count);
    // Several edges may have the same ends.
    let mut keys: Vec<EdgeKey> = Vec::with_capacity(3 * points.len());
    for (face, edges) in by_ends.of_half_edges(points.len()).iter().enumerate() {
        for (side, &edge) in edges.iter().enumerate() {
            let at = 3 * face as u32 + side as u32;
            // A face with a repeated point does not share the edge.
            let apart = if edge == NONE { at } else { midpoints.get(face).map_or(NONE, |sides| sides[side]) };
            keys.push(([edge, apart], at));
        }
    }
    keys.sort_unstable();
    keys
}

/// Numbers the different keys. Returns the edges of each face, and their number.
pub(super) fn number_edges(keys: &[EdgeKey], faces: usize) -> Result<(Vec<[u32; 3]>, usize), WaveletError> {
    let mut edges = vec![[NONE; 3]; faces];
    let mut count = 0;
    for sides in keys.chunk_by(|a, b| a.0 == b.0) {
        if sides.len() > MOST_ALONG {
            let triangle = (sides[0].1 / 3) as usize;
            return Err(WaveletError::TooManyAlongEdge { triangle, count: sides.len(), limit: MOST_ALONG });
        }
        sides.iter().for_each(|key| edges.as_flattened_mut()[key.1 as usize] = count as u32);
        count += 1;
    }
    Ok((edges, count))
}

/// Returns, per edge, whether it is a seam: its two ends, in order, are not the same vertices in all faces.
pub(super) fn seam_edges(
    corners: &[[u32; 3]],
    edges: &[[u32; 3]],
    against: &[[bool; 3]],
    edge_count: usize,
) -> Vec<bool> {
    let mut seam = vec![false; edge_count];
    let mut first = vec![[NONE; 2]; edge_count];
    for face in 0..corners.len() {
        for k in 0..3 {
            let [a, b] = [corners[face][k], corners[face][(k + 1) % 3]];
            let ends = if against[face][k] { [b, a] } else { [a, b] };
            let edge = edges[face][k] as usize;
            if first[edge] == [NONE; 2] {
                first[edge] = ends;
            }
            seam[edge] |= first[edge] != ends;
        }
    }
    seam
}
