//! A window's surface, and the panel's painter.

use std::sync::Arc;

use winit::window::Window;

use crate::gpu::{self, Gpu};
use crate::headless::Failure;
use crate::renderer::{Compare, Show};

/// A part of the window, pixels (left, top, width, height), and what is shown there.
pub type Part<'a> = ([u32; 4], Show<'a>);

/// What the panel looks like in this frame.
pub struct Painted {
    /// Triangles, clipped.
    pub shapes: Vec<egui::ClippedPrimitive>,
    /// Textures that came or go.
    pub textures: egui::TexturesDelta,
    /// Pixels a point.
    pub scale: f32,
}

/// A surface that is as large as its window.
pub struct Screen {
    surface: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
    compare: Compare,
    panel: egui_wgpu::Renderer,
}

impl Screen {
    /// Opens a card that can draw to a window.
    ///
    /// # Errors
    /// There is no card, or it cannot draw there.
    pub fn open(window: &Arc<Window>) -> Result<(Gpu, Self), Failure> {
        let refused = |reason: String| Failure::Window { reason };
        let instance = gpu::instance();
        let surface =
            instance.create_surface(Arc::clone(window)).map_err(|error| refused(error.to_string()))?;
        let gpu = Gpu::open(&instance, Some(&surface))?;
        let size = window.inner_size();
        let mut config = surface
            .get_default_config(&gpu.adapter, size.width.max(1), size.height.max(1))
            .ok_or_else(|| refused(format!("{} cannot draw to it", gpu.name())))?;
        // Bytes as they are, which the panel prefers, where the surface has them.
        let formats = surface.get_capabilities(&gpu.adapter).formats;
        if let Some(&format) = formats.iter().find(|format| {
            matches!(format, wgpu::TextureFormat::Bgra8Unorm | wgpu::TextureFormat::Rgba8Unorm)
        }) {
            config.format = format;
        }
        config.present_mode = wgpu::PresentMode::AutoVsync;
        surface.configure(&gpu.device, &config);
        let screen = Self {
            compare: Compare::with_distances(&gpu.device, config.format),
            panel: egui_wgpu::Renderer::new(&gpu.device, config.format, Default::default()),
            surface,
            config,
        };
        Ok((gpu, screen))
    }

    /// Pixels across and down.
    pub fn size(&self) -> [u32; 2] {
        [self.config.width, self.config.height]
    }

    /// Takes the window's new size.
    pub fn resize(&mut self, gpu: &Gpu, size: [u32; 2]) {
        let most = gpu.device.limits().max_texture_dimension_2d;
        let [width, height] = size.map(|side| side.clamp(1, most));
        (self.config.width, self.config.height) = (width, height);
        self.surface.configure(&gpu.device, &self.config);
    }

    /// Shows parts and the panel over them, after what the encoder holds. `false` where the window takes no picture just now.
    pub fn show(
        &mut self,
        gpu: &Gpu,
        mut encoder: wgpu::CommandEncoder,
        parts: &[Part<'_>],
        mut painted: Painted,
    ) -> bool {
        for (id, deltas) in painted.textures.set.drain() {
            for delta in deltas {
                self.panel.update_texture(&gpu.device, &gpu.queue, id, &delta);
            }
        }
        let shown = match self.surface.get_current_texture() {
            wgpu::CurrentSurfaceTexture::Success(texture)
            | wgpu::CurrentSurfaceTexture::Suboptimal(texture) => Some(texture),
            wgpu::CurrentSurfaceTexture::Outdated | wgpu::CurrentSurfaceTexture::Lost => {
                self.surface.configure(&gpu.device, &self.config);
                None
            }
            _ => None,
        };
        let screen = egui_wgpu::ScreenDescriptor {
            size_in_pixels: [self.config.width, self.config.height],
            pixels_per_point: painted.scale,
        };
        let more = self.panel.update_buffers(&gpu.device, &gpu.queue, &mut encoder, &painted.shapes, &screen);
        if let Some(texture) = &shown {
            let view = texture.texture.create_view(&Default::default());
            let mut pass = encoder
                .begin_render_pass(&wgpu::RenderPassDescriptor {
                    label: Some("window"),
                    color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                        view: &view,
                        depth_slice: None,
                        resolve_target: None,
                        ops: wgpu::Operations {
                            load: wgpu::LoadOp::Clear(wgpu::Color { r: 0.1, g: 0.1, b: 0.11, a: 1.0 }),
                            store: wgpu::StoreOp::Store,
                        },
                    })],
                    ..Default::default()
                })
                .forget_lifetime();
            for (part, show) in parts {
                // A window that was made smaller a moment ago has less room than the panel thinks.
                let [x, y, width, height] = *part;
                let (x, y) = (x.min(self.config.width), y.min(self.config.height));
                let part = [x, y, width.min(self.config.width - x), height.min(self.config.height - y)];
                self.compare.draw(&gpu.device, &mut pass, part, show);
            }
            pass.set_viewport(0.0, 0.0, self.config.width as f32, self.config.height as f32, 0.0, 1.0);
            self.panel.render(&mut pass, &painted.shapes, &screen);
        }
        gpu.queue.submit(more.into_iter().chain([encoder.finish()]));
        let done = shown.is_some();
        if let Some(texture) = shown {
            gpu.queue.present(texture);
        }
        for id in painted.textures.free.drain() {
            self.panel.free_texture(&id);
        }
        done
    }
}
