//! Kinds of points and edges: border, seam, material border, non-manifold, or ordinary.
//!
//! A point is classified by walking over its star: at the start, and again where parts were joined or a feature moved.
//! An edge is classified when asked about, from the end with fewer triangles.

use crate::geometry::sets::Sets;
use crate::mesh::NONE;
use crate::simplify::surface::patch::Patch;
use crate::simplify::surface::{Corner, WorkingSurface};

use super::sheets::{LayerEdge, edge_between};

/// Kinds of a point, as bits.
pub(crate) mod kind {
    /// On an open border.
    pub const BORDER: u16 = 1;
    /// On an edge of three or more triangles, or where several fans meet.
    pub const NON_MANIFOLD: u16 = 2;
    /// On an edge across which the wedge changes.
    pub const SEAM: u16 = 4;
    /// On an edge between two materials.
    pub const MATERIAL: u16 = 8;
    /// Locked by the caller.
    pub const LOCKED: u16 = 16;
    /// Exactly two feature edges meet here: the point may slide along them.
    pub const CURVE: u16 = 32;
    /// Its corners do not list each neighbour exactly once as "next" (border, non-manifold, clashing orientation).
    pub const IRREGULAR: u16 = 64;
    /// Its triangles name several vertices. May stay set after they no longer do.
    pub const WEDGES: u16 = 128;
    /// On a curve of the input, or on the image of a curve (`curves.rs`).
    pub const ON_CURVE: u16 = 256;
    /// On an edge of any kind whose edges must stay edges.
    pub const FEATURE: u16 = BORDER | NON_MANIFOLD | SEAM | MATERIAL;
}

/// Points with more triangles are not walked at every change.
const LARGE_HUB: usize = 512;
/// A large hub is walked again after valence / HUB_SHARE changes.
const HUB_SHARE: usize = 16;

impl WorkingSurface {
    /// Whether edges of this kind must stay edges.
    pub(crate) fn holds(&self, bit: u16) -> bool {
        self.held & bit != 0
    }

    /// Releases edges of this kind: from now on they count as ordinary edges. O(corners).
    pub(crate) fn release(&mut self, bit: u16) {
        self.held &= !bit;
        self.classify();
    }

    /// Classifies every point. O(corners).
    pub(crate) fn classify(&mut self) {
        self.scratch.seen = vec![SeenNeighbour::default(); self.positions.len()];
        for point in 0..self.positions.len() as u32 {
            self.classify_point(point);
        }
    }

    /// Classifies a point and its neighbours again, after `lost` was merged into it by the collapse of a patch which joined two
    /// parts, broke the topology (`is_broken`) or moved a feature.
    ///
    /// A hub is walked only once a share of its triangles has changed: each walk at each merge would take quadratic time. Until
    /// then it counts as everything that it may have become, so rules refuse rather more than they would.
    pub(crate) fn reclassify_around(&mut self, point: u32, lost: u32, patch: &Patch, is_broken: bool) {
        let mut gained = self.kinds[lost as usize] & (kind::FEATURE | kind::IRREGULAR);
        if is_broken {
            gained |= kind::NON_MANIFOLD | kind::IRREGULAR;
        }
        let is_walked = self.classify_in_time(point, gained);
        let mut around = std::mem::take(&mut self.scratch.moved);
        around.clear();
        if is_walked {
            around.extend(self.star(point).flat_map(|corner| corner.others));
        } else {
            // Other neighbours have the triangles that they had.
            around.extend(patch.facets_of_lost().iter().flat_map(|facet| facet.others));
            around.extend(patch.opposite());
        }
        // Visit each neighbour once: a neighbour may be a hub, and share many triangles with this point.
        around.sort_unstable();
        around.dedup();
        for &neighbour in &around {
            self.classify_in_time(neighbour, gained);
        }
        self.scratch.moved = around;
    }

    /// Classifies the large hubs which have changed since their last walks. Returns them.
    pub(crate) fn walk_hubs(&mut self) -> Vec<u32> {
        let mut hubs = std::mem::take(&mut self.scratch.unwalked_hubs);
        hubs.retain(|&hub| std::mem::take(&mut self.scratch.unwalked[hub as usize]) > 0);
        for &hub in &hubs {
            self.classify_point(hub);
        }
        hubs
    }

    /// Classifies a point, or adds what it may have gained to a large hub walked a few changes ago. Whether it was walked.
    fn classify_in_time(&mut self, point: u32, gained: u16) -> bool {
        let is_time = self.is_time_to_walk(point);
        if is_time {
            self.classify_point(point);
        } else {
            // Whether two features meet there is unknown.
            let kinds = &mut self.kinds[point as usize];
            *kinds = (*kinds | gained) & !kind::CURVE;
        }
        is_time
    }

    /// Counts a change around a point. Whether it may be walked: always, except for a large hub walked a few changes ago.
    fn is_time_to_walk(&mut self, point: u32) -> bool {
        let valence = self.valence(point);
        if valence <= LARGE_HUB {
            return true;
        }
        if self.scratch.unwalked.is_empty() {
            self.scratch.unwalked = vec![0; self.positions.len()];
        }
        let changes = &mut self.scratch.unwalked[point as usize];
        if *changes == 0 {
            self.scratch.unwalked_hubs.push(point);
        }
        *changes += 1;
        let is_time = *changes as usize >= valence / HUB_SHARE;
        if is_time {
            *changes = 0;
        }
        is_time
    }

    /// Whether the triangles around a point form a single closed ring with consistent orientation; only tried for
    /// common valences. Such a point has no feature edge unless by a seam or material.
    #[inline]
    fn is_plain_ring(&self, point: u32) -> bool {
        let count = self.valence(point);
        if !(3..=16).contains(&count) {
            return false;
        }
        if count <= 8 { self.is_ring_of::<8>(point, count) } else { self.is_ring_of::<16>(point, count) }
    }

    /// Walks around the point: from each corner's last neighbour to the corner listing it as next. Compares all corners
    /// at once, since a search would mispredict a branch.
    #[inline]
    fn is_ring_of<const N: usize>(&self, point: u32, count: usize) -> bool {
        let (mut next, mut last) = ([NONE; N], [0; N]);
        for ((next, last), corner) in next.iter_mut().zip(&mut last).zip(self.star(point)) {
            [*next, *last] = corner.others;
        }
        let (first, mut at) = (next[0], last[0]);
        let mut is_ring = true;
        for _ in 1..count {
            is_ring &= at != first;
            let (mut to, mut found) = (0, 0);
            for (&next, &last) in next.iter().zip(&last) {
                let is_it = u32::from(next == at);
                to |= last & is_it.wrapping_neg();
                found += is_it;
            }
            is_ring &= found == 1;
            at = to;
        }
        // Back at the start after as many steps as triangles: each triangle was passed once.
        is_ring & (at == first)
    }

    /// Classifies a point by a single walk over its star, with marks: O(valence).
    fn classify_point(&mut self, point: u32) {
        let is_bare = self.corner_vertices.is_empty() && self.materials.is_empty() && !self.has_sheets();
        if is_bare && self.is_plain_ring(point) {
            self.kinds[point as usize] &= kind::LOCKED | kind::ON_CURVE;
            return;
        }
        self.kinds[point as usize] = self.walk_star(point, self.held);
    }

    /// Returns the kind of a point if edges of every kind had to stay. O(valence).
    pub(crate) fn kind_if_held(&mut self, point: u32) -> u16 {
        self.walk_star(point, kind::FEATURE)
    }

    /// Returns the kind of a point, where edges of the kinds in `held` must stay.
    fn walk_star(&mut self, point: u32, held: u16) -> u16 {
        let mut seen = std::mem::take(&mut self.scratch.seen);
        let mut neighbours = std::mem::take(&mut self.scratch.neighbours);
        neighbours.clear();
        let mut wedge = NONE;
        let mut wedges = 0;
        for corner in self.star(point) {
            if self.has_seams() {
                for layer in self.layers(corner.triangle) {
                    let own = layer.vertices[corner.slot as usize];
                    wedges |= if wedge != NONE && wedge != own { kind::WEDGES } else { 0 };
                    wedge = own;
                }
            }
            for side in 0..2 {
                let n = corner.others[side];
                let entry = &mut seen[n as usize];
                if entry.count == 0 {
                    neighbours.push(n);
                    entry.first = self.edge_vertices(corner, side);
                    entry.material = self.material(corner.triangle);
                    entry.triangle = corner.triangle;
                } else if self.are_layered([entry.triangle, corner.triangle]) {
                    entry.bits |= self.sheet_edge([entry.triangle, corner.triangle], [point, n]);
                } else {
                    let seam = self.edge_vertices(corner, side) != entry.first;
                    let border = self.material(corner.triangle) != entry.material;
                    entry.bits |= if seam { kind::SEAM } else { 0 } | if border { kind::MATERIAL } else { 0 };
                }
                entry.count += 1;
                if side == 0 {
                    entry.next += 1;
                    entry.follow = corner.others[1];
                }
            }
        }
        let (mut bits, mut features) =
            (self.kinds[point as usize] & (kind::LOCKED | kind::ON_CURVE) | wedges, 0u32);
        for &n in &neighbours {
            let entry = &seen[n as usize];
            let edge = match entry.count {
                1 => kind::BORDER,
                2 => entry.bits & held,
                _ => entry.bits & held | kind::NON_MANIFOLD,
            };
            bits |= edge | if entry.next == 1 { 0 } else { kind::IRREGULAR };
            features += u32::from(edge != 0);
        }
        if bits & kind::NON_MANIFOLD == 0 {
            let single = if bits & kind::IRREGULAR == 0 {
                ring_length(&seen, &neighbours) == neighbours.len()
            } else {
                self.fan_length(point) == self.valence(point)
            };
            bits |= if single { 0 } else { kind::NON_MANIFOLD };
            features += if single { 0 } else { 3 };
        }
        bits |= if features == 2 { kind::CURVE } else { 0 };
        for &n in &neighbours {
            seen[n as usize] = SeenNeighbour::default();
        }
        self.scratch.seen = seen;
        self.scratch.neighbours = neighbours;
        bits
    }

    /// Returns the number of triangles around a point reachable from the first across shared edges: less than the
    /// valence where several fans meet. O(valence log valence).
    fn fan_length(&self, point: u32) -> usize {
        let mut ends: Vec<(u32, u32)> = Vec::with_capacity(2 * self.valence(point));
        for (i, corner) in self.star(point).enumerate() {
            ends.extend(corner.others.map(|o| (o, i as u32)));
        }
        ends.sort_unstable();
        let mut fans = Sets::new(self.valence(point));
        for pair in ends.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
            fans.join(pair[0].1, pair[1].1);
        }
        (0..fans.len() as u32).filter(|&i| fans.find(i) == 0).count()
    }

    /// Returns the kind of the edge between two points, as `kind` bits: 0 for an ordinary edge, `None` where there is
    /// no edge.
    pub(crate) fn edge_kind(&self, u: u32, v: u32) -> Option<u16> {
        self.edge_kind_if_held(u, v).map(|bits| bits & self.held)
    }

    /// Returns the kind of an edge if edges of every kind had to stay.
    pub(crate) fn edge_kind_if_held(&self, u: u32, v: u32) -> Option<u16> {
        // Walk the end with fewer triangles: the other end may be a hub.
        let (u, v) = if self.valence(u) <= self.valence(v) { (u, v) } else { (v, u) };
        let mut first: Option<(Corner, [u32; 2])> = None;
        let mut count = 0;
        let mut bits = 0;
        for corner in self.star(u) {
            let Some(side) = corner.others.iter().position(|&o| o == v) else { continue };
            count += 1;
            let ends = self.edge_vertices(corner, side);
            match first {
                None => first = Some((corner, ends)),
                Some((other, _)) if self.are_layered([other.triangle, corner.triangle]) => {
                    bits |= self.sheet_edge([other.triangle, corner.triangle], [u, v]);
                }
                Some((other, other_ends)) => {
                    bits |= if ends != other_ends { kind::SEAM } else { 0 };
                    let differ = self.material(corner.triangle) != self.material(other.triangle);
                    bits |= if differ { kind::MATERIAL } else { 0 };
                }
            }
        }
        match count {
            0 => None,
            1 => Some(kind::BORDER),
            2 => Some(bits),
            _ => Some(bits | kind::NON_MANIFOLD),
        }
    }

    /// Whether two points share an edge on a border or of three or more triangles, of the kinds which must stay. Stops at the
    /// third triangle.
    pub(crate) fn ends_sheet(&self, u: u32, v: u32) -> bool {
        let (from, to) = if self.valence(u) <= self.valence(v) { (u, v) } else { (v, u) };
        let has_third = || self.star(from).filter(|corner| corner.others.contains(&to)).nth(2).is_some();
        self.holds(kind::NON_MANIFOLD) && has_third()
            || self.edge_kind(u, v).is_some_and(|edge| edge & (kind::BORDER | kind::NON_MANIFOLD) != 0)
    }

    /// Whether two points share an edge of a kind other than ordinary. Stops early: the third triangle on an edge
    /// decides.
    pub(crate) fn is_feature_edge(&self, u: u32, v: u32) -> bool {
        if self.has_sheets() {
            return self.edge_kind(u, v).is_some_and(|kind| kind != 0);
        }
        let (u, v) = if self.valence(u) <= self.valence(v) { (u, v) } else { (v, u) };
        let mut first: Option<(u32, [u32; 2])> = None;
        let mut count = 0;
        for corner in self.star(u) {
            let Some(side) = corner.others.iter().position(|&o| o == v) else { continue };
            count += 1;
            let material = if self.holds(kind::MATERIAL) { self.material(corner.triangle) } else { 0 };
            let ends = if self.holds(kind::SEAM) { self.edge_vertices(corner, side) } else { [0; 2] };
            if count > 2 || *first.get_or_insert((material, ends)) != (material, ends) {
                return true;
            }
        }
        count == 1
    }

    /// Whether either of two triangles has further layers with other attributes.
    #[inline]
    fn are_layered(&self, triangles: [u32; 2]) -> bool {
        self.has_sheets() && triangles.iter().any(|&triangle| self.is_layered(triangle))
    }

    /// Returns the kind of the edge between two points by the layers of two triangles on it, as `kind` bits.
    fn sheet_edge(&self, triangles: [u32; 2], [u, v]: [u32; 2]) -> u16 {
        let [before, beyond] = triangles.map(|triangle| {
            let corners = self.triangle(triangle).unwrap_or([NONE; 3]);
            let [a, b] = [u, v].map(|end| corners.iter().position(|&p| p == end).unwrap_or(0));
            let forward = (a + 1) % 3 == b;
            self.layers(triangle).map(move |layer| -> LayerEdge {
                (forward != layer.opposite, [layer.vertices[a], layer.vertices[b]], layer.material)
            })
        });
        edge_between(before, beyond)
    }

    /// Returns the vertices of the corner's point and of `corner.others[side]`.
    #[inline]
    fn edge_vertices(&self, corner: Corner, side: usize) -> [u32; 2] {
        if self.corner_vertices.is_empty() {
            return [0, 0];
        }
        let vertices = self.corner_vertices[corner.triangle as usize];
        [vertices[corner.slot as usize], vertices[(corner.slot as usize + 1 + side) % 3]]
    }
}

/// Returns the number of neighbours on the ring starting at the first neighbour, where each neighbour has exactly one
/// follower.
fn ring_length(seen: &[SeenNeighbour], neighbours: &[u32]) -> usize {
    let Some(&first) = neighbours.first() else { return 0 };
    let (mut at, mut length) = (seen[first as usize].follow, 1);
    while at != first && length <= neighbours.len() {
        at = seen[at as usize].follow;
        length += 1;
    }
    length
}

/// State of a neighbour while a star is walked.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct SeenNeighbour {
    count: u32,
    next: u32,
    /// Neighbour after this neighbour around the point.
    follow: u32,
    first: [u32; 2],
    material: u32,
    /// First triangle with this neighbour.
    triangle: u32,
    bits: u16,
}
