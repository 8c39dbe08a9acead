//! The indices of a resolution: copy the first triangles, then replace what is not active.
//!
//! At full resolution that is a copy. Below it, corners need a different number of hops each, and a loop per corner would
//! spend its time on mispredicted branches. So a block of corners takes passes: in each, every corner that is not there
//! yet makes one hop, as a conditional move, and those that need more are appended, without a branch, to a list for the
//! next pass.

use super::{Resolution, SUBSTITUTE, TotallyOrderedMesh};
use crate::mesh::NONE;

/// Corners per block: positions in it and the list of those left both stay in the first-level cache. A power of two.
const BLOCK: usize = 1024;

/// Where the triangles of one material lie in a filled index buffer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub struct MaterialRange {
    /// The material id; `u32::MAX` where the triangles are not told apart by material.
    pub material: u32,
    /// First index in the buffer.
    pub start: u32,
    /// Number of indices from there, three per triangle.
    pub count: u32,
}

impl TotallyOrderedMesh {
    /// The number of indices that a resolution takes.
    pub fn index_count(&self, resolution: Resolution) -> usize {
        3 * self.clamp(resolution).triangles()
    }

    /// Fills `out` with the indices of a resolution, replacing what it held. No index reaches
    /// [`Resolution::vertices`]. O(output times mean chain length, see [`TotallyOrderedMesh::traversal_overhead`]);
    /// allocates only where `out` is too small.
    pub fn fill_indices(&self, resolution: Resolution, out: &mut Vec<u32>) {
        let resolution = self.clamp(resolution);
        out.clear();
        out.extend_from_slice(self.stored(resolution));
        self.substitute_all(resolution.vertices, out);
    }

    /// Writes the indices of a resolution to the front of `out`, as many whole triangles as fit, and returns how many
    /// indices that were; [`TotallyOrderedMesh::index_count`] says how many there are.
    pub fn write_indices(&self, resolution: Resolution, out: &mut [u32]) -> usize {
        let resolution = self.clamp(resolution);
        let stored = self.stored(resolution);
        let count = stored.len().min(out.len() / 3 * 3);
        out[..count].copy_from_slice(&stored[..count]);
        self.substitute_all(resolution.vertices, &mut out[..count]);
        count
    }

    /// Fills `out` with the indices of a resolution sorted by material, and `ranges` with one entry per material of
    /// [`TotallyOrderedMesh::material_ids`], in that order (empty ones included): one drawing call each. Within a
    /// material the order is that of [`TotallyOrderedMesh::fill_indices`]. A mesh without materials has one range.
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
        self.substitute_all(resolution.vertices, out);
    }

    /// Hops along substitution chains per corner drawn: the extra vertices that extraction visits (TOM, figure 6). 0 at
    /// full resolution. O(what it counts).
    pub fn traversal_overhead(&self, resolution: Resolution) -> f64 {
        let resolution = self.clamp(resolution);
        let stored = self.stored(resolution);
        let mut hops = 0u64;
        for &corner in stored {
            let mut v = corner;
            while v >= resolution.vertices {
                v = self.substitute[v as usize] & SUBSTITUTE;
                hops += 1;
            }
        }
        if stored.is_empty() { 0.0 } else { hops as f64 / stored.len() as f64 }
    }

    fn stored(&self, resolution: Resolution) -> &[u32] {
        self.triangles[..resolution.triangles()].as_flattened()
    }

    /// Replaces every corner by the active vertex that stands for it.
    fn substitute_all(&self, active: u32, corners: &mut [u32]) {
        if (active as usize) < self.substitute.len() {
            for block in corners.chunks_mut(BLOCK) {
                substitute_block(&self.substitute, active, block);
            }
        }
    }
}

/// At most [`BLOCK`] corners. `active` is at least the base, where chains end.
fn substitute_block(substitute: &[u32], active: u32, corners: &mut [u32]) {
    let mut left = [0u16; BLOCK];
    let mut count = 0;
    for (i, corner) in corners.iter_mut().enumerate() {
        let next = substitute[*corner as usize] & SUBSTITUTE;
        let v = if *corner < active { *corner } else { next };
        *corner = v;
        left[count & (BLOCK - 1)] = i as u16;
        count += usize::from(v >= active);
    }
    while count > 0 {
        let mut kept = 0;
        for at in 0..count {
            let i = left[at & (BLOCK - 1)];
            let corner = &mut corners[i as usize];
            let v = substitute[*corner as usize] & SUBSTITUTE;
            *corner = v;
            left[kept & (BLOCK - 1)] = i;
            kept += usize::from(v >= active);
        }
        count = kept;
    }
}
