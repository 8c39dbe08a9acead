//! A small renderer to lift into an engine: what turns a level of detail into pixels, and nothing else.
//!
//! ```text
//!     adapt        your level of detail follows the view
//!     sync         LodBuffers write its dirty ranges into Uploads
//!     flush        Uploads go to the card in one write
//!     draw         Renderer draws every group of every object
//! ```
//!
//! | file | idea |
//! |---|---|
//! | `buffers.rs` | [`LodBuffers`]: buffers in step with a level of detail by its dirty ranges; [`SharedBuffers`]: those of all instances |
//! | `edges.rs` | edges of triangles, for cards that cannot draw them |
//! | `uploads.rs` | [`Uploads`]: all that a frame uploads, in one write |
//! | `vertex.rs` | [`Vertex`] and [`Instance`]: what the card reads |
//! | `pipelines.rs`, `shader.wgsl` | how things are drawn |
//! | `target.rs` | [`Target`]: what is drawn into, and the way back |
//! | `picture.rs` | [`Paint`]: textures on surfaces |
//! | `compare.rs`, `compare.wgsl` | [`Compare`]: pictures on a window, the difference of two, and the distance of their surfaces |
//!
//! Knows nothing of files, scenes, windows or panels. Depth is reversed (1 near, 0 at infinity, in floats), there are 4 samples a
//! pixel, both sides of triangles are drawn.

mod buffers;
mod compare;
mod edges;
mod picture;
mod pipelines;
mod target;
mod uploads;
mod vertex;

pub use buffers::{LodBuffers, SharedBuffers, card_morph};
pub use compare::{Compare, Show};
pub use picture::Paint;
pub use pipelines::LineEnd;
pub use target::{COLOUR, DEPTH, Reading, Target};
pub use uploads::{Kind, Uploaded, Uploads};
pub use vertex::{Instance, MORPH_LAYOUT, TRIANGLE, Vertex};

use std::ops::Range;

use bytemuck::{Pod, Zeroable};
use multires::quality::palette;

use pipelines::Pipelines;

/// Why nothing could be drawn.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum RenderError {
    /// A picture could not be read back.
    #[error("the picture could not be read from the card: {reason}")]
    Read {
        /// What the card's driver said.
        reason: String,
    },
}

/// What colours a surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "program", derive(clap::ValueEnum))]
pub enum Shading {
    /// A colour for each material.
    #[default]
    Material,
    /// How early a vertex comes: dark for the coarsest mesh, yellow for what comes last.
    Level,
    /// How far the surface would be off without a vertex, from this eye, by octaves: the middle of the scale is the tolerance.
    Error,
    /// Normals, as red, green and blue.
    Normal,
    /// The texture.
    Texture,
    /// By material; triangles that were written of late glow.
    Dirty,
}

/// Where one looks from, and how: all that shaders need to know of a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Look {
    /// The eye, world units.
    pub eye: [f64; 3],
    /// Unit vectors to the right of the picture, to its top, and ahead.
    pub axes: [[f64; 3]; 3],
    /// Vertical field of view, radians, between 0 and pi.
    pub field_of_view: f64,
    /// Distance of the near plane, world units; above 0.
    pub near: f64,
    /// Tolerance in pixels, for shading by error.
    pub tolerance: f32,
    /// What colours surfaces.
    pub shading: Shading,
    /// Whether triangles get one normal each.
    pub flat: bool,
    /// sRGB at the top and at the foot of the picture.
    pub background: [[u8; 3]; 2],
}

/// As the shader has it.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct Frame {
    clip: [[f32; 4]; 4],
    eye: [f32; 4],
    right: [f32; 4],
    up: [f32; 4],
    forward: [f32; 4],
    background: [[f32; 4]; 2],
    mode: [u32; 4],
}

impl Look {
    fn frame(&self, size: [u32; 2]) -> Frame {
        let [right, up, forward] = self.axes.map(glam::DVec3::from_array);
        let high = 1.0 / (self.field_of_view * 0.5).tan();
        let wide = high * f64::from(size[1]) / f64::from(size[0].max(1));
        // Depth is near / distance: reversed, and without an end.
        let rows = [
            (right * wide).extend(0.0),
            (up * high).extend(0.0),
            glam::DVec4::new(0.0, 0.0, 0.0, self.near),
            forward.extend(0.0),
        ];
        let clip = glam::DMat4::from_cols(rows[0], rows[1], rows[2], rows[3]).transpose().as_mat4();
        let vector = |v: glam::DVec3, w: f64| v.extend(w).as_vec4().to_array();
        let pixels = high * f64::from(size[1]) * 0.5;
        let mode = match self.shading {
            Shading::Material | Shading::Dirty => 0,
            Shading::Level => 1,
            Shading::Error => 2,
            Shading::Normal => 3,
            Shading::Texture => 4,
        };
        Frame {
            clip: clip.to_cols_array_2d(),
            eye: vector(glam::DVec3::from_array(self.eye), pixels),
            right: vector(right, f64::from(self.tolerance)),
            up: vector(up, 0.0),
            forward: vector(forward, 0.0),
            background: self.background.map(|colour| linear(colour, 1.0)),
            mode: [mode, u32::from(self.flat), 0, 0],
        }
    }
}

/// Light of an sRGB colour (IEC 61966-2-1), and an opacity.
pub fn linear(colour: [u8; 3], opacity: f32) -> [f32; 4] {
    let [r, g, b] = colour.map(|byte| {
        let x = f32::from(byte) / 255.0;
        if x <= 0.04045 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) }
    });
    [r, g, b, opacity]
}

/// One camera's part of a frame: its uniforms on the card. One for each picture of a frame.
pub struct Eye {
    buffer: wgpu::Buffer,
    group: wgpu::BindGroup,
}

impl Eye {
    /// Looks from elsewhere, at a target of that size.
    pub fn look(&self, uploads: &mut Uploads, look: &Look, size: [u32; 2]) {
        uploads.write(Kind::Other, &self.buffer, 0, bytemuck::bytes_of(&look.frame(size)));
    }
}

/// What can be drawn, once for a card.
pub struct Renderer {
    pipelines: Pipelines,
    samples: u32,
    scale: wgpu::TextureView,
    sampler: wgpu::Sampler,
}

impl Renderer {
    /// Makes pipelines for targets of that many samples a pixel.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, samples: u32) -> Self {
        let colours: Vec<[u8; 4]> = (0..256_u16)
            .map(|i| {
                let [r, g, b] = palette::sequential(f32::from(i) / 255.0);
                [r, g, b, 255]
            })
            .collect();
        let scale = picture::texture(device, queue, picture::COLOURS, [256, 1], &[colours]);
        let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..Default::default()
        });
        Self { pipelines: Pipelines::new(device, samples), samples, scale, sampler }
    }

    /// Samples a pixel of its targets.
    pub fn samples(&self) -> u32 {
        self.samples
    }

    /// Whether edges of triangles are drawn from [buffers of their own](LodBuffers::sync_edges), since the card cannot draw triangles
    /// as lines.
    pub fn needs_edges(&self) -> bool {
        self.pipelines.wire_is_lines
    }

    /// A camera.
    pub fn eye(&self, device: &wgpu::Device) -> Eye {
        let buffer = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("frame"),
            size: size_of::<Frame>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let entries = [
            wgpu::BindGroupEntry { binding: 0, resource: buffer.as_entire_binding() },
            wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::Sampler(&self.sampler) },
            wgpu::BindGroupEntry { binding: 2, resource: wgpu::BindingResource::TextureView(&self.scale) },
        ];
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("frame"),
            layout: &self.pipelines.frame_layout,
            entries: &entries,
        });
        Eye { buffer, group }
    }

    /// A texture that surfaces can be painted with, and a map of normals in tangent space for them.
    pub fn paint(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        colours: ([u32; 2], &[[u8; 4]]),
        normals: Option<([u32; 2], &[[u8; 4]])>,
    ) -> Paint {
        Paint::new(device, queue, &self.pipelines.picture_layout, colours, normals)
    }

    /// Starts a pass: the camera, the texture, the backdrop.
    pub fn begin(&self, pass: &mut wgpu::RenderPass<'_>, eye: &Eye, paint: &Paint) {
        pass.set_bind_group(0, &eye.group, &[]);
        pass.set_bind_group(1, &paint.group, &[]);
        pass.set_pipeline(&self.pipelines.backdrop);
        pass.draw(0..3, 0..1);
    }

    /// Draws the surface of objects from here on.
    pub fn surfaces(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_pipeline(&self.pipelines.surface);
    }

    /// Draws over the surface, each instance in its colour, from here on.
    pub fn overlays(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_pipeline(&self.pipelines.overlay);
    }

    /// Draws [edges](Self::draw_wire) of triangles, each instance in its colour, from here on.
    pub fn wires(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_pipeline(&self.pipelines.wire);
    }

    /// Draws from here on as [instances](Instance) at those places, whose vertices have gone those ways to their targets: a
    /// [`MorphUniform`](multires::lod::MorphUniform) for each instance.
    pub fn instances(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        instances: wgpu::BufferSlice<'_>,
        morphs: wgpu::BufferSlice<'_>,
    ) {
        pass.set_vertex_buffer(1, instances);
        pass.set_vertex_buffer(2, morphs);
    }

    /// Draws an object: group `g` as instance `first + g` of the instances that are set.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>, object: &LodBuffers, first: u32) {
        pass.set_vertex_buffer(0, object.vertices().slice(..));
        pass.set_vertex_buffer(3, object.targets().slice(..));
        for ((indices, triangles), instance) in object.groups().zip(first..) {
            if !triangles.is_empty() {
                pass.set_index_buffer(indices.slice(..), wgpu::IndexFormat::Uint32);
                pass.draw_indexed(3 * triangles.start..3 * triangles.end, 0, instance..instance + 1);
            }
        }
    }

    /// Draws the edges of an object as [`draw`](Self::draw) draws its triangles. Where the renderer
    /// [needs edges](Self::needs_edges), those that the object keeps.
    pub fn draw_wire(&self, pass: &mut wgpu::RenderPass<'_>, object: &LodBuffers, first: u32) {
        if !self.needs_edges() {
            return self.draw(pass, object, first);
        }
        pass.set_vertex_buffer(0, object.vertices().slice(..));
        pass.set_vertex_buffer(3, object.targets().slice(..));
        for ((indices, triangles), instance) in object.edges().zip(first..) {
            if !triangles.is_empty() {
                pass.set_index_buffer(indices.slice(..), wgpu::IndexFormat::Uint32);
                let range = edges::EDGE_INDICES * triangles.start..edges::EDGE_INDICES * triangles.end;
                pass.draw_indexed(range, 0, instance..instance + 1);
            }
        }
    }

    /// Draws some triangles of one group of an object, as far as the object draws them.
    pub fn draw_some(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        object: &LodBuffers,
        group: usize,
        triangles: impl Iterator<Item = Range<u32>>,
        instance: u32,
    ) {
        let Some((indices, drawn)) = object.groups().nth(group) else { return };
        pass.set_vertex_buffer(0, object.vertices().slice(..));
        pass.set_vertex_buffer(3, object.targets().slice(..));
        pass.set_index_buffer(indices.slice(..), wgpu::IndexFormat::Uint32);
        for range in triangles {
            let (start, end) = (range.start.max(drawn.start), range.end.min(drawn.end));
            if start < end {
                pass.draw_indexed(3 * start..3 * end, 0, instance..instance + 1);
            }
        }
    }

    /// Draws lines: two ends each.
    pub fn lines(&self, pass: &mut wgpu::RenderPass<'_>, ends: &wgpu::Buffer, count: u32) {
        pass.set_pipeline(&self.pipelines.lines);
        pass.set_vertex_buffer(0, ends.slice(..));
        pass.draw(0..count, 0..1);
    }
}
