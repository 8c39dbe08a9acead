//! Dependencies of splits besides parents, so splits happen among neighbours seen by the simplifier.
//!
//! ```text
//!          w2                     the star of x after the collapse of u into x; a split of x needs
//!        /    \                     nothing                                      (none)
//!     w3 - x - w1                   x, both ends of its new edge's triangles and what lies beyond
//!        \    /                       those two triangles' sides                 (adjacent)
//!          w4                       all of w1 ... w4, none of them finer than then  (neighbours)
//! ```

use crate::geometry::lists::Lists;

use super::wings::wing_pairs;
use super::{CutSurface, VertexHierarchy};

/// How near a cut must stay to meshes seen by the simplifier.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Dependencies {
    /// A split needs only its vertex. Most selective, but some triangles may flip (Kim and Lee, *Truly Selective
    /// Refinement of Progressive Meshes*, 2001).
    #[default]
    None,
    /// A split needs the vertices of its triangles and of the triangles beside them: up to seven (Southern, section
    /// 5.1.2).
    Adjacent,
    /// A split needs all neighbours of its vertex, and is not undone while a neighbour is finer than at the time of the
    /// collapse. Every split happens in exactly the star judged by the simplifier (Xia and Varshney 1996; Berkey and
    /// Song, section 3.2).
    Neighbours,
    /// A split needs the split that keeps the two wings of its edge apart. Nearly as selective as none, and every cut of a
    /// manifold is a manifold, with the same Euler characteristic, if the simplifier kept its levels so. For what is not: closed
    /// meshes stay closed with any dependencies.
    Manifold,
}

/// Finds the dependencies of every split by replaying all collapses. `order` lists the splits in the order of their
/// collapses. `point_of` returns the point of every leaf: equal for leaves of one place.
pub(super) fn dependency_lists(
    hierarchy: &VertexHierarchy,
    order: &[u32],
    point_of: impl FnOnce() -> Vec<u32>,
    dependencies: Dependencies,
) -> Lists {
    match dependencies {
        Dependencies::None => Lists::default(),
        Dependencies::Manifold => lists(hierarchy, wing_pairs(hierarchy, order, &point_of())),
        Dependencies::Adjacent | Dependencies::Neighbours => {
            lists(hierarchy, neighbour_pairs(hierarchy, order, dependencies))
        }
    }
}

/// Makes lists of pairs of a split and one needed by it, without parents.
fn lists(hierarchy: &VertexHierarchy, mut pairs: Vec<[u32; 2]>) -> Lists {
    pairs.sort_unstable();
    pairs.dedup();
    pairs.retain(|&[split, need]| !hierarchy.parents.get(split).contains(&need));
    Lists::from_pairs(hierarchy.split_count(), pairs.iter().map(|&[split, need]| (split, need)))
}

/// Finds the splits needed among neighbours.
fn neighbour_pairs(hierarchy: &VertexHierarchy, order: &[u32], dependencies: Dependencies) -> Vec<[u32; 2]> {
    let count = hierarchy.split_count();
    let mut surface = CutSurface::new(hierarchy, false);
    // Applies all splits, coarsest first.
    for split in 0..count as u32 {
        surface.split(hierarchy, split, |other| other <= split);
    }
    let mut pairs: Vec<[u32; 2]> = Vec::new();
    // Per vertex, the last collapse into it so far.
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
    pairs
}

/// Adds the corners of a vanishing triangle, and of the drawn triangles beside it, to `ring`.
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
