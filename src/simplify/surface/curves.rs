//! The curves of a surface and their images on a level: borders, non-manifold edges, seams, borders between materials,
//! and creases.
//!
//! ```text
//!     input   a---b---c---d---e          A curve of a level is the image of the input's curve under the merges, as the
//!                  \ b -> c              level is the image of the input's triangles: edges with two equal ends are
//!     level   a-------c---d---e          gone, equal edges are one. So no rule and no mode can lose track of it.
//! ```
//!
//! An edge is a feature by its triangles (`classify.rs`). A crease is an edge where two triangles meet at more than 41.4
//! degrees (a cosine of 3/4: an eight-sided prism has edges, a ten-sided prism is round, a chamfer of 45 degrees is an
//! edge), if it belongs to the drawing of a manufactured shape: connected creases without loose ends, going from feature
//! to feature or at least [`LEAST_CREASES`] in number, which have most of the bending around their points. Scans are full
//! of edges as sharp, in short pieces of relief or noise: sliding over the surface is no error there.

use glam::Vec3;

use crate::geometry::sets::Sets;
use crate::mesh::NONE;

use super::WorkingSurface;
use super::classify::kind;

/// Cosine of the angle between two triangles' normals below which their edge is a crease.
const CREASE: f32 = 0.75;
/// Cosine of half the crease angle: two normals both within it of a third do not form a crease.
const HALF_CREASE: f32 = 0.935_414_3;
/// Minimum number of connected creases, on meshes large enough to have them.
const LEAST_CREASES: u64 = 12;
/// Minimum share of the creases in the bending around their points: the share of rims of a ten-sided hole.
const LEAST_SHARE: f32 = 10.0 / 11.0;
/// Minimum share (see [`LEAST_SHARE`]) for creases going from feature to feature.
const LEAST_HELD_SHARE: f32 = 0.75;
/// Count added for an end at a feature; more than the creases of any mesh.
const HELD: u64 = 1 << 32;

/// Meaning of a curve edge to metrics.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Rim {
    /// A mere seam: the surface goes on across it.
    Seam,
    /// The surface bends there.
    Crease,
    /// The surface ends, or becomes another: a border, a non-manifold edge, or an edge between materials.
    Edge,
}

/// The curve edges between points, doubly linked around each point.
#[derive(Debug, Clone, Default)]
pub(crate) struct Curves {
    /// First entry of every point: `2 edge + end`, with `end` 0 or 1. Empty where there are no curves.
    first: Vec<u32>,
    /// Points of every edge; `NONE` once the edge is gone.
    ends: Vec<[u32; 2]>,
    /// Meaning of every edge to metrics.
    rims: Vec<Rim>,
    /// Per entry the previous and the next entry around its point.
    links: Vec<[u32; 2]>,
}

impl Curves {
    /// Finds the curves of a classified surface. O(n), plus O(k log k) around a point of valence k.
    pub fn new(surface: &WorkingSurface) -> Self {
        let mut found = creases(surface);
        let features = (0..surface.point_count() as u32).filter(|&p| surface.kind(p) & kind::FEATURE != 0);
        let mut around = Vec::new();
        for point in features {
            around.clear();
            around
                .extend(surface.star(point).flat_map(|corner| corner.others).filter(|&other| other > point));
            around.sort_unstable();
            around.dedup();
            let is_feature = |&other: &u32| {
                surface.kind(other) & kind::FEATURE != 0 && surface.is_feature_edge(point, other)
            };
            found.extend(around.iter().copied().filter(is_feature).map(|other| [point, other]));
        }
        found.sort_unstable();
        found.dedup();
        let mut curves = Self::of_edges(found, surface.point_count());
        let rim = |&[u, v]: &[u32; 2]| match surface.edge_kind(u, v) {
            Some(kind::SEAM) if !is_bent(surface, u, v) => Rim::Seam,
            Some(0 | kind::SEAM) => Rim::Crease,
            _ => Rim::Edge,
        };
        curves.rims = curves.ends.iter().map(rim).collect();
        curves
    }

    fn of_edges(ends: Vec<[u32; 2]>, points: usize) -> Self {
        if ends.is_empty() {
            return Self::default();
        }
        let mut curves = Self {
            first: vec![NONE; points],
            rims: vec![Rim::Crease; ends.len()],
            links: vec![[NONE; 2]; 2 * ends.len()],
            ends,
        };
        for entry in (0..curves.links.len() as u32).rev() {
            let point = curves.ends[(entry >> 1) as usize][(entry & 1) as usize];
            curves.push(point, entry);
        }
        curves
    }

    /// Whether there never were any curves.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.first.is_empty()
    }

    /// Returns the number of edges, gone edges included.
    pub fn edge_count(&self) -> usize {
        self.ends.len()
    }

    /// Returns the points of an edge.
    pub fn ends(&self, edge: u32) -> [u32; 2] {
        self.ends[edge as usize]
    }

    /// Returns the meaning of an edge to metrics.
    pub fn rim(&self, edge: u32) -> Rim {
        self.rims[edge as usize]
    }

    /// Returns the edges around a point, each with the point at its other end.
    #[inline]
    pub fn around(&self, point: u32) -> impl Iterator<Item = [u32; 2]> + '_ {
        let mut at = self.first.get(point as usize).copied().unwrap_or(NONE);
        std::iter::from_fn(move || {
            (at != NONE).then(|| {
                let entry = at;
                at = self.links[entry as usize][1];
                [entry >> 1, self.other(entry)]
            })
        })
    }

    /// Returns the edge between two points. Walks around both at once: O(least of both edge counts).
    pub fn find(&self, u: u32, v: u32) -> Option<u32> {
        let mut around_v = self.around(v);
        for [edge, other] in self.around(u) {
            if other == v {
                return Some(edge);
            }
            match around_v.next() {
                Some([edge, other]) if other == u => return Some(edge),
                Some(_) => {}
                None => return None,
            }
        }
        None
    }

    #[inline]
    fn other(&self, entry: u32) -> u32 {
        self.ends[(entry >> 1) as usize][(entry & 1 ^ 1) as usize]
    }

    fn push(&mut self, point: u32, entry: u32) {
        let first = std::mem::replace(&mut self.first[point as usize], entry);
        self.links[entry as usize] = [NONE, first];
        if first != NONE {
            self.links[first as usize][0] = entry;
        }
    }

    fn unlink(&mut self, entry: u32) {
        let [before, after] = self.links[entry as usize];
        match before {
            NONE => {
                let point = self.ends[(entry >> 1) as usize][(entry & 1) as usize];
                self.first[point as usize] = after;
            }
            before => self.links[before as usize][1] = after,
        }
        if after != NONE {
            self.links[after as usize][0] = before;
        }
    }

    /// Merges a point into another. Removes the edge between both, and every edge of `lost` parallel to an edge of
    /// `kept`.
    pub fn merge(&mut self, lost: u32, kept: u32) {
        let mut at = std::mem::replace(&mut self.first[lost as usize], NONE);
        while at != NONE {
            let next = self.links[at as usize][1];
            let other = self.other(at);
            if other == kept || self.find(kept, other).is_some() {
                self.unlink(at ^ 1);
                self.ends[(at >> 1) as usize] = [NONE; 2];
            } else {
                self.ends[(at >> 1) as usize][(at & 1) as usize] = kept;
                self.push(kept, at);
            }
            at = next;
        }
    }
}

/// Whether triangles on an edge meet at the angle of a crease.
fn is_bent(surface: &WorkingSurface, u: u32, v: u32) -> bool {
    // Walk the end with fewer triangles: the other end may be a hub. Both list them in the order of their numbers.
    let (u, v) = if surface.valence(u) <= surface.valence(v) { (u, v) } else { (v, u) };
    let (mut first, mut bent) = (None, false);
    surface.for_shared_triangles(u, v, |triangle| {
        let Some([p, q, r]) = surface.triangle(triangle).map(|points| points.map(|p| surface.at(p))) else {
            return;
        };
        let normal = (q - p).cross(r - p).normalize_or_zero();
        let other = *first.get_or_insert(normal);
        bent |= normal.dot(other) < CREASE;
    });
    bent
}

/// Computes the bending across edges.
struct Bends<'a> {
    surface: &'a WorkingSurface,
    /// Normals, each of length twice the triangle's area.
    normals: Vec<Vec3>,
}

impl Bends<'_> {
    /// Whether all normals around a point are so close to the first that no two can meet at a crease.
    fn is_smooth(&self, point: u32) -> bool {
        let mut triangles = self.surface.star_triangles(point).map(|t| self.normals[t as usize]);
        let Some(first) = triangles.next() else { return true };
        let least = HALF_CREASE * HALF_CREASE * first.length_squared();
        triangles.all(|normal| {
            let dot = first.dot(normal);
            dot > 0.0 && dot * dot >= least * normal.length_squared()
        })
    }

    /// Calls `visit` with every neighbour accepted by `counts` across an edge of exactly two triangles with areas, and
    /// the cosine of the angle between their normals.
    fn for_each(
        &self,
        point: u32,
        around: &mut Vec<u64>,
        counts: impl Fn(u32) -> bool,
        mut visit: impl FnMut(u32, f32),
    ) {
        // The other point, the triangle, and whether the triangle runs out to the other point.
        let entry = |other: u32, triangle: u32, out: bool| {
            u64::from(other) << 32 | u64::from(triangle) << 1 | u64::from(out)
        };
        around.clear();
        for corner in self.surface.star(point) {
            let [a, b] = corner.others;
            around.extend(counts(a).then_some(entry(a, corner.triangle, true)));
            around.extend(counts(b).then_some(entry(b, corner.triangle, false)));
        }
        around.sort_unstable();
        for edge in around.chunk_by(|a, b| a >> 32 == b >> 32) {
            let &[one, two] = edge else { continue };
            let other = (one >> 32) as u32;
            let [out, again] = [one, two].map(|entry| entry & 1 == 1);
            let [n, m] = [one, two].map(|entry| self.normals[(entry as u32 >> 1) as usize]);
            let lengths = n.length() * m.length();
            if lengths > f32::MIN_POSITIVE {
                let cosine = n.dot(m) / lengths;
                // Triangles running the same way along their edge disagree on which side is outside.
                visit(other, if out == again { -cosine } else { cosine });
            }
        }
    }
}

/// Returns the creases of a surface, the lower end first. O(n), plus O(k log k) around a point of valence k with
/// creases.
fn creases(surface: &WorkingSurface) -> Vec<[u32; 2]> {
    let normal = |t: u32| match surface.triangle(t).map(|points| points.map(|p| surface.at(p))) {
        Some([p, q, r]) => (q - p).cross(r - p),
        None => Vec3::ZERO,
    };
    let normals = (0..surface.triangle_count() as u32).map(normal).collect();
    let bends = Bends { surface, normals };
    let mut around = Vec::new();
    let mut found: Vec<[u32; 2]> = Vec::new();
    let mut bending: Vec<(f32, f32)> = Vec::new();
    // Both ends of a crease are rough.
    let rough: Vec<bool> = (0..surface.point_count() as u32).map(|point| !bends.is_smooth(point)).collect();
    for point in (0..surface.point_count() as u32).filter(|&point| rough[point as usize]) {
        let counts = |other: u32| other > point && rough[other as usize];
        let is_feature = surface.kind(point) & kind::FEATURE != 0;
        bends.for_each(point, &mut around, counts, |other, cosine| {
            let ordinary = !is_feature
                || surface.kind(other) & kind::FEATURE == 0
                || !surface.is_feature_edge(point, other);
            if cosine < CREASE && ordinary {
                found.push([point, other]);
            }
        });
    }
    if found.is_empty() {
        return found;
    }
    without_loose_ends(surface, &mut found);
    // Connected pieces, by union of their points.
    let mut pieces = Sets::new(surface.point_count());
    for &[u, v] in &found {
        pieces.join(u, v);
    }
    let mut counts = vec![0u64; surface.point_count()];
    bending.resize(surface.point_count(), (0.0, 0.0));
    let mut points: Vec<u32> = found.as_flattened().to_vec();
    points.sort_unstable();
    points.dedup();
    for &[u, _] in &found {
        counts[pieces.find(u) as usize] += 1;
    }
    for &point in &points {
        // A line ending at a border or another feature goes on there.
        if surface.kind(point) & kind::FEATURE != 0 {
            counts[pieces.find(point) as usize] += HELD;
        }
        let sum = &mut bending[pieces.find(point) as usize];
        bends.for_each(
            point,
            &mut around,
            |_| true,
            |other, cosine| {
                let bend = 1.0 - cosine.min(1.0);
                sum.1 += bend;
                let edge = [point.min(other), point.max(other)];
                if cosine < CREASE && found.binary_search(&edge).is_ok() {
                    sum.0 += bend;
                }
            },
        );
    }
    let least = LEAST_CREASES.min(surface.live_points().isqrt() as u64);
    found.retain(|&[u, _]| {
        let root = pieces.find(u) as usize;
        let (own, all) = bending[root];
        let held = counts[root] >= 2 * HELD;
        counts[root] >= least && own >= if held { LEAST_HELD_SHARE } else { LEAST_SHARE } * all
    });
    found
}

/// Removes creases ending at a point without another crease or feature, repeatedly.
fn without_loose_ends(surface: &WorkingSurface, creases: &mut Vec<[u32; 2]>) {
    let curves = Curves::of_edges(creases.clone(), surface.point_count());
    let mut left: Vec<u32> =
        (0..surface.point_count() as u32).map(|p| curves.around(p).count() as u32).collect();
    let is_held = |point: u32| surface.kind(point) & kind::FEATURE != 0;
    let mut loose: Vec<u32> =
        (0..left.len() as u32).filter(|&p| left[p as usize] == 1 && !is_held(p)).collect();
    let mut gone = vec![false; curves.edge_count()];
    while let Some(point) = loose.pop() {
        let Some([edge, other]) = curves.around(point).find(|&[edge, _]| !gone[edge as usize]) else {
            continue;
        };
        gone[edge as usize] = true;
        left[point as usize] = 0;
        left[other as usize] -= 1;
        if left[other as usize] == 1 && !is_held(other) {
            loose.push(other);
        }
    }
    let mut edge = 0;
    creases.retain(|_| {
        edge += 1;
        !gone[edge - 1]
    });
}
