//! Vertex and index buffers that are kept in step with a level of detail by its uploads.
//!
//! ```text
//!     adapt(views)  ->  sync: for every upload   grow, if it ends beyond the buffer
//!                                                write its bytes
//!                   ->  clean()
//! ```
//!
//! After that the buffers hold, byte for byte, what the level of detail holds. A buffer that grows at least doubles, and what it
//! held is copied on the card: also then only what was written is uploaded.

use multires::lod::Lod;

use super::uploads::{Kind, Uploads};
use super::vertex::Vertex;

/// A buffer with room for more than it holds.
struct Growing {
    buffer: wgpu::Buffer,
    /// Bytes in use.
    used: u64,
}

impl Growing {
    fn new(device: &wgpu::Device, bytes: u64, usage: wgpu::BufferUsages) -> Self {
        Self { buffer: create(device, bytes, usage), used: 0 }
    }

    /// Makes room for so many bytes.
    fn fit(&mut self, device: &wgpu::Device, uploads: &mut Uploads, bytes: u64) {
        if bytes > self.buffer.size() {
            let larger = create(device, bytes, self.buffer.usage());
            uploads.grow(&self.buffer, &larger, self.used);
            self.buffer = larger;
        }
        // What was beyond the end of what is in use may be in use again without being written.
        self.used = self.used.max(bytes);
    }
}

fn create(device: &wgpu::Device, bytes: u64, usage: wgpu::BufferUsages) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("level of detail"),
        size: bytes.next_power_of_two().max(4096),
        usage,
        mapped_at_creation: false,
    })
}

const VERTEX_USAGE: wgpu::BufferUsages =
    wgpu::BufferUsages::VERTEX.union(wgpu::BufferUsages::COPY_DST).union(wgpu::BufferUsages::COPY_SRC);
const INDEX_USAGE: wgpu::BufferUsages =
    wgpu::BufferUsages::INDEX.union(wgpu::BufferUsages::COPY_DST).union(wgpu::BufferUsages::COPY_SRC);

/// The vertices of a structure in one buffer, uploaded once and drawn by all its instances.
pub fn shared_vertices(device: &wgpu::Device, uploads: &mut Uploads, vertices: &[Vertex]) -> wgpu::Buffer {
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("vertices of all levels"),
        size: (size_of_val(vertices) as u64).max(4),
        usage: VERTEX_USAGE,
        mapped_at_creation: false,
    });
    uploads.write(Kind::Vertices, &buffer, 0, bytemuck::cast_slice(vertices));
    buffer
}

/// The buffers of one instance, numbered as its uploads are: one of vertices, which is empty where they are shared, and one of
/// indices for each group.
pub struct LodBuffers {
    buffers: Vec<Growing>,
    shares_vertices: bool,
    /// Triangles to draw of every group.
    counts: Vec<u32>,
}

impl LodBuffers {
    /// Empty buffers for a level of detail, all of which counts as written.
    pub fn new(device: &wgpu::Device, lod: &dyn Lod) -> Self {
        let usage = |buffer: usize| if buffer == 0 { VERTEX_USAGE } else { INDEX_USAGE };
        Self {
            buffers: (0..=lod.groups()).map(|buffer| Growing::new(device, 0, usage(buffer))).collect(),
            shares_vertices: lod.shares_vertices(),
            counts: vec![0; lod.groups()],
        }
    }

    /// Uploads what was written since the last call, and cleans the level of detail.
    pub fn sync(&mut self, device: &wgpu::Device, uploads: &mut Uploads, lod: &mut dyn Lod) {
        for upload in lod.uploads() {
            let growing = &mut self.buffers[upload.buffer];
            growing.fit(device, uploads, upload.size);
            let kind = if upload.buffer == 0 { Kind::Vertices } else { Kind::Indices };
            uploads.write(kind, &growing.buffer, upload.offset, upload.bytes);
        }
        self.counts.fill(0);
        for draw in lod.draws() {
            // What is drawn again without being written was in the buffer all the time.
            self.counts[draw.buffer - 1] = draw.indices.end / 3;
        }
        lod.clean();
    }

    /// The vertex buffer; `shared` where it is not this instance's own.
    pub fn vertices<'a>(&'a self, shared: &'a wgpu::Buffer) -> &'a wgpu::Buffer {
        if self.shares_vertices { shared } else { &self.buffers[0].buffer }
    }

    /// The index buffer and the triangles to draw of every group.
    pub fn groups(&self) -> impl Iterator<Item = (&wgpu::Buffer, u32)> {
        self.buffers[1..].iter().map(|growing| &growing.buffer).zip(self.counts.iter().copied())
    }

    /// Bytes on the card.
    pub fn memory(&self) -> u64 {
        let own = usize::from(self.shares_vertices);
        self.buffers[own..].iter().map(|growing| growing.buffer.size()).sum()
    }
}
