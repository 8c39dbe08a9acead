//! Pictures on a window, side by side: as they are, the difference of two, or how far apart their surfaces lie.

use wgpu::util::{BufferInitDescriptor, DeviceExt};

use super::Target;
use super::pipelines::{FILTERED, UNIFORM, layout};

/// What is shown in a part of a window.
pub enum Show<'a> {
    /// A picture.
    Picture(&'a Target),
    /// How two pictures of the same size differ: grey where they agree, yellow by eight times the largest difference of a colour,
    /// red where only the first and blue where only the second shows a surface.
    Difference(&'a Target, &'a Target),
    /// How far apart the surfaces of two pictures of the same size lie along the view, whatever their colours and normals:
    /// yellow by the distance between them in distances from the eye, times this. Of targets with depths to be read.
    Distance(&'a Target, &'a Target, f32),
}

/// Shows pictures on surfaces of one format.
pub struct Compare {
    layout: wgpu::BindGroupLayout,
    show: wgpu::RenderPipeline,
    difference: wgpu::RenderPipeline,
    /// Where that was asked for.
    distance: Option<(wgpu::BindGroupLayout, wgpu::RenderPipeline)>,
}

impl Compare {
    /// For a window, or a picture, of that format: colours alone.
    pub fn new(device: &wgpu::Device, format: wgpu::TextureFormat) -> Self {
        let layout = layout(device, &[FILTERED, FILTERED]);
        let make = |entries| pipeline(device, &layout, format, entries);
        let show = make(["show_light", "show_bytes"]);
        let difference = make(["difference_light", "difference_bytes"]);
        Self { show, difference, layout, distance: None }
    }

    /// The same, and distances of targets with several samples a pixel.
    pub fn with_distances(device: &wgpu::Device, format: wgpu::TextureFormat) -> Self {
        let layout = layout(device, &[DEPTHS, DEPTHS, UNIFORM]);
        let distance = pipeline(device, &layout, format, ["distance_light", "distance_bytes"]);
        Self { distance: Some((layout, distance)), ..Self::new(device, format) }
    }

    /// Shows something in a part of what the pass draws to: left, top, width and height in pixels.
    pub fn draw(
        &self,
        device: &wgpu::Device,
        pass: &mut wgpu::RenderPass<'_>,
        part: [u32; 4],
        show: &Show<'_>,
    ) {
        let (pipeline, layout, views, gain) = match (show, &self.distance) {
            (Show::Picture(picture), _) => (&self.show, &self.layout, [picture.view(); 2], None),
            (Show::Difference(first, second), _) => {
                (&self.difference, &self.layout, [first.view(), second.view()], None)
            }
            (Show::Distance(first, second, gain), Some((layout, pipeline))) => {
                (pipeline, layout, [first.depth(), second.depth()], Some([*gain; 4]))
            }
            (Show::Distance(..), None) => return,
        };
        let gain = gain.map(|gain| {
            let contents = bytemuck::bytes_of(&gain);
            device.create_buffer_init(&BufferInitDescriptor {
                label: Some("gain"),
                contents,
                usage: wgpu::BufferUsages::UNIFORM,
            })
        });
        let resources = views.map(wgpu::BindingResource::TextureView).into_iter();
        let resources = resources.chain(gain.as_ref().map(wgpu::Buffer::as_entire_binding));
        let entries: Vec<_> = (0..)
            .zip(resources)
            .map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource })
            .collect();
        let group =
            device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries });
        let [x, y, width, height] = part.map(|pixels| pixels as f32);
        if width < 1.0 || height < 1.0 {
            return;
        }
        pass.set_viewport(x, y, width, height, 0.0, 1.0);
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.draw(0..3, 0..1);
    }
}

const DEPTHS: wgpu::BindingType = wgpu::BindingType::Texture {
    sample_type: wgpu::TextureSampleType::Depth,
    view_dimension: wgpu::TextureViewDimension::D2,
    multisampled: true,
};

/// A pipeline that fills a part of a window by the first of two fragment shaders if it turns light into sRGB by itself, else by the
/// second.
fn pipeline(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    format: wgpu::TextureFormat,
    [light, bytes]: [&str; 2],
) -> wgpu::RenderPipeline {
    let module = device.create_shader_module(wgpu::include_wgsl!("compare.wgsl"));
    let fragment = if format.is_srgb() { light } else { bytes };
    let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: None,
        bind_group_layouts: &[Some(layout)],
        immediate_size: 0,
    });
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(fragment),
        layout: Some(&pipeline_layout),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("corner"),
            compilation_options: Default::default(),
            buffers: &[],
        },
        primitive: Default::default(),
        depth_stencil: None,
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some(fragment),
            compilation_options: Default::default(),
            targets: &[Some(format.into())],
        }),
        multiview_mask: None,
        cache: None,
    })
}
