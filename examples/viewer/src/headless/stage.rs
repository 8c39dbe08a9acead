//! A scene, a card and a picture, without a window.

use std::sync::Arc;
use std::time::{Duration, Instant};

use multires::lod::{LodError, LodOptions};
use multires::view::View;

use crate::gpu::Gpu;
use crate::renderer::{Eye, Look, Paint, RenderError, Renderer, Target, Uploaded, Uploads};
use crate::scene::{Adapted, Model, Overlays, Scene};

/// What a frame did, and how long each part of it took.
#[derive(Debug, Clone, Copy, Default)]
pub struct FrameReport {
    /// How objects followed the view.
    pub adapted: Adapted,
    /// What went to the card.
    pub uploaded: Uploaded,
    /// Time for gathering and writing that.
    pub upload: Duration,
    /// Time for recording and submitting the draws; nothing where nothing was drawn.
    pub draw: Duration,
    /// Time until the card was done.
    pub wait: Duration,
}

impl FrameReport {
    /// Time on this side: all but the waiting.
    pub fn cpu(&self) -> Duration {
        self.adapted.time + self.upload + self.draw
    }
}

/// Everything that one picture takes.
pub struct Stage {
    gpu: Gpu,
    renderer: Renderer,
    uploads: Uploads,
    eye: Eye,
    paint: Paint,
    target: Target,
    scene: Scene,
}

impl Stage {
    /// For pictures of that size, with 1 or 4 samples a pixel.
    ///
    /// # Errors
    /// The model cannot be drawn that way.
    pub fn new(
        gpu: Gpu,
        model: Arc<Model>,
        places: &[[[f32; 4]; 4]],
        options: LodOptions,
        size: [u32; 2],
        samples: u32,
    ) -> Result<Self, LodError> {
        let renderer = Renderer::new(&gpu.device, &gpu.queue, samples);
        let mut uploads = Uploads::default();
        let (side, picture) = model.picture();
        let normals = model.normal_map().map(|map| (map.size, &map.pixels[..]));
        let paint = renderer.paint(&gpu.device, &gpu.queue, (side, &picture), normals);
        drop(picture);
        Ok(Self {
            eye: renderer.eye(&gpu.device),
            paint,
            target: Target::new(&gpu.device, size, samples),
            scene: Scene::new(&gpu.device, &mut uploads, model, places, options)?,
            renderer,
            uploads,
            gpu,
        })
    }

    /// Paints surfaces with a picture instead of the model's.
    pub fn set_paint(&mut self, size: [u32; 2], pixels: &[[u8; 4]]) {
        self.paint = self.renderer.paint(&self.gpu.device, &self.gpu.queue, (size, pixels), None);
    }

    /// What is drawn.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The same, to change it.
    pub fn scene_mut(&mut self) -> &mut Scene {
        &mut self.scene
    }

    /// One frame, `seconds` after the last: adapts, uploads, and draws where there is something to look with. Waits for the card.
    pub fn frame(
        &mut self,
        views: &[View],
        look: Option<&Look>,
        overlays: Overlays,
        seconds: f32,
    ) -> FrameReport {
        let Self { gpu, renderer, uploads, eye, paint, target, scene } = self;
        let adapted = scene.adapt(views, seconds);

        let start = Instant::now();
        scene.sync(&gpu.device, uploads, renderer, overlays);
        if let Some(look) = look {
            eye.look(uploads, look, target.size());
        }
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let uploaded = uploads.flush(&gpu.device, &gpu.queue, &mut encoder);
        let upload = start.elapsed();

        let start = Instant::now();
        if look.is_some() {
            scene.draw_to(renderer, &mut encoder, target, eye, paint, overlays);
        }
        gpu.queue.submit([encoder.finish()]);
        let draw = start.elapsed();

        let start = Instant::now();
        // A lost card shows in the picture that cannot be read.
        let _ = gpu.device.poll(wgpu::PollType::wait_indefinitely());
        FrameReport { adapted, uploaded, upload, draw, wait: start.elapsed() }
    }

    /// The last picture, row by row from the top: red, green, blue, and the share of the pixel that shows a surface.
    ///
    /// # Errors
    /// The card was lost.
    pub fn picture(&self) -> Result<Vec<[u8; 4]>, RenderError> {
        self.target.read(&self.gpu.device, &self.gpu.queue)
    }
}
