//! Edges of triangles as lines, for cards that cannot draw triangles as lines: browsers'.
//!
//! ```text
//!     triangles   a b c, d e f ...                 the index buffer of a group
//!     edges       a b, b c, c a, d e, e f, f d     a second one, in step with it while edges are asked for
//! ```

use multires::lod::Lod;

use super::buffers::{Growing, INDEX_USAGE, SharedBuffers};
use super::uploads::{Kind, Uploads};

/// Indices of a triangle's edges, and their bytes.
pub(super) const EDGE_INDICES: u32 = 6;
const EDGE_BYTES: u64 = 4 * EDGE_INDICES as u64;
/// Triangles not written between two written that are written with them.
const GAP: usize = 2;

/// Edges of a group's triangles.
pub(super) enum Edges {
    /// Of an instance, in step with its triangles.
    Own(Growing),
    /// Of all instances.
    Shared(wgpu::Buffer),
}

impl Edges {
    pub fn buffer(&self) -> &wgpu::Buffer {
        match self {
            Self::Own(growing) => &growing.buffer,
            Self::Shared(buffer) => buffer,
        }
    }

    /// Makes the edges of all groups.
    pub fn all(
        device: &wgpu::Device,
        uploads: &mut Uploads,
        lod: &dyn Lod,
        shared: &mut SharedBuffers,
    ) -> Vec<Self> {
        if lod.shares_triangles() {
            return shared.edges(device, uploads, lod).iter().cloned().map(Self::Shared).collect();
        }
        let own = |group| {
            let mut edges = Growing::new(device, 0, INDEX_USAGE);
            write(device, uploads, &mut edges, 0, lod.buffered_triangles(group));
            Self::Own(edges)
        };
        (0..lod.groups()).map(own).collect()
    }

    /// Uploads what was written of a group since the last [`clean`](Lod::clean).
    pub fn sync(&mut self, device: &wgpu::Device, uploads: &mut Uploads, lod: &dyn Lod, group: usize) {
        if let Self::Own(edges) = self {
            let triangles = lod.buffered_triangles(group);
            for range in lod.dirty_triangles(group, GAP) {
                write(device, uploads, edges, range.start, &triangles[range]);
            }
        }
    }
}

/// Writes the edges of triangles, the first of which is triangle `first` of its buffer.
pub(super) fn write(
    device: &wgpu::Device,
    uploads: &mut Uploads,
    edges: &mut Growing,
    first: usize,
    triangles: &[[u32; 3]],
) {
    let indices: Vec<[u32; EDGE_INDICES as usize]> =
        triangles.iter().map(|&[a, b, c]| [a, b, b, c, c, a]).collect();
    let start = first as u64 * EDGE_BYTES;
    edges.fit(device, uploads, start + triangles.len() as u64 * EDGE_BYTES);
    uploads.write(Kind::Indices, &edges.buffer, start, bytemuck::cast_slice(&indices));
}
