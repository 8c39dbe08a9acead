//! The rule that keeps the topology.

use crate::mesh::NONE;
use crate::simplify::metric::Pair;
use crate::simplify::surface::classify::kind;
use crate::simplify::surface::{Facet, WorkingSurface};

use super::{Collapse, Oracle};

/// The link condition: the collapse keeps the topology (Dey et al. 1999; Berkey 3.1, read as: the only points adjacent to
/// both ends are the third corners of the edge's own triangles).
///
/// A pair without an edge (see [`Simplifier::join_distance`](crate::simplify::Simplifier::join_distance)) is allowed if
/// the two points have no common neighbour: it joins two parts on purpose.
#[derive(Debug, Clone, Copy, Default)]
pub struct LinkCondition;

impl Oracle for LinkCondition {
    fn name(&self) -> &str {
        "link"
    }

    fn keeps_topology(&self) -> bool {
        true
    }

    fn allows(&self, surface: &WorkingSurface, collapse: &Collapse) -> bool {
        let Pair { lost, kept } = collapse.pair;
        let opposite = collapse.patch.opposite();
        // Each triangle on the edge must have a third corner of its own.
        if !collapse.patch.thirds_differ()
            || opposite.len() > 1 && surface.is_border(lost) && surface.is_border(kept)
        {
            // The second condition: two borders would meet in a point.
            return false;
        }
        if (surface.kind(lost) | surface.kind(kept)) & kind::NON_MANIFOLD != 0
            && opposite.iter().any(|&third| joins_curves(surface, collapse.pair, third))
        {
            return false;
        }
        let near = Neighbourhood::new(surface, kept);
        let (mut meets, mut between_thirds) = (false, false);
        for facet in collapse.patch.facets_of_lost() {
            // Thirds are neighbours of both ends. No other point may be.
            let [a, b] = facet.others;
            let (third_a, third_b) = (collapse.patch.has_third(a), collapse.patch.has_third(b));
            meets |= (!third_a & near.contains(a)) | (!third_b & near.contains(b));
            between_thirds |= third_a & third_b;
        }
        if meets {
            return false;
        }
        // Both ends have the edge ab: if `kept` also has a triangle there, the two triangles would coincide.
        let coincides = |facet: &Facet| {
            let [a, b] = facet.others;
            collapse.patch.has_third(a) && collapse.patch.has_third(b) && has_triangle(surface, kept, a, b)
        };
        if between_thirds && collapse.patch.facets_of_lost().iter().any(coincides) {
            return false;
        }
        // If nothing of the star survives, every remaining edge must belong to another triangle.
        !collapse.patch.facets_of_lost().is_empty()
            || opposite.iter().all(|&third| is_shared_edge(surface, kept, third))
    }
}

/// Whether a third corner is joined to both ends by borders or non-manifold edges: the collapse would merge two curves
/// and remove the sheet between them.
#[cold]
fn joins_curves(surface: &WorkingSurface, pair: Pair, third: u32) -> bool {
    surface.ends_sheet(pair.lost, third) && surface.is_curve_edge(pair.kept, third)
}

/// Whether at least two triangles share an edge.
fn is_shared_edge(surface: &WorkingSurface, u: u32, v: u32) -> bool {
    // Searches the side with fewer triangles: the other may be a hub.
    let (from, to) = if surface.valence(u) <= surface.valence(v) { (u, v) } else { (v, u) };
    surface.star(from).filter(|corner| corner.others.contains(&to)).nth(1).is_some()
}

fn has_triangle(surface: &WorkingSurface, point: u32, a: u32, b: u32) -> bool {
    let mut corners = [point, a, b];
    corners.sort_unstable_by_key(|&p| surface.valence(p));
    let [from, p, q] = corners;
    surface.star(from).any(|corner| corner.others == [p, q] || corner.others == [q, p])
}

/// Tests for neighbours of a point: in a short list of fixed length (compared in a few vector instructions), or for a
/// hub by a search.
struct Neighbourhood<'a> {
    surface: &'a WorkingSurface,
    point: u32,
    list: [u32; 16],
    listed: bool,
}

impl<'a> Neighbourhood<'a> {
    #[inline]
    fn new(surface: &'a WorkingSurface, point: u32) -> Self {
        let mut list = [NONE; 16];
        let count = surface.few_neighbours(point, &mut list);
        Self { surface, point, list, listed: count <= 16 }
    }

    #[inline]
    fn contains(&self, other: u32) -> bool {
        if self.listed {
            self.list.iter().fold(false, |any, &n| any | (n == other))
        } else {
            self.search(other)
        }
    }

    #[cold]
    fn search(&self, other: u32) -> bool {
        self.surface.is_edge(self.point, other)
    }
}
