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
//!
//! What all instances of a model share lies in [`SharedBuffers`]: the vertices, the values of the vertices' targets, and the
//! index buffers of a structure that keeps all its levels in them.

use std::ops::Range;

use multires::lod::{Lod, MorphUniform};

use super::edges::{self, Edges};
use super::uploads::{Kind, Uploads};
use super::vertex::Vertex;

/// A buffer with room for more than it holds.
pub(super) struct Growing {
    pub buffer: wgpu::Buffer,
    /// Bytes in use.
    used: u64,
}

impl Growing {
    pub fn new(device: &wgpu::Device, bytes: u64, usage: wgpu::BufferUsages) -> Self {
        Self { buffer: create(device, bytes, usage), used: 0 }
    }

    /// Makes room for so many bytes.
    pub fn fit(&mut self, device: &wgpu::Device, uploads: &mut Uploads, bytes: u64) {
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
/// Usage of index buffers.
pub(super) const INDEX_USAGE: wgpu::BufferUsages =
    wgpu::BufferUsages::INDEX.union(wgpu::BufferUsages::COPY_DST).union(wgpu::BufferUsages::COPY_SRC);

/// Buffers shared by all instances of a model, each uploaded once, when the first instance needs it.
#[derive(Clone, Default)]
pub struct SharedBuffers {
    vertices: Option<wgpu::Buffer>,
    targets: Option<wgpu::Buffer>,
    /// One for each group; empty unless instances share triangles.
    indices: Vec<wgpu::Buffer>,
    /// The edges of those, where they were asked for.
    edges: Vec<wgpu::Buffer>,
}

impl SharedBuffers {
    /// Uploads what an instance shares with all others and what is not there yet. `vertices` are the values given to the instance,
    /// `targets` is [`Model::morph_targets`](multires::lod::Model::morph_targets).
    pub fn add(
        &mut self,
        device: &wgpu::Device,
        uploads: &mut Uploads,
        lod: &dyn Lod,
        vertices: &[Vertex],
        targets: &[u32],
    ) {
        let mut upload = |kind: Kind, usage, bytes: &[u8]| {
            let buffer = device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("shared by instances"),
                size: (bytes.len() as u64).max(4),
                usage,
                mapped_at_creation: false,
            });
            uploads.write(kind, &buffer, 0, bytes);
            buffer
        };
        if lod.shares_vertices() && self.vertices.is_none() {
            self.vertices = Some(upload(Kind::Vertices, VERTEX_USAGE, bytemuck::cast_slice(vertices)));
        }
        if card_morph(lod).is_some() && self.targets.is_none() {
            let value = |(own, &target): (&Vertex, &u32)| *vertices.get(target as usize).unwrap_or(own);
            let values: Vec<Vertex> = vertices.iter().zip(targets).map(value).collect();
            self.targets = Some(upload(Kind::Vertices, VERTEX_USAGE, bytemuck::cast_slice(&values)));
        }
        if lod.shares_triangles() && self.indices.is_empty() {
            let triangles = (0..lod.groups()).map(|group| lod.buffered_triangles(group));
            let indices = triangles.map(|t| upload(Kind::Indices, INDEX_USAGE, bytemuck::cast_slice(t)));
            self.indices = indices.collect();
        }
    }

    /// Returns the edges of the triangles that instances share, uploaded the first time.
    pub(super) fn edges(
        &mut self,
        device: &wgpu::Device,
        uploads: &mut Uploads,
        lod: &dyn Lod,
    ) -> &[wgpu::Buffer] {
        if self.edges.is_empty() {
            let of = |group| {
                let mut edges = Growing::new(device, 0, INDEX_USAGE);
                edges::write(device, uploads, &mut edges, 0, lod.buffered_triangles(group));
                edges.buffer
            };
            self.edges = (0..lod.groups()).map(of).collect();
        }
        &self.edges
    }

    /// Returns the bytes on the card.
    pub fn memory(&self) -> u64 {
        let all = self.vertices.iter().chain(&self.targets).chain(&self.indices).chain(&self.edges);
        all.map(wgpu::Buffer::size).sum()
    }
}

/// Returns the way of vertices to be gone in the vertex shader; `None` if the vertex buffer holds vertices as drawn.
pub fn card_morph(lod: &dyn Lod) -> Option<MorphUniform> {
    lod.morph().filter(|_| lod.shares_vertices())
}

/// A buffer of an instance.
enum Held {
    /// Kept in step with the instance.
    Own(Growing),
    /// Never written by the instance.
    Shared(wgpu::Buffer),
}

impl Held {
    fn buffer(&self) -> &wgpu::Buffer {
        match self {
            Self::Own(growing) => &growing.buffer,
            Self::Shared(buffer) => buffer,
        }
    }
}

/// The buffers of one instance, numbered as its uploads are: vertices, and indices for each group. Each is the instance's own or
/// shared.
pub struct LodBuffers {
    buffers: Vec<Held>,
    targets: Option<wgpu::Buffer>,
    /// Edges of the triangles of every group; empty unless asked for.
    edges: Vec<Edges>,
    morph: MorphUniform,
    /// Triangles to draw of every group.
    drawn: Vec<Range<u32>>,
}

impl LodBuffers {
    /// Makes empty buffers for a level of detail, all of which counts as written. What the level of detail shares was
    /// [added](SharedBuffers::add) to `shared`.
    pub fn new(device: &wgpu::Device, lod: &dyn Lod, shared: &SharedBuffers) -> Self {
        let hold = |buffer: usize| {
            let (usage, shared) = match buffer.checked_sub(1) {
                None => (VERTEX_USAGE, shared.vertices.as_ref().filter(|_| lod.shares_vertices())),
                Some(group) => (INDEX_USAGE, shared.indices.get(group).filter(|_| lod.shares_triangles())),
            };
            match shared {
                Some(shared) => Held::Shared(shared.clone()),
                None => Held::Own(Growing::new(device, 0, usage)),
            }
        };
        Self {
            buffers: (0..=lod.groups()).map(hold).collect(),
            targets: shared.targets.clone().filter(|_| card_morph(lod).is_some()),
            edges: Vec::new(),
            morph: MorphUniform::default(),
            drawn: vec![0..0; lod.groups()],
        }
    }

    /// Keeps the edges of triangles as well, from now on: for a card that cannot draw triangles as lines. Call it before
    /// [`sync`](Self::sync), in every frame that shows them.
    pub fn sync_edges(
        &mut self,
        device: &wgpu::Device,
        uploads: &mut Uploads,
        lod: &dyn Lod,
        shared: &mut SharedBuffers,
    ) {
        if self.edges.is_empty() {
            self.edges = Edges::all(device, uploads, lod, shared);
        } else {
            for (group, edges) in self.edges.iter_mut().enumerate() {
                edges.sync(device, uploads, lod, group);
            }
        }
    }

    /// Forgets the edges: a frame that shows none does not keep them.
    pub fn drop_edges(&mut self) {
        self.edges.clear();
    }

    /// Uploads what was written since the last call, and cleans the level of detail.
    pub fn sync(&mut self, device: &wgpu::Device, uploads: &mut Uploads, lod: &mut dyn Lod) {
        for upload in lod.uploads() {
            if let Held::Own(growing) = &mut self.buffers[upload.buffer] {
                growing.fit(device, uploads, upload.size);
                let kind = if upload.buffer == 0 { Kind::Vertices } else { Kind::Indices };
                uploads.write(kind, &growing.buffer, upload.offset, upload.bytes);
            }
        }
        self.drawn.fill(0..0);
        for draw in lod.draws() {
            // What is drawn again without being written was in the buffer all the time.
            self.drawn[draw.buffer - 1] = draw.indices.start / 3..draw.indices.end / 3;
        }
        self.morph = card_morph(lod).unwrap_or_default();
        lod.clean();
    }

    /// Returns the vertex buffer.
    pub fn vertices(&self) -> &wgpu::Buffer {
        self.buffers[0].buffer()
    }

    /// Returns the values to which vertices move in the vertex shader; the vertices themselves if they do not move there.
    pub fn targets(&self) -> &wgpu::Buffer {
        self.targets.as_ref().unwrap_or_else(|| self.vertices())
    }

    /// Returns the way of vertices to their targets as of the last [`sync`](Self::sync); of share 0 if they do not move in the
    /// vertex shader.
    pub fn morph(&self) -> MorphUniform {
        self.morph
    }

    /// Returns the index buffer of every group, and the range of triangles to draw from it.
    pub fn groups(&self) -> impl Iterator<Item = (&wgpu::Buffer, Range<u32>)> {
        self.buffers[1..].iter().map(Held::buffer).zip(self.drawn.iter().cloned())
    }

    /// Returns the buffer of the edges of every group, and the range of triangles to draw the edges of.
    pub fn edges(&self) -> impl Iterator<Item = (&wgpu::Buffer, Range<u32>)> {
        self.edges.iter().map(Edges::buffer).zip(self.drawn.iter().cloned())
    }

    /// Returns the bytes on the card, without what is shared.
    pub fn memory(&self) -> u64 {
        let own = |held: &Held| if let Held::Own(growing) = held { growing.buffer.size() } else { 0 };
        let edges = |edges: &Edges| if let Edges::Own(growing) = edges { growing.buffer.size() } else { 0 };
        self.buffers.iter().map(own).sum::<u64>() + self.edges.iter().map(edges).sum::<u64>()
    }
}
