//! The largest distance to within a proven bound: branch and bound, from the largest sample.
//!
//! ```text
//!     known: some point is L away        what can a piece of the surface come to?
//!       /\        U <= L: dropped          its corners' distances and its extent say U;
//!      /--\       U > L:  cut in four      and a triangle T of the other surface is convex, so that no point of
//!     /_\/_\      until U and L meet       the piece is farther from T than its farthest corner: U again
//! ```
//!
//! After Guthe, Borodin and Klein, "Fast and accurate Hausdorff distance calculation between meshes", WSCG 2005, and
//! Tang, Lee and Kim, "Interactive Hausdorff distance computation for general polygonal models", SIGGRAPH 2009. Most of
//! a surface is dropped without a query: its corners lie far nearer than L.

use glam::DVec3;

use crate::geometry::{
    bvh::{Bvh, Walker},
    parallel::map_chunks,
    triangle::{Corners, closest_on_triangle},
};

/// Relative gap at which the bounds count as equal.
const CLOSE: f64 = 1e-3;
/// Gap at which the bounds count as equal, as a share of the surface's size: above rounding.
const ROUNDING: f64 = 1e-9;
/// Pieces of a unit of work.
const CHUNK: usize = 256;

/// A distance, and the two points between which it was measured.
pub(super) type Found = (f64, (DVec3, DVec3));

/// A part of a triangle, and an upper bound of the distance of its points.
struct Piece {
    corners: Corners,
    bound: f64,
}

/// Returns the largest distance from a surface to another, at least `found`, and a proven upper bound. `corner` returns
/// the distances at the corners of a slot. Refines at most `budget` pieces. When they run out, the bound is looser but
/// still holds.
pub(super) fn largest(
    from: &Bvh,
    to: &Bvh,
    corner: impl Fn(u32) -> [f64; 3],
    mut found: Found,
    budget: usize,
) -> (Found, f64) {
    let rounding = ROUNDING * from.size().max(to.size());
    let close = |found: &Found| found.0 * (1.0 + CLOSE) + rounding;
    let mut dropped = 0.0f64;
    let mut left = budget;
    let mut pieces: Vec<Piece> = Vec::new();
    for slot in 0..from.len() as u32 {
        let corners = from.corners(slot);
        let bound = by_extent(&corners, corner(slot));
        if bound > close(&found) {
            pieces.push(Piece { corners, bound });
        } else {
            dropped = dropped.max(bound);
        }
    }
    while !pieces.is_empty() {
        // Pieces of the largest bound first.
        pieces.sort_by(|a, b| b.bound.total_cmp(&a.bound));
        if pieces.len() > left {
            dropped = dropped.max(pieces[left].bound);
            pieces.truncate(left);
        }
        left -= pieces.len();
        let looked_at = map_chunks(pieces.len(), CHUNK, |range| {
            let mut walker = to.walker();
            pieces[range].iter().map(|piece| look_at(piece, to, &mut walker)).collect::<Vec<_>>()
        });
        let looked_at = looked_at.concat();
        for &(_, seen) in &looked_at {
            if seen.0 > found.0 {
                found = seen;
            }
        }
        let mut next = Vec::new();
        for (piece, (bound, _)) in pieces.iter().zip(looked_at) {
            if bound > close(&found) {
                next.extend(cut(&piece.corners).map(|corners| Piece { corners, bound }));
            } else {
                dropped = dropped.max(bound);
            }
        }
        pieces = next;
    }
    (found, dropped.max(found.0))
}

/// Bounds the distance of a piece: no point is farther than the distance at a corner plus the way to that corner.
fn by_extent(corners: &Corners, distances: [f64; 3]) -> f64 {
    let reach = |i: usize| {
        corners.iter().map(|p| (*p - corners[i]).length()).fold(distances[i], |a, b| a.max(distances[i] + b))
    };
    reach(0).min(reach(1)).min(reach(2))
}

/// Returns a bound of a piece, and the larger of the distances at its middle and at the corner giving the bound.
fn look_at(piece: &Piece, to: &Bvh, walker: &mut Walker<'_>) -> (f64, Found) {
    let corners = &piece.corners;
    let middle = corners[0] + ((corners[1] - corners[0]) + (corners[2] - corners[0])) / 3.0;
    let mut ask = |point: DVec3| {
        let nearest = walker.closest(point);
        (nearest.slot, (nearest.distance_squared.sqrt(), (point, nearest.point)))
    };
    let (slot, seen) = ask(middle);
    let triangle = to.corners(slot);
    let away = corners.map(|p| closest_on_triangle(&triangle, p).1.sqrt());
    let farthest = (1..3).fold(0, |best, i| if away[i] > away[best] { i } else { best });
    let extent = corners.iter().map(|p| (*p - middle).length()).fold(0.0, f64::max);
    let bound = away[farthest].min(seen.0 + extent).min(piece.bound);
    let (_, at_corner) = ask(corners[farthest]);
    (bound, if at_corner.0 > seen.0 { at_corner } else { seen })
}

fn cut(&[a, b, c]: &Corners) -> [Corners; 4] {
    let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(p, q)| p + (q - p) * 0.5);
    [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
}
