//! The mesh during simplification: points, triangles over points, and the star of every point.
//!
//! ```text
//!          w2 ---- w1            star of u: one corner per triangle around it, in no order.
//!         /  \    /  \           Each corner knows its triangle and which of the three it is,
//!       w3 --- u ---- v          so the two others are at hand without a search.
//!         \  /    \  /
//!          w4 ---- w5            collapse u -> v: the triangles with both die, in the others u becomes v
//! ```
//!
//! Coordinates are centred and scaled by a power of two (both exact for relevant differences). A mesh far from the
//! origin, very large or very small therefore behaves like a mesh of size 1 near the origin.

use glam::Vec3;

use crate::geometry::rounding;
use crate::mesh::{Mesh, NONE, Topology};

use super::classify::{SeenNeighbour, kind};
use super::curves::{Curves, Rim};
use super::hub_edges::{HUB, HubEdges};
use super::sheets::{Layer, Sheets};
use super::stars::PointStars;
use super::wedge_values::WedgeValues;

/// Converts between object and inner coordinates: `inner = (object - centre) * scale`, in double precision. `scale` is
/// the power of two bringing the longest side of the mesh's bounding box into [0.5, 1).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    centre: [f64; 3],
    scale: f64,
}

impl Frame {
    /// Returns the frame of a mesh.
    pub fn new(mesh: &Mesh) -> Self {
        let Some([low, high]) = mesh.bounds() else { return Self { centre: [0.0; 3], scale: 1.0 } };
        let side = (0..3).map(|i| f64::from(high[i]) - f64::from(low[i])).fold(0.0, f64::max);
        let centre = std::array::from_fn(|i| 0.5 * (f64::from(high[i]) + f64::from(low[i])));
        // Exponent field only: exact, and equal on every platform.
        let exponent = (side.to_bits() >> 52) as i64 - 1023 + 1;
        let scale = if side > 0.0 { f64::from_bits(((1023 - exponent) as u64) << 52) } else { 1.0 };
        Self { centre, scale }
    }

    /// Converts a position to the inner frame.
    pub fn inner(&self, object: [f32; 3]) -> [f32; 3] {
        std::array::from_fn(|i| ((f64::from(object[i]) - self.centre[i]) * self.scale) as f32)
    }

    /// Converts a position to object units, clamped to finite values.
    pub fn object(&self, inner: [f32; 3]) -> [f32; 3] {
        std::array::from_fn(|i| {
            let x = f64::from(inner[i]) / self.scale + self.centre[i];
            x.clamp(-f64::from(f32::MAX), f64::from(f32::MAX)) as f32
        })
    }

    /// Converts a length to object units, rounded up.
    pub fn object_length(&self, inner: f32) -> f32 {
        rounding::up(f64::from(inner) / self.scale)
    }

    /// Inner units per object unit.
    pub fn scale(&self) -> f64 {
        self.scale
    }
}

/// Most triangles of a small mesh. Measuring it between its points is worthwhile, and costs milliseconds.
const SMALL: usize = 4096;
/// Levels of at most 1 in `COARSE` input triangles are coarse.
const COARSE: usize = 16;

/// A triangle seen from a point: the point is its first corner.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Corner {
    /// The triangle (its number in the input).
    pub triangle: u32,
    /// The point's corner in the triangle, 0 to 2.
    pub slot: u8,
    /// The two other corners, in the triangle's order.
    pub others: [u32; 2],
}

/// The mesh during simplification. Points, triangles and vertices keep the numbers of the input's [`Topology`]; removed
/// triangles are in no star.
#[derive(Debug, Clone)]
pub struct WorkingSurface {
    frame: Frame,
    pub(crate) positions: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    /// Current vertex at each corner; empty where each point has a single wedge.
    pub(crate) corner_vertices: Vec<[u32; 3]>,
    /// Current vertex of each point (its lowest wedge where there are several).
    point_vertex: Vec<u32>,
    pub(crate) materials: Vec<u32>,
    pub(crate) kinds: Vec<u16>,
    /// Kinds of edges required to stay edges.
    pub(crate) held: u16,
    /// Values distinguishing wedges; empty without any.
    pub(crate) values: WedgeValues,
    /// True if a wedge with nowhere to go may move along with its point, as a new vertex.
    pub(crate) moves_wedges: bool,
    stars: PointStars,
    hub_edges: HubEdges,
    curves: Curves,
    sheets: Sheets,
    live: usize,
    /// Number of live triangles following another.
    followers: usize,
    live_points: usize,
    pub(crate) scratch: Scratch,
}

/// Marks and lists of checks and collapses, reused: nothing is allocated once warm.
#[derive(Debug, Clone, Default)]
pub(crate) struct Scratch {
    pub(crate) moved: Vec<u32>,
    pub(crate) neighbours: Vec<u32>,
    pub(crate) seen: Vec<SeenNeighbour>,
    /// Per point the changes since its last walk, for large hubs; empty until there is one.
    pub(crate) unwalked: Vec<u32>,
    pub(crate) unwalked_hubs: Vec<u32>,
    /// Edges around a point: the other point, and the vertices at both ends.
    pub(crate) ends: Vec<[u32; 3]>,
}

impl WorkingSurface {
    /// Builds the surface of a mesh. Triangles with two equal points are dead from the start. Of triangles over the
    /// same three points, a leader is chosen and the others follow it. O(n).
    pub fn new(mesh: &Mesh, topology: &Topology) -> Self {
        let frame = Frame::new(mesh);
        let points = topology.point_count();
        let position = |&v: &u32| Vec3::from(frame.inner(mesh.positions()[v as usize]));
        let positions: Vec<Vec3> = topology.vertex_of_point().iter().map(position).collect();
        let point_of = topology.point_of();
        let mut triangles: Vec<[u32; 3]> = mesh
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
        let vertices = |t: u32| mesh.triangles()[t as usize].map(|v| wedge_of[v as usize]);
        let material = |t: u32| mesh.materials().get(t as usize).copied().unwrap_or(0);
        let sheets = Sheets::new(&mut triangles, vertices, material, points);
        let stars = PointStars::new(&triangles, points);
        let mut surface = Self {
            frame,
            positions,
            triangles,
            corner_vertices,
            point_vertex: topology.vertex_of_point().to_vec(),
            materials: mesh.materials().to_vec(),
            kinds: vec![0; points],
            held: kind::FEATURE,
            values: WedgeValues::new(mesh, !one_wedge),
            moves_wedges: false,
            live_points: (0..points as u32).filter(|&p| !stars.of(p).is_empty()).count(),
            stars,
            hub_edges: HubEdges::default(),
            curves: Curves::default(),
            followers: sheets.count(),
            sheets,
            live,
            scratch: Scratch::default(),
        };
        surface.classify();
        for (vertex, _) in mesh.locks().iter().enumerate().filter(|&(_, &locked)| locked) {
            surface.kinds[point_of[vertex] as usize] |= kind::LOCKED;
        }
        for point in 0..surface.point_count() as u32 {
            surface.note_hub_edges(point, 0);
        }
        surface.curves = Curves::new(&surface);
        for edge in 0..surface.curves.edge_count() as u32 {
            surface.curves.ends(edge).iter().for_each(|&p| surface.kinds[p as usize] |= kind::ON_CURVE);
        }
        surface
    }

    /// Returns the frame of the positions.
    pub fn frame(&self) -> &Frame {
        &self.frame
    }

    /// Number of points, removed points included.
    pub fn point_count(&self) -> usize {
        self.positions.len()
    }

    /// Number of input triangles, dead triangles included.
    pub fn triangle_count(&self) -> usize {
        self.triangles.len()
    }

    /// Number of live triangles, followers included.
    pub fn live_triangles(&self) -> usize {
        self.live
    }

    /// Number of live triangles; triangles over the same three points count once.
    pub(crate) fn live_sheets(&self) -> usize {
        self.live - self.followers
    }

    /// Number of points used by live triangles.
    pub fn live_points(&self) -> usize {
        self.live_points
    }

    /// Returns the position of a point, inner frame.
    pub fn position(&self, point: u32) -> [f32; 3] {
        self.positions[point as usize].into()
    }

    #[inline]
    pub(crate) fn at(&self, point: u32) -> Vec3 {
        self.positions[point as usize]
    }

    /// Returns the points of a triangle; `None` for a dead triangle, and for a follower of another triangle over the
    /// same three points.
    pub fn triangle(&self, triangle: u32) -> Option<[u32; 3]> {
        let corners = self.triangles[triangle as usize];
        (corners[0] != NONE).then_some(corners)
    }

    /// Returns the vertices (wedges) at a triangle's corners; meaningful only while the triangle is alive.
    #[inline]
    pub fn corner_vertices(&self, triangle: u32) -> [u32; 3] {
        match self.corner_vertices.get(triangle as usize) {
            Some(&vertices) => vertices,
            None => self.triangles[triangle as usize].map(|p| self.point_vertex[p as usize]),
        }
    }

    /// Returns true if some point has several wedges.
    pub fn has_seams(&self) -> bool {
        !self.corner_vertices.is_empty()
    }

    /// Returns true if triangles have materials.
    pub(crate) fn has_materials(&self) -> bool {
        !self.materials.is_empty()
    }

    /// Returns the vertex of a point with a single wedge.
    pub(crate) fn point_vertex(&self, point: u32) -> u32 {
        self.point_vertex[point as usize]
    }

    /// Returns the material of a triangle; 0 without materials.
    #[inline]
    pub fn material(&self, triangle: u32) -> u32 {
        self.materials.get(triangle as usize).copied().unwrap_or(0)
    }

    /// Returns true if some triangles follow another.
    #[inline]
    pub(crate) fn has_sheets(&self) -> bool {
        !self.sheets.is_empty()
    }

    /// Returns true if a triangle has followers with other vertices, material or winding.
    #[inline]
    pub(crate) fn is_layered(&self, triangle: u32) -> bool {
        !self.sheets.layers(triangle).is_empty()
    }

    /// Returns the followers of a triangle: triangles over the same three points, which die with it.
    #[inline]
    pub(crate) fn followers(&self, triangle: u32) -> &[u32] {
        self.sheets.followers(triangle)
    }

    /// Returns a live triangle's own layer, and the layer of each different follower.
    #[inline]
    pub(crate) fn layers(&self, triangle: u32) -> impl Iterator<Item = Layer> + Clone + '_ {
        let (vertices, material) = (self.corner_vertices(triangle), self.material(triangle));
        let own = Layer { triangle, vertices, material, opposite: false };
        let has_seams = self.has_seams();
        // Without seams all layers share the leader's vertices.
        let layer = move |&layer: &Layer| if has_seams { layer } else { Layer { vertices, ..layer } };
        std::iter::once(own).chain(self.sheets.layers(triangle).iter().map(layer))
    }

    /// Number of triangles around a point.
    #[inline]
    pub fn valence(&self, point: u32) -> usize {
        self.stars.of(point).len()
    }

    /// Returns the triangles around a point, in a fixed but arbitrary order.
    #[inline]
    pub fn star(&self, point: u32) -> impl ExactSizeIterator<Item = Corner> + Clone + '_ {
        self.stars.of(point).iter().map(|&entry| self.corner(entry))
    }

    /// Returns each `stride`-th triangle around a point. O(triangles returned).
    pub(crate) fn star_thinned(&self, point: u32, stride: usize) -> impl Iterator<Item = Corner> + '_ {
        self.stars.of(point).iter().step_by(stride).map(|&entry| self.corner(entry))
    }

    /// Returns the corners of a star on both sides of a triangle in the star's order: at most `most`.
    pub(crate) fn star_near(
        &self,
        point: u32,
        triangle: u32,
        most: usize,
    ) -> impl Iterator<Item = Corner> + '_ {
        let star = self.stars.of(point);
        let from = self.stars.find(point, triangle).unwrap_or(0).saturating_sub(most / 2);
        star[from..].iter().take(most).map(|&entry| self.corner(entry))
    }

    /// Returns the numbers of the triangles around a point, in the order of [`star`](WorkingSurface::star).
    #[inline]
    pub(crate) fn star_triangles(&self, point: u32) -> impl ExactSizeIterator<Item = u32> + Clone + '_ {
        self.stars.of(point).iter().map(|&entry| entry >> 2)
    }

    /// Calls `visit` with every triangle shared by two points.
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
        // By table: the slot is unpredictable, so a branch on it would mostly be mispredicted.
        const NEXT: [u8; 4] = [1, 2, 0, 0];
        const LAST: [u8; 4] = [2, 0, 1, 0];
        let (triangle, slot) = (entry >> 2, (entry & 3) as usize);
        let t = &self.triangles[triangle as usize];
        let others = [t[NEXT[slot] as usize], t[LAST[slot] as usize]];
        Corner { triangle, slot: slot as u8, others }
    }

    /// Calls `visit` with every neighbour of a point at least once (some twice where the star is irregular).
    #[inline]
    pub fn for_neighbours(&self, point: u32, mut visit: impl FnMut(u32)) {
        if self.kinds[point as usize] & kind::IRREGULAR == 0 {
            for &entry in self.stars.of(point) {
                visit(self.corner(entry).others[0]);
            }
        } else {
            self.star(point).for_each(|corner| corner.others.into_iter().for_each(&mut visit));
        }
    }

    /// Writes the neighbours of a point to `few`, as listed by [`for_neighbours`](WorkingSurface::for_neighbours), and
    /// returns their number. Where they are too many to fit, returns a number above `N`.
    #[inline]
    pub(crate) fn few_neighbours<const N: usize>(&self, point: u32, few: &mut [u32; N]) -> usize {
        let star = self.stars.of(point);
        if star.len() > N {
            return star.len();
        }
        if self.kinds[point as usize] & kind::IRREGULAR != 0 {
            let mut count = 0;
            self.for_neighbours(point, |other| {
                few[count % N] = other;
                count += 1;
            });
            return count;
        }
        for (&entry, few) in star.iter().zip(few) {
            *few = self.corner(entry).others[0];
        }
        star.len()
    }

    #[inline]
    pub(crate) fn kind(&self, point: u32) -> u16 {
        self.kinds[point as usize]
    }

    /// Returns true if a point lies on an open border.
    pub fn is_border(&self, point: u32) -> bool {
        self.kind(point) & kind::BORDER != 0
    }

    /// Returns true if a point lies on a non-manifold edge or joins several fans.
    pub fn is_non_manifold(&self, point: u32) -> bool {
        self.kind(point) & kind::NON_MANIFOLD != 0
    }

    /// Returns true if a point lies on a curve: a border, non-manifold edge, seam, border between materials or crease
    /// of the input, or the image of such a curve.
    #[inline]
    pub fn is_on_curve(&self, point: u32) -> bool {
        self.kind(point) & kind::ON_CURVE != 0
    }

    /// Returns true if the edge between two points belongs to a curve.
    #[inline]
    pub fn is_curve_edge(&self, u: u32, v: u32) -> bool {
        self.kind(u) & self.kind(v) & kind::ON_CURVE != 0 && self.curves.find(u, v).is_some()
    }

    /// Calls `visit` with the other end and the rim of every curve edge at a point.
    pub(crate) fn for_rims(&self, point: u32, mut visit: impl FnMut(u32, Rim)) {
        for [edge, other] in self.curves.around(point) {
            visit(other, self.curves.rim(edge));
        }
    }

    /// Returns true if the input has at most `SMALL` triangles, so each may be examined many times.
    pub(crate) fn is_small(&self) -> bool {
        self.triangles.len() <= SMALL
    }

    /// Returns true if at most `SMALL` triangles or 1 in `COARSE` are left: the middle of a triangle may then be far
    /// from every point over it.
    #[inline]
    pub(crate) fn is_coarse(&self) -> bool {
        self.live <= SMALL.max(self.triangles.len() / COARSE)
    }

    /// Returns the curves in their current state.
    pub(crate) fn curves(&self) -> &Curves {
        &self.curves
    }

    /// Returns true if the caller locked a vertex at this point.
    pub fn is_locked(&self, point: u32) -> bool {
        self.kind(point) & kind::LOCKED != 0
    }

    /// Merges `lost` into `kept`, which moves to `position` (inner frame). `dead` receives the vanishing triangles.
    /// O(valence).
    pub(crate) fn collapse(&mut self, lost: u32, kept: u32, position: Vec3, dead: &mut Vec<u32>) {
        let mut moved = std::mem::take(&mut self.scratch.moved);
        // A point without triangles is not counted.
        self.live_points -= usize::from(self.valence(lost) != 0);
        // Each triangle is written to both lists and counted in its own: a branch would be mispredicted.
        let star = self.stars.of(lost);
        moved.resize(star.len(), 0);
        dead.resize(star.len(), 0);
        let (mut moves, mut dies) = (0, 0);
        for &entry in star {
            let Corner { triangle, others: [a, b], .. } = self.corner(entry);
            moved[moves] = entry;
            dead[dies] = triangle;
            let dying = (a == kept) | (b == kept);
            moves += usize::from(!dying);
            dies += usize::from(dying);
        }
        moved.truncate(moves);
        dead.truncate(dies);
        match dead[..] {
            [] => {}
            [only] => {
                self.stars.remove(kept, only);
                self.detach_third(only, [lost, kept]);
                self.live_points -= usize::from(self.valence(kept) == 0);
            }
            [first, second] => {
                if self.valence(kept) > HUB {
                    // A hub: two searches in wide steps.
                    self.stars.remove(kept, first);
                    self.stars.remove(kept, second);
                } else {
                    self.stars.retain(kept, |triangle| triangle != first && triangle != second);
                }
                self.detach_third(first, [lost, kept]);
                self.detach_third(second, [lost, kept]);
                self.live_points -= usize::from(self.valence(kept) == 0);
            }
            _ => self.remove_many(lost, dead),
        }
        self.add_followers(dead);
        self.live -= dead.len();
        // A bare point comes alive by a merge of two separate parts.
        self.live_points += usize::from(self.stars.of(kept).is_empty() && !moved.is_empty());
        for &entry in &moved {
            self.triangles[(entry >> 2) as usize][(entry & 3) as usize] = kept;
        }
        self.stars.clear(lost);
        let known = self.valence(kept);
        self.stars.append(kept, &moved);
        self.note_hub_edges(kept, if known > HUB { known } else { 0 });
        // Triangles that are turned against each other are so around the merged point, too.
        self.kinds[kept as usize] |= self.kinds[lost as usize] & (kind::WEDGES | kind::IRREGULAR);
        if self.kinds[lost as usize] & kind::ON_CURVE != 0 {
            self.kinds[kept as usize] |= kind::ON_CURVE;
            self.curves.merge(lost, kept);
        }
        self.positions[kept as usize] = position;
        self.scratch.moved = moved;
    }

    /// Records edges of a point to hubs, if the point is a hub itself. Looks at the point's triangles from number `from`
    /// of its star on.
    #[inline]
    fn note_hub_edges(&mut self, point: u32, from: usize) {
        if self.valence(point) <= HUB {
            return;
        }
        for at in from..self.valence(point) {
            let Corner { triangle, others, .. } = self.corner(self.stars.of(point)[at]);
            for other in others {
                if self.valence(other) > HUB {
                    self.hub_edges.insert(point, other, triangle);
                }
            }
        }
    }

    /// Returns true if two points have a triangle in common. O(valence), at most [`HUB`], but for edges between hubs that
    /// lost the triangle last recorded there.
    pub(crate) fn is_edge(&self, u: u32, v: u32) -> bool {
        let (from, to) = if self.valence(u) <= self.valence(v) { (u, v) } else { (v, u) };
        if self.valence(from) > HUB {
            let Some(triangle) = self.hub_edges.get(u, v) else { return false };
            let corners = self.triangles[triangle as usize];
            if corners.contains(&u) && corners.contains(&v) {
                return true;
            }
        }
        self.star(from).any(|corner| corner.others.contains(&to))
    }

    /// Removes points with all their triangles, which must have no other corners. `dead` receives the triangles.
    pub(crate) fn vanish(&mut self, points: &[u32], dead: &mut Vec<u32>) {
        dead.clear();
        for &point in points {
            self.live_points -= usize::from(self.valence(point) != 0);
            for &entry in self.stars.of(point) {
                let corners = &mut self.triangles[(entry >> 2) as usize];
                if corners[0] != NONE {
                    *corners = [NONE; 3];
                    dead.push(entry >> 2);
                }
            }
            self.stars.clear(point);
        }
        self.add_followers(dead);
        self.live -= dead.len();
    }

    /// Appends the followers of dead triangles.
    fn add_followers(&mut self, dead: &mut Vec<u32>) {
        if self.has_sheets() {
            let leaders = dead.len();
            for leader in 0..leaders {
                dead.extend_from_slice(self.sheets.followers(dead[leader]));
            }
            self.followers -= dead.len() - leaders;
        }
    }

    /// Makes a triangle dead, and removes it from the star of its third point, opposite the edge.
    #[inline]
    fn detach_third(&mut self, triangle: u32, [u, v]: [u32; 2]) {
        let [a, b, c] = std::mem::replace(&mut self.triangles[triangle as usize], [NONE; 3]);
        let third = a ^ b ^ c ^ u ^ v;
        self.stars.remove(third, triangle);
        self.live_points -= usize::from(self.valence(third) == 0);
    }

    /// Makes many triangles around `lost` dead, and removes them from the other points' stars, each star in a single
    /// pass.
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

    /// Replaces the vertices at the corners of `point`'s star by `map`: at all, or where `kept_stay` at the corners just
    /// moved there, which may be few of a hub's. Call after the collapse into `point`.
    pub(crate) fn replace_vertices(&mut self, point: u32, kept_stay: bool, mut map: impl FnMut(u32) -> u32) {
        if self.corner_vertices.is_empty() {
            let vertex = &mut self.point_vertex[point as usize];
            *vertex = map(*vertex);
            return;
        }
        let changed = if kept_stay { &self.scratch.moved[..] } else { self.stars.of(point) };
        for &entry in changed {
            let vertex = &mut self.corner_vertices[(entry >> 2) as usize][(entry & 3) as usize];
            *vertex = map(*vertex);
            self.sheets.replace(entry >> 2, (entry & 3) as usize, &mut map);
        }
    }
}
