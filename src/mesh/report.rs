//! Counts, borders and non-manifold parts of a mesh, by stored vertex or by welded point.
//!
//! ```text
//!     border edge           one triangle           non-manifold vertex     its triangles form more than one fan,
//!     flipped edge          two, the same way                              fans being joined by edges at the vertex
//!     non-manifold edge     three or more          component               triangles joined by shared vertices
//! ```
//!
//! Edges, fans and Euler characteristic leave out triangles naming a vertex twice: they have no area and fewer than
//! three edges. All counts take O(n log n) at worst.

use std::fmt;

use crate::geometry::sets::Sets;

use super::edges::next_half_edge;
use super::near::near_twins;
use super::{Edges, Mesh, NONE, Topology, names};

/// Counts of the parts of a mesh. *Vertices* are stored vertices ([`Report::new`]) or points ([`Report::welded`]).
///
/// ```
/// use multires::mesh::{Report, shapes};
///
/// let report = Report::new(&shapes::torus(1.0, 0.4, 16, 8));
/// assert!(report.is_closed() && report.is_manifold());
/// assert_eq!(report.genus(), Some(1));
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Report {
    /// Vertices, used by triangles or not.
    pub vertices: usize,
    /// Triangles as stored, degenerate triangles included.
    pub triangles: usize,
    /// Edges with 1 triangle.
    pub border_edges: usize,
    /// Edges with 3 or more triangles.
    pub non_manifold_edges: usize,
    /// Vertices whose triangles form more than 1 fan.
    pub non_manifold_vertices: usize,
    /// Edges with 2 triangles running along them in the same direction.
    pub flipped_edges: usize,
    /// Sets of triangles joined by shared vertices.
    pub components: usize,
    /// `used vertices - edges + faces`, without triangles naming a vertex twice.
    pub euler_characteristic: i64,
    /// `stored vertices - distinct positions`, welded or not.
    pub duplicate_vertices: usize,
    /// Triangles on the same three vertices as an earlier triangle, in any order.
    pub duplicate_triangles: usize,
    /// Triangles naming a vertex twice, or with `area <= 1e-10 * (longest edge)^2`.
    pub degenerate_triangles: usize,
    /// Vertices used by no triangle.
    pub unused_vertices: usize,
    /// Positions with more than 1 texture coordinate (first set) among their triangles.
    pub seam_vertices: usize,
    /// Number of distinct stored vertices, compared by position and all attributes.
    pub wedges: usize,
    /// Border points nearly coincident with an earlier border point: within 1e-6 of the diagonal (or 8 steps of 2^-23
    /// of the largest coordinate, if more), and within a quarter of the shortest edge at either. On a surface meant to
    /// be closed, near twins are sides computed twice.
    pub near_twins: usize,
    /// Distance at which [`Mesh::welded`] merges all near twins, object units; 0 without near twins.
    pub twin_distance: f64,
    /// Length of the diagonal of the bounding box of all used vertices, object units.
    pub diagonal: f64,
}

impl Report {
    /// Counts by stored vertex: triangles are joined where they share an index.
    pub fn new(mesh: &Mesh) -> Self {
        let topology = Topology::new(mesh);
        Self::count(mesh, &topology, mesh.triangles(), mesh.positions().len())
    }

    /// Counts by point: vertices at equal positions (-0 equals 0) count once.
    pub fn welded(mesh: &Mesh) -> Self {
        let topology = Topology::new(mesh);
        let corner_points: Vec<_> =
            mesh.triangles().iter().map(|corners| topology.points(*corners)).collect();
        Self::count(mesh, &topology, &corner_points, topology.point_count())
    }

    fn count(mesh: &Mesh, topology: &Topology, corner_points: &[[u32; 3]], vertices: usize) -> Self {
        let edges = Edges::new(corner_points, vertices);
        let every_edge = || 0..edges.len() as u32;
        let used = mark_used(corner_points, vertices);
        let unused_vertices = used.iter().filter(|&&u| !u).count();
        let points_differ = vertices != topology.point_count();
        let (near_twins, twin_distance) = if points_differ {
            let points: Vec<_> = mesh.triangles().iter().map(|t| topology.points(*t)).collect();
            near_twins(mesh, topology, &Edges::new(&points, topology.point_count()))
        } else {
            near_twins(mesh, topology, &edges)
        };
        let in_faces = if corner_points.iter().any(|&corners| repeats(corners)) {
            let faces: Vec<_> = corner_points.iter().copied().filter(|&corners| !repeats(corners)).collect();
            let used = mark_used(&faces, vertices).iter().filter(|&&u| u).count();
            [used, faces.len()]
        } else {
            [vertices - unused_vertices, corner_points.len()]
        };
        Self {
            vertices,
            triangles: corner_points.len(),
            border_edges: every_edge().filter(|&e| edges.is_border(e)).count(),
            non_manifold_edges: every_edge().filter(|&e| edges.is_non_manifold(e)).count(),
            non_manifold_vertices: non_manifold_vertices(corner_points, vertices, &edges),
            flipped_edges: every_edge().filter(|&e| edges.is_flipped(e)).count(),
            components: components(corner_points, vertices) - unused_vertices,
            euler_characteristic: in_faces[0] as i64 - edges.len() as i64 + in_faces[1] as i64,
            duplicate_vertices: mesh.positions().len() - topology.point_count(),
            duplicate_triangles: duplicate_triangles(corner_points, &edges),
            degenerate_triangles: degenerate_triangles(mesh, corner_points),
            unused_vertices,
            seam_vertices: seam_vertices(mesh, topology),
            wedges: topology.wedge_count(),
            near_twins,
            twin_distance,
            diagonal: mesh.diagonal(),
        }
    }

    /// Whether no edge is a border. True for a mesh without triangles.
    pub fn is_closed(&self) -> bool {
        self.border_edges == 0
    }

    /// Whether every edge has at most 2 triangles and every vertex 1 fan of triangles: a manifold, with border or
    /// without. Does not check orientation or geometry.
    pub fn is_manifold(&self) -> bool {
        self.non_manifold_edges == 0 && self.non_manifold_vertices == 0
    }

    /// Returns the number of handles, summed over the components. `None` without triangles, or unless the surface is
    /// closed, manifold and consistently oriented.
    pub fn genus(&self) -> Option<u32> {
        let whole = self.triangles > 0 && self.is_closed() && self.is_manifold() && self.flipped_edges == 0;
        let doubled = 2 * self.components as i64 - self.euler_characteristic;
        (whole && doubled % 2 == 0).then(|| u32::try_from(doubled / 2).ok()).flatten()
    }
}

/// Writes a block of aligned lines: a count, its parts indented below it.
impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let counts = [
            ("vertices", self.vertices),
            ("  unused", self.unused_vertices),
            ("  duplicate", self.duplicate_vertices),
            ("  near twins", self.near_twins),
            ("  at seams", self.seam_vertices),
            ("  non-manifold", self.non_manifold_vertices),
            ("wedges", self.wedges),
            ("triangles", self.triangles),
            ("  duplicate", self.duplicate_triangles),
            ("  degenerate", self.degenerate_triangles),
            ("border edges", self.border_edges),
            ("non-manifold edges", self.non_manifold_edges),
            ("flipped edges", self.flipped_edges),
            ("components", self.components),
        ];
        for (label, count) in counts {
            writeln!(f, "{label:<20}{:>15}", grouped(count))?;
        }
        writeln!(f, "{:<20}{:>15}", "Euler characteristic", self.euler_characteristic)?;
        match self.genus() {
            Some(genus) => writeln!(f, "{:<20}{genus:>15}", "genus")?,
            None => writeln!(f, "{:<20}{:>15}", "genus", "-")?,
        }
        writeln!(f, "{:<20}{:>15.4}", "diagonal", self.diagonal)?;
        let closed = if self.is_closed() { "closed" } else { "open" };
        let manifold = if self.is_manifold() { "manifold" } else { "non-manifold" };
        write!(f, "{:<20}{:>15}", "surface", format!("{closed}, {manifold}"))
    }
}

/// Formats a count with commas between thousands.
fn grouped(count: usize) -> String {
    let digits = count.to_string();
    let mut text = String::with_capacity(digits.len() * 4 / 3);
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

fn repeats([a, b, c]: [u32; 3]) -> bool {
    a == b || b == c || c == a
}

fn mark_used(corner_points: &[[u32; 3]], vertices: usize) -> Vec<bool> {
    let mut used = vec![false; vertices];
    corner_points.as_flattened().iter().for_each(|&p| used[p as usize] = true);
    used
}

/// Counts the sets of vertices joined by triangles. An unused vertex is a set of its own.
fn components(corner_points: &[[u32; 3]], vertices: usize) -> usize {
    let mut sets = Sets::new(vertices);
    for &[a, b, c] in corner_points {
        sets.join(a, b);
        sets.join(a, c);
    }
    sets.count()
}

/// Joins the corners at both ends of every edge into fans. Counts vertices with more than 1 fan.
fn non_manifold_vertices(corner_points: &[[u32; 3]], vertices: usize, edges: &Edges) -> usize {
    let mut fans = Sets::new(3 * corner_points.len());
    for edge in 0..edges.len() as u32 {
        let (forward, backward) = (edges.forward(edge), edges.backward(edge));
        let mut first: Option<[u32; 2]> = None;
        let at_ends = forward
            .iter()
            .map(|&h| [h, next_half_edge(h)])
            .chain(backward.iter().map(|&h| [next_half_edge(h), h]));
        for [low, high] in at_ends {
            let first = first.get_or_insert([low, high]);
            fans.join(first[0], low);
            fans.join(first[1], high);
        }
    }
    let mut fan_of = vec![NONE; vertices];
    let mut many = vec![false; vertices];
    for (triangle, &corners) in corner_points.iter().enumerate() {
        if repeats(corners) {
            continue;
        }
        for (k, &point) in corners.iter().enumerate() {
            let fan = fans.find((3 * triangle + k) as u32);
            let slot = &mut fan_of[point as usize];
            many[point as usize] |= *slot != NONE && *slot != fan;
            *slot = fan;
        }
    }
    many.iter().filter(|&&m| m).count()
}

/// Counts triangles on the same three vertices as an earlier triangle. Compares triangles at the edge between their two
/// lowest vertices.
fn duplicate_triangles(corner_points: &[[u32; 3]], edges: &Edges) -> usize {
    let mut duplicates = 0;
    let mut opposite = Vec::new();
    for (edge, &[_, high]) in edges.ends().iter().enumerate() {
        let half_edges = edges.half_edges(edge as u32);
        if half_edges.len() < 2 {
            continue;
        }
        opposite.clear();
        opposite.extend(half_edges.iter().map(|&h| corner_points[h as usize / 3][(h as usize + 2) % 3]));
        opposite.retain(|&point| point > high);
        opposite.sort_unstable();
        duplicates += opposite.windows(2).filter(|pair| pair[0] == pair[1]).count();
    }
    duplicates
}

/// Computes in double precision, where no finite input overflows.
fn degenerate_triangles(mesh: &Mesh, corner_points: &[[u32; 3]]) -> usize {
    let is_flat = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map(|v| glam::Vec3::from(mesh.positions()[v as usize]).as_dvec3());
        let longest = (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared());
        (b - a).cross(c - a).length() / 2.0 <= 1e-10 * longest
    };
    let both = mesh.triangles().iter().zip(corner_points);
    both.filter(|(corners, points)| repeats(**points) || is_flat(corners)).count()
}

fn seam_vertices(mesh: &Mesh, topology: &Topology) -> usize {
    let Some(uv) = mesh.attribute(names::UV) else { return 0 };
    let mut first_at = vec![NONE; topology.point_count()];
    let mut seam = vec![false; topology.point_count()];
    for &vertex in mesh.indices() {
        let point = topology.point_of()[vertex as usize] as usize;
        match first_at[point] {
            NONE => first_at[point] = vertex,
            first => seam[point] |= first != vertex && uv.words(first) != uv.words(vertex),
        }
    }
    seam.iter().filter(|&&s| s).count()
}
