//! What the window shows, apart from the window: a scene, a camera, and the pictures that are asked for.

use std::path::{Path as FilePath, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use multires::lod::LodOptions;

use super::frustum;
use super::graphs::{History, Numbers};
use super::hands::Hands;
use super::screen::Part;
use crate::arguments::{Arguments, Layout};
use crate::camera::{Lens, Orbit, Path, Pose, Tolerances};
use crate::gpu::Gpu;
use crate::headless::read_png;
use crate::renderer::{Eye, Kind, LineEnd, Look, Paint, Renderer, Shading, Show, Target, Uploaded, Uploads};
use crate::scene::{
    Adapted, BuildOptions, ControlOptions, Controller, Loading, ModelError, Overlays, Scene, Source, Texture,
};

/// Samples a pixel.
const SAMPLES: u32 = 4;
/// Ends of lines at most.
const LINE_ENDS: u64 = 64;

/// All that can be set by hand.
pub struct Controls {
    /// How models are built: what the next build takes.
    pub build: BuildOptions,
    /// How instances follow the view.
    pub options: LodOptions,
    /// How triangles or time are held over all objects.
    pub control: ControlOptions,
    /// How large errors may be.
    pub tolerances: Tolerances,
    /// What colours surfaces.
    pub shading: Shading,
    /// Whether edges are drawn.
    pub wire: bool,
    /// Whether triangles get one normal each.
    pub flat: bool,
    /// What is shown beside what.
    pub layout: Layout,
    /// Vertical field of view, radians.
    pub field_of_view: f64,
    /// Whether z is up.
    pub z_up: bool,
}

/// A cut that is looked at from elsewhere.
struct Frozen {
    pose: Pose,
    lens: Lens,
}

/// A path on its way.
enum Tape {
    /// Every frame is added.
    Recording(Path),
    /// The next frame is shown.
    Playing(usize),
}

/// The viewer.
pub struct Viewer {
    gpu: Gpu,
    renderer: Renderer,
    uploads: Uploads,
    eyes: [Eye; 2],
    targets: [Target; 2],
    paint: Paint,
    /// Whether that is a picture that somebody brought, which models do not replace.
    painted: bool,
    /// What could not be built as a wavelet mesh.
    refused: Option<Source>,
    lines: wgpu::Buffer,
    line_count: u32,
    source: Source,
    built: BuildOptions,
    scene: Option<Scene>,
    full: Option<Scene>,
    loading: Option<Loading>,
    /// What is wrong, for people.
    pub message: Option<String>,
    /// What can be set.
    pub controls: Controls,
    /// The camera.
    pub hands: Hands,
    frozen: Option<Frozen>,
    path: Option<Path>,
    tape: Option<Tape>,
    out: PathBuf,
    /// Curves.
    pub history: History,
    /// The last frame.
    pub adapted: Adapted,
    /// What it uploaded.
    pub uploaded: Uploaded,
    last: Instant,
    /// Whether the next frame comes as soon as it can: only then is the time to it one of a frame, and not of rest.
    pub follows: bool,
    /// Milliseconds of the last frame that another followed at once.
    frame_time: f32,
    /// Frames for which triangles still glow.
    glow: usize,
}

impl Viewer {
    /// Starts to load what the arguments ask for.
    pub fn new(gpu: Gpu, arguments: &Arguments, wake: impl Fn() + Send + 'static) -> Self {
        let renderer = Renderer::new(&gpu.device, &gpu.queue, SAMPLES);
        let (side, checker) = Paint::checker();
        let field_of_view = arguments.fov.to_radians();
        let controls = Controls {
            build: arguments.build(),
            options: arguments.options(),
            control: arguments.control(),
            tolerances: arguments.tolerances(),
            // What this is about is seen at once.
            shading: arguments.shading.unwrap_or(Shading::Level),
            wire: arguments.wire,
            flat: arguments.flat,
            layout: arguments.beside,
            field_of_view,
            z_up: arguments.z_up,
        };
        let mut viewer = Self {
            eyes: [renderer.eye(&gpu.device), renderer.eye(&gpu.device)],
            targets: [(); 2].map(|()| Target::with_depth(&gpu.device, [1, 1], SAMPLES)),
            paint: renderer.paint(&gpu.device, &gpu.queue, ([side; 2], &checker), None),
            painted: false,
            refused: None,
            lines: gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("lines"),
                size: LINE_ENDS * size_of::<LineEnd>() as u64,
                usage: wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }),
            line_count: 0,
            source: arguments.source(),
            built: controls.build.clone(),
            scene: None,
            full: None,
            loading: None,
            message: None,
            hands: Hands::Orbit(Orbit::framing([0.0; 3], 1.0, field_of_view, arguments.z_up)),
            frozen: None,
            path: None,
            tape: None,
            out: arguments.out.clone(),
            history: History::default(),
            adapted: Adapted::default(),
            uploaded: Uploaded::default(),
            last: Instant::now(),
            follows: false,
            frame_time: 0.0,
            glow: 0,
            controls,
            renderer,
            uploads: Uploads::default(),
            gpu,
        };
        viewer.load(arguments.source(), wake);
        for file in [&arguments.texture, &arguments.path].into_iter().flatten() {
            viewer.open(file, || {});
        }
        viewer
    }

    /// Starts to load something else. What is shown stays until it is there.
    pub fn load(&mut self, source: Source, wake: impl Fn() + Send + 'static) {
        self.cancel();
        self.message = None;
        self.refused = None;
        self.loading = Some(Loading::start(source, self.controls.build.clone(), wake));
    }

    /// Builds what is shown anew, as the controls say.
    pub fn rebuild(&mut self, wake: impl Fn() + Send + 'static) {
        self.load(self.source.clone(), wake);
    }

    /// Whether what is shown was built otherwise than the controls say.
    pub fn is_outdated(&self) -> bool {
        self.built != self.controls.build
    }

    /// Stops loading.
    pub fn cancel(&mut self) {
        if let Some(loading) = self.loading.take() {
            loading.cancel();
        }
    }

    /// A file that was dropped on the window: a path, a picture to paint with, or a model.
    pub fn open(&mut self, file: &FilePath, wake: impl Fn() + Send + 'static) {
        let is = |extension: &str| file.extension().is_some_and(|e| e.eq_ignore_ascii_case(extension));
        let name = file.file_name().unwrap_or(file.as_os_str()).to_string_lossy().into_owned();
        if is("csv") {
            match Path::read(file) {
                Ok(path) => self.path = Some(path),
                Err(error) => self.message = Some(format!("{name}: {error}")),
            }
        } else if is("png") {
            match read_png(file) {
                Ok(Texture { size, pixels }) => {
                    let colours = (size, &pixels[..]);
                    self.paint = self.renderer.paint(&self.gpu.device, &self.gpu.queue, colours, None);
                    self.painted = true;
                    self.controls.shading = Shading::Texture;
                }
                Err(error) => self.message = Some(error.to_string()),
            }
        } else {
            self.load(Source::File(file.to_owned()), wake);
        }
    }

    /// What is shown.
    pub fn scene(&self) -> Option<&Scene> {
        self.scene.as_ref()
    }

    /// What is on its way: its name, how far it is, and for how long.
    pub fn loading(&self) -> Option<(String, f32, Duration)> {
        self.loading.as_ref().map(|l| (l.source().name(), l.progress(), l.elapsed()))
    }

    /// What is shown is called.
    pub fn name(&self) -> String {
        self.source.name()
    }

    /// Whether something is on its way.
    pub fn is_loading(&self) -> bool {
        self.loading.is_some()
    }

    /// What could not be built as a wavelet mesh, but could as a vertex hierarchy.
    pub fn refused(&self) -> Option<&Source> {
        self.refused.as_ref()
    }

    /// The card's name.
    pub fn card(&self) -> String {
        self.gpu.name()
    }

    /// Length of the scene.
    pub fn size(&self) -> f64 {
        self.scene.as_ref().map_or(1.0, Scene::diagonal)
    }

    /// Shows all of the scene.
    pub fn reset_camera(&mut self) {
        let (centre, size) = self.scene.as_ref().map_or(([0.0; 3], 1.0), |s| (s.centre(), s.diagonal()));
        let lens = Lens { field_of_view: self.controls.field_of_view, size: self.targets[0].size() };
        let orbit = self.source.orbit(centre, size, lens.narrow(), self.controls.z_up);
        let flies = matches!(self.hands, Hands::Fly(_));
        self.hands = Hands::Orbit(orbit);
        self.hands.fly(flies, size);
    }

    /// Whether the cut stays as it is.
    pub fn is_frozen(&self) -> bool {
        self.frozen.is_some()
    }

    /// Freezes the cut, or lets it follow again.
    pub fn freeze(&mut self, on: bool) {
        let lens = Lens { field_of_view: self.controls.field_of_view, size: self.targets[0].size() };
        self.frozen = on.then(|| Frozen { pose: self.hands.pose(), lens });
        self.line_count = 0;
    }

    /// Whether a path is being recorded, and whether one is being replayed.
    pub fn tape(&self) -> [bool; 2] {
        [matches!(self.tape, Some(Tape::Recording(_))), matches!(self.tape, Some(Tape::Playing(_)))]
    }

    /// Frames of the path that can be replayed.
    pub fn path_frames(&self) -> usize {
        self.path.as_ref().map_or(0, |path| path.frames().len())
    }

    /// Starts to record, or ends and writes what was recorded.
    pub fn record(&mut self, on: bool) {
        match (on, self.tape.take()) {
            (true, _) => self.tape = Some(Tape::Recording(Path::default())),
            (false, Some(Tape::Recording(path))) if !path.frames().is_empty() => {
                let file = self.out.join("path.csv");
                let done = std::fs::create_dir_all(&self.out).map_err(|error| error.to_string());
                let done = done.and_then(|()| path.write(&file).map_err(|error| error.to_string()));
                self.message = Some(match done {
                    Ok(()) => format!("{} frames -> {}", path.frames().len(), file.display()),
                    Err(error) => error,
                });
                self.path = Some(path);
            }
            _ => {}
        }
    }

    /// Starts to replay the path, or stops.
    pub fn play(&mut self, on: bool) {
        self.tape = (on && self.path_frames() > 0).then_some(Tape::Playing(0));
    }

    /// Whether the next frame will differ from this one though nobody does anything.
    pub fn is_busy(&self) -> bool {
        self.loading.is_some()
            || self.tape.is_some()
            || self.glow > 0
            || self.adapted.change.pending > 0
            || self.adapted.change.moving > 0
            || self.is_controlled()
    }

    /// Whether a controller is not at rest: it has just moved, what it asked for is still uploaded, or it goes by the time of
    /// frames.
    fn is_controlled(&self) -> bool {
        let uploads = self.uploaded.indices + self.uploaded.vertices > 0;
        let times = self.controls.control.controller == Controller::Time;
        self.adapted.controlled.is_some_and(|controlled| controlled.settles || uploads || times)
    }

    /// Takes what was loaded, if it is there: before the panel is laid out.
    pub fn take_loaded(&mut self) {
        let Some(answer) = self.loading.as_ref().and_then(Loading::poll) else { return };
        let Some(loading) = self.loading.take() else { return };
        match answer {
            Ok(model) => {
                let same = self.scene.is_some() && self.source == *loading.source();
                self.source = loading.source().clone();
                self.built = self.controls.build.clone();
                let places = self.source.places();
                if !self.painted {
                    let (size, pixels) = model.picture();
                    let normals = model.normal_map().map(|map| (map.size, &map.pixels[..]));
                    let (device, queue) = (&self.gpu.device, &self.gpu.queue);
                    self.paint = self.renderer.paint(device, queue, (size, &pixels), normals);
                    if !same
                        && model.is_painted()
                        && matches!(self.controls.shading, Shading::Material | Shading::Level)
                    {
                        self.controls.shading = Shading::Texture;
                    }
                }
                self.full = None;
                let warning = model.warnings().first().cloned();
                let scene = Scene::new(
                    &self.gpu.device,
                    &mut self.uploads,
                    Arc::new(model),
                    &places,
                    self.controls.options,
                );
                self.message = scene.as_ref().err().map(ToString::to_string).or(warning);
                self.scene = scene.ok();
                self.freeze(false);
                if !same {
                    self.reset_camera();
                }
            }
            Err(ModelError::Cancelled) => {}
            Err(error) => {
                self.message = Some(format!("{}: {error}", loading.source().name()));
                if matches!(error, ModelError::NoConnectivity(_)) {
                    self.refused = Some(loading.source().clone());
                }
            }
        }
    }

    /// One frame: what the card is to draw, put into the encoder. `size` is that of each picture in pixels.
    pub fn frame(&mut self, encoder: &mut wgpu::CommandEncoder, size: [u32; 2]) {
        let now = Instant::now();
        let elapsed = now.duration_since(self.last);
        self.last = now;
        for target in &mut self.targets {
            if target.size() != size.map(|side| side.max(1)) {
                *target = Target::with_depth(&self.gpu.device, size, SAMPLES);
            }
        }
        let lens = Lens { field_of_view: self.controls.field_of_view, size: self.targets[0].size() };
        let Some(mut scene) = self.scene.take() else {
            self.draw_nothing(encoder, &lens);
            return;
        };
        self.turn_tape(&scene);
        let device = &self.gpu.device;
        if let Err(error) = scene.set_options(device, &mut self.uploads, self.controls.options) {
            self.message = Some(error.to_string());
        }
        if let Err(error) = scene.set_control(self.controls.control) {
            self.message = Some(error.to_string());
            self.controls.control = *scene.control();
        }
        if self.follows {
            scene.measured(elapsed.as_secs_f64());
            self.frame_time = elapsed.as_secs_f32() * 1e3;
        }
        let pose = self.hands.pose();

        let seen = self.frozen.as_ref().map_or((pose, lens), |frozen| (frozen.pose, frozen.lens));
        let before = self.uploaded;
        match seen.0.view(&seen.1, &self.controls.tolerances) {
            // A frozen cut still follows its own view, so that other tolerances show.
            Ok(view) => self.adapted = scene.adapt(&[view], elapsed.as_secs_f32().min(0.25)),
            Err(error) => self.message = Some(error.to_string()),
        }
        let start = Instant::now();
        // A difference is one of surfaces.
        let wire = self.controls.wire && self.controls.layout.pictures() < 3;
        let overlays = Overlays { wire, written: self.controls.shading == Shading::Dirty };
        scene.sync(device, &mut self.uploads, &self.renderer, overlays);
        self.sync_full(&scene, overlays);
        let look = Look {
            tolerance: self.controls.tolerances.anywhere,
            shading: self.shading(),
            flat: self.controls.flat,
            ..pose.look(&lens, scene.diagonal())
        };
        self.eyes[0].look(&mut self.uploads, &look, lens.size);
        self.draw_frustum(&scene);
        self.uploaded = self.uploads.flush(&self.gpu.device, &self.gpu.queue, encoder);
        let upload = start.elapsed();
        self.glow = match (overlays.written, self.uploaded.indices > 0 || before.indices > 0) {
            (true, true) => 14,
            (true, false) => self.glow.saturating_sub(1),
            (false, _) => 0,
        };
        {
            let mut pass = self.targets[0].pass(encoder);
            scene.draw(&self.renderer, &mut pass, &self.eyes[0], &self.paint, overlays);
            if self.line_count > 0 {
                self.renderer.lines(&mut pass, &self.lines, self.line_count);
            }
        }
        if let Some(full) = &self.full {
            let overlays = Overlays { wire, written: false };
            full.draw_to(&self.renderer, encoder, &self.targets[1], &self.eyes[0], &self.paint, overlays);
        }
        let change = self.adapted.change;
        let micros = |time: Duration| time.as_secs_f32() * 1e6;
        let numbers: Numbers = [
            change.triangles as f32,
            change.cut.tests as f32,
            (change.cut.splits + change.cut.collapses) as f32,
            micros(self.adapted.time),
            micros(upload),
            self.frame_time,
            self.uploaded.bytes() as f32,
            self.adapted.controlled.map_or(0.0, |controlled| controlled.output),
        ];
        self.history.push(numbers);
        self.scene = Some(scene);
    }

    /// What colours surfaces. A difference is one of what is seen, not of colours that tell which vertices are drawn.
    fn shading(&self) -> Shading {
        match (self.controls.layout, self.controls.shading) {
            (Layout::Difference, Shading::Level | Shading::Error | Shading::Dirty) => Shading::Material,
            (_, shading) => shading,
        }
    }

    /// Before there is a scene: the backdrop.
    fn draw_nothing(&mut self, encoder: &mut wgpu::CommandEncoder, lens: &Lens) {
        let look = self.hands.pose().look(lens, 1.0);
        self.eyes[0].look(&mut self.uploads, &look, lens.size);
        self.uploads.flush(&self.gpu.device, &self.gpu.queue, encoder);
        for target in &self.targets {
            self.renderer.begin(&mut target.pass(encoder), &self.eyes[0], &self.paint);
        }
    }

    fn turn_tape(&mut self, scene: &Scene) {
        let (centre, diagonal) = (scene.centre(), scene.diagonal());
        match &mut self.tape {
            Some(Tape::Recording(path)) => {
                let fits = path.record(&self.hands.pose(), centre, diagonal);
                if !fits {
                    self.record(false);
                }
            }
            Some(Tape::Playing(at)) => {
                let up = if self.controls.z_up { [0.0, 0.0, 1.0] } else { [0.0, 1.0, 0.0] };
                let pose = self.path.as_ref().and_then(|path| path.pose(*at, centre, diagonal, up));
                *at += 1;
                match pose {
                    Some(pose) => self.hands.take(&pose),
                    None => self.tape = None,
                }
            }
            None => {}
        }
    }

    /// The full mesh is there where it is shown, and only there.
    fn sync_full(&mut self, scene: &Scene, overlays: Overlays) {
        if self.controls.layout == Layout::Nothing {
            self.full = None;
            return;
        }
        let device = &self.gpu.device;
        let uploads = &mut self.uploads;
        if self.full.is_none() {
            let full = scene.full(device, uploads);
            self.message = full.as_ref().err().map(ToString::to_string).or(self.message.take());
            self.full = full.ok();
        }
        if let Some(full) = &mut self.full {
            full.sync(device, uploads, &self.renderer, Overlays { written: false, ..overlays });
        }
    }

    fn draw_frustum(&mut self, scene: &Scene) {
        let Some(frozen) = &self.frozen else { return };
        if self.line_count == 0 {
            let centre = glam::DVec3::from_array(scene.centre());
            let away = glam::DVec3::from_array(frozen.pose.eye).distance(centre);
            let ends = frustum::lines(&frozen.pose, &frozen.lens, away + 0.3 * scene.diagonal());
            self.uploads.write(Kind::Other, &self.lines, 0, bytemuck::cast_slice(&ends));
            self.line_count = ends.len() as u32;
        }
    }

    /// Distances in pixels at which a picture of distances is brightest.
    pub fn brightest(&self) -> f32 {
        2.0 * self.controls.tolerances.anywhere.max(0.05)
    }

    /// By what a distance, in distances from the eye, becomes 1 where it is brightest.
    fn gain(&self) -> f32 {
        let half = f64::from(self.targets[0].size()[1]) * 0.5;
        (half / (self.controls.field_of_view * 0.5).tan()) as f32 / self.brightest()
    }

    /// The pictures of the last frame in those parts of the window.
    pub fn parts(&self, rectangles: &[[u32; 4]]) -> Vec<Part<'_>> {
        let [level, full] = &self.targets;
        let compared = match self.controls.layout {
            Layout::Distance => Show::Distance(level, full, self.gain()),
            _ => Show::Difference(level, full),
        };
        let shows = [Show::Picture(level), Show::Picture(full), compared];
        rectangles.iter().copied().zip(shows).collect()
    }
}
