//! A model that can be drawn at any level of detail: a structure, and its vertices as the card reads them.

use std::borrow::Cow;
use std::ops::ControlFlow;
use std::path::Path;

use glam::Vec3;
use multires::gmesh::{Gmesh, GmeshBuilder};
use multires::hierarchy::{Dependencies, HierarchyBuilder};
use multires::io::{self, BakeError, ReadError, ReadOptions, SceneOrigin};
use multires::lod::{Baked, FromSequence, Lod, LodError, LodOptions, Structure, Values, VertexBuffer};
use multires::mesh::{MAX_ELEMENTS, Mesh, Topology, names};
use multires::simplify::{Placement, Simplifier, Target, metric};
use multires::tom::TomBuilder;
use multires::wavelet::{WaveletError, WaveletMesh, WaveletOptions};

use super::pictures::Pictures;
use super::texture::{self, Texture};
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
    Baked(BakeError),
    /// No structure could be built, or no instance made.
    #[error(transparent)]
    Build(multires::Error),
    /// The mesh has no subdivision connectivity, which wavelets need.
    #[error("{0}; a vertex hierarchy takes any mesh (--structure hierarchy)")]
    NoConnectivity(multires::Error),
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

impl From<LodError> for ModelError {
    fn from(error: LodError) -> Self {
        Self::Build(error.into())
    }
}

impl ModelError {
    /// Of any error of the library.
    fn of(error: impl Into<multires::Error>) -> Self {
        match error.into() {
            multires::Error::Read(error) => Self::Read(error),
            multires::Error::Bake(error) => Self::Baked(error),
            error if error.is_cancelled() => Self::Cancelled,
            error @ multires::Error::Wavelet(WaveletError::NoConnectivity { .. }) => {
                Self::NoConnectivity(error)
            }
            error => Self::Build(error),
        }
    }
}

/// Which structure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "program", derive(clap::ValueEnum))]
pub enum StructureKind {
    /// A vertex hierarchy: fine where a view needs it.
    #[default]
    Hierarchy,
    /// A totally ordered mesh: one resolution for all of the model, by its nearest point.
    Tom,
    /// A geomorph mesh: few levels for all of the model, which turn into each other in the vertex shader.
    Gmesh,
    /// A wavelet mesh: fine where a view needs it, of a mesh that is a four-to-one subdivision of a coarser one.
    Wavelet,
}

/// Which texture coordinates a wavelet mesh has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "program", derive(clap::ValueEnum))]
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
    /// Triangles of the coarsest level; default as few as can be. A wavelet mesh has those of its base.
    pub coarsest: Option<usize>,
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
            coarsest: None,
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

    /// With so many triangles in the coarsest level.
    #[must_use]
    pub fn with_coarsest(mut self, triangles: impl Into<Option<usize>>) -> Self {
        self.coarsest = triangles.into();
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

/// A baked model and its vertices as the card reads them. Immutable; instances share it.
pub struct Model {
    baked: Box<dyn io::StoredModel<Vertex>>,
    values: Values<Vertex>,
    bounds: [[f32; 3]; 2],
    materials: Vec<u32>,
    has_uv: bool,
    texture: Option<Texture>,
    /// Normals in tangent space, for the model's own coordinates.
    normal_map: Option<Texture>,
    /// Whether the file names pictures.
    is_painted: bool,
    warnings: Vec<String>,
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
        Self::new(io::read_model(path).map_err(ModelError::of)?, coordinates)
    }

    /// The same from memory.
    ///
    /// # Errors
    /// The bytes hold something else.
    pub fn of_baked(bytes: &[u8], coordinates: Coordinates) -> Result<Self, ModelError> {
        Self::new(io::unbake_model(bytes).map_err(ModelError::of)?, coordinates)
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
        let metric = metric::by_name(&options.metric)
            .ok_or_else(|| ModelError::NoMetric { name: options.metric.clone() })?;
        let to_coarsest = |simplifier: Simplifier| match options.coarsest {
            Some(triangles) => simplifier.target(Target::Triangles(triangles)),
            None => simplifier,
        };
        let simplifier = to_coarsest(match options.structure {
            StructureKind::Gmesh => Gmesh::simplifier(),
            _ => Simplifier::new(),
        });
        let simplifier = simplifier.metric(metric);
        let baked: Box<dyn io::StoredModel<Vertex>> = match options.structure {
            StructureKind::Hierarchy => Box::new(
                HierarchyBuilder::new()
                    .simplifier(simplifier.placement(options.placement))
                    .dependencies(options.dependencies)
                    .bake_with(mesh, progress)
                    .map_err(ModelError::of)?,
            ),
            StructureKind::Tom => Box::new(
                TomBuilder::new().simplifier(simplifier).bake_with(mesh, progress).map_err(ModelError::of)?,
            ),
            StructureKind::Gmesh => Box::new(
                GmeshBuilder::new()
                    .simplifier(simplifier.placement(options.placement))
                    .bake_with(mesh, progress)
                    .map_err(ModelError::of)?,
            ),
            StructureKind::Wavelet => {
                Box::new(WaveletMesh::bake_with(mesh, &options.wavelets, progress).map_err(ModelError::of)?)
            }
        };
        Self::new(baked, options.coordinates)
    }

    fn new(baked: Box<dyn io::StoredModel<Vertex>>, coordinates: Coordinates) -> Result<Self, ModelError> {
        let (baked, texture) = match coordinates {
            Coordinates::Atlas => texture::worn(baked),
            Coordinates::Own => (baked, None),
        };
        let [low, high] = baked.bounds().ok_or(ModelError::NoTriangles)?;
        let diagonal = (Vec3::from(high) - Vec3::from(low)).length();
        let mut vertices = vertices(baked.vertices());
        for (vertex, rank) in vertices.iter_mut().zip(baked.vertex_ranks()) {
            // Vertices of the coarsest mesh are never left out.
            (vertex.level, vertex.error) = (rank.share, rank.error.min(diagonal));
        }
        if !has_normals(baked.vertices()) {
            shade(&*baked, &mut vertices)?;
        }
        let materials = baked.materials();
        Ok(Self {
            bounds: [low, high],
            materials: if materials.is_empty() { vec![0] } else { materials.to_vec() },
            has_uv: vertices.iter().any(|v| v.uv != [0.0; 2]),
            values: Values::from(vertices).with_blending(),
            texture,
            normal_map: None,
            is_painted: false,
            warnings: Vec::new(),
            baked,
        })
    }

    /// With the pictures inside the glTF file that it was built from.
    #[must_use]
    pub fn with_pictures_in(self, gltf: &[u8]) -> Self {
        self.with_pictures(Pictures::of(gltf))
    }

    /// With pictures for its texture coordinates, or warnings why there are none.
    pub(super) fn with_pictures(mut self, pictures: Pictures) -> Self {
        self.warnings.extend(pictures.warnings);
        let is_any = pictures.base_colour.is_some() || pictures.normals.is_some();
        if is_any && !self.has_uv {
            self.warnings.push("pictures need texture coordinates".to_owned());
        } else if is_any {
            // A normal map alone lies on grey.
            let grey = || Texture { size: [1; 2], pixels: vec![[176, 180, 186, 255]] };
            self.texture = Some(pictures.base_colour.unwrap_or_else(grey));
            self.normal_map = pictures.normals;
            self.is_painted = true;
        }
        self
    }

    /// With pictures that were read elsewhere: colours, and normals in tangent space, and whether its file names them.
    #[must_use]
    pub fn with_textures(
        mut self,
        colours: Option<Texture>,
        normals: Option<Texture>,
        is_painted: bool,
    ) -> Self {
        (self.texture, self.normal_map, self.is_painted) = (colours, normals, is_painted);
        self
    }

    /// Whether its file names pictures to paint it with.
    pub fn is_painted(&self) -> bool {
        self.is_painted
    }

    /// The normals in tangent space that its file names, for where the surface is painted.
    pub fn normal_map(&self) -> Option<&Texture> {
        self.normal_map.as_ref()
    }

    /// What is not drawn as the file asks for.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// Its vertices, in the structure's order.
    pub fn vertices(&self) -> &Values<Vertex> {
        &self.values
    }

    /// What surfaces are painted with unless somebody says otherwise: the size of a picture, and its pixels row by row. A glTF
    /// file's base colours, a wavelet mesh's by its base, else a checker.
    pub fn picture(&self) -> ([u32; 2], Cow<'_, [[u8; 4]]>) {
        match &self.texture {
            Some(Texture { size, pixels }) => (*size, Cow::Borrowed(pixels)),
            None => {
                let (side, checker) = Paint::checker();
                ([side; 2], Cow::Owned(checker))
            }
        }
    }

    /// The base colours of its file, or the texture by its base, where it has one.
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
        self.baked.triangle_counts()[0]
    }

    /// Whether it has texture coordinates.
    pub fn has_uv(&self) -> bool {
        self.has_uv
    }

    /// What kind of structure it is.
    pub fn kind(&self) -> &'static str {
        self.baked.kind()
    }

    /// The baked model.
    pub fn baked(&self) -> &dyn io::StoredModel<Vertex> {
        &*self.baked
    }

    /// The baked model as a g-mesh; `None` if it is another structure.
    pub fn gmesh(&self) -> Option<&Baked<Gmesh>> {
        self.baked.as_any().downcast_ref()
    }

    /// An instance that follows a view.
    ///
    /// # Errors
    /// The structure cannot be drawn that way.
    pub fn instance(&self, options: &LodOptions) -> Result<Box<dyn Lod>, LodError> {
        self.baked.instance(&self.values, options)
    }
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

/// Gives every vertex the mean normal of the triangles around its position at full resolution, by area; one that a collapse made
/// the mean of those that it was made of.
fn shade(baked: &dyn io::StoredModel<Vertex>, vertices: &mut [Vertex]) -> Result<(), ModelError> {
    let places = Values::from(vertices.to_vec()).with_blending();
    let mut full = baked.instance(&places, &LodOptions::default().with_buffer(VertexBuffer::Shared))?;
    full.refine_fully();
    let triangles: Vec<[u32; 3]> =
        (0..full.groups()).flat_map(|group| full.triangles(group)).copied().collect();
    smooth(vertices, &triangles);
    let mut normal_of: Vec<(u32, Vec3)> = vertices
        .iter()
        .zip(baked.origins().order())
        .map(|(v, &origin)| (origin, Vec3::from(v.normal)))
        .collect();
    normal_of.sort_by_key(|entry| entry.0);
    let origins = baked.origins();
    let own =
        |origin: u32| normal_of.binary_search_by_key(&origin, |entry| entry.0).map(|at| normal_of[at].1);
    let mut made: Vec<Vec3> = Vec::with_capacity(origins.mixtures().len());
    for mixture in origins.mixtures() {
        let [a, b] = mixture.from.map(|from| match (from as usize).checked_sub(origins.input_vertices()) {
            Some(mixture) => made[mixture],
            None => own(from).unwrap_or_default(),
        });
        made.push(a.lerp(b, mixture.weight));
    }
    for (vertex, &origin) in vertices.iter_mut().zip(origins.order()) {
        if let Some(mixture) = (origin as usize).checked_sub(origins.input_vertices()) {
            vertex.normal = made[mixture].normalize_or_zero().to_array();
        }
    }
    Ok(())
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
