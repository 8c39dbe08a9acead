//! What the canvas shows: a scene, a camera, and what can be set by hand.

use std::sync::Arc;

use multires::adapt::Geomorph;
use multires::lod::LodOptions;
use multires_viewer::camera::{Lens, Orbit, Pose, Tolerances};
use multires_viewer::gpu::Gpu;
use multires_viewer::renderer::{
    Compare, Eye, Look, Paint, Reading, Renderer, Shading, Show, Target, Uploads,
};
use multires_viewer::scene::{ControlOptions, Controller, Coordinates, Model, Overlays, Scene, Texture};
use wasm_bindgen::prelude::*;
use web_sys::OffscreenCanvas;

use crate::names::builtin;

/// Samples a pixel.
const SAMPLES: u32 = 4;
/// Vertical field of view, radians.
const FIELD_OF_VIEW: f64 = 45.0 * std::f64::consts::PI / 180.0;

/// What a frame did.
#[wasm_bindgen]
#[derive(Debug, Clone, Copy, Default)]
pub struct Frame {
    /// Triangles drawn.
    pub triangles: u32,
    /// Splits, collapses and changes of level.
    pub operations: u32,
    /// Whether the next frame will differ though nothing moves.
    pub moving: bool,
}

/// What a model is painted with.
#[wasm_bindgen]
pub struct Pictures {
    colours: Option<Texture>,
    normals: Option<Texture>,
    is_painted: bool,
}

#[wasm_bindgen]
impl Pictures {
    /// Colours, and normals in tangent space: pixels of four bytes row by row, and the width; no pixels where there is no picture.
    /// Then whether the model's file names them.
    #[wasm_bindgen(constructor)]
    pub fn new(colours: &[u8], width: u32, normals: &[u8], normal_width: u32, is_painted: bool) -> Self {
        let texture = |pixels: &[u8], width: u32| {
            let pixels = pixels.as_chunks().0.to_vec();
            let height = (pixels.len() as u32).checked_div(width).filter(|&height| height > 0)?;
            Some(Texture { size: [width, height], pixels })
        };
        Self { colours: texture(colours, width), normals: texture(normals, normal_width), is_painted }
    }
}

/// A canvas and what it shows.
#[wasm_bindgen]
pub struct Stage {
    gpu: Gpu,
    canvas: OffscreenCanvas,
    surface: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
    renderer: Renderer,
    uploads: Uploads,
    eye: Eye,
    paint: Paint,
    target: Target,
    compare: Compare,
    scene: Option<Scene>,
    orbit: Orbit,
    home: Orbit,
    /// The view that the cut stays for, while it is frozen.
    frozen: Option<(Pose, Lens)>,
    tolerances: Tolerances,
    options: LodOptions,
    control: ControlOptions,
    shading: Shading,
    wire: bool,
    is_dark: bool,
    /// Triangles of all objects at full resolution.
    full: usize,
    reading: Option<Reading>,
}

#[wasm_bindgen]
impl Stage {
    /// Opens the card for a canvas, by what this program was built for: WebGPU or WebGL 2.
    ///
    /// # Errors
    /// The browser has no such thing.
    pub async fn open(canvas: OffscreenCanvas) -> Result<Stage, JsError> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
        let surface = instance.create_surface(wgpu::SurfaceTarget::OffscreenCanvas(canvas.clone()))?;
        let gpu = Gpu::find(&instance, Some(&surface)).await?;
        let size = [canvas.width().max(1), canvas.height().max(1)];
        let mut config = surface
            .get_default_config(&gpu.adapter, size[0], size[1])
            .ok_or_else(|| JsError::new("the canvas cannot be drawn to"))?;
        config.format = config.format.remove_srgb_suffix();
        surface.configure(&gpu.device, &config);
        let renderer = Renderer::new(&gpu.device, &gpu.queue, SAMPLES);
        let (side, checker) = Paint::checker();
        let orbit = Orbit::framing([0.0; 3], 1.0, FIELD_OF_VIEW, false);
        Ok(Self {
            eye: renderer.eye(&gpu.device),
            paint: renderer.paint(&gpu.device, &gpu.queue, ([side; 2], &checker), None),
            target: Target::new(&gpu.device, size, SAMPLES),
            compare: Compare::new(&gpu.device, config.format),
            renderer,
            uploads: Uploads::default(),
            gpu,
            canvas,
            surface,
            config,
            scene: None,
            orbit,
            home: orbit,
            frozen: None,
            tolerances: Tolerances::default(),
            options: LodOptions::default(),
            control: ControlOptions::default(),
            shading: Shading::Material,
            wire: false,
            is_dark: false,
            full: 0,
            reading: None,
        })
    }

    /// What draws.
    pub fn card(&self) -> String {
        self.gpu.name()
    }

    /// Shows a baked model, at the places of a built-in scene or as one object.
    ///
    /// # Errors
    /// The bytes are no baked model.
    pub fn show(&mut self, baked: &[u8], scene: &str, pictures: Pictures) -> Result<(), JsError> {
        let Pictures { colours, normals, is_painted } = pictures;
        let model = Model::of_baked(baked, Coordinates::Own)?.with_textures(colours, normals, is_painted);
        let (device, queue) = (&self.gpu.device, &self.gpu.queue);
        let (size, picture) = model.picture();
        let normals = model.normal_map().map(|map| (map.size, &map.pixels[..]));
        self.paint = self.renderer.paint(device, queue, (size, &picture), normals);
        drop(picture);
        let builtin = builtin(scene);
        let places = match builtin {
            Some(builtin) => builtin.places(),
            None => vec![glam::Mat4::IDENTITY.to_cols_array_2d()],
        };
        self.full = model.triangle_count() * places.len();
        if model.is_painted() {
            self.shading = Shading::Texture;
        }
        let mut scene = Scene::new(device, &mut self.uploads, Arc::new(model), &places, self.options)?;
        scene.set_control(self.control)?;
        let (centre, diagonal, narrow) = (scene.centre(), scene.diagonal(), self.lens().narrow());
        self.home = match builtin {
            Some(builtin) => builtin.orbit(centre, diagonal, narrow),
            None => Orbit::framing(centre, 0.4 * diagonal, narrow, false),
        };
        (self.orbit, self.frozen, self.scene) = (self.home, None, Some(scene));
        Ok(())
    }

    /// Triangles of all objects at full resolution.
    #[wasm_bindgen(getter)]
    pub fn full(&self) -> usize {
        self.full
    }

    /// Gives the canvas another size, pixels.
    pub fn resize(&mut self, width: u32, height: u32) {
        let most = self.gpu.device.limits().max_texture_dimension_2d;
        let size = [width, height].map(|side| side.clamp(1, most));
        if size == self.target.size() {
            return;
        }
        (self.config.width, self.config.height) = (size[0], size[1]);
        self.canvas.set_width(size[0]);
        self.canvas.set_height(size[1]);
        self.surface.configure(&self.gpu.device, &self.config);
        self.target = Target::new(&self.gpu.device, size, SAMPLES);
    }

    /// Turns by angles, radians.
    pub fn turn(&mut self, around: f64, above: f64) {
        self.orbit.turn(around, above);
    }

    /// Moves along the picture, in shares of its height.
    pub fn pan(&mut self, right: f64, up: f64) {
        self.orbit.pan(right, up, FIELD_OF_VIEW);
    }

    /// Comes nearer by a factor above 1, or goes away.
    pub fn zoom(&mut self, factor: f64) {
        let size = self.scene.as_ref().map_or(1.0, Scene::diagonal);
        self.orbit.zoom(factor, size);
    }

    /// Goes back to the first view.
    pub fn home(&mut self) {
        self.orbit = self.home;
    }

    /// Keeps the cut as it is for the present view, or lets it follow again.
    pub fn freeze(&mut self, frozen: bool) {
        let seen = || (self.orbit.pose(), self.lens());
        self.frozen = if frozen { Some(self.frozen.unwrap_or_else(seen)) } else { None };
    }

    /// Tolerance, pixels.
    pub fn set_tolerance(&mut self, pixels: f32) {
        self.tolerances = self.tolerances.with_anywhere(pixels.max(0.0));
    }

    /// Triangles of all objects together; 0: as many as the tolerance asks for.
    ///
    /// # Errors
    /// The scene cannot be held to that.
    pub fn set_budget(&mut self, triangles: usize) -> Result<(), JsError> {
        let controller = if triangles == 0 { Controller::Off } else { Controller::Triangles };
        let control = ControlOptions::default().with_controller(controller);
        self.control = if triangles == 0 { control } else { control.with_triangles(triangles) };
        match &mut self.scene {
            Some(scene) => Ok(scene.set_control(self.control)?),
            None => Ok(()),
        }
    }

    /// Time that vertices take to their places, seconds.
    ///
    /// # Errors
    /// The structure cannot be drawn that way.
    pub fn set_geomorph(&mut self, seconds: f32) -> Result<(), JsError> {
        self.options =
            self.options.with_geomorph((seconds > 0.0).then(|| Geomorph::default().with_duration(seconds)));
        match &mut self.scene {
            Some(scene) => Ok(scene.set_options(&self.gpu.device, &mut self.uploads, self.options)?),
            None => Ok(()),
        }
    }

    /// What colours surfaces: `material`, `level`, `error`, `normal`, `texture` or `written`.
    pub fn set_shading(&mut self, name: &str) {
        self.shading = match name {
            "level" => Shading::Level,
            "error" => Shading::Error,
            "normal" => Shading::Normal,
            "texture" => Shading::Texture,
            "written" => Shading::Dirty,
            _ => Shading::Material,
        };
    }

    /// Name of what colours surfaces.
    pub fn shading(&self) -> String {
        let name = match self.shading {
            Shading::Material => "material",
            Shading::Level => "level",
            Shading::Error => "error",
            Shading::Normal => "normal",
            Shading::Texture => "texture",
            Shading::Dirty => "written",
        };
        name.to_owned()
    }

    /// Whether edges are drawn, and whether the backdrop is dark.
    pub fn set_look(&mut self, wire: bool, dark: bool) {
        (self.wire, self.is_dark) = (wire, dark);
    }

    /// Lets all objects follow the view, `seconds` after the last frame. [`draw`](Self::draw) shows it.
    ///
    /// # Errors
    /// Nothing can be seen from there.
    pub fn adapt(&mut self, seconds: f32) -> Result<Frame, JsError> {
        let lens = self.lens();
        let Some(scene) = &mut self.scene else { return Ok(Frame::default()) };
        let (pose, of) = self.frozen.unwrap_or((self.orbit.pose(), lens));
        let view = pose.view(&of, &self.tolerances)?;
        let adapted = scene.adapt(&[view], seconds.clamp(0.0, 0.25));
        let change = adapted.change;
        let settles = adapted.controlled.is_some_and(|controlled| controlled.settles);
        Ok(Frame {
            triangles: change.triangles as u32,
            operations: (change.cut.splits + change.cut.collapses) as u32,
            moving: change.pending > 0 || change.moving > 0 || settles,
        })
    }

    /// Uploads what was written since the last call. Returns the bytes.
    pub fn upload(&mut self) -> u32 {
        let lens = self.lens();
        let overlays = self.overlays();
        let Some(scene) = &mut self.scene else { return 0 };
        scene.sync(&self.gpu.device, &mut self.uploads, &self.renderer, overlays);
        let background =
            if self.is_dark { [[38, 41, 48], [22, 24, 28]] } else { [[250, 250, 252], [226, 229, 234]] };
        let look = Look {
            tolerance: self.tolerances.anywhere,
            shading: self.shading,
            background,
            ..self.orbit.pose().look(&lens, scene.diagonal())
        };
        self.eye.look(&mut self.uploads, &look, lens.size);
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        let uploaded = self.uploads.flush(&self.gpu.device, &self.gpu.queue, &mut encoder);
        self.gpu.queue.submit([encoder.finish()]);
        uploaded.bytes() as u32
    }

    /// Starts to read the last picture.
    pub fn start_reading(&mut self) {
        self.reading = Some(self.target.start_reading(&self.gpu.device, &self.gpu.queue));
    }

    /// The picture that is read, red, green, blue and 255 of every pixel from the top, once it is there.
    ///
    /// # Errors
    /// The card is lost.
    pub fn read(&mut self) -> Result<Option<Vec<u8>>, JsError> {
        // Where a browser polls by itself this does nothing.
        let _ = self.gpu.device.poll(wgpu::PollType::Poll);
        match self.reading.take_if(|reading| reading.is_there()) {
            None => Ok(None),
            Some(reading) => {
                let pixels = reading.finish()?;
                Ok(Some(pixels.into_iter().flat_map(|[r, g, b, _]| [r, g, b, 255]).collect()))
            }
        }
    }

    /// Draws to the canvas.
    ///
    /// # Errors
    /// The card is lost, or says that something was wrong.
    pub fn draw(&mut self) -> Result<(), JsError> {
        let Some(scene) = &self.scene else { return Ok(()) };
        let device = &self.gpu.device;
        let shown = match self.surface.get_current_texture() {
            wgpu::CurrentSurfaceTexture::Success(shown) | wgpu::CurrentSurfaceTexture::Suboptimal(shown) => {
                shown
            }
            // Nothing to draw to for the moment.
            _ => return Ok(()),
        };
        let mut encoder = device.create_command_encoder(&Default::default());
        scene.draw_to(&self.renderer, &mut encoder, &self.target, &self.eye, &self.paint, self.overlays());
        {
            let view = shown.texture.create_view(&Default::default());
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: &view,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations {
                        load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                        store: wgpu::StoreOp::Store,
                    },
                })],
                ..Default::default()
            });
            let [width, height] = self.target.size();
            self.compare.draw(device, &mut pass, [0, 0, width, height], &Show::Picture(&self.target));
        }
        self.gpu.queue.submit([encoder.finish()]);
        self.gpu.queue.present(shown);
        match self.gpu.error() {
            Some(reason) => Err(JsError::new(&reason)),
            None => Ok(()),
        }
    }
}

impl Stage {
    fn lens(&self) -> Lens {
        Lens { field_of_view: FIELD_OF_VIEW, size: self.target.size() }
    }

    fn overlays(&self) -> Overlays {
        Overlays { wire: self.wire, written: self.shading == Shading::Dirty }
    }
}
