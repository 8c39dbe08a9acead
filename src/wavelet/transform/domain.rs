//! Nodes: the degrees of freedom of a function on a subdivision, numbered level by level.
//!
//! For attributes, a node is a vertex: the surface is cut along its seams. For positions, a node is a point with all its
//! vertices. Hats, their supports and everything else about a function follow from the corners of faces as nodes.

use std::ops::Range;

use crate::mesh::NONE;
use crate::wavelet::subdivision::Part;

use super::super::{Subdivision, WaveletError, WaveletMesh};

/// Nodes of a subdivision: base nodes first, then level by level, so ends come before midpoints.
#[derive(Debug, Clone)]
pub(super) struct Domain {
    /// Per vertex its node.
    pub node_of: Vec<u32>,
    /// Per node its first vertex.
    pub vertex_of: Vec<u32>,
    /// Per node above the base, the nodes at the ends of its edge.
    ends: Vec<[u32; 2]>,
    /// End of the nodes of every level, from level 0, the base.
    levels: Vec<u32>,
}

impl Domain {
    /// Makes every vertex a node: seams are borders.
    pub fn of_vertices(subdivision: &Subdivision) -> Self {
        Self::new(subdivision, (0..subdivision.base_vertices).collect(), false)
    }

    /// Joins the vertices of each point into a node, so no function opens a seam.
    pub fn of_points(mesh: &WaveletMesh) -> Self {
        let of = &mesh.subdivision;
        let mut same = Joined::new(of.base_vertices);
        // Join along seams, by connectivity: right even where positions differ. Vertices of finer levels follow.
        for wavelet in of.wavelets_of(1) {
            let mut sides = of.faces_along(wavelet);
            let Some(first) = sides.next().map(|side| of.side_ends(side)) else { continue };
            for ends in sides.map(|side| of.side_ends(side)) {
                first.into_iter().zip(ends).for_each(|(a, b)| same.join(a, b));
            }
        }
        // Join base vertices at equal positions, where only vertices meet.
        let key = |vertex: u32| mesh.vertices.positions()[vertex as usize].map(|x| (x + 0.0).to_bits());
        let mut by_place: Vec<u32> = (0..of.base_vertices).collect();
        by_place.sort_unstable_by_key(|&vertex| (key(vertex), vertex));
        for pair in by_place.windows(2).filter(|pair| key(pair[0]) == key(pair[1])) {
            same.join(pair[0], pair[1]);
        }
        let first = (0..of.base_vertices).map(|vertex| same.first(vertex)).collect();
        Self::new(of, first, true)
    }

    /// `first`: per base vertex the first vertex of its node. `whole`: all vertices of a wavelet on a seam share a node.
    fn new(of: &Subdivision, first: Vec<u32>, whole: bool) -> Self {
        let mut node_of = vec![NONE; of.vertex_count()];
        let mut vertex_of = Vec::with_capacity(of.vertex_count());
        for (vertex, &first) in first.iter().enumerate() {
            node_of[vertex] = if first as usize == vertex {
                vertex_of.push(first);
                vertex_of.len() as u32 - 1
            } else {
                node_of[first as usize]
            };
        }
        let mut ends = Vec::with_capacity(of.wavelet_count());
        let mut levels = vec![vertex_of.len() as u32];
        for level in 1..=of.depth() {
            for wavelet in of.wavelets_of(level) {
                let own = of.vertex_of(wavelet);
                for vertex in std::iter::once(own).chain(of.seam_vertices_of(wavelet)) {
                    if whole && vertex != own {
                        node_of[vertex as usize] = node_of[own as usize];
                        continue;
                    }
                    node_of[vertex as usize] = vertex_of.len() as u32;
                    vertex_of.push(vertex);
                    let vertices = of.ends(vertex).unwrap_or_default();
                    ends.push(vertices.map(|end| node_of[end as usize]));
                }
            }
            levels.push(vertex_of.len() as u32);
        }
        Self { node_of, vertex_of, ends, levels }
    }

    pub fn len(&self) -> usize {
        self.vertex_of.len()
    }

    /// Number of base nodes.
    pub fn base(&self) -> usize {
        self.levels[0] as usize
    }

    pub fn depth(&self) -> usize {
        self.levels.len() - 1
    }

    /// Nodes new in a level; level 0 is the base. Empty out of range.
    pub fn nodes_of(&self, level: usize) -> Range<usize> {
        let end = |level: usize| self.levels.get(level).copied();
        match (level.checked_sub(1).and_then(end), end(level)) {
            (Some(start), Some(end)) => start as usize..end as usize,
            (None, Some(end)) => 0..end as usize,
            (_, None) => 0..0,
        }
    }

    /// Nodes at the ends of the edge whose midpoint a node is. Only for nodes above the base.
    #[inline]
    pub fn ends(&self, node: usize) -> [usize; 2] {
        self.ends[node - self.base()].map(|end| end as usize)
    }

    /// Returns the split faces of a level.
    ///
    /// # Errors
    /// A split and an unsplit face share a node: hats of the level would end inside their supports.
    pub fn split_faces(&self, of: &Subdivision, level: usize) -> Result<Vec<SplitFace>, WaveletError> {
        let nodes = |vertices: [u32; 3]| vertices.map(|vertex| self.node_of[vertex as usize]);
        let faces = of.faces_of(level);
        let mut split = Vec::with_capacity(faces.len());
        let mut touched = vec![false; self.nodes_of(level).end];
        for face in faces.clone().filter(|&face| of.is_split(face)) {
            let corners = nodes(of.corners(face));
            let wavelets = of.sides_of_split(face);
            // Where a seam runs inside the face, the first half's vertex stands for all: any lifting weights are valid, so
            // nothing is lost.
            let midpoints = nodes([0, 1, 2].map(|side| of.vertices_at(wavelets[side], face, side)[0]));
            corners.iter().for_each(|&node| touched[node as usize] = true);
            split.push(SplitFace { corners, midpoints });
        }
        if split.len() < faces.len() {
            let cut_off = |face: &u32| nodes(of.corners(*face)).iter().any(|&node| touched[node as usize]);
            if let Some(face) = faces.filter(|&face| !of.is_split(face)).find(cut_off) {
                let what = "faces of one component are not split equally deep: the base face";
                return Err(WaveletError::Invalid { what, at: of.base_face_of(face) as usize });
            }
        }
        Ok(split)
    }

    /// Per node above the base, returns the inner product of its hat with itself at the node's own level, in 48ths of the area
    /// of a face of the next coarser level.
    pub fn midpoint_products(&self, of: &Subdivision) -> Vec<u32> {
        let mut products = vec![0; self.len() - self.base()];
        for wavelet in 0..of.wavelet_count() as u32 {
            for side in of.faces_along(wavelet) {
                let (face, side) = (side.face(), side.side());
                let node = self.node_of[of.vertices_at(wavelet, face, side)[0] as usize];
                // Three of the four children touch the midpoint, each of 1/4 area x 1/6: 2/48.
                if of.is_split(face) {
                    for part in Part::ALL {
                        let (child, corner) = part.corner(side);
                        let node = self.node_of[of.corner(of.child(face, child), corner) as usize];
                        products[node as usize - self.base()] += 2;
                    }
                } else {
                    products[node as usize - self.base()] += 6;
                }
                if of.is_split(face) {
                    // A face with the edge on two sides: two children have both midpoints, each adding 1/12 of the child's
                    // area.
                    let twice = of.sides_of_split(face).iter().filter(|&&w| w == wavelet).count() as u32 - 1;
                    products[node as usize - self.base()] += 2 * twice;
                }
            }
        }
        products
    }

    /// Bytes of its arrays.
    pub fn memory(&self) -> usize {
        size_of_val(&self.node_of[..]) + size_of_val(&self.vertex_of[..]) + size_of_val(&self.ends[..])
    }
}

/// A split face as nodes; midpoint k is on the side from corner k to corner k + 1.
#[derive(Debug, Clone, Copy)]
pub(super) struct SplitFace {
    pub corners: [u32; 3],
    pub midpoints: [u32; 3],
}

/// Disjoint sets of vertices, each represented by its first vertex.
struct Joined(Vec<u32>);

impl Joined {
    fn new(count: u32) -> Self {
        Self((0..count).collect())
    }

    fn first(&mut self, mut vertex: u32) -> u32 {
        while self.0[vertex as usize] != vertex {
            let next = self.0[self.0[vertex as usize] as usize];
            self.0[vertex as usize] = next;
            vertex = next;
        }
        vertex
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.first(a), self.first(b));
        self.0[a.max(b) as usize] = a.min(b);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{Attribute, Mesh, names, shapes};
    use crate::wavelet::{WaveletBuilder, WaveletOptions};

    fn once(base: &Mesh) -> WaveletMesh {
        let mut builder = WaveletBuilder::new(base).unwrap();
        builder.subdivide(|midpoint| midpoint.middle).unwrap();
        builder.build(&WaveletOptions::default()).unwrap()
    }

    #[test]
    fn seams_are_one_wherever_their_vertices_lie() {
        let mut mesh = once(&shapes::box_with_face_normals(1));
        let points = Domain::of_points(&mesh);
        assert_eq!((points.base(), points.len()), (8, 8 + 18));
        // Move every vertex elsewhere.
        let apart = (0..mesh.vertices.positions().len()).map(|v| [v as f32, 0.0, 0.0]).collect();
        mesh.vertices = mesh.vertices.with_positions(apart);
        assert_eq!(Domain::of_points(&mesh).node_of, points.node_of);
        assert_eq!(Domain::of_vertices(&mesh.subdivision).len(), mesh.subdivision.vertex_count());
    }

    #[test]
    fn vertices_that_only_meet_are_one() {
        let positions =
            [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [-0.0, 0.0, 0.0], [-1.0, 0.0, 0.0]];
        let positions = [&positions[..], &[[-1.0, 1.0, 0.0]]].concat();
        let normals = [[0.0, 0.0, 1.0]; 3].into_iter().chain([[0.0, 1.0, 0.0]; 3]).collect::<Vec<_>>();
        let base = Mesh::new(positions, [[0, 1, 2], [3, 4, 5]]).unwrap();
        let base = base.with_attribute(Attribute::floats(names::NORMAL, &normals)).unwrap();
        let mesh = once(&base);
        let points = Domain::of_points(&mesh);
        assert_eq!(points.node_of[0], points.node_of[3]);
        assert_eq!((points.base(), points.len()), (5, 5 + 6));
    }
}
