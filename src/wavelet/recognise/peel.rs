//! Peels a component of uneven depth: takes off its finest splits, region by region, until all faces are base faces or equally
//! deep.
//!
//! ```text
//!     while there are regions
//!         for every vertex of five faces, and every two of them in a row     the mark of a split face beside an
//!             suppose it is the midpoint between the ends of the two         unsplit one: 3 + 2 faces
//!             spread: across a side with a midpoint lies another face         (region.rs)
//!         merge the faces of all regions: four children, or the pieces of a face beside them
//! ```
//!
//! Vertices of a level come after all vertices of coarser levels. Files written here have this order, and formats keep it. Without
//! it there is no telling: small regions can be read in many ways. The last vertices are looked at first, and a pass ends at the
//! first vertex before all midpoints found, so that the levels come off one by one.
//!
//! Merged pieces become a leaf, which is never split. The rest of the mesh is left as it is, so what comes out is a plain complex
//! again: its next regions are one level coarser.

use crate::mesh::NONE;

use super::complex::{Complex, FaceComplex};
use super::fans::{Fans, around};
use super::merge::turned;
use super::region::Search;
use super::tower::{Closing, Tower};

/// A component is taken for a mesh of uneven depth if at least one in so many of its triangles is part of a split face or of a
/// face beside one. Elsewhere the patterns of such faces occur by accident.
const LEAST_SHARE: usize = 4;

/// A complex of merged faces.
pub(super) struct Peeled {
    pub complex: Complex,
    /// Per face its node in the tower.
    pub nodes: Vec<u32>,
}

/// Peels a connected complex of triangles. `None` if it has too little to peel. O(n x levels) where few vertices are supposed to
/// be midpoints in vain.
pub(super) fn peel(complex: Complex, surface: &FaceComplex, tower: &mut Tower) -> Option<Peeled> {
    let triangles = complex.face_count();
    let Fans { of_corner: mut fans, lowest_wedge } = Fans::new(&complex, surface);
    let mut layer = Peeled { nodes: complex.lowest.clone(), complex };
    loop {
        let mut search = Search::new(&layer.complex, surface, &fans, &lowest_wedge, |face| {
            layer.nodes[face as usize] < tower.triangles()
        });
        search.around = around(&layer.complex, &fans, lowest_wedge.len());
        find_regions(&mut search);
        if search.merges.is_empty() {
            break;
        }
        let (merges, merge_of, mates) = search.finish();
        let coarser =
            Coarser { layer: &layer, fans: &fans, merges: &merges, merge_of: &merge_of, mates: &mates };
        (layer, fans) = coarser.make(tower);
    }
    let left = layer.nodes.iter().filter(|&&node| node < tower.triangles()).count();
    ((triangles - left) * LEAST_SHARE >= triangles && left < triangles).then_some(layer)
}

/// Finds regions from the vertices of five faces, the last vertex first.
fn find_regions(search: &mut Search<'_, impl Fn(u32) -> bool>) {
    let mut seeds: Vec<(u32, u32)> = Vec::new();
    let fans = search.fans.as_flattened();
    let mut seen = vec![false; search.around.len()];
    for corner in 0..fans.len() as u32 {
        let fan = fans[corner as usize];
        if search.is_seed(fan) && !std::mem::replace(&mut seen[fan as usize], true) {
            seeds.push((search.number(fan), corner));
        }
    }
    seeds.sort_unstable_by(|a, b| b.cmp(a));
    let mut lowest = 0;
    for (number, corner) in seeds {
        // Vertices before all midpoints so far may be of a coarser level.
        if number < lowest {
            break;
        }
        if let Some(found) = find_region(search, corner) {
            lowest = if lowest == 0 { found } else { lowest.min(found) };
        }
    }
}

/// Finds the region in which a vertex is a midpoint: of several the one whose first midpoint comes last. Returns the number of
/// this midpoint.
fn find_region(search: &mut Search<'_, impl Fn(u32) -> bool>, corner: u32) -> Option<u32> {
    // Half-edges into the vertex, in order around it.
    let mut into = [NONE; 5];
    let mut half_edge = turned(corner, 2);
    for slot in &mut into {
        *slot = half_edge;
        half_edge = search.complex.next(turned(half_edge, 1));
    }
    let fans = search.fans.as_flattened();
    let ends_here = |&half_edge: &u32| fans[turned(half_edge, 1) as usize] == fans[corner as usize];
    if !search.is_free(corner) || half_edge != into[0] || !into.iter().all(ends_here) {
        return None;
    }
    let mut best: Option<(u32, usize, [u32; 2])> = None;
    for k in 0..5 {
        let side = [into[k], into[(k + 1) % 5]];
        if search.region(side) {
            best = best.max(Some((search.first_midpoint(), search.size(), side)));
            search.forget();
        }
    }
    let (first, _, side) = best?;
    search.region(side).then_some(first)
}

/// A layer about to be merged.
struct Coarser<'a> {
    layer: &'a Peeled,
    fans: &'a [[u32; 3]],
    merges: &'a [super::merge::Merge],
    /// Per face its merge, or `NONE`.
    merge_of: &'a [u32],
    /// Per edge the other half of its coarse edge, or itself.
    mates: &'a [u32],
}

impl Coarser<'_> {
    /// Returns the coarser layer, and the fans at its corners. In the order of the lowest triangles.
    fn make(&self, tower: &mut Tower) -> (Peeled, Vec<[u32; 3]>) {
        let complex = &self.layer.complex;
        let mut number = vec![NONE; complex.edge_count];
        let mut count = 0;
        let mut edge_of = |edge: u32| {
            let number = &mut number[edge.min(self.mates[edge as usize]) as usize];
            if *number == NONE {
                *number = count;
                count += 1;
            }
            *number
        };
        let mut made = vec![false; self.merges.len()];
        let (mut lowest, mut corners, mut edges, mut turns) =
            (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let (mut fans, mut nodes) = (Vec::new(), Vec::new());
        for face in 0..complex.face_count() {
            let merge = self.merge_of[face];
            if merge == NONE {
                corners.push(complex.corners[face]);
                edges.push(complex.edges[face].map(&mut edge_of));
                turns.push(complex.turns.get(face).copied().unwrap_or(0b111));
                fans.push(self.fans[face]);
                nodes.push(self.layer.nodes[face]);
            } else if !std::mem::replace(&mut made[merge as usize], true) {
                let merge = &self.merges[merge as usize];
                corners.push(merge.corners.map(|corner| complex.corners.as_flattened()[corner as usize]));
                edges.push(merge.sides.map(|side| edge_of(side[0])));
                turns.push(merge.turns);
                fans.push(merge.corners.map(|corner| self.fans.as_flattened()[corner as usize]));
                let named = |corner: u32| match corner {
                    NONE => NONE,
                    _ => 3 * self.layer.nodes[(corner / 3) as usize] + corner % 3,
                };
                nodes.push(match merge.is_split {
                    true => tower.add_split(merge.faces.map(named)),
                    false => tower.add_closing(Closing {
                        lowest: complex.lowest[face],
                        corners: merge.corners.map(named),
                        midpoints: merge.midpoints.map(named),
                    }),
                });
            } else {
                continue;
            }
            lowest.push(complex.lowest[face]);
        }
        let mut coarse = Complex::new(lowest, corners, edges, count as usize);
        coarse.turns = turns;
        (Peeled { complex: coarse, nodes }, fans)
    }
}
