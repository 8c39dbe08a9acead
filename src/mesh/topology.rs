//! Points (vertices at equal positions) and wedges (vertices equal in every value).
//!
//! ```text
//!     vertex   what an index names: a position and one value of every attribute
//!     wedge    vertices equal in position and in all attributes; named by its lowest vertex
//!     point    vertices equal in position; a seam or crease is a point with several wedges
//! ```
//!
//! Points are exact (-0 equals 0): welding never moves a vertex. Wedges are equal bit for bit ([`Topology::new`]), or
//! within tolerances ([`Topology::with`]).

use super::group::{Key, group};
use super::tolerances::Comparison;
use super::{Attribute, Mesh, NONE, Tolerances};

/// Maximum number of a point's wedges compared with a vertex, the lowest first: enough for any corner of a real model,
/// and no quadratic time at a point of very many wedges.
const MOST_COMPARED: usize = 64;

/// Points and wedges of a mesh. Built in O(n) expected time; 12 bytes a vertex.
///
/// ```
/// use multires::mesh::{Topology, shapes};
///
/// // A cube with a normal per side: 24 vertices at 8 points.
/// let mesh = shapes::box_with_face_normals(1);
/// let topology = Topology::new(&mesh);
/// assert_eq!((topology.point_count(), topology.wedge_count()), (8, 24));
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Topology {
    point_of: Vec<u32>,
    wedge_of: Vec<u32>,
    vertex_of_point: Vec<u32>,
}

impl Topology {
    /// Finds the points and wedges of a mesh. Wedges are equal bit for bit.
    pub fn new(mesh: &Mesh) -> Self {
        Self::with(mesh, &Tolerances::exact())
    }

    /// Finds the points and wedges of a mesh. Vertices of a point within the tolerances are a single wedge.
    ///
    /// Processes vertices in ascending order. Each vertex joins the lowest wedge whose naming vertex agrees within the
    /// tolerances, or names a new wedge. So every wedge lies within the tolerances of its naming vertex, even where
    /// values drift along a ring of vertices. Only the 64 lowest wedges of a point are compared; later wedges accept
    /// only equal vertices. Points are exact: [`Tolerances::position`] is not used.
    pub fn with(mesh: &Mesh, tolerances: &Tolerances) -> Self {
        let positions: Vec<[u32; 3]> = mesh.positions().iter().map(|p| p.map(position_word)).collect();
        let leader =
            group(positions.len(), |key, v| hash(key, positions[v]), |a, b| positions[a] == positions[b]);

        let mut point_of = vec![NONE; leader.len()];
        let mut vertex_of_point = Vec::with_capacity(leader.len());
        for (vertex, &first) in leader.iter().enumerate() {
            if first as usize == vertex {
                point_of[vertex] = vertex_of_point.len() as u32;
                vertex_of_point.push(first);
            } else {
                point_of[vertex] = point_of[first as usize];
            }
        }
        let wedge_of = if vertex_of_point.len() == leader.len() {
            leader
        } else {
            let comparison = Comparison::new(mesh, tolerances);
            let same = |a: usize, b: usize| leader[a] == leader[b] && comparison.equal(a as u32, b as u32);
            let hash_of = |key: Key, v: usize| {
                let words = comparison.words(v as u32);
                words.fold(key.mix(u64::from(leader[v])), |hash, word| key.mix(hash ^ u64::from(word)))
            };
            let mut wedge_of = group(leader.len(), hash_of, same);
            if !comparison.is_exact() {
                join_near(&mut wedge_of, &point_of, vertex_of_point.len(), |a, b| comparison.near(a, b));
            }
            wedge_of
        };
        Self { point_of, wedge_of, vertex_of_point }
    }

    /// Merges points: `twin[p]` is an earlier point, or `p` itself. A merged point lies at its lowest vertex. Wedges
    /// within the tolerances merge. O(vertices).
    pub(crate) fn with_twins(&self, mesh: &Mesh, tolerances: &Tolerances, twin: &[u32]) -> Self {
        let mut number = vec![NONE; twin.len()];
        let mut vertex_of_point = Vec::with_capacity(twin.len());
        for (point, &to) in twin.iter().enumerate() {
            if to as usize == point {
                number[point] = vertex_of_point.len() as u32;
                vertex_of_point.push(self.vertex_of_point[point]);
            } else {
                number[point] = number[to as usize];
            }
        }
        let point_of: Vec<u32> = self.point_of.iter().map(|&point| number[point as usize]).collect();
        let mut wedge_of = self.wedge_of.clone();
        let comparison = Comparison::new(mesh, tolerances);
        join_near(&mut wedge_of, &point_of, vertex_of_point.len(), |a, b| comparison.near(a, b));
        Self { point_of, wedge_of, vertex_of_point }
    }

    /// Returns the points of three vertices.
    pub(super) fn points(&self, corners: [u32; 3]) -> [u32; 3] {
        corners.map(|v| self.point_of[v as usize])
    }

    /// Number of distinct positions.
    pub fn point_count(&self) -> usize {
        self.vertex_of_point.len()
    }

    /// Number of distinct wedges.
    pub fn wedge_count(&self) -> usize {
        self.wedge_of.iter().enumerate().filter(|&(v, &w)| v as u32 == w).count()
    }

    /// Point of every vertex. Points are numbered in order of their lowest vertex.
    pub fn point_of(&self) -> &[u32] {
        &self.point_of
    }

    /// Naming vertex of each vertex's wedge: the lowest vertex equal to it in position and all attributes, or within
    /// the tolerances of it.
    pub fn wedge_of(&self) -> &[u32] {
        &self.wedge_of
    }

    /// Returns, for each vertex, the lowest vertex equal in position and in a single attribute.
    pub(crate) fn equal_values(&self, attribute: &Attribute) -> Vec<u32> {
        let count = self.point_of.len();
        if self.vertex_of_point.len() == count {
            return (0..count as u32).collect();
        }
        let hash_of = |key: Key, v: usize| {
            let words = attribute.words(v as u32).iter();
            words.fold(key.mix(u64::from(self.point_of[v])), |hash, &word| key.mix(hash ^ u64::from(word)))
        };
        group(count, hash_of, |a, b| {
            self.point_of[a] == self.point_of[b] && attribute.words(a as u32) == attribute.words(b as u32)
        })
    }

    /// Lowest vertex at every point.
    pub fn vertex_of_point(&self) -> &[u32] {
        &self.vertex_of_point
    }
}

/// Merges near wedges of a point: each joins the lowest near wedge that keeps its name. O(wedges).
fn join_near(wedge_of: &mut [u32], point_of: &[u32], points: usize, near: impl Fn(u32, u32) -> bool) {
    // Wedges that keep their names, as lists: first and last per point, next per wedge.
    let mut ends = vec![[NONE; 2]; points];
    let mut next = vec![NONE; wedge_of.len()];
    for vertex in 0..wedge_of.len() as u32 {
        let named = wedge_of[vertex as usize];
        if named != vertex {
            // Its own wedge has a lower number, so it is settled.
            wedge_of[vertex as usize] = wedge_of[named as usize];
            continue;
        }
        let [first, last] = &mut ends[point_of[vertex as usize] as usize];
        let some = |wedge: u32| (wedge != NONE).then_some(wedge);
        let kept = std::iter::successors(some(*first), |&wedge| some(next[wedge as usize]));
        let lowest = kept.take(MOST_COMPARED).find(|&wedge| near(wedge, vertex));
        match lowest {
            Some(wedge) => wedge_of[vertex as usize] = wedge,
            None if *first == NONE => [*first, *last] = [vertex; 2],
            None => {
                next[*last as usize] = vertex;
                *last = vertex;
            }
        }
    }
}

/// The bits of a coordinate; -0 becomes 0.
fn position_word(x: f32) -> u32 {
    (x + 0.0).to_bits()
}

fn hash(key: Key, words: [u32; 3]) -> u64 {
    let low = u64::from(words[0]) | u64::from(words[1]) << 32;
    key.mix(key.mix(low) ^ u64::from(words[2]))
}
