//! Options of a remeshing, and the run.

use std::ops::ControlFlow;

use crate::mesh::Mesh;
use crate::simplify::metric::{Borrowed, ErrorMetric, MemorylessQuadric};

use super::coarsen::coarsen;
use super::parameterisation::Parameterisation;
use super::sectors::split;
use super::{Features, RemeshError};

/// Base faces by default.
const BASE_FACES: usize = 500;

/// Finds a base of few triangles and a one-to-one map between it and a mesh.
///
/// Any mesh will do: any genus, open or not, several components, non-manifold. The map keeps borders, seams, material
/// borders and creases on edges of the base ([`Features`]).
///
/// ```
/// use multires::mesh::shapes;
/// use multires::remesh::{Depth, Remesher};
/// use multires::wavelet::WaveletOptions;
///
/// let mesh = shapes::rock(5_000, 1);
/// let map = Remesher::new().base_faces(100).run(&mesh)?;
/// assert_eq!(map.base().triangles().len(), 100);
///
/// // 100 faces, split four to one three times: a model that adapts to views.
/// let model = map.bake(&mesh, Depth::Levels(3), &WaveletOptions::default())?;
/// assert_eq!(model.structure().subdivision().leaf_count(), 6_400);
/// # Ok::<(), multires::remesh::RemeshError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Remesher<M = MemorylessQuadric> {
    metric: M,
    base_faces: usize,
    features: Features,
    smoothing: Smoothing,
    fitting: Fitting,
}

/// Smoothing of the map from a base to a mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Smoothing {
    /// Lines on the base bend at edges and vertices of the base.
    Off,
    /// Points of the base move towards the discrete harmonic map: edges of the base do not show, angles are kept better.
    #[default]
    Harmonic,
}

/// Where the vertices of a remesh go.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Fitting {
    /// On the mesh: a remesh lies inside of bulges and outside of hollows.
    Off,
    /// Off the mesh, along their normals, so that the triangles come closest to the mesh: mean and largest distances fall by
    /// about a third. Vertices of the base and on features stay on the mesh, and so do those of remeshes to an error
    /// ([`Depth::Error`](super::Depth::Error)).
    #[default]
    LeastSquares,
}

impl Default for Remesher {
    fn default() -> Self {
        Self::new()
    }
}

impl Remesher {
    /// Creates a remesher with the defaults.
    pub fn new() -> Self {
        Self {
            metric: MemorylessQuadric::new(),
            base_faces: BASE_FACES,
            features: Features::new(),
            smoothing: Smoothing::default(),
            fitting: Fitting::default(),
        }
    }
}

impl<M: ErrorMetric> Remesher<M> {
    /// Sets the number of base faces to aim at. Default: 500. More are left where features, the topology or the shape of
    /// triangles forbid fewer: if more by a quarter, then another quarter of the number is left on top of the fewest possible, so
    /// that parts which could go on are not ground down in the place of parts which cannot.
    #[must_use]
    pub fn base_faces(mut self, count: usize) -> Self {
        self.base_faces = count;
        self
    }

    /// Sets the cost of the collapses that make the base. Default: [`MemorylessQuadric`], which had the least distortion of
    /// five metrics tried on a scan, before smoothing.
    #[must_use]
    pub fn metric<N: ErrorMetric>(self, metric: N) -> Remesher<N> {
        let Self { base_faces, features, smoothing, fitting, .. } = self;
        Remesher { metric, base_faces, features, smoothing, fitting }
    }

    /// Sets the edges that base edges must follow.
    #[must_use]
    pub fn features(mut self, features: Features) -> Self {
        self.features = features;
        self
    }

    /// Sets the smoothing of the map. Default: [`Smoothing::Harmonic`].
    #[must_use]
    pub fn smoothing(mut self, smoothing: Smoothing) -> Self {
        self.smoothing = smoothing;
        self
    }

    /// Sets where the vertices of remeshes go. Default: [`Fitting::LeastSquares`].
    #[must_use]
    pub fn fitting(mut self, fitting: Fitting) -> Self {
        self.fitting = fitting;
        self
    }

    /// Finds base and map. O(n log n).
    ///
    /// # Errors
    /// The mesh has no triangles.
    pub fn run(&mut self, mesh: &Mesh) -> Result<Parameterisation, RemeshError> {
        self.run_with(mesh, |_| ControlFlow::Continue(()))
    }

    /// Finds base and map, with progress: the share done, 0 to 1. Where `progress` breaks, the run ends.
    ///
    /// # Errors
    /// The mesh has no triangles, or `progress` breaks.
    pub fn run_with(
        &mut self,
        mesh: &Mesh,
        mut progress: impl FnMut(f32) -> ControlFlow<()>,
    ) -> Result<Parameterisation, RemeshError> {
        // The simplifier reports every few thousand collapses: small meshes would never be asked about.
        if progress(0.0).is_break() {
            return Err(RemeshError::Cancelled);
        }
        let sectors = split(mesh, &self.features)?;
        if !sectors.is_face.contains(&true) {
            return Err(RemeshError::Empty);
        }
        let coarse = coarsen(&sectors, Borrowed(&mut self.metric), self.base_faces, &mut progress)?;
        let map = Parameterisation::new(mesh, &sectors, coarse, (self.smoothing, self.fitting));
        if progress(1.0).is_break() { Err(RemeshError::Cancelled) } else { Ok(map) }
    }
}
