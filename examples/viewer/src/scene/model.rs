//! A model that can be drawn at any level of detail: a structure, and its vertices as the card reads them.

use std::borrow::Cow;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::Arc;

use glam::Vec3;
use multires::adapt::{LevelOfDetail, Refinements};
use multires::hierarchy::{Dependencies, HierarchyError, HierarchyMesh, HierarchyParts};
use multires::io::{self, BakeError, ReadError, ReadOptions, SceneOrigin};
use multires::mesh::{MAX_ELEMENTS, Mesh, Topology, names};
use multires::simplify::metric;
use multires::simplify::{OptionError, Placement, Simplifier, StopReason};
use multires::tom::{TomError, TomMesh, TomSteps};
use multires::view::Motion;
use multires::wavelet::{Drawing, ErrorBound, WaveletError, WaveletLod, WaveletMesh, WaveletOptions};

use super::instance::{Everything, HierarchyInstance, Instance, LodSettings};
use super::texture::{self, Texture};
use super::tom_lod::TomLod;
use super::wavelet_instance::WaveletInstance;
use crate::renderer::{Paint, Vertex};

/// Why there is no model.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ModelError {
    /// The file cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The baked file cannot be read.
    #[error(transparent)]
    Baked(#[from] BakeError),
    /// A baked file of something that is not drawn here.
    #[error("a baked file of kind {kind:?}; hierarchy, tom and wavelet can be drawn")]
    Kind {
        /// What it says it is.
        kind: String,
    },
    /// Options that make no sense.
    #[error(transparent)]
    Option(#[from] OptionError),
    /// No hierarchy could be built.
    #[error(transparent)]
    Hierarchy(#[from] HierarchyError),
    /// No totally ordered mesh could be built.
    #[error(transparent)]
    Tom(#[from] TomError),
    /// No wavelet mesh could be built.
    #[error(transparent)]
    Wavelet(WaveletError),
    /// The mesh has no subdivision connectivity, which wavelets need.
    #[error("{0}; a vertex hierarchy takes any mesh (--structure hierarchy)")]
    NoConnectivity(WaveletError),
    /// There is nothing to draw.
    #[error("there are no triangles")]
    NoTriangles,
    /// A metric that does not exist.
    #[error("there is no metric named {name:?}")]
    NoMetric {
        /// As given.
        name: String,
    },
    /// Cancelled.
    #[error("cancelled")]
    Cancelled,
    /// The thread that built it is gone.
    #[error("the build ended without an answer")]
    Lost,
}

impl From<WaveletError> for ModelError {
    fn from(error: WaveletError) -> Self {
        match error {
            WaveletError::NoConnectivity { .. } => Self::NoConnectivity(error),
            _ => Self::Wavelet(error),
        }
    }
}

/// Which structure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum)]
pub enum StructureKind {
    /// A vertex hierarchy: fine where a view needs it.
    #[default]
    Hierarchy,
    /// A totally ordered mesh: one resolution for all of the model, by its nearest point.
    Tom,
    /// A wavelet mesh: fine where a view needs it, of a mesh that is a four-to-one subdivision of a coarser one.
    Wavelet,
}

/// Which texture coordinates a wavelet mesh has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum)]
pub enum Coordinates {
    /// Those of an atlas of its base faces, with a texture that shows them.
    #[default]
    Atlas,
    /// Its own.
    Own,
}

/// How to build.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct BuildOptions {
    /// Which structure; default a vertex hierarchy.
    pub structure: StructureKind,
    /// What a collapse costs, by name ([`metric::NAMES`]); default quadric.
    pub metric: String,
    /// Where merged vertices go; default at one end. A totally ordered mesh has no other.
    pub placement: Placement,
    /// How near cuts of a hierarchy stay to what the simplifier saw; default none.
    pub dependencies: Dependencies,
    /// Which errors the bounds of wavelets hold, and the shape around them.
    pub wavelets: WaveletOptions,
    /// Which texture coordinates a wavelet mesh has; default those of an atlas.
    pub coordinates: Coordinates,
}

impl Default for BuildOptions {
    fn default() -> Self {
        Self {
            structure: StructureKind::default(),
            metric: "quadric".to_owned(),
            placement: Placement::Endpoint,
            dependencies: Dependencies::None,
            wavelets: WaveletOptions::default(),
            coordinates: Coordinates::default(),
        }
    }
}

impl BuildOptions {
    /// With this structure.
    #[must_use]
    pub fn with_structure(mut self, structure: StructureKind) -> Self {
        self.structure = structure;
        self
    }

    /// With the metric of that name.
    #[must_use]
    pub fn with_metric(mut self, name: &str) -> Self {
        self.metric = name.to_owned();
        self
    }

    /// With this placement.
    #[must_use]
    pub fn with_placement(mut self, placement: Placement) -> Self {
        self.placement = placement;
        self
    }

    /// With these dependencies.
    #[must_use]
    pub fn with_dependencies(mut self, dependencies: Dependencies) -> Self {
        self.dependencies = dependencies;
        self
    }

    /// With these bounds of wavelets.
    #[must_use]
    pub fn with_wavelets(mut self, wavelets: WaveletOptions) -> Self {
        self.wavelets = wavelets;
        self
    }

    /// With these texture coordinates of a wavelet mesh.
    #[must_use]
    pub fn with_coordinates(mut self, coordinates: Coordinates) -> Self {
        self.coordinates = coordinates;
        self
    }
}

enum Structure {
    Hierarchy(HierarchyMesh),
    Tom(Arc<TomSteps>),
    Wavelet(Arc<WaveletMesh>),
}

/// A structure and its vertices. Immutable; instances share it.
pub struct Model {
    structure: Structure,
    vertices: Arc<[Vertex]>,
    bounds: [[f32; 3]; 2],
    materials: Vec<u32>,
    triangles: usize,
    has_uv: bool,
    texture: Option<Texture>,
}

/// Told how far a build is, 0 to 1; says whether to go on.
pub type Progress<'a> = &'a mut dyn FnMut(f32) -> ControlFlow<()>;

impl Model {
    /// Reads a mesh file, to be built: its origin is moved to the middle of its box, so that models far from the origin keep
    /// their shape.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn read_mesh(path: &Path) -> Result<Mesh, ModelError> {
        Ok(io::read_with(path, &ReadOptions::default().with_origin(SceneOrigin::Center))?.mesh)
    }

    /// Whether a path names a baked file.
    pub fn is_baked(path: &Path) -> bool {
        path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("mres"))
    }

    /// Reads a baked file; a wavelet mesh with those texture coordinates.
    ///
    /// # Errors
    /// The file cannot be read, or holds something else.
    pub fn read_baked(path: &Path, coordinates: Coordinates) -> Result<Self, ModelError> {
        let bytes = std::fs::read(path).map_err(|source| BakeError::Io { path: path.to_owned(), source })?;
        match io::baked_kind(&bytes)?.as_str() {
            HierarchyMesh::KIND => Self::of_hierarchy(io::unbake(HierarchyMesh::KIND, &bytes)?),
            TomMesh::KIND => Self::of_tom(io::unbake(TomMesh::KIND, &bytes)?),
            WaveletMesh::KIND => Self::of_wavelet(io::unbake(WaveletMesh::KIND, &bytes)?, coordinates),
            kind => Err(ModelError::Kind { kind: kind.to_owned() }),
        }
    }

    /// Builds a structure from a mesh.
    ///
    /// # Errors
    /// An option that makes no sense, a mesh without triangles or without the connectivity that wavelets need, or `progress` said
    /// to stop.
    pub fn build(mesh: &Mesh, options: &BuildOptions, progress: Progress<'_>) -> Result<Self, ModelError> {
        if mesh.triangles().is_empty() {
            return Err(ModelError::NoTriangles);
        }
        if options.structure == StructureKind::Wavelet {
            // Bounds take most of the time, and nobody counts their steps.
            let found = WaveletMesh::recognise(mesh, &options.wavelets)?;
            if progress(0.75).is_break() {
                return Err(ModelError::Cancelled);
            }
            return Self::of_wavelet(found, options.coordinates);
        }
        let metric = metric::by_name(&options.metric)
            .ok_or_else(|| ModelError::NoMetric { name: options.metric.clone() })?;
        let placement = match options.structure {
            StructureKind::Tom => Placement::Endpoint,
            _ => options.placement,
        };
        // What comes after the simplification takes about a quarter of the time.
        let sequence = Simplifier::new()
            .metric(metric)
            .placement(placement)
            .run_with(mesh, |at| progress(0.75 * at.fraction()))?;
        if sequence.report().stop == StopReason::Cancelled || progress(0.75).is_break() {
            return Err(ModelError::Cancelled);
        }
        match options.structure {
            StructureKind::Tom => Self::of_tom(TomMesh::new(mesh, &sequence)?),
            _ => Self::of_hierarchy(HierarchyMesh::new(mesh, &sequence, options.dependencies)?),
        }
    }

    fn of_hierarchy(mesh: HierarchyMesh) -> Result<Self, ModelError> {
        let parts = HierarchyParts::from((**mesh.hierarchy()).clone());
        let mut vertices = vertices(mesh.vertices());
        if !has_normals(mesh.vertices()) {
            smooth(&mut vertices, &parts.triangles);
            // A new vertex faces where those that it stands for do; fine ones are summed up first.
            let leaves = parts.substitute.len() - parts.first_leaf.len();
            for &vertex in parts.brings.iter().rev() {
                let to = parts.substitute[vertex as usize] as usize;
                if to >= leaves {
                    let sum = Vec3::from(vertices[to].normal) + Vec3::from(vertices[vertex as usize].normal);
                    vertices[to].normal = sum.to_array();
                }
            }
            let (_, made) = vertices.split_at_mut(leaves);
            made.iter_mut().for_each(|v| v.normal = Vec3::from(v.normal).normalize_or_zero().to_array());
        }
        let count = parts.bounds.len();
        for (split, bounds) in parts.bounds.iter().enumerate() {
            let brought = parts.brings_start[split] as usize..parts.brings_start[split + 1] as usize;
            for &vertex in &parts.brings[brought] {
                let vertex = &mut vertices[vertex as usize];
                (vertex.level, vertex.error) = (level(split, count), bounds.error);
            }
        }
        let materials = parts.materials;
        Self::new(Structure::Hierarchy(mesh), vertices, &parts.triangles, materials)
    }

    fn of_tom(mesh: TomMesh) -> Result<Self, ModelError> {
        let tom = mesh.tom();
        let mut made = vertices(mesh.vertices());
        if !has_normals(mesh.vertices()) {
            smooth(&mut made, tom.triangles());
        }
        let base = tom.coarsest().vertices();
        let count = made.len() - base.min(made.len());
        for (i, vertex) in made.iter_mut().enumerate().skip(base) {
            let above = tom.error_marks().partition_point(|mark| mark.vertices as usize <= i);
            let error = above.checked_sub(1).map_or(0.0, |at| tom.error_marks()[at].error);
            (vertex.level, vertex.error) = (level(i - base, count), error);
        }
        let materials = tom.material_ids().to_vec();
        let triangles = tom.triangles().to_vec();
        let steps = TomSteps::by_material(tom.clone())?;
        Self::new(Structure::Tom(Arc::new(steps)), made, &triangles, materials)
    }

    fn of_wavelet(mesh: WaveletMesh, coordinates: Coordinates) -> Result<Self, ModelError> {
        let worn = match coordinates {
            Coordinates::Atlas => texture::by_base(&mesh),
            Coordinates::Own => None,
        };
        let (mesh, texture) = worn.map_or((mesh, None), |(mesh, texture)| (mesh, Some(texture)));
        let mesh = Arc::new(mesh);
        let places: Arc<[[f32; 3]]> = mesh.vertices().positions().into();
        let mut full =
            WaveletLod::new(Arc::clone(&mesh), places, &Drawing::default()).map_err(WaveletError::from)?;
        full.adapt_by(&Everything, Motion::Other, f32::INFINITY);
        let triangles: Vec<[u32; 3]> =
            (0..full.groups()).flat_map(|group| full.triangles(group)).copied().collect();

        let mut made = vertices(mesh.vertices());
        if !has_normals(mesh.vertices()) {
            smooth(&mut made, &triangles);
        }
        let of = mesh.subdivision();
        for (i, vertex) in (0_u32..).zip(&mut made) {
            let Some(wavelet) = of.wavelet_of(i) else { continue };
            let bounds = mesh.bounds(wavelet);
            vertex.level = of.level_of(wavelet) as f32 / of.depth() as f32;
            vertex.error = bounds.along.max(bounds.across);
        }
        let materials = mesh.materials().to_vec();
        let model = Self::new(Structure::Wavelet(mesh), made, &triangles, materials)?;
        Ok(Self { texture, ..model })
    }

    fn new(
        structure: Structure,
        vertices: Vec<Vertex>,
        triangles: &[[u32; 3]],
        materials: Vec<u32>,
    ) -> Result<Self, ModelError> {
        let mut vertices = vertices;
        let mut corners = triangles.as_flattened().iter().map(|&v| Vec3::from(vertices[v as usize].position));
        let first = corners.next().ok_or(ModelError::NoTriangles)?;
        let (low, high) = corners.fold((first, first), |(low, high), p| (low.min(p), high.max(p)));
        // Vertices of the coarsest mesh are never left out.
        let diagonal = (high - low).length();
        vertices.iter_mut().filter(|v| v.level == 0.0).for_each(|v| v.error = diagonal);
        Ok(Self {
            structure,
            bounds: [low.to_array(), high.to_array()],
            materials: if materials.is_empty() { vec![0] } else { materials },
            triangles: triangles.len(),
            has_uv: vertices.iter().any(|v| v.uv != [0.0; 2]),
            vertices: vertices.into(),
            texture: None,
        })
    }

    /// Its vertices, in the structure's order.
    pub fn vertices(&self) -> &Arc<[Vertex]> {
        &self.vertices
    }

    /// Those of them that instances share on the card: none where each draws values of its own.
    pub fn shared_vertices(&self) -> &[Vertex] {
        match &self.structure {
            Structure::Wavelet(_) => &[],
            _ => &self.vertices,
        }
    }

    /// What surfaces are painted with unless somebody says otherwise: the size of a picture, and its pixels row by row. A wavelet
    /// mesh's by its base, else a checker.
    pub fn picture(&self) -> ([u32; 2], Cow<'_, [[u8; 4]]>) {
        match &self.texture {
            Some(Texture { size, pixels }) => (*size, Cow::Borrowed(pixels)),
            None => {
                let (side, checker) = Paint::checker();
                ([side; 2], Cow::Owned(checker))
            }
        }
    }

    /// The texture by its base, where it has one.
    pub fn texture(&self) -> Option<&Texture> {
        self.texture.as_ref()
    }

    /// Smallest and largest corner of the box around its full resolution, object units.
    pub fn bounds(&self) -> [[f32; 3]; 2] {
        self.bounds
    }

    /// Material id of every group of triangles.
    pub fn materials(&self) -> &[u32] {
        &self.materials
    }

    /// Triangles at full resolution.
    pub fn triangle_count(&self) -> usize {
        self.triangles
    }

    /// Whether it has texture coordinates.
    pub fn has_uv(&self) -> bool {
        self.has_uv
    }

    /// What it is called.
    pub fn kind(&self) -> &'static str {
        match &self.structure {
            Structure::Hierarchy(mesh) => match mesh.hierarchy().dependencies() {
                Dependencies::Adjacent => "vertex hierarchy, adjacent dependencies",
                Dependencies::Neighbours => "vertex hierarchy, neighbours as dependencies",
                _ => "vertex hierarchy",
            },
            Structure::Tom(_) => "totally ordered mesh",
            Structure::Wavelet(mesh) => match mesh.options().bound {
                ErrorBound::WithoutSiblings => "wavelet mesh, bounds without siblings",
                _ => "wavelet mesh",
            },
        }
    }

    /// The wavelet mesh, where it is one.
    pub fn wavelets(&self) -> Option<&Arc<WaveletMesh>> {
        match &self.structure {
            Structure::Wavelet(mesh) => Some(mesh),
            _ => None,
        }
    }

    /// Whether instances may be compact, geomorphed and limited: not those of a totally ordered mesh.
    pub fn is_selective(&self) -> bool {
        !matches!(self.structure, Structure::Tom(_))
    }

    /// An instance that follows a view.
    pub fn instance(&self, settings: &LodSettings) -> Box<dyn Instance> {
        match &self.structure {
            Structure::Hierarchy(mesh) => {
                Box::new(HierarchyInstance::new(mesh.hierarchy(), &self.vertices, settings))
            }
            Structure::Tom(steps) => Box::new(TomLod::new(Arc::clone(steps), self.bounds)),
            Structure::Wavelet(mesh) => Box::new(
                WaveletInstance::new(mesh, &self.vertices, settings)
                    .expect("a model has as many vertices as its wavelet mesh"),
            ),
        }
    }

    /// An instance at full resolution.
    pub fn full(&self) -> Box<dyn Instance> {
        let mut full = self.instance(&LodSettings::default());
        full.refine_fully();
        full
    }
}

/// Where something comes in an order that doubles, from the coarsest (0) to the last (1).
fn level(at: usize, count: usize) -> f32 {
    ((1.0 + at as f32).log2() / (1.0 + count as f32).log2()).clamp(0.0, 1.0)
}

fn has_normals(mesh: &Mesh) -> bool {
    floats(mesh, names::NORMAL, 3).is_some()
}

fn floats<'a>(mesh: &'a Mesh, name: &str, width: usize) -> Option<&'a [f32]> {
    mesh.attribute(name).filter(|a| a.width() == width).and_then(|a| a.as_floats())
}

/// Positions, normals and texture coordinates of a mesh.
fn vertices(mesh: &Mesh) -> Vec<Vertex> {
    let (normals, uv) = (floats(mesh, names::NORMAL, 3), floats(mesh, names::UV, 2));
    let vertex = |(i, &position): (usize, &[f32; 3])| Vertex {
        position,
        normal: normals.map_or([0.0; 3], |n| [n[3 * i], n[3 * i + 1], n[3 * i + 2]]),
        uv: uv.map_or([0.0; 2], |uv| [uv[2 * i], uv[2 * i + 1]]),
        ..Vertex::default()
    };
    mesh.positions().iter().enumerate().map(vertex).collect()
}

/// Gives every vertex the mean normal of the triangles around its position, by area.
fn smooth(vertices: &mut [Vertex], triangles: &[[u32; 3]]) {
    debug_assert!(vertices.len() <= MAX_ELEMENTS);
    let positions: Vec<[f32; 3]> = vertices.iter().map(|v| v.position).collect();
    // Positions and triangles come from a mesh and fit; where they did not, there are no normals and shading is flat.
    let Ok(mesh) = Mesh::new(positions, triangles) else { return };
    let topology = Topology::new(&mesh);
    let mut sums = vec![glam::DVec3::ZERO; topology.point_count()];
    let unit = mesh.diagonal().max(f64::MIN_POSITIVE);
    for triangle in mesh.triangles() {
        let [a, b, c] =
            triangle.map(|v| glam::DVec3::from_array(mesh.positions()[v as usize].map(f64::from)) / unit);
        let normal = (b - a).cross(c - a);
        triangle.iter().for_each(|&v| sums[topology.point_of()[v as usize] as usize] += normal);
    }
    for (vertex, &point) in vertices.iter_mut().zip(topology.point_of()) {
        vertex.normal = sums[point as usize].normalize_or_zero().as_vec3().to_array();
    }
}
