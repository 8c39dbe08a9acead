//! Everything that one frame uploads, in one write.
//!
//! ```text
//!     write, write, write ...      bytes gather in memory
//!     flush(encoder)               one write_buffer into a staging buffer, then a copy on the card for each range
//! ```
//!
//! `Queue::write_buffer` makes a staging buffer of its own in every call, which costs more than the bytes of a small range.
//! Copies on the card cost next to nothing, so hundreds of small ranges of hundreds of objects do no harm.

/// Bytes of memory that are kept for the next frame at most.
const MOST_KEPT: u64 = 1 << 24;

/// What a flush did.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Uploaded {
    /// Bytes of vertices that went to the card.
    pub vertices: u64,
    /// Bytes of indices.
    pub indices: u64,
    /// Bytes of what else there was: matrices, colours, the camera.
    pub other: u64,
    /// Ranges written.
    pub ranges: usize,
    /// Buffers that grew: what they held was copied on the card and not uploaded again.
    pub grown: usize,
}

impl Uploaded {
    /// All bytes.
    pub fn bytes(&self) -> u64 {
        self.vertices + self.indices + self.other
    }
}

/// What a range is of, to count by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Vertices.
    Vertices,
    /// Indices.
    Indices,
    /// Anything else.
    Other,
}

enum Step {
    /// The start of one buffer into another.
    Grow { from: wgpu::Buffer, to: wgpu::Buffer, bytes: u64 },
    /// A range of the staging buffer.
    Range { start: u64, to: wgpu::Buffer, at: u64, bytes: u64 },
}

/// Uploads of a frame; its memory is used again in the next.
#[derive(Default)]
pub struct Uploads {
    bytes: Vec<u8>,
    steps: Vec<Step>,
    staging: Option<wgpu::Buffer>,
    counted: Uploaded,
}

impl Uploads {
    /// Writes bytes into a buffer that takes copies, `at` bytes from its start. Both in multiples of 4.
    pub fn write(&mut self, kind: Kind, to: &wgpu::Buffer, at: u64, bytes: &[u8]) {
        let start = self.bytes.len() as u64;
        self.bytes.extend_from_slice(bytes);
        self.wrote(kind, to, at, start);
    }

    /// A range whose bytes lie at the end of those gathered.
    fn wrote(&mut self, kind: Kind, to: &wgpu::Buffer, at: u64, start: u64) {
        let length = self.bytes.len() as u64 - start;
        if length == 0 {
            return;
        }
        match kind {
            Kind::Vertices => self.counted.vertices += length,
            Kind::Indices => self.counted.indices += length,
            Kind::Other => self.counted.other += length,
        }
        self.counted.ranges += 1;
        self.steps.push(Step::Range { start, to: to.clone(), at, bytes: length });
    }

    /// Takes the first bytes of a buffer over into the larger one that follows it, before what is written from here on.
    pub fn grow(&mut self, from: &wgpu::Buffer, to: &wgpu::Buffer, bytes: u64) {
        self.counted.grown += 1;
        if bytes > 0 {
            self.steps.push(Step::Grow { from: from.clone(), to: to.clone(), bytes });
        }
    }

    /// Puts all that was written into the encoder, to be there before whatever it draws after that. Once a submission: the
    /// staging buffer is written anew in the next.
    pub fn flush(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        encoder: &mut wgpu::CommandEncoder,
    ) -> Uploaded {
        let needed = self.bytes.len() as u64;
        let staging = match self.staging.take().filter(|staging| staging.size() >= needed) {
            Some(staging) => staging,
            None => staging(device, needed),
        };
        if staging.usage().contains(wgpu::BufferUsages::MAP_WRITE) {
            if let Ok(mut mapped) = staging.slice(..).get_mapped_range_mut() {
                mapped.slice(..self.bytes.len()).copy_from_slice(&self.bytes);
            }
            staging.unmap();
        } else if needed > 0 {
            queue.write_buffer(&staging, 0, &self.bytes);
        }
        for step in self.steps.drain(..) {
            match step {
                Step::Grow { from, to, bytes } => encoder.copy_buffer_to_buffer(&from, 0, &to, 0, bytes),
                Step::Range { start, to, at, bytes } => {
                    encoder.copy_buffer_to_buffer(&staging, start, &to, at, bytes);
                }
            }
        }
        self.bytes.clear();
        // Once a model's vertices are there, no frame writes as much again.
        if needed > MOST_KEPT {
            self.bytes = Vec::new();
        } else if !staging.usage().contains(wgpu::BufferUsages::MAP_WRITE) {
            self.staging = Some(staging);
        }
        std::mem::take(&mut self.counted)
    }
}

/// A buffer for the bytes of a frame. In WebGL no index buffer takes bytes from a buffer of another kind, but all take them from
/// memory, which is where wgpu keeps what is mapped: there it is one for this frame alone, mapped.
fn staging(device: &wgpu::Device, needed: u64) -> wgpu::Buffer {
    let mapped = cfg!(target_arch = "wasm32") && device.adapter_info().backend == wgpu::Backend::Gl;
    let kind = if mapped { wgpu::BufferUsages::MAP_WRITE } else { wgpu::BufferUsages::COPY_DST };
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("uploads"),
        size: if mapped { needed.max(4) } else { needed.next_power_of_two().max(1 << 16) },
        usage: wgpu::BufferUsages::COPY_SRC | kind,
        mapped_at_creation: mapped,
    })
}
