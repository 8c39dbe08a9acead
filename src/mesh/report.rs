//! Counts, borders and non-manifold parts of a mesh, by stored vertex or by welded point.
//!
//! ```text
//!     border edge           one triangle           non-manifold vertex     its triangles form more than one fan,
//!     flipped edge          two, the same way                              fans being joined by edges at the vertex
//!     non-manifold edge     three or more          component               triangles joined by shared vertices
//! ```
//!
//! Edges, fans and Euler characteristic leave out triangles that name a vertex twice: they have no area and no three
//! edges. Everything is counted in O(n log n) at worst.

use std::fmt;

use super::edges::next_half_edge;
use super::near::near_twins;
use super::{Edges, Mesh, NONE, Topology, names};

/// What a mesh is made of. All counts are of *vertices* as [`Report::new`] or [`Report::welded`] understands them.
#[derive(Debug, Clone, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Report {
    /// Vertices, whether a triangle uses them or not.
    pub vertices: usize,
    /// Triangles as stored, degenerate ones included.
    pub triangles: usize,
    /// Edges with one triangle.
    pub border_edges: usize,
    /// Edges with three triangles or more.
    pub non_manifold_edges: usize,
    /// Vertices whose triangles form more than one fan.
    pub non_manifold_vertices: usize,
    /// Edges with two triangles that run along them the same way.
    pub flipped_edges: usize,
    /// Sets of triangles joined by shared vertices.
    pub components: usize,
    /// Used vertices less edges plus faces, triangles that name a vertex twice left out.
    pub euler_characteristic: i64,
    /// Stored vertices less distinct positions, welded or not.
    pub duplicate_vertices: usize,
    /// Triangles on the same three vertices as an earlier one, in any order.
    pub duplicate_triangles: usize,
    /// Triangles that name a vertex twice, or whose area is at most 1e-10 of the square of their longest edge.
    pub degenerate_triangles: usize,
    /// Vertices that no triangle uses.
    pub unused_vertices: usize,
    /// Positions at which triangles see more than one texture coordinate (the first set).
    pub seam_vertices: usize,
    /// Stored vertices that differ from one another in position or any attribute, bit for bit.
    pub wedges: usize,
    /// Points on open borders that nearly coincide with another, an earlier one: within 1e-6 of the diagonal, or 8 steps of
    /// 2^-23 of the largest coordinate where that is more, and within a quarter of the shortest edge at either. Where a
    /// surface should be closed, its sides were computed twice.
    pub near_twins: usize,
    /// The distance that makes each of them one point with its twin ([`Mesh::welded`]), object units; 0 where there are none.
    pub twin_distance: f64,
    /// Length of the diagonal of the box around all used vertices, object units.
    pub diagonal: f64,
}

impl Report {
    /// Counts by stored vertex: what is joined is what shares an index.
    pub fn new(mesh: &Mesh) -> Self {
        let topology = Topology::new(mesh);
        Self::count(mesh, &topology, mesh.triangles(), mesh.positions().len())
    }

    /// Counts by point: vertices at the same position (bit for bit) count as one.
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

    /// Whether no edge is a border. True without triangles too.
    pub fn is_closed(&self) -> bool {
        self.border_edges == 0
    }

    /// Whether every edge has at most two triangles and every vertex one fan of them, so that the surface is a
    /// manifold, with border or without. Says nothing of orientation, nor of geometry.
    pub fn is_manifold(&self) -> bool {
        self.non_manifold_edges == 0 && self.non_manifold_vertices == 0
    }

    /// The number of handles, summed over the components; `None` unless the surface is closed, manifold, and
    /// consistently oriented, and there is one.
    pub fn genus(&self) -> Option<u32> {
        let whole = self.triangles > 0 && self.is_closed() && self.is_manifold() && self.flipped_edges == 0;
        let doubled = 2 * self.components as i64 - self.euler_characteristic;
        (whole && doubled % 2 == 0).then(|| u32::try_from(doubled / 2).ok()).flatten()
    }
}

/// A block of aligned lines: a count, its parts indented below it.
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

/// A count with commas between the thousands.
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

/// Sets of vertices joined by triangles, those of one unused vertex included.
fn components(corner_points: &[[u32; 3]], vertices: usize) -> usize {
    let mut sets = Sets::new(vertices);
    for &[a, b, c] in corner_points {
        sets.join(a, b);
        sets.join(a, c);
    }
    sets.count()
}

/// Joins the corners at both ends of every edge into fans, and counts vertices with more than one.
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

/// Triangles that repeat an earlier one's three vertices. Looked for at the edge between a triangle's two lowest.
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

/// In double precision, in which no finite input overflows.
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

/// Disjoint sets. The lowest item leads, so that nothing depends on the order of joining.
struct Sets {
    parent: Vec<u32>,
}

impl Sets {
    fn new(count: usize) -> Self {
        Self { parent: (0..count as u32).collect() }
    }

    fn find(&mut self, mut item: u32) -> u32 {
        loop {
            let parent = self.parent[item as usize];
            if parent == item {
                return item;
            }
            let above = self.parent[parent as usize];
            self.parent[item as usize] = above;
            item = above;
        }
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.find(a), self.find(b));
        self.parent[a.max(b) as usize] = a.min(b);
    }

    fn count(&self) -> usize {
        self.parent.iter().enumerate().filter(|&(item, &parent)| item as u32 == parent).count()
    }
}
