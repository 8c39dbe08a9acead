//! A Bevy app without a window: draws into an image, and hands out its pixels.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use bevy::app::PluginsState;
use bevy::camera::RenderTarget;
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::log::LogPlugin;
use bevy::prelude::*;
use bevy::render::gpu_readback::{Readback, ReadbackComplete};
use bevy::render::pipelined_rendering::PipelinedRenderingPlugin;
use bevy::render::render_resource::{PipelineCache, PollType, TextureFormat, TextureUsages};
use bevy::render::renderer::RenderDevice;
use bevy::render::{Render, RenderApp};
use bevy::tasks::block_on;
use bevy::window::{ExitCondition, WindowPlugin};
use bevy_multires::{LodCache, MultiresPlugin};

/// An app that draws into an image.
pub struct Headless {
    /// The app. Its plugins are all there.
    pub app: App,
    size: UVec2,
    pixels: Arc<Mutex<Option<Vec<u8>>>>,
    image: Handle<Image>,
}

/// Number of pipelines that are not ready.
#[derive(Resource, Clone, Default)]
struct Waiting(Arc<Mutex<usize>>);

/// Returns the name of the adapter that Bevy would draw with; `None` if there is none.
pub fn adapter() -> Option<String> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
    let adapter = block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default())).ok()?;
    Some(adapter.get_info().name)
}

impl Headless {
    /// Makes an app of `size` pixels, looking from `eye`. `None` if there is no adapter.
    pub fn new(size: UVec2, eye: Transform, sky: Color, plugins: impl FnOnce(&mut App)) -> Option<Self> {
        adapter()?;
        let mut app = App::new();
        let window =
            WindowPlugin { primary_window: None, exit_condition: ExitCondition::DontExit, ..default() };
        let quiet = DefaultPlugins.build().disable::<LogPlugin>().disable::<PipelinedRenderingPlugin>();
        // The loop of events is for windows, and for main threads.
        #[cfg(feature = "window")]
        let quiet = quiet.disable::<bevy::winit::WinitPlugin>();
        app.add_plugins(quiet.set(window)).add_plugins(MultiresPlugin).insert_resource(ClearColor(sky));
        plugins(&mut app);
        let waiting = Waiting::default();
        app.get_sub_app_mut(RenderApp)?.insert_resource(waiting.clone()).add_systems(Render, count_waiting);
        app.insert_resource(waiting);
        while app.plugins_state() == PluginsState::Adding {
            std::thread::sleep(Duration::from_millis(1));
        }
        app.finish();
        app.cleanup();

        let mut image = Image::new_target_texture(size.x, size.y, TextureFormat::Rgba8UnormSrgb, None);
        image.texture_descriptor.usage |= TextureUsages::COPY_SRC;
        let image = app.world_mut().resource_mut::<Assets<Image>>().add(image);
        let camera = (
            Camera3d::default(),
            Msaa::Sample4,
            Tonemapping::None,
            RenderTarget::Image(image.clone().into()),
        );
        app.world_mut().spawn((camera, eye));
        Some(Self { app, size, pixels: Arc::default(), image })
    }

    /// Draws frames until all levels are built and all pipelines compiled.
    pub fn settle(&mut self) {
        let mut still = 0;
        while still < 4 {
            self.frame();
            let waiting = self.app.world().resource::<Waiting>();
            let pipelines = *waiting.0.lock().unwrap_or_else(PoisonError::into_inner);
            let building = self.app.world().resource::<LodCache>().building();
            still = if pipelines + building == 0 { still + 1 } else { 0 };
        }
    }

    /// Draws a frame, and returns how long it took until the card was done.
    pub fn frame(&mut self) -> Duration {
        let begin = Instant::now();
        self.app.update();
        if let Some(device) = self.app.world().get_resource::<RenderDevice>()
            && let Err(error) = device.poll(PollType::wait_indefinitely())
        {
            error!("the card does not answer: {error}");
        }
        begin.elapsed()
    }

    /// Draws a frame and returns its pixels, red, green, blue and alpha, row by row.
    pub fn picture(&mut self) -> Vec<u8> {
        let taken = Arc::clone(&self.pixels);
        let mut readback = self.app.world_mut().spawn(Readback::texture(self.image.clone()));
        readback.observe(move |read: On<ReadbackComplete>| {
            *taken.lock().unwrap_or_else(PoisonError::into_inner) = Some(read.data.clone());
        });
        let entity = readback.id();
        let mut pixels = None;
        // The first answers may be of earlier frames.
        for _ in 0..3 {
            pixels = loop {
                self.frame();
                let taken = self.pixels.lock().unwrap_or_else(PoisonError::into_inner).take();
                if taken.is_some() {
                    break taken;
                }
            };
        }
        self.app.world_mut().despawn(entity);
        let mut pixels = pixels.unwrap_or_default();
        pixels.truncate((4 * self.size.x * self.size.y) as usize);
        pixels
    }
}

/// Counts pipelines that are being compiled.
fn count_waiting(cache: Res<PipelineCache>, waiting: Res<Waiting>) {
    *waiting.0.lock().unwrap_or_else(PoisonError::into_inner) = cache.waiting_pipelines().count();
}

/// Returns the mean difference of two pictures, 0 to 255, over red, green and blue.
pub fn difference(a: &[u8], b: &[u8]) -> f64 {
    let colours = |pixels: &'_ [u8]| {
        pixels.iter().enumerate().filter(|(at, _)| at % 4 != 3).map(|(_, x)| *x).collect::<Vec<u8>>()
    };
    let (a, b) = (colours(a), colours(b));
    let sum: u64 = a.iter().zip(&b).map(|(a, b)| u64::from(a.abs_diff(*b))).sum();
    sum as f64 / a.len().max(1) as f64
}
