//! How things are drawn: one pipeline each for the surface, what lies on top of it, what is behind it, and lines.

use multires::gmesh::MORPH_WGSL;

use super::target::{COLOUR, DEPTH};
use super::vertex::{Instance, MORPH_LAYOUT, Vertex};

/// One end of a line in the world: 28 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default, bytemuck::Pod, bytemuck::Zeroable)]
pub struct LineEnd {
    /// World units.
    pub position: [f32; 3],
    /// Linear red, green, blue, and opacity.
    pub colour: [f32; 4],
}

/// All pipelines of a renderer.
pub(super) struct Pipelines {
    pub backdrop: wgpu::RenderPipeline,
    pub surface: wgpu::RenderPipeline,
    /// On top of the surface, in one colour.
    pub overlay: wgpu::RenderPipeline,
    /// The edges of triangles.
    pub wire: wgpu::RenderPipeline,
    /// Whether those are lines in buffers of their own, and not triangles drawn as lines.
    pub wire_is_lines: bool,
    pub lines: wgpu::RenderPipeline,
    pub frame_layout: wgpu::BindGroupLayout,
    pub picture_layout: wgpu::BindGroupLayout,
}

pub(super) const UNIFORM: wgpu::BindingType = wgpu::BindingType::Buffer {
    ty: wgpu::BufferBindingType::Uniform,
    has_dynamic_offset: false,
    min_binding_size: None,
};
pub(super) const FILTERED: wgpu::BindingType = wgpu::BindingType::Texture {
    sample_type: wgpu::TextureSampleType::Float { filterable: true },
    view_dimension: wgpu::TextureViewDimension::D2,
    multisampled: false,
};
const SAMPLER: wgpu::BindingType = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering);

/// A layout of bindings 0, 1, ... that vertex and fragment shaders see.
pub(super) fn layout(device: &wgpu::Device, types: &[wgpu::BindingType]) -> wgpu::BindGroupLayout {
    let entries: Vec<_> = (0..)
        .zip(types)
        .map(|(binding, &ty)| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
            ty,
            count: None,
        })
        .collect();
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: None, entries: &entries })
}

impl Pipelines {
    pub fn new(device: &wgpu::Device, samples: u32) -> Self {
        // Vertices of a g-mesh move by the library's own functions.
        let source = [include_str!("shader.wgsl"), MORPH_WGSL].concat();
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("shader.wgsl"),
            source: wgpu::ShaderSource::Wgsl(source.into()),
        });
        let frame_layout = layout(device, &[UNIFORM, SAMPLER, FILTERED]);
        let picture_layout = layout(device, &[FILTERED, SAMPLER, FILTERED]);
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: None,
            bind_group_layouts: &[Some(&frame_layout), Some(&picture_layout)],
            immediate_size: 0,
        });
        let triangles = wgpu::PrimitiveState {
            front_face: wgpu::FrontFace::Ccw,
            // Both sides: models have holes, and the back faces of a coarse part may be what is seen.
            cull_mode: None,
            ..Default::default()
        };
        let corners = [Vertex::LAYOUT, Instance::LAYOUT, MORPH_LAYOUT, Vertex::TARGET_LAYOUT].map(Some);
        let ends = [Some(wgpu::VertexBufferLayout {
            array_stride: size_of::<LineEnd>() as u64,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x4],
        })];
        let make = |what: Kind<'_>| {
            let blends = what.fragment != "surface" && what.fragment != "backdrop";
            device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some(what.fragment),
                layout: Some(&pipeline_layout),
                vertex: wgpu::VertexState {
                    module: &module,
                    entry_point: Some(what.vertex),
                    compilation_options: Default::default(),
                    buffers: what.buffers,
                },
                primitive: what.primitive,
                depth_stencil: Some(wgpu::DepthStencilState {
                    format: DEPTH,
                    depth_write_enabled: Some(what.fragment == "surface"),
                    // Reversed: what is nearer has the greater depth, and floats have most digits near 0, which is far away.
                    depth_compare: Some(wgpu::CompareFunction::GreaterEqual),
                    stencil: Default::default(),
                    bias: Default::default(),
                }),
                multisample: wgpu::MultisampleState { count: samples, ..Default::default() },
                fragment: Some(wgpu::FragmentState {
                    module: &module,
                    entry_point: Some(what.fragment),
                    compilation_options: Default::default(),
                    targets: &[Some(wgpu::ColorTargetState {
                        format: COLOUR,
                        blend: blends.then_some(wgpu::BlendState {
                            color: wgpu::BlendState::ALPHA_BLENDING.color,
                            // What is drawn over the surface leaves it surface.
                            alpha: wgpu::BlendComponent::OVER,
                        }),
                        write_mask: wgpu::ColorWrites::ALL,
                    })],
                }),
                multiview_mask: None,
                cache: None,
            })
        };
        let overlay =
            Kind { vertex: "overlay_corner", fragment: "overlay", buffers: &corners, primitive: triangles };
        let lines =
            wgpu::PrimitiveState { topology: wgpu::PrimitiveTopology::LineList, ..Default::default() };
        let wire_is_lines = !device.features().contains(wgpu::Features::POLYGON_MODE_LINE);
        let wire = if wire_is_lines {
            lines
        } else {
            wgpu::PrimitiveState { polygon_mode: wgpu::PolygonMode::Line, ..triangles }
        };
        Self {
            backdrop: make(Kind {
                vertex: "backdrop_corner",
                fragment: "backdrop",
                buffers: &[],
                primitive: triangles,
            }),
            surface: make(Kind { vertex: "surface_corner", fragment: "surface", ..overlay }),
            wire: make(Kind { primitive: wire, ..overlay }),
            wire_is_lines,
            lines: make(Kind { vertex: "line_end", fragment: "line", buffers: &ends, primitive: lines }),
            overlay: make(overlay),
            frame_layout,
            picture_layout,
        }
    }
}

/// What one pipeline differs in from the others.
#[derive(Clone, Copy)]
struct Kind<'a> {
    vertex: &'a str,
    fragment: &'a str,
    buffers: &'a [Option<wgpu::VertexBufferLayout<'a>>],
    primitive: wgpu::PrimitiveState,
}
