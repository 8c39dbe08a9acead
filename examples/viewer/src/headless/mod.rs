//! Pictures and tables without a window, on any adapter.
//!
//! | file | idea |
//! |---|---|
//! | `mod.rs` | [`run`]: pictures of a path's frames, as PNG |
//! | `stage.rs` | [`Stage`]: a scene, a card and a picture |
//! | `bench.rs` | what every frame uploads and takes, as a table |

mod bench;
mod stage;

pub use bench::{Bench, Summary};
pub use stage::{FrameReport, Stage};

use std::ops::ControlFlow;
use std::path::{Path as FilePath, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use multires::io::atomic;
use multires::view::ViewError;

use crate::arguments::Arguments;
use crate::camera::{Lens, Path, PathError, Pose};
use crate::gpu::{self, Gpu, GpuError};
use crate::renderer::{Look, RenderError, Shading};
use crate::scene::{ModelError, Scene, SceneControlError, Texture};

/// Seconds from frame to frame.
pub const STEP: f32 = 1.0 / 60.0;

/// Why a run failed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Failure {
    /// There is no card.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// There is no model.
    #[error("{name}: {source}")]
    Model {
        /// The file or scene.
        name: String,
        /// What is wrong with it.
        source: ModelError,
    },
    /// The camera path is none.
    #[error("{}: {source}", path.display())]
    Path {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        source: PathError,
    },
    /// A frame that the path does not have.
    #[error("the path has no frame {frame}")]
    NoFrame {
        /// The frame asked for.
        frame: u64,
    },
    /// A pose from which nothing can be seen.
    #[error(transparent)]
    View(#[from] ViewError),
    /// Nothing could be drawn.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// A picture that cannot be read or written.
    #[error("{}: {reason}", path.display())]
    Picture {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// The scene cannot be held to a number of triangles.
    #[error(transparent)]
    Control(#[from] SceneControlError),
    /// The window system refuses.
    #[error("no window could be opened: {reason}")]
    Window {
        /// What it says.
        reason: String,
    },
    /// The card said that something was wrong.
    #[error("the graphics adapter reports: {reason}")]
    Card {
        /// What it says.
        reason: String,
    },
}

impl Failure {
    /// The program's exit code: 3 without an adapter, 1 for all else.
    pub fn exit_code(&self) -> u8 {
        if matches!(self, Self::Gpu(_)) { 3 } else { 1 }
    }
}

/// The picture of a PNG file.
///
/// # Errors
/// The file cannot be read, is no PNG, or is larger than cards take.
pub fn read_png(path: &FilePath) -> Result<Texture, Failure> {
    let wrong = |reason: String| Failure::Picture { path: path.to_owned(), reason };
    Texture::from_png(&std::fs::read(path).map_err(|error| wrong(error.to_string()))?).map_err(wrong)
}

/// Writes a picture as PNG, whole or not at all. Opacity is left out.
///
/// # Errors
/// The file cannot be written.
pub fn write_png(path: &FilePath, size: [u32; 2], pixels: &[[u8; 4]]) -> Result<(), Failure> {
    let wrong = |reason: String| Failure::Picture { path: path.to_owned(), reason };
    let rgb: Vec<u8> = pixels.iter().flat_map(|p| [p[0], p[1], p[2]]).collect();
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, size[0], size[1]);
    encoder.set_color(png::ColorType::Rgb);
    let written = encoder.write_header().and_then(|mut writer| writer.write_image_data(&rgb));
    written.map_err(|error| wrong(error.to_string()))?;
    atomic::write(path, &bytes).map_err(|error| wrong(error.to_string()))
}

/// The poses of a run, with the numbers of their frames: the path's, or one that shows all of the scene.
fn poses(arguments: &Arguments, scene: &Scene, path: Option<&Path>) -> Vec<(u64, Pose)> {
    let (centre, diagonal, up) = (scene.centre(), scene.diagonal(), arguments.up());
    match path {
        Some(path) => path
            .frames()
            .iter()
            .enumerate()
            .filter_map(|(i, frame)| Some((frame.frame, path.pose(i, centre, diagonal, up)?)))
            .collect(),
        None => {
            let fov = arguments.fov.to_radians();
            vec![(0, arguments.source().orbit(centre, diagonal, fov, arguments.z_up).pose())]
        }
    }
}

/// Takes pictures, or measures, as the arguments ask; tells on `say` what was done. `since` is when the program started.
///
/// # Errors
/// See [`Failure`].
pub fn run(arguments: &Arguments, since: Instant, mut say: impl FnMut(&str)) -> Result<(), Failure> {
    let path = match &arguments.path {
        Some(file) => Some(Path::read(file).map_err(|source| Failure::Path { path: file.clone(), source })?),
        None => None,
    };
    // The card is opened while the model is built.
    let opening = std::thread::spawn(|| Gpu::open(&gpu::instance(), None));
    let source = arguments.source();
    let model = source
        .load(&arguments.build(), &mut |_| ControlFlow::Continue(()))
        .map_err(|error| Failure::Model { name: source.name(), source: error });
    let lost = || GpuError::NoAdapter { reason: "its driver failed".to_owned() };
    let gpu = opening.join().map_err(|_| lost())??;
    say(&format!("adapter {}", gpu.name()));
    let model = Arc::new(model?);
    let triangles = model.triangle_count();
    say(&format!("model   {}: {}, {triangles} triangles", source.name(), model.kind()));

    for warning in model.warnings() {
        say(&format!("warning {warning}"));
    }

    let painted = if model.is_painted() { Shading::Texture } else { Shading::Material };
    let shading = arguments.shading.unwrap_or(painted);
    let samples = 4;
    let mut stage =
        Stage::new(gpu.clone(), model, &source.places(), arguments.options(), arguments.size, samples)
            .map_err(|error| Failure::Model { name: source.name(), source: error.into() })?;
    stage.scene_mut().set_control(arguments.control())?;
    if let Some(texture) = &arguments.texture {
        let Texture { size, pixels } = read_png(texture)?;
        stage.set_paint(size, &pixels);
    }
    let poses = poses(arguments, stage.scene(), path.as_ref());
    let wanted: Vec<u64> = match &arguments.frames[..] {
        [] => poses.first().map(|(frame, _)| *frame).into_iter().collect(),
        frames => frames.to_vec(),
    };
    if let Some(&frame) = wanted.iter().find(|frame| !poses.iter().any(|(at, _)| at == *frame)) {
        return Err(Failure::NoFrame { frame });
    }

    let lens = Lens { field_of_view: arguments.fov.to_radians(), size: arguments.size };
    let (tolerances, overlays) = (arguments.tolerances(), arguments.overlays());
    let look = |scene: &Scene, pose: &Pose| Look {
        tolerance: tolerances.anywhere,
        shading,
        flat: arguments.flat,
        ..pose.look(&lens, scene.diagonal())
    };
    let last = if arguments.bench {
        poses.len()
    } else {
        poses.iter().rposition(|(frame, _)| wanted.contains(frame)).map_or(0, |at| at + 1)
    };
    let mut bench = Bench::default();
    for (i, (frame, pose)) in poses[..last].iter().enumerate() {
        let pictured = wanted.contains(frame) && !arguments.bench;
        let seen = look(stage.scene(), pose);
        let draws = arguments.bench || pictured;
        let views = [pose.view(&lens, &tolerances)?];
        let report = stage.frame(&views, draws.then_some(&seen), overlays, STEP);
        bench.add(&report, stage.scene());
        if draws && (i == 0 || pictured) && bench.first_picture.is_none() {
            bench.first_picture = Some(since.elapsed());
        }
        if pictured {
            std::fs::create_dir_all(&arguments.out).map_err(|error| Failure::Picture {
                path: arguments.out.clone(),
                reason: error.to_string(),
            })?;
            let file = arguments.out.join(format!("frame-{frame:04}.png"));
            write_png(&file, arguments.size, &stage.picture()?)?;
            let change = report.adapted.change;
            say(&format!("frame   {frame}: {} triangles -> {}", change.triangles, file.display()));
        }
        if let Some(reason) = gpu.error() {
            return Err(Failure::Card { reason });
        }
    }
    if arguments.bench {
        say(&bench.table(stage.scene()));
    } else if let Some(first) = bench.first_picture {
        say(&format!("first picture after {:.2} s", first.as_secs_f64()));
    }
    Ok(())
}
