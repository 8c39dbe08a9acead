//! What a server knows of its model besides the hierarchy: shared by all sessions.

use crate::geometry::lists::Lists;
use crate::hierarchy::VertexHierarchy;
use crate::mesh::NONE;

use super::bits::Bits;
use super::record::{DrawnMesh, Record, Run};

/// Tables of a hierarchy, 4 bytes an entry.
#[derive(Debug)]
pub(super) struct Tables {
    /// Per vertex, the end of its run of leaves at its coarsest.
    end: Vec<u32>,
    /// Per vertex, the vertices that part from it, coarsest first.
    parts: Lists,
    /// Per leaf, the triangles around it at full resolution.
    around: Lists,
    /// Per triangle, the split that brings it, or `NONE`.
    owner: Vec<u32>,
    /// Vertices of the coarsest mesh, by first leaf.
    pub base: Vec<u32>,
}

impl Tables {
    pub fn new(of: &VertexHierarchy) -> Self {
        let (vertices, splits) = (of.vertex_count(), of.split_count() as u32);
        let base = Self::base(of);
        // Ends while all splits so far are made.
        let mut end = vec![0; vertices];
        let mut now = vec![0; vertices];
        for (at, &vertex) in base.iter().enumerate() {
            let next = base.get(at + 1).map_or(of.leaf_count() as u32, |&next| of.first_leaf(next));
            end[vertex as usize] = next;
            now[vertex as usize] = next;
        }
        let mut pairs = Vec::new();
        for split in 0..splits {
            for &vertex in of.brings(split).iter().rev() {
                let to = of.substitute(vertex);
                end[vertex as usize] = now[to as usize];
                now[vertex as usize] = now[to as usize];
                now[to as usize] = of.first_leaf(vertex);
                pairs.push((to, vertex));
            }
        }
        let corners = (0_u32..).zip(of.triangles()).flat_map(|(t, leaves)| leaves.map(|leaf| (leaf, t)));
        let mut owner = vec![NONE; of.triangle_count()];
        for split in 0..splits {
            owner[of.owned(split).start as usize..of.owned(split).end as usize].fill(split);
        }
        Self {
            end,
            parts: Lists::from_pairs(vertices, pairs.into_iter()),
            around: Lists::from_pairs(of.leaf_count(), corners),
            owner,
            base,
        }
    }

    /// Returns the vertices of the coarsest mesh, by first leaf.
    pub fn base(of: &VertexHierarchy) -> Vec<u32> {
        let vertices = 0..of.vertex_count() as u32;
        let mut base: Vec<u32> = vertices.filter(|&vertex| of.split_of(vertex) == NONE).collect();
        base.sort_unstable_by_key(|&vertex| of.first_leaf(vertex));
        base
    }

    /// Returns the key of a split: the first leaf of the first vertex that comes.
    pub fn key(of: &VertexHierarchy, split: u32) -> u32 {
        of.brings(split).last().map_or(0, |&vertex| of.first_leaf(vertex))
    }

    /// Whether a split parts a run at its key, so that no other split has the key.
    pub fn is_keyed(of: &VertexHierarchy, split: u32) -> bool {
        let last = of.brings(split).last();
        last.is_some_and(|&vertex| of.first_leaf(vertex) != of.first_leaf(of.substitute(vertex)))
    }

    /// Returns the run of a vertex of the coarsest mesh.
    pub fn base_run(&self, of: &VertexHierarchy, vertex: u32) -> Run {
        Run { vertex, start: of.first_leaf(vertex), end: self.end[vertex as usize] }
    }

    pub fn memory(&self) -> usize {
        size_of_val(&self.end[..])
            + self.parts.memory()
            + self.around.memory()
            + size_of_val(&self.owner[..])
            + size_of_val(&self.base[..])
    }
}

/// Fills the record of a split.
pub(super) fn record_of(
    of: &VertexHierarchy,
    numbers: &[u32],
    channels: usize,
    split: u32,
    record: &mut Record,
) {
    record.start(Tables::key(of, split));
    record.firsts.clear();
    for &vertex in of.brings(split).iter().rev() {
        record.firsts.push(of.first_leaf(vertex));
        record.numbers.extend_from_slice(&numbers[vertex as usize * channels..][..channels]);
    }
    for triangle in of.owned(split) {
        record.triangles.push(of.triangles()[triangle as usize]);
        record.groups.push(of.group_of(triangle) as u16);
    }
}

/// The mesh of a client, by the splits it has.
pub(super) struct SetMesh<'a> {
    pub of: &'a VertexHierarchy,
    pub tables: &'a Tables,
    pub numbers: &'a [u32],
    pub channels: usize,
    pub has: &'a Bits,
}

impl DrawnMesh for SetMesh<'_> {
    fn leaves(&self) -> u32 {
        self.of.leaf_count() as u32
    }

    fn run(&self, leaf: u32) -> Run {
        let vertex = self.of.active(leaf, |split| self.has.has(split));
        // Splits of a vertex are nested: the first of its parts have parted.
        let parts = self.tables.parts.get(vertex);
        let parted = parts.partition_point(|&part| self.has.has(self.of.split_of(part)));
        let end = match parted.checked_sub(1) {
            Some(last) => self.of.first_leaf(parts[last]),
            None => self.tables.end[vertex as usize],
        };
        Run { vertex, start: self.of.first_leaf(vertex), end }
    }

    fn vertex(&self, leaf: u32) -> [u32; 2] {
        let vertex = self.of.active(leaf, |split| self.has.has(split));
        [vertex, self.of.first_leaf(vertex)]
    }

    fn numbers(&self, vertex: u32) -> &[u32] {
        &self.numbers[vertex as usize * self.channels..][..self.channels]
    }

    fn around(&self, leaf: u32, most: usize, mut each: impl FnMut([u32; 2])) {
        let all = self.tables.around.get(leaf);
        let drawn = |triangle: &&u32| {
            let owner = self.tables.owner[**triangle as usize];
            owner == NONE || self.has.has(owner)
        };
        if all.len() > most && all.iter().filter(drawn).nth(most).is_some() {
            return;
        }
        for &triangle in all.iter().filter(drawn) {
            let leaves = self.of.triangles()[triangle as usize];
            if let Some(at) = leaves.iter().position(|&corner| corner == leaf) {
                each([leaves[(at + 1) % 3], leaves[(at + 2) % 3]]);
            }
        }
    }
}
