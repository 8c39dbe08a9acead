//! Vertex and index buffers that are kept in step with a level of detail by its dirty ranges.
//!
//! ```text
//!     adapt(views)  ->  sync: for every group   grow, if there are more triangles than room
//!                                               write the dirty ranges
//!                       the same for vertices, where they are not shared
//!                   ->  clean()
//! ```
//!
//! After that the buffers hold, byte for byte, what the level of detail holds. A buffer that grows at least doubles, and what it
//! held is copied on the card: also then only dirty ranges are uploaded.

use multires::adapt::LevelOfDetail;

use super::uploads::{Kind, Uploads};
use super::vertex::{TRIANGLE, Vertex};

/// Unwritten triangles between two dirty ranges that are uploaded rather than parted: 24 bytes, less than a copy costs.
const TRIANGLE_GAP: usize = 2;
/// The same for vertices.
const VERTEX_GAP: usize = 1;

/// Where the values of vertices are that a level of detail draws.
#[derive(Debug, Clone, Copy)]
pub enum Values<'a> {
    /// Indices name vertices of the structure, which lie in one buffer for all instances: nothing to upload.
    Shared,
    /// Vertices are packed: these are the structure's, and each slot holds one of them.
    Slots(&'a [Vertex]),
    /// These are drawn, as they are: dirty ranges are of them.
    Own(&'a [Vertex]),
}

/// What can be drawn: a level of detail and the values of its vertices.
pub trait Drawn: Send {
    /// The level of detail.
    fn lod(&self) -> &dyn LevelOfDetail;

    /// The same, to adapt it.
    fn lod_mut(&mut self) -> &mut dyn LevelOfDetail;

    /// The values of its vertices.
    fn values(&self) -> Values<'_>;
}

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

/// The buffers of one instance: an index buffer for each group, and one of vertices where they are not shared.
pub struct LodBuffers {
    vertices: Option<Growing>,
    groups: Vec<(Growing, u32)>,
}

impl LodBuffers {
    /// Empty buffers for a level of detail, all of which is dirty.
    pub fn new(device: &wgpu::Device, drawn: &dyn Drawn) -> Self {
        let vertices = match drawn.values() {
            Values::Shared => None,
            Values::Slots(_) | Values::Own(_) => Some(Growing::new(device, 0, VERTEX_USAGE)),
        };
        let group = |_| (Growing::new(device, 0, INDEX_USAGE), 0);
        Self { vertices, groups: (0..drawn.lod().groups()).map(group).collect() }
    }

    /// Uploads what was written since the last call, and cleans the level of detail.
    pub fn sync(&mut self, device: &wgpu::Device, uploads: &mut Uploads, drawn: &mut dyn Drawn) {
        let lod = drawn.lod();
        for (group, (growing, count)) in self.groups.iter_mut().enumerate() {
            let triangles = lod.triangles(group);
            growing.fit(device, uploads, triangles.len() as u64 * TRIANGLE);
            for range in lod.dirty_triangles(group, TRIANGLE_GAP) {
                let at = range.start as u64 * TRIANGLE;
                let bytes = bytemuck::cast_slice(&triangles[range]);
                uploads.write(Kind::Indices, &growing.buffer, at, bytes);
            }
            *count = triangles.len() as u32;
        }
        if let Some(growing) = &mut self.vertices {
            sync_vertices(growing, device, uploads, drawn);
        }
        drawn.lod_mut().clean();
    }

    /// The vertex buffer; `shared` where it is not this instance's own.
    pub fn vertices<'a>(&'a self, shared: &'a wgpu::Buffer) -> &'a wgpu::Buffer {
        self.vertices.as_ref().map_or(shared, |growing| &growing.buffer)
    }

    /// The index buffer and the triangles to draw of every group.
    pub fn groups(&self) -> impl Iterator<Item = (&wgpu::Buffer, u32)> {
        self.groups.iter().map(|(growing, count)| (&growing.buffer, *count))
    }

    /// Bytes on the card.
    pub fn memory(&self) -> u64 {
        let groups = self.groups.iter().map(|(growing, _)| growing.buffer.size()).sum::<u64>();
        groups + self.vertices.as_ref().map_or(0, |growing| growing.buffer.size())
    }
}

fn sync_vertices(growing: &mut Growing, device: &wgpu::Device, uploads: &mut Uploads, drawn: &dyn Drawn) {
    let stride = size_of::<Vertex>() as u64;
    let lod = drawn.lod();
    match drawn.values() {
        Values::Shared => {}
        Values::Slots(values) => {
            let slots = lod.vertices().unwrap_or(&[]);
            growing.fit(device, uploads, slots.len() as u64 * stride);
            for range in lod.dirty_vertices(VERTEX_GAP) {
                let at = range.start as u64 * stride;
                let gathered = slots[range].iter().map(|&vertex| values[vertex as usize]);
                uploads.gather(Kind::Vertices, &growing.buffer, at, gathered);
            }
        }
        Values::Own(values) => {
            growing.fit(device, uploads, values.len() as u64 * stride);
            for range in lod.dirty_vertices(VERTEX_GAP) {
                let at = range.start as u64 * stride;
                uploads.write(Kind::Vertices, &growing.buffer, at, bytemuck::cast_slice(&values[range]));
            }
        }
    }
}
