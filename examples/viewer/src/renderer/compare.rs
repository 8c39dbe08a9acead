//! Pictures on a window, side by side: as they are, or the difference of two.

use super::Target;
use super::pipelines::layout;

/// What is shown in a part of a window.
pub enum Show<'a> {
    /// A picture.
    Picture(&'a Target),
    /// How two pictures of the same size differ: grey where they agree, yellow by eight times the largest difference of a colour,
    /// red where only the first and blue where only the second shows a surface.
    Difference(&'a Target, &'a Target),
}

/// Shows pictures on surfaces of one format.
pub struct Compare {
    layout: wgpu::BindGroupLayout,
    show: wgpu::RenderPipeline,
    difference: wgpu::RenderPipeline,
}

impl Compare {
    /// For a window, or a picture, of that format.
    pub fn new(device: &wgpu::Device, format: wgpu::TextureFormat) -> Self {
        let module = device.create_shader_module(wgpu::include_wgsl!("compare.wgsl"));
        let texture = wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable: true },
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        };
        let layout = layout(device, &[texture, texture]);
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: None,
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let make = |fragment| {
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
        };
        let [show, difference] = match format.is_srgb() {
            true => ["show_light", "difference_light"],
            false => ["show_bytes", "difference_bytes"],
        };
        Self { show: make(show), difference: make(difference), layout }
    }

    /// Shows something in a part of what the pass draws to: left, top, width and height in pixels.
    pub fn draw(
        &self,
        device: &wgpu::Device,
        pass: &mut wgpu::RenderPass<'_>,
        part: [u32; 4],
        show: &Show<'_>,
    ) {
        let (pipeline, first, second) = match show {
            Show::Picture(picture) => (&self.show, picture, picture),
            Show::Difference(first, second) => (&self.difference, first, second),
        };
        let views = [first.view(), second.view()];
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &self.layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(views[0]) },
                wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::TextureView(views[1]) },
            ],
        });
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
