//! What a split needs besides its parents, so that it happens among neighbours that the simplifier saw it among.
//!
//! ```text
//!          w2                     the star of x after the collapse of u into x; a split of x needs
//!        /    \                     nothing                                      (none)
//!     w3 - x - w1                   x, both ends of its new edge's triangles and what lies beyond
//!        \    /                       those two triangles' sides                 (adjacent)
//!          w4                       all of w1 ... w4, none of them finer than then  (neighbours)
//! ```

use super::{CutSurface, Lists, VertexHierarchy};

/// How near a cut must stay to meshes that the simplifier has seen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Dependencies {
    /// A split needs only its vertex: the most selective, and some triangles may flip (Kim and Lee, *Truly Selective
    /// Refinement of Progressive Meshes*, 2001).
    #[default]
    None,
    /// A split needs the vertices of its triangles and of those beside them: up to seven (Southern, section 5.1.2).
    Adjacent,
    /// A split needs all neighbours of its vertex, and is not undone while one of them is finer than when it was made: every
    /// split happens in the very star the simplifier judged (Xia and Varshney 1996; Berkey and Song, section 3.2).
    Neighbours,
}

/// Needs of every split, found by replaying all collapses. `order` is the splits in order of their collapses, by collapse.
pub(super) fn dependency_lists(
    hierarchy: &VertexHierarchy,
    order: &[u32],
    dependencies: Dependencies,
) -> Lists {
    let count = hierarchy.split_count();
    if dependencies == Dependencies::None {
        return Lists { start: vec![0; count + 1], items: Vec::new() };
    }
    let mut surface = CutSurface::new(hierarchy, false);
    // All splits, coarsest first.
    for split in 0..count as u32 {
        surface.split(hierarchy, split, |other| other <= split);
    }
    let mut pairs: Vec<[u32; 2]> = Vec::new();
    // The last collapse that made each vertex what it is.
    let mut made = vec![u32::MAX; hierarchy.vertex_count()];
    let mut ring: Vec<u32> = Vec::new();
    for &split in order {
        ring.clear();
        if dependencies == Dependencies::Adjacent {
            for triangle in hierarchy.owned(split) {
                adjacent(hierarchy, &surface, triangle, &mut ring);
            }
            surface.collapse(hierarchy, split);
        } else {
            surface.collapse(hierarchy, split);
            for &vertex in hierarchy.brings.get(split) {
                let to = hierarchy.substitute[vertex as usize];
                for corner in surface.star(to) {
                    ring.extend(surface.corners(hierarchy, corner / 3).into_iter().flatten());
                }
            }
        }
        ring.sort_unstable();
        ring.dedup();
        for &vertex in &ring {
            let coarser = hierarchy.split_of[vertex as usize];
            if coarser != u32::MAX && coarser != split {
                pairs.push([split, coarser]);
            }
            if dependencies == Dependencies::Neighbours {
                let finer = made[vertex as usize];
                if finer != u32::MAX {
                    pairs.push([finer, split]);
                }
            }
        }
        for &vertex in hierarchy.brings.get(split) {
            made[hierarchy.substitute[vertex as usize] as usize] = split;
        }
    }
    pairs.sort_unstable();
    pairs.dedup();
    pairs.retain(|&[split, need]| !hierarchy.parents.get(split).contains(&need));
    Lists::from_pairs(count, pairs.iter().map(|&[split, need]| (split, need)))
}

/// The corners of a triangle that vanishes, and of the drawn triangles beside it.
fn adjacent(hierarchy: &VertexHierarchy, surface: &CutSurface, triangle: u32, ring: &mut Vec<u32>) {
    let Some(corners) = surface.corners(hierarchy, triangle) else { return };
    ring.extend(corners);
    for &vertex in &corners {
        for corner in surface.star(vertex) {
            let Some(other) = surface.corners(hierarchy, corner / 3) else { continue };
            if other.iter().filter(|v| corners.contains(v)).count() >= 2 {
                ring.extend(other);
            }
        }
    }
}
