//! Rules for collapses that make a base: the flattened star must be covered by the new triangles, and the base should be even.

use glam::{DVec2, DVec3};

use crate::simplify::{Collapse, Corner, Oracle, WorkingSurface};

use super::flatten::{flatten, is_fan};

/// Most triangles around a point of the base.
const LARGEST_VALENCE: usize = 12;
/// Valences from here on are put off.
const EVEN_VALENCE: usize = 8;

/// Allows a collapse if the star of the lost point, flattened sector by sector, is covered by the triangles around the kept
/// point, each facing up: the map between both triangulations is then one to one.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Flattens;

impl Oracle for Flattens {
    fn name(&self) -> &str {
        "flattening"
    }

    fn allows(&self, surface: &WorkingSurface, collapse: &Collapse) -> bool {
        let (lost, kept) = (collapse.pair.lost, collapse.pair.kept);
        let valence = surface.valence(lost);
        if valence > 2 * LARGEST_VALENCE {
            return false;
        }
        let mut star: Vec<(u32, Corner)> = surface
            .star(lost)
            .map(|corner| (surface.corner_vertices(corner.triangle)[usize::from(corner.slot)], corner))
            .collect();
        star.sort_unstable_by_key(|(sector, corner)| (*sector, corner.triangle));
        let at = |point: u32| DVec3::from_array(surface.position(point).map(f64::from));
        let (mut ring, mut positions, mut flat) = (Vec::new(), Vec::new(), Vec::<DVec2>::new());
        star.chunk_by(|a, b| a.0 == b.0).all(|sector| {
            let Some(closed) = walk(sector.iter().map(|(_, corner)| corner.others), &mut ring, |_| {}) else {
                return false;
            };
            positions.clear();
            positions.extend(ring.iter().map(|&point| at(point)));
            let hub = ring.iter().position(|&point| point == kept);
            hub.is_some_and(|hub| {
                (closed || hub == 0 || hub + 1 == ring.len())
                    && flatten(at(lost), &positions, closed, &mut flat)
                    && is_fan(&flat, hub)
            })
        })
    }
}

/// Puts the triangles around a vertex in order, each given by its two other corners; `visit` gets their numbers. Returns
/// whether they form a closed ring; `None` if they do not form a single fan.
pub(super) fn walk(
    others: impl ExactSizeIterator<Item = [u32; 2]> + Clone,
    ring: &mut Vec<u32>,
    mut visit: impl FnMut(usize),
) -> Option<bool> {
    ring.clear();
    let count = others.len();
    let start = others.clone().position(|[a, _]| others.clone().all(|[_, b]| a != b));
    let mut at = start.unwrap_or(0);
    let first = others.clone().nth(at)?[0];
    ring.push(first);
    for step in 0..count {
        visit(at);
        let [_, to] = others.clone().nth(at)?;
        if step + 1 == count {
            if start.is_some() {
                ring.push(to);
                return Some(false);
            }
            return (to == first).then_some(true);
        }
        if to == first {
            return None;
        }
        ring.push(to);
        at = others.clone().position(|[a, _]| a == to)?;
    }
    None
}

/// Puts off collapses after which a point has more than [`EVEN_VALENCE`] triangles, or fewer than 4; refuses more than
/// [`LARGEST_VALENCE`].
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct EvenValence;

impl Oracle for EvenValence {
    fn name(&self) -> &str {
        "valence"
    }

    fn allows(&self, surface: &WorkingSurface, collapse: &Collapse) -> bool {
        let gone = collapse.patch.opposite().len();
        let kept = surface.valence(collapse.pair.kept) + surface.valence(collapse.pair.lost) - 2 * gone;
        kept <= EVEN_VALENCE
            && collapse
                .patch
                .opposite()
                .iter()
                .all(|&third| surface.valence(third) > 4 || surface.is_border(third))
    }

    fn surcharge(&self) -> Option<f32> {
        Some(16.0)
    }
}

/// Refuses valences above [`LARGEST_VALENCE`].
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct LimitedValence;

impl Oracle for LimitedValence {
    fn name(&self) -> &str {
        "largest valence"
    }

    fn allows(&self, surface: &WorkingSurface, collapse: &Collapse) -> bool {
        let gone = collapse.patch.opposite().len();
        surface.valence(collapse.pair.kept) + surface.valence(collapse.pair.lost) - 2 * gone
            <= LARGEST_VALENCE
    }
}
