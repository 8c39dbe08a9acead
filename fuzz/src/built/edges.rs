//! How many triangles each edge has, by places.

use std::collections::{BTreeMap, BTreeSet};

use multires::mesh::Mesh;

type Place = [u32; 3];

/// Edges of triangles.
pub struct Edges {
    of: BTreeMap<[Place; 2], usize>,
    points: usize,
    triangles: usize,
}

impl Edges {
    /// Of triangles given by their corners. Those with two equal corners have none.
    pub fn of(triangles: impl Iterator<Item = [[f32; 3]; 3]>) -> Self {
        let mut edges = Self { of: BTreeMap::new(), points: 0, triangles: 0 };
        let mut points = BTreeSet::new();
        for triangle in triangles {
            // -0 equals 0.
            let [a, b, c] = triangle.map(|p| p.map(|x| (x + 0.0).to_bits()));
            if a == b || b == c || c == a {
                continue;
            }
            edges.triangles += 1;
            for [from, to] in [[a, b], [b, c], [c, a]] {
                *edges.of.entry([from.min(to), from.max(to)]).or_default() += 1;
                points.insert(from);
            }
        }
        edges.points = points.len();
        edges
    }

    /// Of a mesh.
    pub fn of_mesh(mesh: &Mesh) -> Self {
        Self::of(mesh.triangles().iter().map(|t| t.map(|v| mesh.positions()[v as usize])))
    }

    /// Whether no edge has an odd number of triangles: the surface has no border.
    pub fn are_even(&self) -> bool {
        self.of.values().all(|count| count % 2 == 0)
    }

    /// Whether all have two.
    pub fn are_two(&self) -> bool {
        self.of.values().all(|&count| count == 2)
    }

    /// Points less edges and triangles.
    pub fn euler(&self) -> i64 {
        self.points as i64 - self.of.len() as i64 + self.triangles as i64
    }
}
