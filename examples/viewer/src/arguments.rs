//! What the program is told: the arguments, and what they ask for.

use std::path::PathBuf;

use clap::builder::PossibleValuesParser;
use clap::{Parser, ValueEnum};
use multires::adapt::Geomorph;
use multires::hierarchy::Dependencies;
use multires::lod::{LodOptions, Triangulation, VertexBuffer};
use multires::simplify::{Placement, metric};
use multires::view::ErrorKind;
use multires::wavelet::{ErrorBound, WaveletOptions};

use crate::camera::Tolerances;
use crate::renderer::Shading;
use crate::scene::{
    BuildOptions, Builtin, ControlOptions, Controller, Coordinates, Overlays, Source, StructureKind,
};

/// Shows a model at the level of detail that the view asks for: in a window, or as pictures with --headless.
///
/// Exit codes: 0 done, 1 bad input (one line on stderr says why), 2 bad usage, 3 no graphics adapter.
#[derive(Debug, Clone, Parser)]
#[command(name = "multires-viewer", version)]
pub struct Arguments {
    /// A mesh (.obj .ply .stl .off .glb .gltf) or a baked structure (.mres); without one a built-in scene.
    pub file: Option<PathBuf>,
    /// A scene that needs no file.
    #[arg(long, value_name = "S", value_enum, conflicts_with = "file")]
    pub scene: Option<Builtin>,
    /// About so many triangles, for the terrain, a rock and an object of the crowd.
    #[arg(long, value_name = "N", requires = "scene", value_parser = clap::value_parser!(u32).range(1..=100_000_000))]
    pub triangles: Option<u32>,

    /// What is built from a mesh.
    #[arg(long, value_name = "S", value_enum, default_value_t)]
    pub structure: StructureKind,
    /// What a collapse costs.
    #[arg(long, value_name = "M", default_value = "quadric", value_parser = PossibleValuesParser::new(metric::NAMES))]
    pub metric: String,
    /// Where merged vertices go, of a hierarchy or a g-mesh.
    #[arg(long, value_name = "P", value_enum, default_value_t)]
    pub placement: Place,
    /// How near cuts stay to what the simplifier saw.
    #[arg(long, value_name = "D", value_enum, default_value_t)]
    pub dependencies: Needs,
    /// Which errors the bounds of wavelets hold.
    #[arg(long, value_name = "B", value_enum, default_value_t)]
    pub bound: Bound,
    /// Texture coordinates of a wavelet mesh [default: atlas; own with --texture].
    #[arg(long, value_name = "C", value_enum)]
    pub coordinates: Option<Coordinates>,

    /// Where vertices are kept: all on the card once, or those in use for each instance.
    #[arg(long, value_name = "S", value_enum, default_value_t)]
    pub storage: Storage,
    /// Which triangles of a wavelet mesh are drawn.
    #[arg(long, value_name = "T", value_enum, default_value_t)]
    pub triangulation: Triangles,
    /// Largest error on the picture, pixels.
    #[arg(long, value_name = "P", default_value_t = 1.0, value_parser = not_negative)]
    pub tolerance: f32,
    /// The same for what may be on the silhouette [default: as anywhere].
    #[arg(long, value_name = "P", value_parser = not_negative)]
    pub silhouette: Option<f32>,
    /// Goes by how far points are from where they belong, not by how far the surface is off.
    #[arg(long)]
    pub parametric: bool,
    /// Most triangles of an object.
    #[arg(long, value_name = "N")]
    pub budget: Option<usize>,
    /// Most triangles of all objects together.
    #[arg(long, value_name = "N")]
    pub budget_scene: Option<usize>,
    /// Most splits and collapses a frame of an object.
    #[arg(long, value_name = "N")]
    pub operations: Option<usize>,
    /// Seconds in which vertices move to their places [default: they jump].
    #[arg(long, value_name = "S", value_parser = not_negative)]
    pub geomorph: Option<f32>,

    /// What colours the surface [default: texture for glTF files that name pictures, else material].
    #[arg(long, value_name = "S", value_enum)]
    pub shading: Option<Shading>,
    /// Draw the edges of triangles.
    #[arg(long)]
    pub wire: bool,
    /// One normal a triangle.
    #[arg(long)]
    pub flat: bool,
    /// A picture (.png) to paint the surface with, for --shading texture [default: a checker; for wavelet meshes one by base face].
    #[arg(long, value_name = "PNG")]
    pub texture: Option<PathBuf>,

    /// What the window shows beside the level of detail.
    #[arg(long, value_name = "B", value_enum, default_value_t)]
    pub beside: Layout,

    /// Pixels of a picture, or of the window at first.
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = size)]
    pub size: [u32; 2],
    /// Vertical field of view, degrees.
    #[arg(long, value_name = "D", default_value_t = 60.0, value_parser = field_of_view)]
    pub fov: f64,
    /// The model's z is up.
    #[arg(long)]
    pub z_up: bool,
    /// A camera path: frame, eye x y z, target x y z a line, in diagonals of the model's box from its centre.
    #[arg(long, value_name = "CSV")]
    pub path: Option<PathBuf>,

    /// No window: pictures into --out.
    #[arg(long)]
    pub headless: bool,
    /// Frames of the path to take pictures of [default: the first].
    #[arg(long, value_name = "N,...", value_delimiter = ',', requires = "path")]
    pub frames: Vec<u64>,
    /// Folder for pictures.
    #[arg(long, value_name = "DIR", default_value = "target/viewer")]
    pub out: PathBuf,
    /// No window: a table of what every frame of the path uploads and takes.
    #[arg(long)]
    pub bench: bool,
    /// Draw no more than so many frames in the window, then end.
    #[arg(long, value_name = "N", hide = true)]
    pub end_after: Option<u64>,
}

/// What is shown beside the level of detail.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub enum Layout {
    /// Nothing.
    #[default]
    Nothing,
    /// The full mesh.
    Full,
    /// The full mesh, and the difference of both.
    Difference,
    /// The full mesh, and how far apart the surfaces of both lie.
    Distance,
}

impl Layout {
    /// Number of pictures.
    pub fn pictures(self) -> u32 {
        match self {
            Self::Nothing => 1,
            Self::Full => 2,
            Self::Difference | Self::Distance => 3,
        }
    }
}

/// Where merged vertices go.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub enum Place {
    /// At one end: no new vertices.
    #[default]
    Endpoint,
    /// Half-way.
    Midpoint,
    /// The better of these.
    Subset,
    /// Where the metric is least.
    Optimal,
}

/// How near cuts stay to what the simplifier saw.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub enum Needs {
    /// As the view asks.
    #[default]
    None,
    /// A split needs the split that keeps its wings apart: cuts stay manifold.
    Manifold,
    /// A split needs the triangles beside it.
    Adjacent,
    /// A split needs all neighbours of its vertex.
    Neighbours,
}

/// Which errors the bounds of wavelets hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub enum Bound {
    /// All that can come about: proven.
    #[default]
    Conservative,
    /// Those of leaving out all wavelets of a level and finer ones: fewer triangles.
    WithoutSiblings,
}

/// Where vertices are kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub enum Storage {
    /// All of them on the card, once for all instances.
    #[default]
    Static,
    /// Those in use, for each instance.
    Compact,
}

impl From<Storage> for VertexBuffer {
    fn from(storage: Storage) -> Self {
        match storage {
            Storage::Static => Self::Shared,
            Storage::Compact => Self::Packed,
        }
    }
}

/// Which triangles of a wavelet mesh are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub enum Triangles {
    /// The sum of the wavelets, exactly.
    #[default]
    Exact,
    /// As few as there can be.
    Minimal,
}

impl From<Bound> for ErrorBound {
    fn from(bound: Bound) -> Self {
        match bound {
            Bound::Conservative => Self::Conservative,
            Bound::WithoutSiblings => Self::WithoutSiblings,
        }
    }
}

impl From<Triangles> for Triangulation {
    fn from(triangles: Triangles) -> Self {
        match triangles {
            Triangles::Exact => Self::Exact,
            Triangles::Minimal => Self::Minimal,
        }
    }
}

impl From<Place> for Placement {
    fn from(place: Place) -> Self {
        match place {
            Place::Endpoint => Self::Endpoint,
            Place::Midpoint => Self::Midpoint,
            Place::Subset => Self::Subset,
            Place::Optimal => Self::Optimal,
        }
    }
}

impl From<Needs> for Dependencies {
    fn from(needs: Needs) -> Self {
        match needs {
            Needs::None => Self::None,
            Needs::Manifold => Self::Manifold,
            Needs::Adjacent => Self::Adjacent,
            Needs::Neighbours => Self::Neighbours,
        }
    }
}

impl Arguments {
    /// What to show.
    pub fn source(&self) -> Source {
        match &self.file {
            Some(path) => Source::File(path.clone()),
            None => Source::Builtin(self.scene.unwrap_or(Builtin::Demo), self.triangles),
        }
    }

    /// How to build it.
    pub fn build(&self) -> BuildOptions {
        // A picture that is brought along is one for the coordinates that the mesh has.
        let coordinates = if self.texture.is_some() { Coordinates::Own } else { Coordinates::Atlas };
        BuildOptions::default()
            .with_structure(self.structure)
            .with_metric(&self.metric)
            .with_placement(self.placement.into())
            .with_dependencies(self.dependencies.into())
            .with_wavelets(WaveletOptions::default().with_bound(self.bound.into()))
            .with_coordinates(self.coordinates.unwrap_or(coordinates))
    }

    /// How it follows the view.
    pub fn options(&self) -> LodOptions {
        let geomorph = self.geomorph.map(|seconds| Geomorph::default().with_duration(seconds));
        LodOptions::default()
            .with_buffer(self.storage.into())
            .with_triangles(self.budget)
            .with_operations(self.operations)
            .with_geomorph(geomorph)
            .with_triangulation(self.triangulation.into())
    }

    /// How triangles are held over all objects.
    pub fn control(&self) -> ControlOptions {
        let options = ControlOptions::default();
        match self.budget_scene {
            Some(most) => options.with_controller(Controller::Triangles).with_triangles(most),
            None => options,
        }
    }

    /// How large errors may be.
    pub fn tolerances(&self) -> Tolerances {
        let error = if self.parametric { ErrorKind::Parametric } else { ErrorKind::Geometric };
        Tolerances::default().with_anywhere(self.tolerance).with_silhouette(self.silhouette).with_error(error)
    }

    /// What lies over the surfaces.
    pub fn overlays(&self) -> Overlays {
        Overlays { wire: self.wire, written: self.shading == Some(Shading::Dirty) }
    }

    /// What is up.
    pub fn up(&self) -> [f64; 3] {
        if self.z_up { [0.0, 0.0, 1.0] } else { [0.0, 1.0, 0.0] }
    }
}

fn not_negative(text: &str) -> Result<f32, String> {
    let number = text.trim().parse::<f32>().ok().filter(|x| *x >= 0.0 && x.is_finite());
    number.ok_or_else(|| "not a number of 0 or more".to_owned())
}

fn field_of_view(text: &str) -> Result<f64, String> {
    let degrees = text.trim().parse::<f64>().ok().filter(|d| *d >= 1.0 && *d <= 170.0);
    degrees.ok_or_else(|| "not a number of degrees from 1 to 170".to_owned())
}

fn size(text: &str) -> Result<[u32; 2], String> {
    let size = text.split_once('x').and_then(|(w, h)| Some([w.parse().ok()?, h.parse().ok()?]));
    size.filter(|size| size.iter().all(|side| (1..=16_384).contains(side)))
        .ok_or_else(|| format!("{text:?} is not WIDTHxHEIGHT in pixels, 1 to 16384 each"))
}
