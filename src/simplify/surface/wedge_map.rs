//! Maps the wedges of a merged point.
//!
//! ```text
//!          w1                a and b are wedges of `lost` on either side of a seam, c and d of `kept`.
//!      a  /  \ c             The triangles on the edge say a -> c and b -> d.
//!   lost ====== kept
//!      b  \  / d             A wedge without a triangle on the edge goes to the wedge of its own chart, if `kept`
//!          w2                has one; else to the nearest in value that mirrors nothing; or, where new vertices
//!                            may be made and none is near, it keeps its values at the new place.
//! ```
//!
//! Each layer of a sheet has its own wedges, mapped by the triangles of the same layer.

use crate::simplify::metric::Pair;

use super::WorkingSurface;
use super::sheets::Layer;

/// Most wedges of the lost point in a map; with more, the map [overflows](WedgeMap::overflows).
const FEW: usize = 16;
/// Most corners around a point searched for wedges.
const CORNERS: usize = 64;

/// Target of each wedge of the lost point.
#[derive(Debug, Clone, Default)]
pub(crate) struct WedgeMap {
    /// `[from, to]`; a wedge keeping its values maps to itself.
    pairs: [[u32; 2]; FEW],
    len: usize,
    /// Number of pairs sharing a chart, which come first. The other pairs were chosen by value.
    linked: usize,
    /// `[from, to]`: wedges of the kept point to be merged, since a wedge of the lost point has triangles with both.
    joined: [[u32; 2]; FEW],
    joins: usize,
    complete: bool,
    overflows: bool,
}

impl WedgeMap {
    /// Builds the map of a pair from the triangles on its edge only.
    pub fn new(surface: &WorkingSurface, pair: Pair) -> Self {
        let mut map = Self { complete: true, ..Self::default() };
        // The edge's triangles are found from the end with fewer triangles: the other end may be a hub.
        let turned =
            surface.valence(pair.lost) > 16 && surface.valence(pair.kept) < surface.valence(pair.lost);
        let (point, other) = if turned { (pair.kept, pair.lost) } else { (pair.lost, pair.kept) };
        for corner in surface.star(point) {
            let Some(side) = corner.others.iter().position(|&o| o == other) else { continue };
            let slots = [corner.slot as usize, (corner.slot as usize + 1 + side) % 3];
            let slots = if turned { [slots[1], slots[0]] } else { slots };
            if surface.is_layered(corner.triangle) {
                surface.layers(corner.triangle).for_each(|layer| map.add(slots.map(|i| layer.vertices[i])));
            } else {
                let vertices = surface.corner_vertices(corner.triangle);
                map.add(slots.map(|i| vertices[i]));
            }
        }
        if map.complete {
            map.complete = surface.star(pair.lost).all(|corner| {
                let goes = |vertices: [u32; 3]| map.get(vertices[corner.slot as usize]).is_some();
                goes(surface.corner_vertices(corner.triangle))
                    && (!surface.is_layered(corner.triangle)
                        || surface.layers(corner.triangle).all(|layer| goes(layer.vertices)))
            });
        }
        map.linked = map.len;
        map
    }

    /// Records the pair of wedges on a triangle at the edge.
    #[inline]
    fn add(&mut self, [from, to]: [u32; 2]) {
        let to = self.root(to);
        match self.get(from) {
            Some(known) if known == to => {}
            Some(known) => self.join(to, known),
            None => self.push(from, to),
        }
    }

    /// Builds the map of a pair with a target for every wedge, unless it [overflows](Self::overflows).
    pub fn chosen(surface: &WorkingSurface, pair: Pair) -> Self {
        let mut map = Self::new(surface, pair);
        if !map.complete && !map.overflows {
            map.choose(surface, pair);
        }
        map
    }

    /// Returns true if the triangles on the edge alone give each wedge exactly 1 target.
    pub fn is_complete(&self) -> bool {
        self.complete
    }

    /// Returns true if there are too many wedges to keep apart.
    pub fn overflows(&self) -> bool {
        self.overflows
    }

    /// Returns true if wedges of the kept point are merged.
    pub fn joins_kept(&self) -> bool {
        self.joins > 0 || self.overflows
    }

    /// Returns the target of a wedge of the lost point: itself where it keeps its values.
    #[inline]
    pub fn get(&self, from: u32) -> Option<u32> {
        self.pairs().iter().find(|pair| pair[0] == from).map(|pair| self.root(pair[1]))
    }

    /// Returns the image of a wedge of the kept point: itself unless merged.
    #[inline]
    pub fn root(&self, mut kept: u32) -> u32 {
        if self.joins == 0 {
            return kept;
        }
        while let Some(&[_, to]) = self.joined[..self.joins].iter().find(|pair| pair[0] == kept) {
            kept = to;
        }
        kept
    }

    /// Returns the first wedge of the lost point sharing a chart with a wedge of the kept point.
    pub fn partner(&self, kept: u32) -> Option<u32> {
        self.pairs[..self.linked].iter().find(|pair| self.root(pair[1]) == kept).map(|pair| pair[0])
    }

    /// All pairs `[from, to]`.
    pub fn pairs(&self) -> &[[u32; 2]] {
        &self.pairs[..self.len]
    }

    fn push(&mut self, from: u32, to: u32) {
        match self.pairs.get_mut(self.len) {
            Some(pair) => {
                *pair = [from, to];
                self.len += 1;
            }
            None => (self.complete, self.overflows) = (false, true),
        }
    }

    /// Merges two different wedges of the kept point.
    fn join(&mut self, from: u32, to: u32) {
        self.complete = false;
        match self.joined.get_mut(self.joins) {
            Some(pair) => {
                *pair = [from, to];
                self.joins += 1;
            }
            None => self.overflows = true,
        }
    }

    /// Chooses targets for the wedges without any.
    fn choose(&mut self, surface: &WorkingSurface, pair: Pair) {
        for from in wedges_of(surface, pair.lost) {
            if self.get(from).is_none()
                && let Some(to) = by_chart(surface, pair, from)
            {
                self.push(from, to);
            }
        }
        self.linked = self.len;
        let mut kept = [0; FEW];
        let mut count = 0;
        for wedge in wedges_of(surface, pair.kept).take(CORNERS) {
            if count < FEW && !kept[..count].contains(&wedge) {
                kept[count] = wedge;
                count += 1;
            }
        }
        for from in wedges_of(surface, pair.lost) {
            if self.get(from).is_none() {
                let to = by_value(surface, pair, from, &kept[..count]);
                self.push(from, to);
            }
        }
    }
}

/// Returns the wedges at the corners around a point, on every layer of a sheet; some several times.
fn wedges_of(surface: &WorkingSurface, point: u32) -> impl Iterator<Item = u32> + '_ {
    surface.star(point).flat_map(|corner| {
        surface.layers(corner.triangle).map(move |layer| layer.vertices[corner.slot as usize])
    })
}

/// Returns the wedge of the kept point next to a vertex which is also next to the lost point's wedge `from`.
fn by_chart(surface: &WorkingSurface, pair: Pair, from: u32) -> Option<u32> {
    for corner in surface.star(pair.lost) {
        let slot = corner.slot as usize;
        let Some(Layer { vertices, .. }) = surface.layers(corner.triangle).find(|l| l.vertices[slot] == from)
        else {
            continue;
        };
        for (side, &third) in corner.others.iter().enumerate() {
            let vertex = vertices[(slot + 1 + side) % 3];
            // From the side with fewer triangles: the other may be a hub.
            let (hub, centre) = if surface.valence(third) <= surface.valence(pair.kept) {
                (pair.kept, third)
            } else {
                (third, pair.kept)
            };
            for beside in surface.star(centre).take(CORNERS) {
                let Some(at) = beside.others.iter().position(|&o| o == hub) else { continue };
                let slot = beside.slot as usize;
                for layer in surface.layers(beside.triangle) {
                    let ends = [layer.vertices[slot], layer.vertices[(slot + 1 + at) % 3]];
                    let [at_third, at_kept] = if centre == third { ends } else { [ends[1], ends[0]] };
                    if at_third == vertex {
                        return Some(at_kept);
                    }
                }
            }
        }
    }
    None
}

/// Returns the wedge among `kept` nearest in value and mirroring no triangle; without any, the nearest. Where wedges
/// may move, returns `from` itself if the wedge found mirrors a triangle or is farther than `NEAR`.
fn by_value(surface: &WorkingSurface, pair: Pair, from: u32, kept: &[u32]) -> u32 {
    let values = &surface.values;
    let mut best: Option<(bool, f32, u32)> = None;
    for &to in kept {
        let mirrors = !surface.keeps_sides_of(pair, from, to);
        let option = (mirrors, values.distance_squared(from, to), to);
        let is_less = |than: (bool, f32, u32)| {
            option.0.cmp(&than.0).then(option.1.total_cmp(&than.1)).then(option.2.cmp(&than.2)).is_lt()
        };
        if best.is_none_or(is_less) {
            best = Some(option);
        }
    }
    match best {
        Some((mirrors, distance, to)) if !surface.moves_wedges || !mirrors && distance <= NEAR * NEAR => to,
        // Also for a kept point without triangles: it has no wedge to choose.
        _ => from,
    }
}

/// Difference of values up to which a wedge takes another's, as a share of the diagonal: 2 degrees of a normal.
const NEAR: f32 = 1e-4;
