//! A graphics card of bytes: buffers that take uploads, and draws read back from them as triangles.

use bytemuck::Pod;
use multires::lod::Lod;

/// The buffers of one instance.
#[derive(Default)]
pub struct Gpu {
    buffers: Vec<Vec<u8>>,
    /// Bytes written so far.
    pub written: usize,
}

/// A triangle as a draw reads it: the material, and its vertices.
pub type Drawn<V> = (u32, [V; 3]);

impl Gpu {
    /// Applies all that was written since the last call. A buffer that is too small grows and keeps what it held.
    pub fn upload(&mut self, lod: &dyn Lod) {
        for upload in lod.uploads() {
            if self.buffers.len() <= upload.buffer {
                self.buffers.resize(upload.buffer + 1, Vec::new());
            }
            let buffer = &mut self.buffers[upload.buffer];
            if buffer.len() < upload.size as usize {
                buffer.resize(upload.size as usize, 0xaa);
            }
            let start = upload.offset as usize;
            buffer[start..start + upload.bytes.len()].copy_from_slice(upload.bytes);
            self.written += upload.bytes.len();
        }
    }

    /// The first bytes of a buffer.
    #[allow(dead_code)]
    pub fn held(&self, buffer: usize, bytes: usize) -> &[u8] {
        self.buffers.get(buffer).map_or(&[], |held| &held[..bytes])
    }

    /// What the draws of an instance show; `shared` is the vertex buffer of those who share one.
    pub fn draw<V: Pod>(&self, lod: &dyn Lod, shared: &[V]) -> Vec<Drawn<V>> {
        let mut drawn = Vec::new();
        let vertex = |index: u32| -> V {
            if lod.shares_vertices() {
                return shared[index as usize];
            }
            bytemuck::pod_read_unaligned(
                &self.buffers[0][index as usize * size_of::<V>()..][..size_of::<V>()],
            )
        };
        for draw in lod.draws() {
            let [start, end] = [draw.indices.start, draw.indices.end].map(|index| 4 * index as usize);
            let indices = self.buffers[draw.buffer][start..end].chunks_exact(4);
            let indices: Vec<u32> = indices.map(|b| u32::from_ne_bytes([b[0], b[1], b[2], b[3]])).collect();
            let corner = |index: u32| vertex((i64::from(index) + i64::from(draw.base_vertex)) as u32);
            drawn.extend(
                indices.chunks_exact(3).map(|t| (draw.material, [corner(t[0]), corner(t[1]), corner(t[2])])),
            );
        }
        drawn
    }
}
