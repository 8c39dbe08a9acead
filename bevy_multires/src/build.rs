//! From a mesh to levels of detail or to a vertex hierarchy: what runs in the background.

use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering::Relaxed};

use bevy::math::Vec3;
use bevy::mesh::Mesh as BevyMesh;
use multires::hierarchy::{HierarchyError, VertexHierarchy};
use multires::lod::{Model, Structure};
use multires::mesh::names;
use multires::simplify::{AttributeDeviation, Normals, NormalsDone, OptionError, Simplifier};

use crate::convert::{self, ConvertError, from_bevy};

/// Why levels of detail cannot be built.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BuildError {
    /// The mesh cannot be converted.
    #[error(transparent)]
    Convert(#[from] ConvertError),
    /// All triangles of the mesh have two equal corners, or there are none.
    #[error("the mesh has no triangle with three different corners")]
    Degenerate,
    /// The mesh cannot be simplified.
    #[error(transparent)]
    Levels(#[from] OptionError),
    /// The mesh went, or changed, while its levels were being built.
    #[error("the mesh went while its levels were being built")]
    Cancelled,
    /// The vertex hierarchy cannot be built.
    #[error(transparent)]
    Hierarchy(#[from] HierarchyError),
    /// The model has no such part.
    #[error("the model has {parts} parts, and none of number {part}")]
    Part {
        /// Number of the part asked for.
        part: usize,
        /// Number of parts.
        parts: usize,
    },
    /// The structure of a baked file cannot follow a view with vertices that may not be mixed: wavelet meshes.
    #[error("a {kind} of a file cannot follow the view here; its levels are drawn")]
    NotViewDependent {
        /// Kind of the structure.
        kind: &'static str,
    },
}

/// Which levels of detail a mesh gets. Each level has `ratio` times the triangles of the level before.
///
/// ```
/// let ladder = bevy_multires::Ladder::default().with_ratio(0.7).with_least_triangles(200);
/// assert_eq!(ladder.most_levels, 12);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Ladder {
    /// Triangles of a level as a share of the level before, 0.1 to 0.9; default 0.5.
    pub ratio: f32,
    /// Fewest triangles of a level; default 48. A mesh with no more has no levels besides itself.
    pub least_triangles: usize,
    /// Most levels, the mesh itself included; default 12.
    pub most_levels: usize,
}

impl Default for Ladder {
    fn default() -> Self {
        Self { ratio: 0.5, least_triangles: 48, most_levels: 12 }
    }
}

impl Ladder {
    /// Sets the share of triangles from level to level. Values outside 0.1 to 0.9 count as the nearest of both; NaN gives no levels.
    #[must_use]
    pub fn with_ratio(mut self, ratio: f32) -> Self {
        self.ratio = ratio;
        self
    }

    /// Sets the fewest triangles of a level.
    #[must_use]
    pub fn with_least_triangles(mut self, least: usize) -> Self {
        self.least_triangles = least;
        self
    }

    /// Sets the most levels, the mesh itself included.
    #[must_use]
    pub fn with_most_levels(mut self, most: usize) -> Self {
        self.most_levels = most;
        self
    }

    /// Returns the numbers of triangles to ask for, of a mesh of so many, without the mesh itself.
    pub(crate) fn steps(self, triangles: usize) -> impl Iterator<Item = usize> {
        let ratio = f64::from(self.ratio.clamp(0.1, 0.9));
        let next = move |&triangles: &usize| Some((triangles as f64 * ratio) as usize);
        let least = self.least_triangles.max(1);
        let first = next(&triangles);
        std::iter::successors(first, next)
            .take_while(move |&triangles| triangles >= least)
            .take(self.most_levels.saturating_sub(1))
    }
}

/// How far a build is, read and cancelled from other threads.
#[derive(Debug, Default)]
pub(crate) struct Progress {
    /// Bits of a float.
    share: AtomicU32,
    cancelled: AtomicBool,
}

impl Progress {
    /// Returns the share done, 0 to 1.
    pub fn share(&self) -> f32 {
        f32::from_bits(self.share.load(Relaxed))
    }

    pub fn cancel(&self) {
        self.cancelled.store(true, Relaxed);
    }

    fn step(&self, share: f32) -> ControlFlow<()> {
        self.share.store(share.to_bits(), Relaxed);
        if self.cancelled.load(Relaxed) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

/// Share of a build's time taken by the simplification.
const SIMPLIFICATION: f32 = 0.8;

/// A level of detail, not an asset yet.
pub(crate) struct BuiltLevel {
    pub mesh: BevyMesh,
    /// As [`LodLevel::error`](crate::LodLevel::error).
    pub error: f32,
}

/// Builds the levels of a mesh, fine to coarse, without the mesh itself. Vertices of levels are vertices of the mesh. Normals, colours,
/// texture coordinates and morph targets are fitted to the mesh, because a value that is right at a vertex of a large triangle is wrong
/// within it.
pub(crate) fn levels(
    source: &BevyMesh,
    ladder: &Ladder,
    progress: &Progress,
) -> Result<Vec<BuiltLevel>, BuildError> {
    let (mesh, layout) = from_bevy(source)?;
    let steps: Vec<usize> = ladder.steps(mesh.triangles().len()).collect();
    if steps.is_empty() && !mesh.triangles().is_empty() {
        return Ok(Vec::new());
    }
    let mut broke = progress.step(0.0);
    let mut simplifier = Simplifier::new().normals(normals(&mesh)?);
    let sequence = simplifier.run_with(&mesh, |at| {
        broke = progress.step(SIMPLIFICATION * at.fraction());
        broke
    })?;
    if sequence.triangles_after(0) == 0 {
        return Err(BuildError::Degenerate);
    }
    let aabb = source.final_aabb.or_else(|| aabb(&mesh));
    let mut levels: Vec<BuiltLevel> = Vec::new();
    let mut last = mesh.triangles().len();
    let extracting = (1.0 - SIMPLIFICATION) / steps.len().max(1) as f32;
    for (at, most) in steps.into_iter().enumerate() {
        if broke.is_break() || progress.step(SIMPLIFICATION + extracting * at as f32).is_break() {
            return Err(BuildError::Cancelled);
        }
        let step = sequence.steps_for_triangles(most);
        let triangles = sequence.triangles_after(step);
        // Where the mesh gives no more, another level would only take memory.
        if triangles == 0 || triangles as f64 > 0.9 * last as f64 {
            break;
        }
        last = triangles;
        let level = sequence.extract_fitted(&mesh, step);
        let shading = shading_error(&level, &sequence.attribute_deviations(&mesh, step, &level));
        // Ascending, as the errors of the surface are.
        let before = levels.last().map_or(0.0, |level| level.error);
        let error = sequence.error_after(step).max(shading).max(before);
        let mut level = layout.to_bevy(&level)?;
        level.final_aabb = aabb;
        levels.push(BuiltLevel { mesh: level, error });
    }
    Ok(levels)
}

/// Returns the distance by which the surface of a level is off as its normals tell: `angle * edge / 2`, object units. Light shows it even
/// where the surface is in place. `angle` is the mean deviation of normals, `edge` the side of a square of two triangles of mean area.
fn shading_error(level: &multires::Mesh, deviations: &[AttributeDeviation]) -> f32 {
    let Some(normals) = deviations.iter().find(|of| of.name == names::NORMAL) else { return 0.0 };
    let place = |corner: u32| Vec3::from(level.positions()[corner as usize]).as_dvec3();
    let double_area = |&[a, b, c]: &[u32; 3]| (place(b) - place(a)).cross(place(c) - place(a)).length();
    let area: f64 = level.triangles().iter().map(double_area).sum();
    let edge = (area / level.triangles().len().max(1) as f64).sqrt();
    (0.5 * normals.mean.to_radians() * edge) as f32
}

/// Returns the treatment of a mesh's normals. Where every face has normals of its own, each level gets new ones: kept, they would hold
/// all vertices.
fn normals(mesh: &multires::Mesh) -> Result<Normals, OptionError> {
    Ok(match Normals::Automatic.resolve(mesh)? {
        NormalsDone::Recomputed(_) => Normals::Recompute { crease_angle: None },
        _ => Normals::Keep,
    })
}

/// A model that follows the view: the structure, and its vertices as Bevy's attributes. Values of its instances are numbers of vertices.
pub(crate) struct Following {
    pub model: Arc<dyn Model<u32>>,
    /// All vertices in the structure's order, without indices.
    pub vertices: BevyMesh,
    /// Whether indices have 16 bits where they fit.
    pub short: bool,
}

/// Builds the vertex hierarchy of a mesh.
pub(crate) fn hierarchy(source: &BevyMesh, progress: &Progress) -> Result<Following, BuildError> {
    let (mesh, _) = from_bevy(source)?;
    let model = VertexHierarchy::bake_with(&mesh, &Default::default(), |share| progress.step(share))?;
    if model.structure().triangle_count() == 0 {
        return Err(BuildError::Degenerate);
    }
    let mut vertices = convert::gather(source, model.origins().order())?;
    vertices
        .try_insert_attribute(BevyMesh::ATTRIBUTE_POSITION, model.vertices().positions().to_vec())
        .map_err(ConvertError::from)?;
    vertices.final_aabb = source.final_aabb.or_else(|| aabb(&mesh));
    Ok(Following { model: Arc::new(model), vertices, short: convert::is_short(source) })
}

/// Returns the box of the full resolution: levels have the same, so that nothing is culled otherwise than before.
fn aabb(mesh: &multires::Mesh) -> Option<bevy::math::bounding::Aabb3d> {
    mesh.bounds().map(|[low, high]| bevy::math::bounding::Aabb3d::from_min_max(low, high))
}
