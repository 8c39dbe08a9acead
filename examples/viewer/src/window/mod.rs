//! The window: events in, pictures and a panel out.
//!
//! | file | idea |
//! |---|---|
//! | `mod.rs` | [`run`]: the event loop |
//! | `viewer.rs` | what is shown, apart from the window |
//! | `hands.rs` | mouse, touch, trackpad and keys on the camera |
//! | `panel.rs` | the side panel |
//! | `graphs.rs` | numbers of the last frames as curves |
//! | `frustum.rs` | a camera as lines |
//! | `screen.rs` | the surface and the panel's painter |

mod frustum;
mod graphs;
mod hands;
mod panel;
mod screen;
mod viewer;

use std::sync::Arc;
use std::time::{Duration, Instant};

use winit::application::ApplicationHandler;
use winit::dpi::PhysicalSize;
use winit::event::{StartCause, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop, EventLoopProxy};
use winit::window::{Window, WindowId};

use crate::arguments::Arguments;
use crate::gpu::Gpu;
use crate::headless::Failure;
use panel::{Asked, Panel};
use screen::{Painted, Screen};
use viewer::Viewer;

/// Smallest window, pixels.
const LEAST: [u32; 2] = [240, 180];

/// Opens a window and shows what the arguments ask for, until it is closed. Tells on `say` which card draws.
///
/// # Errors
/// There is no card, or no window can be opened.
pub fn run(arguments: Arguments, say: impl Fn(&str)) -> Result<(), Failure> {
    let refused = |error: &dyn std::fmt::Display| {
        let reason = error.to_string();
        // The window system's own words, without the place in somebody's source where they were heard.
        let own = reason.rsplit_once(".rs:").and_then(|(_, rest)| rest.split_once(": "));
        Failure::Window { reason: own.map_or(reason.clone(), |(_, own)| own.to_owned()) }
    };
    let events = EventLoop::with_user_event().build().map_err(|error| refused(&error))?;
    let proxy = events.create_proxy();
    let mut app = App { arguments, say: &say, proxy, open: None, failure: None, frames: 0 };
    events.run_app(&mut app).map_err(|error| refused(&error))?;
    app.failure.map_or(Ok(()), Err)
}

/// Something was loaded.
struct Wake;

struct App<'a> {
    arguments: Arguments,
    say: &'a dyn Fn(&str),
    proxy: EventLoopProxy<Wake>,
    open: Option<Open>,
    failure: Option<Failure>,
    frames: u64,
}

/// An open window.
struct Open {
    window: Arc<Window>,
    gpu: Gpu,
    screen: Screen,
    input: egui_winit::State,
    panel: Panel,
    viewer: Viewer,
    last: Instant,
    /// Whether the last frame changed what the panel says in this one.
    was_busy: bool,
}

impl App<'_> {
    fn open(&self, events: &ActiveEventLoop) -> Result<Open, Failure> {
        let [width, height] = self.arguments.size;
        let attributes = Window::default_attributes()
            .with_title("multires")
            .with_inner_size(PhysicalSize::new(width, height))
            .with_min_inner_size(PhysicalSize::new(LEAST[0], LEAST[1]));
        let window = events
            .create_window(attributes)
            .map_err(|error| Failure::Window { reason: error.to_string() })?;
        let window = Arc::new(window);
        let (gpu, screen) = Screen::open(&window)?;
        (self.say)(&format!("adapter {}", gpu.name()));
        let context = egui::Context::default();
        context.set_theme(egui::Theme::Dark);
        let input = egui_winit::State::new(
            context,
            egui::ViewportId::ROOT,
            &window,
            Some(window.scale_factor() as f32),
            None,
            Some(gpu.device.limits().max_texture_dimension_2d as usize),
        );
        let viewer = Viewer::new(gpu.clone(), &self.arguments, self.wake());
        let (panel, last) = (Panel::default(), Instant::now());
        Ok(Open { window, gpu, screen, input, panel, viewer, last, was_busy: true })
    }

    fn wake(&self) -> impl Fn() + Send + 'static {
        let proxy = self.proxy.clone();
        // Where the loop has ended, nobody is to be woken.
        move || drop(proxy.send_event(Wake))
    }

    fn redraw(&mut self, events: &ActiveEventLoop) {
        let wake = self.wake();
        let Some(open) = &mut self.open else { return };
        let again = open.frame(wake);
        open.viewer.follows = again.is_zero();
        self.frames += 1;
        if let Some(reason) = open.gpu.error() {
            // Where the card draws nothing, the panel is not seen either.
            let failure = Failure::Card { reason };
            if self.frames == 1 || self.arguments.end_after.is_some() {
                self.failure = Some(failure);
                events.exit();
                return;
            }
            open.viewer.message = Some(failure.to_string());
        }
        if self.arguments.end_after.is_some_and(|most| self.frames >= most && !open.viewer.is_loading()) {
            (self.say)(&format!("{} frames", self.frames));
            open.viewer.message.iter().for_each(|message| (self.say)(message));
            events.exit();
        } else if again.is_zero() || self.arguments.end_after.is_some() {
            open.window.request_redraw();
        } else {
            match Instant::now().checked_add(again) {
                Some(then) => events.set_control_flow(ControlFlow::WaitUntil(then)),
                None => events.set_control_flow(ControlFlow::Wait),
            }
        }
    }
}

impl ApplicationHandler<Wake> for App<'_> {
    fn resumed(&mut self, events: &ActiveEventLoop) {
        if self.open.is_none() {
            match self.open(events) {
                Ok(open) => {
                    open.window.request_redraw();
                    self.open = Some(open);
                }
                Err(failure) => {
                    self.failure = Some(failure);
                    events.exit();
                }
            }
        }
    }

    fn new_events(&mut self, _: &ActiveEventLoop, cause: StartCause) {
        if let (StartCause::ResumeTimeReached { .. }, Some(open)) = (cause, &self.open) {
            open.window.request_redraw();
        }
    }

    fn user_event(&mut self, _: &ActiveEventLoop, _: Wake) {
        if let Some(open) = &self.open {
            open.window.request_redraw();
        }
    }

    fn window_event(&mut self, events: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        let wake = self.wake();
        let Some(open) = &mut self.open else { return };
        let response = open.input.on_window_event(&open.window, &event);
        match event {
            WindowEvent::CloseRequested => events.exit(),
            WindowEvent::Resized(size) => {
                open.screen.resize(&open.gpu, [size.width, size.height]);
                open.window.request_redraw();
            }
            WindowEvent::DroppedFile(file) => {
                open.viewer.open(&file, wake);
                open.window.request_redraw();
            }
            WindowEvent::RedrawRequested => self.redraw(events),
            _ if response.repaint => open.window.request_redraw(),
            _ => {}
        }
    }
}

impl Open {
    /// One frame. For how long nothing needs to be drawn unless something happens.
    fn frame(&mut self, wake: impl Fn() + Send + 'static) -> Duration {
        let seconds = self.last.elapsed().as_secs_f64().min(0.25);
        self.last = Instant::now();
        let input = self.input.take_egui_input(&self.window);
        let context = self.input.egui_ctx().clone();
        self.viewer.take_loaded();
        let mut asked = Asked::default();
        let Self { panel, viewer, .. } = self;
        let output = context.run_ui(input, |ui| asked = panel.show(ui, viewer, seconds));
        self.input.handle_platform_output(&self.window, output.platform_output);
        if let Some(source) = asked.load {
            self.viewer.load(source, wake);
        } else if asked.rebuild {
            self.viewer.rebuild(wake);
        }

        let scale = output.pixels_per_point;
        let [width, height] = self.screen.size();
        let pixels = |part: &egui::Rect| {
            let x = |points: f32| (points * scale).round().clamp(0.0, width as f32) as u32;
            let y = |points: f32| (points * scale).round().clamp(0.0, height as f32) as u32;
            let [left, top] = [x(part.left()), y(part.top())];
            [left, top, x(part.right()).saturating_sub(left), y(part.bottom()).saturating_sub(top)]
        };
        let parts: Vec<[u32; 4]> = asked.parts.iter().map(pixels).collect();
        let each = parts.first().map_or([1, 1], |part| [part[2].max(1), part[3].max(1)]);
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        self.viewer.frame(&mut encoder, each);
        let painted = Painted {
            shapes: context.tessellate(output.shapes, scale),
            textures: output.textures_delta,
            scale,
        };
        let shown = self.screen.show(&self.gpu, encoder, &self.viewer.parts(&parts), painted);

        let wait = output
            .viewport_output
            .get(&egui::ViewportId::ROOT)
            .map_or(Duration::MAX, |viewport| viewport.repaint_delay);
        let change = self.viewer.adapted.change.cut;
        let busy = self.viewer.is_busy() || asked.moved || change.splits + change.collapses > 0;
        let was_busy = std::mem::replace(&mut self.was_busy, busy);
        match (shown, busy || was_busy) {
            // Loading takes a while, and a window that takes no pictures may not for long.
            (true, true) if self.viewer.is_loading() => Duration::from_millis(50).min(wait),
            (false, _) => Duration::from_millis(50),
            (true, true) => Duration::ZERO,
            (true, false) => wait,
        }
    }
}
