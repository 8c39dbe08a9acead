//! A cluster hierarchy as meshoptimizer builds it (`clusterlod`), and its selection on the CPU.
//!
//! A cluster is drawn where the error of its group is too large on the screen, and that of the group from which it was
//! simplified is not. A tree of bounds over the groups of each level finds those without looking at all.

use std::error::Error;

use meshopt::clusterlod::{
    ClodBounds, ClodGroup, ClodMesh, ClodNode, clod_build, clod_build_hierarchy, clod_default_config,
};
use meshopt::{VertexDataAdapter, typed_to_bytes};
use multires::mesh::Mesh;

const TRIANGLES_A_CLUSTER: usize = 128;
const CHILDREN_A_NODE: usize = 8;

/// Clusters at all levels.
pub(crate) struct ClusterDag {
    groups: Vec<ClodGroup>,
    nodes: Vec<ClodNode>,
    levels: usize,
    /// Per group its first cluster; one more than groups.
    first: Vec<u32>,
    clusters: Vec<Cluster>,
    indices: Vec<u32>,
    stack: Vec<u32>,
}

#[derive(Clone, Copy)]
struct Cluster {
    /// The group that it was simplified from, or -1.
    refined: i32,
    start: u32,
    end: u32,
    /// Sphere around it.
    centre: [f32; 3],
    radius: f32,
}

/// Where it is looked at from.
#[derive(Clone, Copy)]
pub(crate) struct Look {
    pub eye: [f32; 3],
    /// Distance up to which an error of one is too large.
    pub reach: f32,
    pub near: f32,
}

impl Look {
    #[inline]
    fn too_large(&self, bounds: &ClodBounds) -> bool {
        let [x, y, z] = std::array::from_fn(|i| bounds.center[i] - self.eye[i]);
        let distance = (x * x + y * y + z * z).sqrt();
        bounds.error * self.reach > (distance - bounds.radius).max(self.near)
    }
}

impl ClusterDag {
    /// Clusters of 128 triangles at most, by positions alone, all else as its authors set it.
    pub fn build(mesh: &Mesh) -> Result<Self, Box<dyn Error>> {
        let bytes = typed_to_bytes(mesh.positions());
        let vertices = VertexDataAdapter::new(bytes, size_of::<[f32; 3]>(), 0)?;
        let (mut groups, mut first) = (Vec::new(), vec![0]);
        let (mut clusters, mut indices) = (Vec::new(), Vec::new());
        let config = clod_default_config(TRIANGLES_A_CLUSTER);
        clod_build(config, &ClodMesh::new(mesh.indices(), &vertices), |group, made| {
            for cluster in made {
                let start = indices.len() as u32;
                indices.extend_from_slice(cluster.indices);
                clusters.push(Cluster {
                    refined: cluster.refined,
                    start,
                    end: indices.len() as u32,
                    centre: cluster.bounds.center,
                    radius: cluster.bounds.radius,
                });
            }
            groups.push(group);
            first.push(clusters.len() as u32);
            groups.len() as i32 - 1
        });
        let levels = groups.iter().map(|group| group.depth as usize + 1).max().unwrap_or(0);
        let nodes = clod_build_hierarchy(&groups, CHILDREN_A_NODE, levels);
        Ok(Self { groups, nodes, levels, first, clusters, indices, stack: Vec::new() })
    }

    /// The clusters to draw.
    pub fn select(&mut self, look: Look, selected: &mut Vec<u32>) {
        selected.clear();
        self.stack.clear();
        self.stack.extend(0..self.levels as u32);
        while let Some(node) = self.stack.pop() {
            let node = &self.nodes[node as usize];
            if !look.too_large(&node.bounds) {
                continue;
            }
            if node.group < 0 {
                self.stack.extend(node.child_offset..node.child_offset + node.child_count);
                continue;
            }
            let group = node.group as usize;
            for cluster in self.first[group]..self.first[group + 1] {
                let refined = self.clusters[cluster as usize].refined;
                if refined < 0 || !look.too_large(&self.groups[refined as usize].simplified) {
                    selected.push(cluster);
                }
            }
        }
    }

    /// Triangles of those selected clusters whose spheres reach inside all planes (unit normals inward, offsets).
    pub fn inside(&self, selected: &[u32], planes: &[[f64; 4]; 5]) -> usize {
        let clusters = selected.iter().map(|&cluster| &self.clusters[cluster as usize]);
        let inside = clusters.filter(|cluster| {
            let [px, py, pz] = cluster.centre.map(f64::from);
            planes.iter().all(|[x, y, z, w]| x * px + y * py + z * pz + w >= -f64::from(cluster.radius))
        });
        inside.map(|cluster| (cluster.end - cluster.start) as usize / 3).sum()
    }

    /// The indices of all that is drawn, in one buffer.
    pub fn concatenate(&self, selected: &[u32], out: &mut Vec<u32>) {
        out.clear();
        for &cluster in selected {
            let Cluster { start, end, .. } = self.clusters[cluster as usize];
            out.extend_from_slice(&self.indices[start as usize..end as usize]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use multires::mesh::shapes;

    /// From afar one cluster or two, from nearby what was put in, and in between every edge of a closed mesh twice.
    #[test]
    fn selections_are_whole() {
        let mesh = shapes::icosphere(5);
        let mut dag = ClusterDag::build(&mesh).unwrap();
        let (mut selected, mut indices) = (Vec::new(), Vec::new());
        let mut counts = Vec::new();
        for reach in [0.01, 10.0, 30.0, 100.0, 300.0, 1e9] {
            dag.select(Look { eye: [3.0, 0.0, 0.0], reach, near: 1e-6 }, &mut selected);
            dag.concatenate(&selected, &mut indices);
            counts.push(indices.len() / 3);
            let mut edges: Vec<[u32; 2]> =
                indices.chunks_exact(3).flat_map(|t| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]]).collect();
            edges.sort_unstable();
            assert!(edges.iter().all(|&[a, b]| edges.binary_search(&[b, a]).is_ok()));
        }
        assert!(counts.is_sorted() && counts[0] < 256);
        assert_eq!(*counts.last().unwrap(), mesh.triangles().len());
    }
}
