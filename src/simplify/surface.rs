//! The mesh while it is being simplified: points, triangles over points, and the star of every point.
//!
//! ```text
//!          w2 ---- w1            star of u: one corner per triangle around it, in no order.
//!         /  \    /  \           Each corner knows its triangle and which of the three it is,
//!       w3 --- u ---- v          so the two others are at hand without a search.
//!         \  /    \  /
//!          w4 ---- w5            collapse u -> v: the triangles with both die, in the others u becomes v
//! ```
//!
//! Coordinates are centred and scaled by a power of two (both exact for the differences that matter), so a mesh far
//! from the origin, very large or very small behaves as the same mesh near it.

use glam::Vec3;

use crate::mesh::{Mesh, NONE, Topology};

/// Object coordinates and back: `inner = (object - centre) * scale`, in double precision; `scale` is a power of two
/// that brings the longest side of the mesh's box into [0.5, 1).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    centre: [f64; 3],
    scale: f64,
}

impl Frame {
    /// The frame of a mesh.
    pub fn new(mesh: &Mesh) -> Self {
        let Some([low, high]) = mesh.bounds() else { return Self { centre: [0.0; 3], scale: 1.0 } };
        let side = (0..3).map(|i| f64::from(high[i]) - f64::from(low[i])).fold(0.0, f64::max);
        let centre = std::array::from_fn(|i| 0.5 * (f64::from(high[i]) + f64::from(low[i])));
        // Exponent field only: exact, and the same on every platform.
        let exponent = (side.to_bits() >> 52) as i64 - 1023 + 1;
        let scale = if side > 0.0 { f64::from_bits(((1023 - exponent) as u64) << 52) } else { 1.0 };
        Self { centre, scale }
    }

    /// A position in the inner frame.
    pub fn inner(&self, object: [f32; 3]) -> [f32; 3] {
        std::array::from_fn(|i| ((f64::from(object[i]) - self.centre[i]) * self.scale) as f32)
    }

    /// A position in object units, kept finite.
    pub fn object(&self, inner: [f32; 3]) -> [f32; 3] {
        std::array::from_fn(|i| {
            let x = f64::from(inner[i]) / self.scale + self.centre[i];
            x.clamp(-f64::from(f32::MAX), f64::from(f32::MAX)) as f32
        })
    }

    /// A length in object units, rounded up.
    pub fn object_length(&self, inner: f32) -> f32 {
        let exact = f64::from(inner) / self.scale;
        let rounded = exact.min(f64::from(f32::MAX)) as f32;
        if f64::from(rounded) < exact { rounded.next_up().min(f32::MAX) } else { rounded }
    }

    /// Inner units per object unit.
    pub fn scale(&self) -> f64 {
        self.scale
    }
}

/// One triangle as seen from a point: the point is its first corner.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Corner {
    /// The triangle (its number in the input).
    pub triangle: u32,
    /// Which of its corners the point is.
    pub slot: u8,
    /// The two other corners, in the triangle's order.
    pub others: [u32; 2],
}

/// What a point is, as bits.
pub(crate) mod kind {
    /// On an open border.
    pub const BORDER: u8 = 1;
    /// On an edge of three or more triangles, or where several fans meet.
    pub const NON_MANIFOLD: u8 = 2;
    /// On an edge across which the wedge changes.
    pub const SEAM: u8 = 4;
    /// On an edge between two materials.
    pub const MATERIAL: u8 = 8;
    /// Locked by the caller.
    pub const LOCKED: u8 = 16;
    /// Exactly two feature edges meet here: it may slide along them.
    pub const CURVE: u8 = 32;
    /// Its corners do not list each neighbour exactly once as "next" (border, non-manifold, clashing orientation).
    pub const IRREGULAR: u8 = 64;
    /// Any edge that must stay an edge.
    pub const FEATURE: u8 = BORDER | NON_MANIFOLD | SEAM | MATERIAL;
}

/// The mesh while it is being simplified. Points, triangles and vertices keep the numbers of the input's
/// [`Topology`]; removed ones are simply gone from every star.
#[derive(Debug, Clone)]
pub struct Surface {
    frame: Frame,
    positions: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    /// Current vertex at each corner; empty where every point has one wedge.
    corner_vertices: Vec<[u32; 3]>,
    /// Current vertex of each point (its lowest wedge where there are several).
    point_vertex: Vec<u32>,
    materials: Vec<u32>,
    kinds: Vec<u8>,
    stars: Stars,
    live: usize,
    live_points: usize,
    scratch: Scratch,
}

/// Marks and lists that checks and collapses use, so that nothing is allocated once warm.
#[derive(Debug, Clone, Default)]
struct Scratch {
    moved: Vec<u32>,
    neighbours: Vec<u32>,
    seen: Vec<Seen>,
}

impl Surface {
    /// The surface of a mesh. Triangles with two equal points are dead from the start. O(n).
    pub fn new(mesh: &Mesh, topology: &Topology) -> Self {
        let frame = Frame::new(mesh);
        let points = topology.point_count();
        let position = |&v: &u32| Vec3::from(frame.inner(mesh.positions()[v as usize]));
        let positions: Vec<Vec3> = topology.vertex_of_point().iter().map(position).collect();
        let point_of = topology.point_of();
        let triangles: Vec<[u32; 3]> = mesh
            .triangles()
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(|v| point_of[v as usize]);
                if a == b || b == c || c == a { [NONE; 3] } else { [a, b, c] }
            })
            .collect();
        let live = triangles.iter().filter(|t| t[0] != NONE).count();
        let wedge_of = topology.wedge_of();
        let one_wedge = topology.wedge_count() == points;
        let corner_vertices = if one_wedge {
            Vec::new()
        } else {
            mesh.triangles().iter().map(|t| t.map(|v| wedge_of[v as usize])).collect()
        };
        let stars = Stars::new(&triangles, points);
        let mut surface = Self {
            frame,
            positions,
            triangles,
            corner_vertices,
            point_vertex: topology.vertex_of_point().to_vec(),
            materials: mesh.materials().to_vec(),
            kinds: vec![0; points],
            live_points: (0..points as u32).filter(|&p| !stars.of(p).is_empty()).count(),
            stars,
            live,
            scratch: Scratch::default(),
        };
        surface.classify();
        for (vertex, _) in mesh.locks().iter().enumerate().filter(|&(_, &locked)| locked) {
            surface.kinds[point_of[vertex] as usize] |= kind::LOCKED;
        }
        surface
    }

    /// The frame that positions are in.
    pub fn frame(&self) -> &Frame {
        &self.frame
    }

    /// Number of points, removed ones included.
    pub fn point_count(&self) -> usize {
        self.positions.len()
    }

    /// Number of input triangles, dead ones included.
    pub fn triangle_count(&self) -> usize {
        self.triangles.len()
    }

    /// Triangles still alive.
    pub fn live_triangles(&self) -> usize {
        self.live
    }

    /// Points that a live triangle uses.
    pub fn live_points(&self) -> usize {
        self.live_points
    }

    /// The position of a point, inner frame.
    pub fn position(&self, point: u32) -> [f32; 3] {
        self.positions[point as usize].into()
    }

    #[inline]
    pub(crate) fn at(&self, point: u32) -> Vec3 {
        self.positions[point as usize]
    }

    /// The points of a triangle; `None` once it is dead.
    pub fn triangle(&self, triangle: u32) -> Option<[u32; 3]> {
        let corners = self.triangles[triangle as usize];
        (corners[0] != NONE).then_some(corners)
    }

    /// The vertices (wedges) at a triangle's corners; of use only while it is alive.
    #[inline]
    pub fn corner_vertices(&self, triangle: u32) -> [u32; 3] {
        match self.corner_vertices.get(triangle as usize) {
            Some(&vertices) => vertices,
            None => self.triangles[triangle as usize].map(|p| self.point_vertex[p as usize]),
        }
    }

    /// Whether some point has several wedges.
    pub fn has_seams(&self) -> bool {
        !self.corner_vertices.is_empty()
    }

    /// The vertex of a point that has one wedge.
    pub(crate) fn point_vertex(&self, point: u32) -> u32 {
        self.point_vertex[point as usize]
    }

    /// The material of a triangle; 0 without materials.
    #[inline]
    pub fn material(&self, triangle: u32) -> u32 {
        self.materials.get(triangle as usize).copied().unwrap_or(0)
    }

    /// Number of triangles around a point.
    #[inline]
    pub fn valence(&self, point: u32) -> usize {
        self.stars.of(point).len()
    }

    /// The triangles around a point, in a fixed but arbitrary order.
    #[inline]
    pub fn star(&self, point: u32) -> impl ExactSizeIterator<Item = Corner> + Clone + '_ {
        self.stars.of(point).iter().map(|&entry| self.corner(entry))
    }

    /// The triangles around a point alone, in the same order.
    #[inline]
    pub(crate) fn star_triangles(&self, point: u32) -> impl ExactSizeIterator<Item = u32> + Clone + '_ {
        self.stars.of(point).iter().map(|&entry| entry >> 2)
    }

    /// Calls `visit` with every triangle that two points share.
    #[inline]
    pub(crate) fn for_shared_triangles(&self, a: u32, b: u32, mut visit: impl FnMut(u32)) {
        for triangle in self.star_triangles(a) {
            let [p, q, r] = self.triangles[triangle as usize];
            if (p == b) | (q == b) | (r == b) {
                visit(triangle);
            }
        }
    }

    #[inline]
    fn corner(&self, entry: u32) -> Corner {
        let (triangle, slot) = (entry >> 2, (entry & 3) as usize);
        let t = self.triangles[triangle as usize];
        let others = match slot {
            0 => [t[1], t[2]],
            1 => [t[2], t[0]],
            _ => [t[0], t[1]],
        };
        Corner { triangle, slot: slot as u8, others }
    }

    /// Calls `visit` with every neighbour of a point at least once (some twice where the star is irregular).
    #[inline]
    pub fn for_neighbours(&self, point: u32, mut visit: impl FnMut(u32)) {
        let irregular = self.kinds[point as usize] & kind::IRREGULAR != 0;
        for corner in self.star(point) {
            visit(corner.others[0]);
            if irregular {
                visit(corner.others[1]);
            }
        }
    }

    #[inline]
    pub(crate) fn kind(&self, point: u32) -> u8 {
        self.kinds[point as usize]
    }

    /// Whether a point lies on an open border.
    pub fn is_border(&self, point: u32) -> bool {
        self.kind(point) & kind::BORDER != 0
    }

    /// Whether a point lies on a non-manifold edge or joins several fans.
    pub fn is_non_manifold(&self, point: u32) -> bool {
        self.kind(point) & kind::NON_MANIFOLD != 0
    }

    /// Whether a point lies on a seam: an edge across which its wedge, or its neighbour's, changes.
    pub fn is_seam(&self, point: u32) -> bool {
        self.kind(point) & kind::SEAM != 0
    }

    /// Whether a point lies on an edge between two materials.
    pub fn is_material_border(&self, point: u32) -> bool {
        self.kind(point) & kind::MATERIAL != 0
    }

    /// Whether the caller locked a vertex at this point.
    pub fn is_locked(&self, point: u32) -> bool {
        self.kind(point) & kind::LOCKED != 0
    }

    /// What the edge between two points is, as `kind` bits; 0 for an ordinary edge, `None` where there is no edge.
    pub(crate) fn edge_kind(&self, u: u32, v: u32) -> Option<u8> {
        // From the side with fewer triangles: the other may be a hub.
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

    /// Whether there is an edge between two points and it is not an ordinary one. Looks no further than it must: on an
    /// edge of many triangles the third tells.
    pub(crate) fn is_feature_edge(&self, u: u32, v: u32) -> bool {
        let (u, v) = if self.valence(u) <= self.valence(v) { (u, v) } else { (v, u) };
        let mut first: Option<(u32, [u32; 2])> = None;
        let mut count = 0;
        for corner in self.star(u) {
            let Some(side) = corner.others.iter().position(|&o| o == v) else { continue };
            count += 1;
            let (material, ends) = (self.material(corner.triangle), self.edge_vertices(corner, side));
            if count > 2 || *first.get_or_insert((material, ends)) != (material, ends) {
                return true;
            }
        }
        count == 1
    }

    /// The vertices of `corner`'s point and of its other number `side`.
    #[inline]
    fn edge_vertices(&self, corner: Corner, side: usize) -> [u32; 2] {
        if self.corner_vertices.is_empty() {
            return [0, 0];
        }
        let vertices = self.corner_vertices[corner.triangle as usize];
        [vertices[corner.slot as usize], vertices[(corner.slot as usize + 1 + side) % 3]]
    }

    /// Merges `lost` into `kept`, which moves to `position` (inner frame). `dead` receives the triangles that vanish.
    /// O(valence).
    pub(crate) fn collapse(&mut self, lost: u32, kept: u32, position: Vec3, dead: &mut Vec<u32>) {
        dead.clear();
        let mut moved = std::mem::take(&mut self.scratch.moved);
        moved.clear();
        // A point without triangles does not count already.
        self.live_points -= usize::from(!self.stars.of(lost).is_empty());
        for &entry in self.stars.of(lost) {
            let corner = self.corner(entry);
            let [a, b] = corner.others;
            if a == kept || b == kept {
                dead.push(corner.triangle);
            } else {
                moved.push(entry);
            }
        }
        if dead.len() <= 2 {
            for &triangle in dead.iter() {
                for point in self.triangles[triangle as usize] {
                    if point != lost {
                        self.stars.remove(point, triangle);
                        self.live_points -= usize::from(self.stars.of(point).is_empty());
                    }
                }
                self.triangles[triangle as usize] = [NONE; 3];
            }
        } else {
            self.remove_many(lost, dead);
        }
        self.live -= dead.len();
        // A point that was bare comes alive by a merge of two separate parts.
        self.live_points += usize::from(self.stars.of(kept).is_empty() && !moved.is_empty());
        for &entry in &moved {
            self.triangles[(entry >> 2) as usize][(entry & 3) as usize] = kept;
        }
        self.stars.clear(lost);
        self.stars.append(kept, &moved);
        self.positions[kept as usize] = position;
        self.scratch.moved = moved;
    }

    /// Takes many triangles around `lost` out of the other points' stars, each star in one pass.
    fn remove_many(&mut self, lost: u32, dead: &[u32]) {
        let mut points = std::mem::take(&mut self.scratch.neighbours);
        points.clear();
        for &triangle in dead {
            let corners = std::mem::replace(&mut self.triangles[triangle as usize], [NONE; 3]);
            points.extend(corners.into_iter().filter(|&point| point != lost));
        }
        points.sort_unstable();
        points.dedup();
        for &point in &points {
            self.stars.retain(point, |triangle| self.triangles[triangle as usize][0] != NONE);
            self.live_points -= usize::from(self.stars.of(point).is_empty());
        }
        self.scratch.neighbours = points;
    }

    /// Replaces the vertex at every corner of `point`'s star by `map` (after the collapse into it).
    pub(crate) fn replace_vertices(&mut self, point: u32, mut map: impl FnMut(u32) -> u32) {
        if self.corner_vertices.is_empty() {
            let vertex = &mut self.point_vertex[point as usize];
            *vertex = map(*vertex);
            return;
        }
        for &entry in self.stars.of(point) {
            let vertex = &mut self.corner_vertices[(entry >> 2) as usize][(entry & 3) as usize];
            *vertex = map(*vertex);
        }
    }

    /// Finds what every point is. O(corners).
    fn classify(&mut self) {
        self.scratch.seen = vec![Seen::default(); self.positions.len()];
        for point in 0..self.positions.len() as u32 {
            self.classify_point(point);
        }
    }

    /// Finds anew what a point is, and each of its neighbours: after two parts were joined there.
    pub(crate) fn reclassify_around(&mut self, point: u32) {
        let mut around = std::mem::take(&mut self.scratch.moved);
        around.clear();
        around.extend(self.star(point).flat_map(|corner| corner.others));
        // Each once: a neighbour may be a hub, and share many triangles with this point.
        around.sort_unstable();
        around.dedup();
        self.classify_point(point);
        for &neighbour in &around {
            self.classify_point(neighbour);
        }
        self.scratch.moved = around;
    }

    /// Whether the triangles around a point are one closed ring in one direction; only tried for common valences.
    /// Such a point has no feature edge, unless a seam or material says so.
    #[inline]
    fn is_plain_ring(&self, point: u32) -> bool {
        let count = self.valence(point);
        if !(3..=16).contains(&count) {
            return false;
        }
        let mut ring = [[0u32; 2]; 16];
        for (slot, corner) in ring.iter_mut().zip(self.star(point)) {
            *slot = corner.others;
        }
        let ring = &ring[..count];
        let (first, mut at) = (ring[0][0], ring[0][1]);
        for _ in 1..count {
            match ring.iter().find(|r| r[0] == at) {
                Some(next) if at != first => at = next[1],
                _ => return false,
            }
        }
        // Back at the start after as many steps as triangles: each was passed once.
        at == first
    }

    /// Finds what a point is by one walk over its star, with marks: O(valence).
    fn classify_point(&mut self, point: u32) {
        if self.corner_vertices.is_empty() && self.materials.is_empty() && self.is_plain_ring(point) {
            self.kinds[point as usize] &= kind::LOCKED;
            return;
        }
        let mut seen = std::mem::take(&mut self.scratch.seen);
        let mut neighbours = std::mem::take(&mut self.scratch.neighbours);
        neighbours.clear();
        for corner in self.star(point) {
            for side in 0..2 {
                let n = corner.others[side];
                let entry = &mut seen[n as usize];
                if entry.count == 0 {
                    neighbours.push(n);
                    entry.first = self.edge_vertices(corner, side);
                    entry.material = self.material(corner.triangle);
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
        let (mut bits, mut features) = (self.kinds[point as usize] & kind::LOCKED, 0u32);
        for &n in &neighbours {
            let entry = &seen[n as usize];
            let edge = match entry.count {
                1 => kind::BORDER,
                2 => entry.bits,
                _ => entry.bits | kind::NON_MANIFOLD,
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
        self.kinds[point as usize] = bits;
        for &n in &neighbours {
            seen[n as usize] = Seen::default();
        }
        self.scratch.seen = seen;
        self.scratch.neighbours = neighbours;
    }

    /// Triangles around a point that can be reached from the first across shared edges: fewer than its valence where
    /// several fans meet. O(valence log valence).
    fn fan_length(&self, point: u32) -> usize {
        let mut ends: Vec<(u32, u32)> = Vec::with_capacity(2 * self.valence(point));
        for (i, corner) in self.star(point).enumerate() {
            ends.extend(corner.others.map(|o| (o, i as u32)));
        }
        ends.sort_unstable();
        let mut parent: Vec<u32> = (0..self.valence(point) as u32).collect();
        fn root(parent: &mut [u32], mut i: u32) -> u32 {
            while parent[i as usize] != i {
                parent[i as usize] = parent[parent[i as usize] as usize];
                i = parent[i as usize];
            }
            i
        }
        for pair in ends.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
            let (a, b) = (root(&mut parent, pair[0].1), root(&mut parent, pair[1].1));
            parent[a.max(b) as usize] = a.min(b);
        }
        (0..parent.len() as u32).filter(|&i| root(&mut parent, i) == 0).count()
    }
}

/// Neighbours on the ring that starts at the first, where each has exactly one follower.
fn ring_length(seen: &[Seen], neighbours: &[u32]) -> usize {
    let Some(&first) = neighbours.first() else { return 0 };
    let (mut at, mut length) = (seen[first as usize].follow, 1);
    while at != first && length <= neighbours.len() {
        at = seen[at as usize].follow;
        length += 1;
    }
    length
}

/// What is known of one neighbour while a star is walked.
#[derive(Debug, Clone, Copy, Default)]
struct Seen {
    count: u32,
    next: u32,
    /// The neighbour that comes after this one around the point.
    follow: u32,
    first: [u32; 2],
    material: u32,
    bits: u8,
}

/// The corners around every point: a slice of one pool each, moved to the pool's end when it outgrows its place.
#[derive(Debug, Clone)]
struct Stars {
    pool: Vec<u32>,
    /// Start, length and room of each star.
    spans: Vec<Span>,
}

#[derive(Debug, Clone, Copy, Default)]
struct Span {
    start: usize,
    len: u32,
    room: u32,
}

impl Stars {
    fn new(triangles: &[[u32; 3]], points: usize) -> Self {
        let mut spans = vec![Span::default(); points];
        let live = || triangles.iter().enumerate().filter(|(_, t)| t[0] != NONE);
        for (_, t) in live() {
            for &p in t {
                spans[p as usize].room += 1;
            }
        }
        let mut start = 0;
        for span in &mut spans {
            span.start = start;
            start += span.room as usize;
        }
        // Merged stars move to the end: about twice as much again over a whole simplification.
        let mut pool = Vec::with_capacity(start * 3);
        pool.resize(start, 0);
        for (i, t) in live() {
            for (slot, &p) in t.iter().enumerate() {
                let span = &mut spans[p as usize];
                pool[span.start + span.len as usize] = (i as u32) << 2 | slot as u32;
                span.len += 1;
            }
        }
        Self { pool, spans }
    }

    #[inline]
    fn of(&self, point: u32) -> &[u32] {
        let Span { start, len, .. } = self.spans[point as usize];
        &self.pool[start..start + len as usize]
    }

    fn remove(&mut self, point: u32, triangle: u32) {
        let Span { start, len, .. } = self.spans[point as usize];
        let star = &mut self.pool[start..start + len as usize];
        if star.len() > 64 {
            // A hub: search and move in wide steps. A triangle is there once.
            let is_it = |entry: &u32| entry >> 2 == triangle;
            let mut chunks = star.chunks(32);
            let chunk = chunks.position(|chunk| chunk.iter().fold(false, |any, entry| any | is_it(entry)));
            let start = 32 * chunk.unwrap_or(0);
            if let Some(at) = star[start..].iter().position(is_it) {
                star.copy_within(start + at + 1.., start + at);
                self.spans[point as usize].len -= 1;
            }
            return;
        }
        self.retain(point, |other| other != triangle);
    }

    #[inline]
    fn retain(&mut self, point: u32, keep: impl Fn(u32) -> bool) {
        let span = &mut self.spans[point as usize];
        let star = &mut self.pool[span.start..span.start + span.len as usize];
        // Compaction without a branch on where it is.
        let mut kept = 0;
        for i in 0..star.len() {
            let entry = star[i];
            star[kept] = entry;
            kept += usize::from(keep(entry >> 2));
        }
        span.len = kept as u32;
    }

    fn clear(&mut self, point: u32) {
        self.spans[point as usize].len = 0;
    }

    fn append(&mut self, point: u32, entries: &[u32]) {
        let span = self.spans[point as usize];
        let end = span.start + span.len as usize;
        let len = span.len + entries.len() as u32;
        if len > span.room {
            let start = self.pool.len();
            self.pool.extend_from_within(span.start..end);
            self.pool.extend_from_slice(entries);
            // Room in proportion, so that a hub that swallows its neighbours one by one is not copied each time.
            let room = if len < 32 { len + 2 } else { len + len / 2 };
            self.pool.resize(start + room as usize, 0);
            self.spans[point as usize] = Span { start, len, room };
        } else {
            self.pool[end..end + entries.len()].copy_from_slice(entries);
            self.spans[point as usize].len = len;
        }
    }
}
