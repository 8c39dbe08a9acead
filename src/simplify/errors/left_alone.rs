//! Points that a collapse leaves without triangles: those of triangles that hung by one corner. They are points of the input
//! no longer on the surface.
//!
//! ```text
//!     \ | /              u, v: merged. Of the triangle (u, v, c) nothing is left, and the merged point has no other: it is
//!      \|/               alone. The rest of the surface is nearest at c.
//!       c
//!      / \               c, u: merged into c. Then v is alone.
//!     u---v
//! ```
//!
//! Rules of topology allow none of this; where the topology gives, it happens.

use crate::simplify::metric::Pair;
use crate::simplify::surface::WorkingSurface;
use crate::simplify::surface::patch::Patch;

/// Returns the points that have no triangle once `pair` is merged: third corners of the removed triangles, then the merged
/// point. A point may come twice.
pub(super) fn left_alone<'a>(
    surface: &'a WorkingSurface,
    patch: &'a Patch,
    pair: Pair,
) -> impl Iterator<Item = u32> + 'a {
    let kept = patch.facets().is_empty().then_some(pair.kept);
    patch
        .opposite()
        .iter()
        .copied()
        .chain(kept)
        .filter(move |&point| is_left_alone(surface, patch, pair, point))
}

/// Returns a third corner of the removed triangles that keeps other triangles.
pub(super) fn still_there(surface: &WorkingSurface, patch: &Patch, pair: Pair) -> Option<u32> {
    patch.opposite().iter().copied().find(|&third| !is_left_alone(surface, patch, pair, third))
}

#[inline]
fn is_left_alone(surface: &WorkingSurface, patch: &Patch, pair: Pair, point: u32) -> bool {
    // Other triangles are more than the removed ones, nearly always.
    surface.valence(point) <= patch.opposite().len() && has_no_other(surface, pair, point)
}

#[cold]
fn has_no_other(surface: &WorkingSurface, pair: Pair, point: u32) -> bool {
    let goes = |others: [u32; 2]| [pair.lost, pair.kept].iter().all(|p| *p == point || others.contains(p));
    surface.star(point).all(|corner| goes(corner.others))
}
