//! What is drawn into: colour with several samples a pixel, depth, and the picture that comes out; and the way back to memory.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use super::RenderError;

/// Colours of a target: bytes, sRGB.
pub const COLOUR: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;
/// Depths of a target, reversed.
pub const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// A picture to be drawn.
pub struct Target {
    size: [u32; 2],
    /// Where there are several samples a pixel.
    samples: Option<wgpu::TextureView>,
    depth: wgpu::TextureView,
    /// Whether depths are read once the picture is drawn.
    keeps_depth: bool,
    picture: wgpu::Texture,
    view: wgpu::TextureView,
}

impl Target {
    /// A target of that many pixels, at least one, and samples a pixel: 1 or 4.
    pub fn new(device: &wgpu::Device, size: [u32; 2], samples: u32) -> Self {
        Self::make(device, size, samples, false)
    }

    /// The same with [depths](Self::depth) to be read.
    pub fn with_depth(device: &wgpu::Device, size: [u32; 2], samples: u32) -> Self {
        Self::make(device, size, samples, true)
    }

    fn make(device: &wgpu::Device, size: [u32; 2], samples: u32, keeps_depth: bool) -> Self {
        let most = device.limits().max_texture_dimension_2d;
        let size = size.map(|side| side.clamp(1, most));
        let texture = |format, sample_count, usage| {
            device.create_texture(&wgpu::TextureDescriptor {
                label: Some("target"),
                size: wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage,
                view_formats: &[],
            })
        };
        let drawn = wgpu::TextureUsages::RENDER_ATTACHMENT;
        let read = drawn | wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_SRC;
        let picture = texture(COLOUR, 1, read);
        let several = samples > 1;
        let depth_usage = if keeps_depth { drawn | wgpu::TextureUsages::TEXTURE_BINDING } else { drawn };
        Self {
            size,
            samples: several.then(|| texture(COLOUR, samples, drawn).create_view(&Default::default())),
            depth: texture(DEPTH, samples.max(1), depth_usage).create_view(&Default::default()),
            keeps_depth,
            view: picture.create_view(&Default::default()),
            picture,
        }
    }

    /// Pixels across and down.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// The picture, for a shader that shows or compares it: light, and the share of a pixel that shows a surface.
    pub fn view(&self) -> &wgpu::TextureView {
        &self.view
    }

    /// Depths, reversed, for a shader; of a target [made for that](Self::with_depth).
    pub fn depth(&self) -> &wgpu::TextureView {
        &self.depth
    }

    /// A pass that draws it anew.
    pub fn pass<'a>(&self, encoder: &'a mut wgpu::CommandEncoder) -> wgpu::RenderPass<'a> {
        let (view, resolve_target) = match &self.samples {
            Some(samples) => (samples, Some(&self.view)),
            None => (&self.view, None),
        };
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("scene"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                    store: if resolve_target.is_some() {
                        wgpu::StoreOp::Discard
                    } else {
                        wgpu::StoreOp::Store
                    },
                },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.depth,
                // Reversed: 0 is infinitely far away.
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(0.0),
                    store: if self.keeps_depth { wgpu::StoreOp::Store } else { wgpu::StoreOp::Discard },
                }),
                stencil_ops: None,
            }),
            ..Default::default()
        })
    }

    /// The picture as red, green, blue and opacity of every pixel, row by row from the top, sRGB. Opacity is the share of the
    /// pixel that shows a surface. Waits for the card.
    ///
    /// # Errors
    /// The card was lost, or its memory could not be read.
    pub fn read(&self, device: &wgpu::Device, queue: &wgpu::Queue) -> Result<Vec<[u8; 4]>, RenderError> {
        let reading = self.start_reading(device, queue);
        device
            .poll(wgpu::PollType::wait_indefinitely())
            .map_err(|error| RenderError::Read { reason: error.to_string() })?;
        reading.finish()
    }

    /// The same for who cannot wait.
    pub fn start_reading(&self, device: &wgpu::Device, queue: &wgpu::Queue) -> Reading {
        let [width, height] = self.size;
        let row = (4 * width).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let buffer = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("picture"),
            size: u64::from(row) * u64::from(height),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let mut encoder = device.create_command_encoder(&Default::default());
        encoder.copy_texture_to_buffer(
            self.picture.as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer: &buffer,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(row),
                    rows_per_image: None,
                },
            },
            self.picture.size(),
        );
        queue.submit([encoder.finish()]);
        let is_there = Arc::new(AtomicBool::new(false));
        let tell = Arc::clone(&is_there);
        buffer.slice(..).map_async(wgpu::MapMode::Read, move |_| {
            // Where that failed, there is nothing to be mapped later.
            tell.store(true, Ordering::Release);
        });
        Reading { buffer, row, width, is_there }
    }
}

/// A picture on its way to memory.
pub struct Reading {
    buffer: wgpu::Buffer,
    /// Bytes of a row.
    row: u32,
    /// Pixels of a row.
    width: u32,
    is_there: Arc<AtomicBool>,
}

impl Reading {
    /// Whether [`finish`](Self::finish) has something to return. A device must be polled for that.
    pub fn is_there(&self) -> bool {
        self.is_there.load(Ordering::Acquire)
    }

    /// The picture, as [`Target::read`] returns it.
    ///
    /// # Errors
    /// The card was lost, or its memory could not be read.
    pub fn finish(self) -> Result<Vec<[u8; 4]>, RenderError> {
        let mapped = self.buffer.slice(..).get_mapped_range();
        let bytes = mapped.map_err(|error| RenderError::Read { reason: error.to_string() })?;
        let rows = bytes.chunks_exact(self.row as usize);
        let line = |row: &[u8]| -> Vec<[u8; 4]> {
            row[..4 * self.width as usize].chunks_exact(4).map(|p| [p[0], p[1], p[2], p[3]]).collect()
        };
        Ok(rows.flat_map(line).collect())
    }
}
