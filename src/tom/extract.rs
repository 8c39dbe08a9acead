//! The indices of a resolution: copy the first triangles, then replace every inactive corner.
//!
//! At full resolution, extraction is a copy. Below it, corners need different numbers of hops along their substitution
//! chains, and a loop per corner would spend its time on mispredicted branches. Two ways avoid them:
//!
//! - A table with the active substitute of every vertex. Substitutes come before the vertices they replace, so a single pass
//!   in order fills the table with one load a vertex. Corners are then looked up. Best where there are enough corners to pay
//!   for it.
//! - For coarse resolutions, corners in lanes of eight, each making some hops as conditional moves, then hops in lanes until
//!   all eight are active. Where chains turn out long, the table takes over.

use super::{Resolution, TotallyOrderedMesh};
use crate::mesh::NONE;

/// Corners hopping together.
const LANES: usize = 8;
/// Hops made by all lanes before the first test for active corners.
const HOPS: usize = 3;

/// The range of a material's triangles in a filled index buffer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub struct MaterialRange {
    /// The material id; `u32::MAX` where triangles are not separated by material.
    pub material: u32,
    /// First index in the buffer.
    pub start: u32,
    /// Number of indices in the range, three per triangle.
    pub count: u32,
}

impl TotallyOrderedMesh {
    /// Returns the number of indices of a resolution.
    pub fn index_count(&self, resolution: Resolution) -> usize {
        3 * self.clamp(resolution).triangles()
    }

    /// Fills `out` with the indices of a resolution, replacing its contents. All indices are below [`Resolution::vertices`].
    ///
    /// O(output + vertices) if there are at least a quarter as many indices as vertices, else O(output * mean number of
    /// hops), see [`TotallyOrderedMesh::traversal_overhead`], and never more than O(output + vertices). The room behind the indices serves as a table: allocates only
    /// if the capacity of `out` is below indices plus vertices.
    pub fn fill_indices(&self, resolution: Resolution, out: &mut Vec<u32>) {
        let resolution = self.clamp(resolution);
        out.clear();
        out.extend_from_slice(self.stored(resolution));
        self.substitute_in(resolution.vertices, out);
    }

    /// Writes the indices of a resolution to the front of `out`, as many whole triangles as fit. Returns the number of
    /// indices written. [`TotallyOrderedMesh::index_count`] returns the number needed.
    pub fn write_indices(&self, resolution: Resolution, out: &mut [u32]) -> usize {
        let resolution = self.clamp(resolution);
        let stored = self.stored(resolution);
        let count = stored.len().min(out.len() / 3 * 3);
        out[..count].copy_from_slice(&stored[..count]);
        let done = substitute_lanes(&self.substitute, resolution.vertices, &mut out[..count]);
        if done < count {
            let mut table = Vec::with_capacity(self.substitute.len());
            self.extend_by_table(resolution.vertices, &mut table);
            out[done..count].iter_mut().for_each(|corner| *corner = table[*corner as usize]);
        }
        count
    }

    /// Fills `out` with the indices of a resolution sorted by material, and `ranges` with an entry per material, in the
    /// order of [`TotallyOrderedMesh::material_ids`], empty ranges included: a drawing call each. Within a material, keeps
    /// the order of [`TotallyOrderedMesh::fill_indices`]. A mesh without materials has a single range.
    pub fn fill_by_material(
        &self,
        resolution: Resolution,
        out: &mut Vec<u32>,
        ranges: &mut Vec<MaterialRange>,
    ) {
        ranges.clear();
        if self.material_of.is_empty() {
            self.fill_indices(resolution, out);
            let material = self.material_ids.first().copied().unwrap_or(NONE);
            ranges.push(MaterialRange { material, start: 0, count: out.len() as u32 });
            return;
        }
        let resolution = self.clamp(resolution);
        let drawn = &self.triangles[..resolution.triangles()];
        ranges.extend(self.material_ids.iter().map(|&material| MaterialRange {
            material,
            start: 0,
            count: 0,
        }));
        for &m in &self.material_of[..drawn.len()] {
            ranges[m as usize].count += 3;
        }
        let mut start = 0;
        for range in ranges.iter_mut() {
            range.start = start;
            start += std::mem::take(&mut range.count);
        }
        out.clear();
        out.resize(3 * drawn.len(), 0);
        for (corners, &m) in drawn.iter().zip(&self.material_of) {
            let range = &mut ranges[m as usize];
            let place = (range.start + range.count) as usize;
            out[place..place + 3].copy_from_slice(corners);
            range.count += 3;
        }
        self.substitute_in(resolution.vertices, out);
    }

    /// Returns the hops along substitution chains per drawn corner: the extra vertices visited by extraction (TOM, figure
    /// 6). 0 at full resolution. O(corners + hops).
    pub fn traversal_overhead(&self, resolution: Resolution) -> f64 {
        let resolution = self.clamp(resolution);
        let stored = self.stored(resolution);
        let mut hops = 0u64;
        for &corner in stored {
            let mut v = corner;
            while v >= resolution.vertices {
                v = self.substitute[v as usize];
                hops += 1;
            }
        }
        if stored.is_empty() { 0.0 } else { hops as f64 / stored.len() as f64 }
    }

    fn stored(&self, resolution: Resolution) -> &[u32] {
        self.triangles[..resolution.triangles()].as_flattened()
    }

    /// Replaces every corner by its active substitute.
    fn substitute_in(&self, active: u32, corners: &mut Vec<u32>) {
        let vertices = self.substitute.len();
        if active as usize == vertices {
            return;
        }
        // A table entry costs about a quarter of a coarse corner's hops.
        let count = corners.len();
        let done = if count < vertices / 4 { substitute_lanes(&self.substitute, active, corners) } else { 0 };
        if done == count {
            return;
        }
        self.extend_by_table(active, corners);
        let (indices, table) = corners.split_at_mut(count);
        for index in &mut indices[done..] {
            *index = table[*index as usize];
        }
        corners.truncate(count);
    }

    /// Appends the active substitute of every vertex.
    fn extend_by_table(&self, active: u32, out: &mut Vec<u32>) {
        let start = out.len();
        out.extend(0..active);
        out.extend_from_slice(&self.substitute[active as usize..]);
        let table = &mut out[start..];
        for v in active as usize..table.len() {
            table[v] = table[table[v] as usize];
        }
    }
}

/// Replaces corners by their active substitutes, in lanes. `active` is at least the base, where chains end. Returns how many corners
/// are done, from the front: not all where that takes as many hops as there are vertices.
fn substitute_lanes(substitute: &[u32], active: u32, corners: &mut [u32]) -> usize {
    let count = corners.len();
    let mut rounds = 0;
    let mut chunks = corners.chunks_exact_mut(LANES);
    for (chunk, corners) in (&mut chunks).enumerate() {
        if rounds > substitute.len() {
            return chunk * LANES;
        }
        let mut lanes = [0; LANES];
        lanes.copy_from_slice(corners);
        for _ in 0..HOPS {
            hop(substitute, active, &mut lanes);
        }
        while lanes.iter().fold(false, |any, &v| any | (v >= active)) {
            hop(substitute, active, &mut lanes);
            rounds += 1;
        }
        corners.copy_from_slice(&lanes);
    }
    for corner in chunks.into_remainder() {
        while *corner >= active {
            *corner = substitute[*corner as usize];
        }
    }
    count
}

/// Makes a hop in each lane not active yet. All lanes load before any chooses. In this order, and with indices, the choice
/// compiles to conditional moves; with iterators over both arrays at once, it has been seen to compile to branches.
#[inline(always)]
#[allow(clippy::needless_range_loop)]
fn hop(substitute: &[u32], active: u32, lanes: &mut [u32; LANES]) {
    let mut next = [0; LANES];
    for i in 0..LANES {
        next[i] = substitute[lanes[i] as usize];
    }
    for i in 0..LANES {
        lanes[i] = if lanes[i] < active { lanes[i] } else { next[i] };
    }
}
