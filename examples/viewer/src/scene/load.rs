//! Models that are read and built in a thread of their own, with progress and cancel.

use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::time::{Duration, Instant};

use multires::mesh::Mesh;

use super::Builtin;
use super::model::{BuildOptions, Coordinates, Model, ModelError, StructureKind};
use super::pictures::Pictures;
use crate::camera::Orbit;

/// Where a model comes from.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Source {
    /// A file: a mesh, or a baked structure.
    File(PathBuf),
    /// A built-in scene, with about so many triangles where that can be chosen.
    Builtin(Builtin, Option<u32>),
}

impl Source {
    /// What it is called.
    pub fn name(&self) -> String {
        match self {
            Self::File(path) => path
                .file_name()
                .map_or_else(|| path.display().to_string(), |name| name.to_string_lossy().into_owned()),
            Self::Builtin(builtin, _) => builtin.name().to_owned(),
        }
    }

    /// Where its objects are.
    pub fn places(&self) -> Vec<[[f32; 4]; 4]> {
        match self {
            Self::File(_) => vec![glam::Mat4::IDENTITY.to_cols_array_2d()],
            Self::Builtin(builtin, _) => builtin.places(),
        }
    }

    /// The first look at a scene with that centre and diagonal, in a picture with that vertical field of view, radians.
    pub fn orbit(&self, centre: [f64; 3], diagonal: f64, field_of_view: f64, z_up: bool) -> Orbit {
        match self {
            Self::Builtin(builtin, _) if !z_up => builtin.orbit(centre, diagonal, field_of_view),
            _ => Orbit::framing(centre, 0.4 * diagonal, field_of_view, z_up),
        }
    }

    fn mesh(&self, structure: StructureKind) -> Result<Mesh, ModelError> {
        match self {
            Self::File(path) => Model::read_mesh(path),
            Self::Builtin(builtin, triangles) => Ok(builtin.mesh(*triangles, structure)),
        }
    }

    /// Reads and builds. A baked file is what it is, whatever the options but for texture coordinates.
    ///
    /// # Errors
    /// Everything that [`Model`] may refuse.
    pub fn load(
        &self,
        options: &BuildOptions,
        progress: &mut dyn FnMut(f32) -> ControlFlow<()>,
    ) -> Result<Model, ModelError> {
        match self {
            Self::File(path) if Model::is_baked(path) => Model::read_baked(path, options.coordinates),
            _ => {
                let mesh = self.mesh(options.structure)?;
                if progress(0.0).is_break() {
                    return Err(ModelError::Cancelled);
                }
                let coarsest = match self {
                    Self::Builtin(builtin, _) => builtin.coarsest(),
                    Self::File(_) => None,
                };
                let pictures = match self {
                    Self::File(path) => Pictures::read(path),
                    Self::Builtin(..) => Pictures::default(),
                };
                let mut options = options.clone().with_coarsest(options.coarsest.or(coarsest));
                if pictures.base_colour.is_some() || pictures.normals.is_some() {
                    // The pictures are for the coordinates that the mesh has.
                    options = options.with_coordinates(Coordinates::Own);
                }
                Ok(Model::build(&mesh, &options, progress)?.with_pictures(pictures))
            }
        }
    }
}

/// A model on its way.
pub struct Loading {
    source: Source,
    answer: Receiver<Result<Model, ModelError>>,
    /// Share of the way, as the bits of a float.
    progress: Arc<AtomicU32>,
    cancel: Arc<AtomicBool>,
    since: Instant,
}

impl Loading {
    /// Starts. `wake` is called when there is an answer.
    pub fn start(source: Source, options: BuildOptions, wake: impl Fn() + Send + 'static) -> Self {
        let progress = Arc::new(AtomicU32::new(0));
        let cancel = Arc::new(AtomicBool::new(false));
        let (sender, answer) = channel();
        let loading = Self {
            source: source.clone(),
            answer,
            progress: Arc::clone(&progress),
            cancel: Arc::clone(&cancel),
            since: Instant::now(),
        };
        std::thread::spawn(move || {
            let mut tell = |at: f32| {
                progress.store(at.to_bits(), Ordering::Relaxed);
                if cancel.load(Ordering::Relaxed) {
                    ControlFlow::Break(())
                } else {
                    ControlFlow::Continue(())
                }
            };
            let model = source.load(&options, &mut tell);
            // Where nobody waits any more, nobody needs it.
            let _ = sender.send(model);
            wake();
        });
        loading
    }

    /// What is loaded.
    pub fn source(&self) -> &Source {
        &self.source
    }

    /// Share of the way, 0 to 1.
    pub fn progress(&self) -> f32 {
        f32::from_bits(self.progress.load(Ordering::Relaxed))
    }

    /// How long it has taken so far.
    pub fn elapsed(&self) -> Duration {
        self.since.elapsed()
    }

    /// Asks to stop soon.
    pub fn cancel(&self) {
        self.cancel.store(true, Ordering::Relaxed);
    }

    /// The answer, once, when it is there.
    pub fn poll(&self) -> Option<Result<Model, ModelError>> {
        match self.answer.try_recv() {
            Ok(answer) => Some(answer),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => Some(Err(ModelError::Lost)),
        }
    }
}
