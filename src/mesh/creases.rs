//! Normals from triangles, smooth up to a crease angle; and the crease angle behind the normals of a mesh.
//!
//! ```text
//!      \ n1   n2 /        corners around a point are one smoothing group as long as the edges between them turn by
//!     ___\_____/___       no more than the crease angle; every group gets one normal, the weighted mean of its
//!    /  smooth |   \      triangles'. Groups that meet in one vertex split it.
//!   /          | crease
//! ```
//!
//! An edge is smooth or creased as a whole, as in smoothing groups: a crease ending in a smooth surface splits nothing
//! at its last point.

use glam::DVec3;

use crate::geometry::sets::Sets;

use super::edges::next_half_edge;
use super::{Attribute, Edges, Mesh, NONE, Topology, names};

/// Edges turning by less are flat. No crease angle applies to flat edges: rounding alone makes turns of this size.
const FLAT_DEGREES: f64 = 0.02;
/// Edges of more triangles are creases.
const MOST_AT_AN_EDGE: usize = 8;
/// Normals turning by less across an edge make no crease.
const SAME_EDGE_DEGREES: f64 = 0.5;
/// Cosine of the turn below which two triangles at an edge are the two sides of a sheet.
const OPPOSITE: f64 = -0.999;
/// Computed normals within this angle of the stored normals look equal.
const SAME_DEGREES: f64 = 5.0;

/// Weight of each triangle's normal in the mean around a point.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum NormalWeights {
    /// Area: large faces stay flat beside small faces.
    #[default]
    Area,
    /// Weight `|a x b| / (|a|^2 |b|^2)` for the edges `a` and `b` at the corner, exact for points on a sphere (Max,
    /// *Weights for Computing Vertex Normals from Facet Normals*, 1999).
    Corner,
    /// Equal weights.
    Equal,
}

const ALL_WEIGHTS: [NormalWeights; 3] = [NormalWeights::Area, NormalWeights::Corner, NormalWeights::Equal];

/// Crease angle and weights of computed normals.
///
/// ```
/// use multires::mesh::{Creases, names, shapes};
///
/// // Smooth everywhere but across edges of more than 30 degrees.
/// let cube = shapes::cube();
/// let creases = Creases::with_angle(&cube, 30.0);
/// let shaded = cube.with_crease_normals(&creases);
/// assert!(shaded.attribute(names::NORMAL).is_some());
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Creases {
    /// Largest turn of a smooth edge, degrees. Edges turning by more are creases. 0: every edge not flat is a crease;
    /// 180: no edge.
    pub angle: f32,
    /// Weight of each triangle in a normal.
    pub weights: NormalWeights,
}

impl Creases {
    /// Fits the angle and weights to the normals of a mesh. Also returns the share of corners whose stored normal they
    /// reproduce to within 5 degrees, 0 to 1. `None` without normals, or if no triangle has an area. O(n log n).
    pub fn fitted(mesh: &Mesh) -> Option<(Self, f64)> {
        let normals = stored(mesh)?;
        let facets = Facets::new(mesh);
        Self::best(mesh, &facets, &normals, facets.best_angle(mesh, &normals))
    }

    /// Uses `angle` (degrees) and fits the weights to the normals of a mesh; default weights without normals.
    pub fn with_angle(mesh: &Mesh, angle: f32) -> Self {
        let best = stored(mesh).and_then(|normals| Self::best(mesh, &Facets::new(mesh), &normals, angle));
        best.map_or(Self { angle, weights: NormalWeights::default() }, |(creases, _)| creases)
    }

    /// Share of points where three or more seams of normals alone meet: no simplification can move such points. 0
    /// without normals. O(n).
    pub(crate) fn hard_share(mesh: &Mesh) -> f64 {
        let Some(normals) = stored(mesh) else { return 0.0 };
        let facets = Facets::new(mesh);
        let bare = Topology::new(&mesh.without_attribute(names::NORMAL));
        let (point_of, wedge_of) = (bare.point_of(), bare.wedge_of());
        let vertex = |half_edge: u32| mesh.triangles().as_flattened()[half_edge as usize] as usize;
        let mut seams = vec![0u32; bare.point_count()];
        let mut last = [NONE; 2];
        facets.for_smoothable(|a, b, turn| {
            let ends = [(vertex(a), vertex(next_half_edge(b))), (vertex(next_half_edge(a)), vertex(b))];
            let other_seam = ends.iter().any(|&(v, w)| wedge_of[v] != wedge_of[w]);
            let is_hard = ends.iter().any(|&(v, w)| normals[v].dot(normals[w]) < cos(SAME_EDGE_DEGREES));
            let points = ends.map(|(v, _)| point_of[v]);
            // The sides of a sheet face away from each other. Each edge counts once.
            if is_hard && !other_seam && turn > OPPOSITE && points != last {
                points.iter().for_each(|&p| seams[p as usize] += 1);
                last = points;
            }
        });
        let mut used = vec![false; seams.len()];
        mesh.triangles().as_flattened().iter().for_each(|&v| used[point_of[v as usize] as usize] = true);
        let used = used.iter().filter(|&&used| used).count();
        seams.iter().filter(|&&count| count >= 3).count() as f64 / used.max(1) as f64
    }

    fn best(mesh: &Mesh, facets: &Facets, stored: &[DVec3], angle: f32) -> Option<(Self, f64)> {
        let groups = facets.groups(angle);
        let mut best: Option<(Self, f64)> = None;
        for weights in ALL_WEIGHTS {
            let of_group = facets.normals(mesh, &groups, weights);
            let share = facets.share_explained(mesh, &groups, &of_group, stored)?;
            if best.is_none_or(|(_, known)| share > known) {
                best = Some((Self { angle, weights }, share));
            }
        }
        best
    }
}

impl Mesh {
    /// Replaces the normals by normals computed from the triangles, smooth except at creases. O(n log n).
    ///
    /// Splits vertices between smoothing groups: a copy per group, in order of first use. Drops vertices used by no
    /// triangle. Makes tangents perpendicular to the new normals.
    #[must_use]
    pub fn with_crease_normals(&self, creases: &Creases) -> Mesh {
        let facets = Facets::new(self);
        let groups = facets.groups(creases.angle);
        let normals = facets.normals(self, &groups, creases.weights);
        // Per vertex its first copy; per copy its group and the next copy of its vertex.
        let mut first = vec![NONE; self.positions().len()];
        let mut copies: Vec<[u32; 2]> = Vec::new();
        let (mut order, mut made) = (Vec::new(), Vec::new());
        let mut triangles = self.triangles().to_vec();
        for (corner, vertex) in triangles.as_flattened_mut().iter_mut().enumerate() {
            let group = groups[corner];
            let mut at = first[*vertex as usize];
            while at != NONE && copies[at as usize][0] != group {
                at = copies[at as usize][1];
            }
            if at == NONE {
                at = copies.len() as u32;
                copies.push([group, first[*vertex as usize]]);
                first[*vertex as usize] = at;
                order.push(*vertex);
                made.push(normals[group as usize].as_vec3().to_array());
            }
            *vertex = at;
        }
        let mut mesh = self.gather(&order, triangles, self.materials().to_vec());
        mesh.replace_normals(&made);
        mesh
    }

    /// Replaces the normals by others, and makes tangents perpendicular to them.
    pub(crate) fn with_normals(mut self, normals: &[[f32; 3]]) -> Self {
        self.replace_normals(normals);
        self
    }

    /// Removes normals and tangents.
    #[must_use]
    pub fn without_normals(&self) -> Mesh {
        let mut mesh = self.clone();
        mesh.attributes.retain(|a| !matches!(a.name(), names::NORMAL | names::TANGENT));
        mesh
    }

    /// Removes the attribute called `name`.
    pub(crate) fn without_attribute(&self, name: &str) -> Mesh {
        let mut mesh = self.clone();
        mesh.attributes.retain(|attribute| attribute.name() != name);
        mesh
    }

    fn replace_normals(&mut self, normals: &[[f32; 3]]) {
        let made = Attribute::floats(names::NORMAL, normals);
        match self.attributes.iter_mut().find(|attribute| attribute.name() == names::NORMAL) {
            Some(attribute) => *attribute = made,
            None => self.attributes.insert(0, made),
        }
        let tangents = self.attributes.iter_mut().find(|a| a.name() == names::TANGENT && a.width >= 3);
        let Some((width, Some(values))) = tangents.map(|a| (a.width(), a.floats_mut())) else { return };
        for (tangent, normal) in values.chunks_mut(width).zip(normals) {
            let normal = DVec3::from_array(normal.map(f64::from));
            let old = DVec3::from_array([tangent[0], tangent[1], tangent[2]].map(f64::from));
            let flat = (old - normal * normal.dot(old)).normalize_or(normal.any_orthonormal_vector());
            flat.as_vec3().write_to_slice(&mut tangent[..3]);
        }
    }
}

/// Returns the unit normals of a mesh, by vertex; `None` without an attribute of 3 floats.
fn stored(mesh: &Mesh) -> Option<Vec<DVec3>> {
    let normals = mesh.attribute(names::NORMAL).filter(|normals| normals.width() == 3)?.as_floats()?;
    let unit = |n: &[f32]| DVec3::new(n[0].into(), n[1].into(), n[2].into()).normalize_or_zero();
    Some(normals.chunks(3).map(unit).collect())
}

fn cos(degrees: f64) -> f64 {
    degrees.to_radians().cos()
}

/// The triangles of a mesh with the normals and edges needed for smoothing.
struct Facets {
    /// Unit normals; zero if the triangle has no area.
    normals: Vec<DVec3>,
    edges: Edges,
}

impl Facets {
    fn new(mesh: &Mesh) -> Self {
        let topology = Topology::new(mesh);
        let point_of = topology.point_of();
        let corners: Vec<[u32; 3]> =
            mesh.triangles().iter().map(|t| t.map(|v| point_of[v as usize])).collect();
        let normals = mesh.triangles().iter().map(|&t| {
            let [a, b, c] = places(mesh, t);
            (b - a).cross(c - a).normalize_or_zero()
        });
        Self { normals: normals.collect(), edges: Edges::new(&corners, topology.point_count()) }
    }

    /// Calls `visit` with every pair of half-edges running along an edge in opposite directions, and the cosine of the
    /// surface's turn. Skips edges of more than [`MOST_AT_AN_EDGE`] triangles.
    fn for_smoothable(&self, mut visit: impl FnMut(u32, u32, f64)) {
        for edge in 0..self.edges.len() as u32 {
            if self.edges.half_edges(edge).len() > MOST_AT_AN_EDGE {
                continue;
            }
            for &a in self.edges.forward(edge) {
                for &b in self.edges.backward(edge) {
                    let turn = self.normals[a as usize / 3].dot(self.normals[b as usize / 3]);
                    visit(a, b, turn);
                }
            }
        }
    }

    /// Returns the smoothing group of every corner, named by the group's lowest corner.
    fn groups(&self, angle: f32) -> Vec<u32> {
        let least = cos(f64::from(angle).max(FLAT_DEGREES));
        let mut groups = Sets::new(3 * self.normals.len());
        self.for_smoothable(|a, b, turn| {
            if turn >= least {
                for (a, b) in [(a, next_half_edge(b)), (next_half_edge(a), b)] {
                    groups.join(a, b);
                }
            }
        });
        (0..groups.len() as u32).map(|corner| groups.find(corner)).collect()
    }

    /// Returns the unit normal of every group, stored at the group's lowest corner.
    fn normals(&self, mesh: &Mesh, groups: &[u32], weights: NormalWeights) -> Vec<DVec3> {
        let mut sums = vec![DVec3::ZERO; groups.len()];
        for (t, (&corners, &normal)) in mesh.triangles().iter().zip(&self.normals).enumerate() {
            let places = places(mesh, corners);
            for slot in 0..3 {
                let [a, b] = [1, 2].map(|next| places[(slot + next) % 3] - places[slot]);
                let weight = match weights {
                    NormalWeights::Area => a.cross(b).length(),
                    NormalWeights::Corner => {
                        a.cross(b).length() / (a.length_squared() * b.length_squared()).max(f64::MIN_POSITIVE)
                    }
                    NormalWeights::Equal => 1.0,
                };
                sums[groups[3 * t + slot] as usize] += normal * weight;
            }
        }
        sums.into_iter().map(|sum| sum.normalize_or(DVec3::Z)).collect()
    }

    /// Returns the share of corners whose stored normal equals their group's normal, up to [`SAME_DEGREES`].
    fn share_explained(
        &self,
        mesh: &Mesh,
        groups: &[u32],
        of_group: &[DVec3],
        stored: &[DVec3],
    ) -> Option<f64> {
        let least = cos(SAME_DEGREES);
        let (mut all, mut same) = (0usize, 0usize);
        for (t, corners) in mesh.triangles().iter().enumerate() {
            if self.normals[t] != DVec3::ZERO {
                all += 3;
                let is_same = |slot: &usize| {
                    of_group[groups[3 * t + slot] as usize].dot(stored[corners[*slot] as usize]) >= least
                };
                same += (0..3).filter(is_same).count();
            }
        }
        (all > 0).then(|| same as f64 / all as f64)
    }

    /// Returns the angle separating smooth edges from creases with the fewest mistakes, degrees.
    fn best_angle(&self, mesh: &Mesh, stored: &[DVec3]) -> f32 {
        let vertex = |half_edge: u32| mesh.triangles().as_flattened()[half_edge as usize] as usize;
        // Chords of angles. Across a small turn, creased normals differ by no more than the face normals: ask for less
        // than half.
        let chord = |turn: f64| (2.0 - 2.0 * turn).max(0.0).sqrt();
        let same = |a: u32, b: u32, turn: f64| {
            let least = chord(cos(SAME_EDGE_DEGREES)).min(0.5 * chord(turn));
            stored[vertex(a)].distance(stored[vertex(b)]) < least
        };
        let flat = cos(FLAT_DEGREES);
        let mut edges: Vec<(f64, bool)> = Vec::new();
        self.for_smoothable(|a, b, turn| {
            // The sides of a sheet face away from each other and are no evidence.
            if turn < flat && turn > OPPOSITE {
                let is_smooth = same(a, next_half_edge(b), turn) && same(next_half_edge(a), b, turn);
                edges.push((turn, is_smooth));
            }
        });
        edges.sort_by(|a, b| b.0.total_cmp(&a.0).then(b.1.cmp(&a.1)));
        // Start with all edges as creases: every smooth edge is a mistake.
        let mut mistakes = edges.iter().filter(|edge| edge.1).count();
        let (mut fewest, mut split) = (mistakes, 0);
        for (i, &(turn, is_smooth)) in edges.iter().enumerate() {
            if is_smooth {
                mistakes -= 1;
            } else {
                mistakes += 1;
            }
            let is_last = edges.get(i + 1).is_none_or(|next| next.0 != turn);
            if is_last && mistakes < fewest {
                (fewest, split) = (mistakes, i + 1);
            }
        }
        let degrees = |i: usize| edges[i].0.clamp(-1.0, 1.0).acos().to_degrees();
        match split {
            0 => 0.0,
            _ if split == edges.len() => 180.0,
            // Levels of detail turn by more at each edge: prefer too smooth over too hard.
            _ => (0.25 * degrees(split - 1) + 0.75 * degrees(split)) as f32,
        }
    }
}

fn places(mesh: &Mesh, triangle: [u32; 3]) -> [DVec3; 3] {
    triangle.map(|v| DVec3::from_array(mesh.positions()[v as usize].map(f64::from)))
}
